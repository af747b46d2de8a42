//! Positions → velocities: how fast the place changes from one sample to the next.
//!
//! The velocity at a position is the slope there of the parabola through it and its two neighbours: a central difference
//! that is right to the second order however the three are spaced. Nothing is taken across a gap longer than the maximum,
//! across a reset of the estimator, or from one side only, so the first and the last position have no velocity.
//!
//! A position waits for the next one, and all samples after it wait with it, so that samples stay in order; never longer
//! than the maximum gap.

use nalgebra::Vector3;

use super::{MaxGap, motion::BURST, orientation::is_same_origin};
use crate::{
    geometry::geodetic::Geodetic,
    sample::{
        DropReason, Position, PositionSample, Sample, Stamp, Tally, Velocity, VelocitySample,
    },
};

/// A place from which differences are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Geodetic(Geodetic),
    /// Metres north, east, down.
    Local(Vector3<f64>),
}

impl Place {
    /// The place; `None` if it is none, such as the latitude and longitude 0 that stand for an unknown place.
    fn of(position: &Position) -> Option<Self> {
        match *position {
            Position::Local(place) => Some(Self::Local(place)),
            Position::Geodetic {
                latitude: 0.0,
                longitude: 0.0,
                ..
            } => None,
            Position::Geodetic {
                latitude,
                longitude,
                altitude,
            } => Geodetic::from_degrees(latitude, longitude, altitude).map(Self::Geodetic),
        }
    }

    /// How the coordinates change up to another place, if both are of the same kind.
    fn change_to(&self, other: &Self) -> Option<Vector3<f64>> {
        match (self, other) {
            (Self::Geodetic(here), Self::Geodetic(there)) => Some(here.change_to(there)),
            (Self::Local(here), Self::Local(there)) => Some(there - here),
            _ => None,
        }
    }

    /// The velocity north, east, down, of something that is here while its coordinates change at these rates.
    fn velocity(&self, rates: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Geodetic(here) => here.in_ned(rates),
            Self::Local(_) => rates,
        }
    }
}

/// A position from which a difference can be taken.
#[derive(Debug, Clone, Copy)]
struct Point {
    stamp: Stamp,
    place: Place,
    resets: Option<u64>,
}

/// How the coordinates changed on average between two positions, per second, and in how many seconds.
#[derive(Debug, Clone, Copy)]
struct Slope {
    rates: Vector3<f64>,
    seconds: f64,
}

impl Point {
    /// The slope up to a later one, if the two belong together.
    fn slope_to(&self, later: &Self, max_gap: MaxGap) -> Option<Slope> {
        let (from, to) = (self.stamp.log_time, later.stamp.log_time);
        if !is_same_origin(self.resets, later.resets) || !max_gap.spans(from, to) {
            return None;
        }
        let seconds = (to - from) as f64 / 1e9;
        let change = self.place.change_to(&later.place)?;
        Some(Slope {
            rates: change / seconds,
            seconds,
        })
    }
}

/// The slope of a parabola at its middle point, from the slopes on both sides: each counts the more the shorter it is.
fn middle(before: Slope, after: Slope) -> Vector3<f64> {
    let both = before.seconds + after.seconds;
    before.rates * (after.seconds / both) + after.rates * (before.seconds / both)
}

/// Turns positions in a stream of samples into velocities, and passes on the other samples, but for velocities.
#[derive(Debug)]
pub(super) struct FromPositions {
    max_gap: MaxGap,
    /// The latest position.
    last: Option<Point>,
    /// The slope up to it, while it waits for the next one.
    slope: Option<Slope>,
    /// The time of the latest position, whatever became of it.
    last_time: Option<u64>,
    /// The samples after the position that waits.
    held: Vec<Sample>,
    /// What became of the positions.
    pub(super) tally: Tally,
}

impl FromPositions {
    pub(super) fn new(max_gap: MaxGap) -> Self {
        Self {
            max_gap,
            last: None,
            slope: None,
            last_time: None,
            held: Vec::new(),
            tally: Tally::default(),
        }
    }

    /// Takes the next sample, and passes on those that need not wait.
    pub(super) fn push(&mut self, sample: Sample, mut pass: impl FnMut(Sample)) {
        let time = sample.stamp().log_time;
        if (self.last).is_some_and(|last| !self.max_gap.spans(last.stamp.log_time, time)) {
            self.give_up(&mut pass);
        }
        match sample {
            Sample::Position(sample) => self.push_position(&sample, pass),
            Sample::Velocity(_) => {}
            other if self.slope.is_some() => self.held.push(other),
            other => pass(other),
        }
    }

    /// Ends the stream, or the part of it whose times belong together: the position that waits is dropped.
    pub(super) fn end(&mut self, mut pass: impl FnMut(Sample)) {
        self.give_up(&mut pass);
        self.last = None;
        self.last_time = None;
    }

    fn push_position(&mut self, sample: &PositionSample, mut pass: impl FnMut(Sample)) {
        let point = match self.point(sample) {
            Ok(point) => point,
            Err(reason) => return self.tally.count_dropped(reason, 1),
        };
        let slope = (self.last).and_then(|last| last.slope_to(&point, self.max_gap));
        match slope {
            Some(after) => self.settle(after, &mut pass),
            None => {
                self.give_up(&mut pass);
                self.tally.count_dropped(DropReason::NoNeighbours, 1);
            }
        }
        self.slope = slope;
        self.last = Some(point);
    }

    /// A position as a point from which differences are taken, or why it is none.
    fn point(&mut self, sample: &PositionSample) -> Result<Point, DropReason> {
        let PositionSample {
            stamp,
            ref position,
            resets,
        } = *sample;
        if self.last_time.replace(stamp.log_time) == Some(stamp.log_time) {
            return Err(DropReason::DuplicateTime);
        }
        let place = Place::of(position).ok_or(DropReason::NotAPlace)?;
        if let Some(last) = self.last {
            if last.place == place && last.resets == resets {
                return Err(DropReason::RepeatedPosition);
            }
            // A difference over so short a time would be mostly noise.
            if stamp.log_time - last.stamp.log_time < BURST {
                return Err(DropReason::InBurst);
            }
        }
        Ok(Point {
            stamp,
            place,
            resets,
        })
    }

    /// Passes on the velocity of the position that waits, given the slope after it, and what waits with it.
    fn settle(&mut self, after: Slope, pass: &mut impl FnMut(Sample)) {
        if let (Some(last), Some(before)) = (self.last, self.slope.take()) {
            let velocity = last.place.velocity(middle(before, after));
            match velocity.iter().all(|component| component.is_finite()) {
                true => {
                    self.tally.used += 1;
                    pass(Sample::Velocity(VelocitySample {
                        stamp: last.stamp,
                        velocity: Velocity::Ned(velocity),
                    }));
                }
                false => self.tally.count_dropped(DropReason::TooLarge, 1),
            }
        }
        self.held.drain(..).for_each(pass);
    }

    /// Drops the position that waits, and passes on what waits with it.
    fn give_up(&mut self, pass: &mut impl FnMut(Sample)) {
        if self.slope.take().is_some() {
            self.tally.count_dropped(DropReason::NoNeighbours, 1);
        }
        self.held.drain(..).for_each(pass);
    }
}
