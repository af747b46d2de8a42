//! Samples of a quantity, interpolated at the ticks between them.

use nalgebra::Vector3;

use super::flight::Tick;
use crate::{sample::Position, transform::MaxGap};

/// A quantity that can be interpolated.
pub trait Interpolate: Copy {
    /// The value at a fraction of the way to a later one; `None` if there is none between the two.
    fn interpolate(&self, later: &Self, fraction: f64) -> Option<Self>;
}

/// The samples of a quantity, as far as they are needed.
#[derive(Debug)]
pub struct Series<T> {
    max_gap: MaxGap,
    last: Option<(u64, T)>,
    /// How many ticks have been passed.
    passed: usize,
}

impl<T: Interpolate> Series<T> {
    pub fn new(max_gap: MaxGap) -> Self {
        Self {
            max_gap,
            last: None,
            passed: 0,
        }
    }

    /// The last sample, and its time.
    pub fn last(&self) -> Option<(u64, T)> {
        self.last
    }

    /// The value at a time that is not after the next sample; `None` if it is not known.
    pub fn value_at(&self, at: u64, (time, value): (u64, T)) -> Option<T> {
        if at == time {
            return Some(value);
        }
        let (earlier, before) = self
            .last
            .filter(|&(earlier, _)| earlier <= at && at < time)?;
        if at == earlier {
            return Some(before);
        }
        let fraction = (at - earlier) as f64 / (time - earlier) as f64;
        let is_near = self.max_gap.spans(earlier, time);
        is_near.then(|| before.interpolate(&value, fraction))?
    }

    /// Takes the next sample, and sets the value of the ticks up to it.
    pub fn push(&mut self, time: u64, value: T, ticks: &mut [Tick], set: impl Fn(&mut Tick, T)) {
        while let Some(tick) = ticks.get_mut(self.passed)
            && tick.time <= time
        {
            self.passed += 1;
            if let Some(value) = self.value_at(tick.time, (time, value)) {
                set(tick, value);
            }
        }
        self.last = Some((time, value));
    }

    /// Ends the series: a tick at the time of its last sample has that. What follows is not related to it.
    pub fn end(&mut self, ticks: &mut [Tick], set: impl Fn(&mut Tick, T)) {
        if let Some((time, value)) = self.last.take()
            && let Some(tick) = ticks.get_mut(self.passed)
            && tick.time == time
        {
            set(tick, value);
        }
        self.passed = ticks.len();
    }
}

impl Interpolate for f64 {
    fn interpolate(&self, later: &Self, fraction: f64) -> Option<Self> {
        Some(self + (later - self) * fraction)
    }
}

impl Interpolate for Vector3<f64> {
    fn interpolate(&self, later: &Self, fraction: f64) -> Option<Self> {
        Some(self.lerp(later, fraction))
    }
}

impl Interpolate for Position {
    fn interpolate(&self, later: &Self, fraction: f64) -> Option<Self> {
        let between = |from: f64, to: f64| from + (to - from) * fraction;
        match (*self, *later) {
            (Self::Local(from), Self::Local(to)) => Some(Self::Local(from.lerp(&to, fraction))),
            (
                Self::Geodetic {
                    latitude,
                    longitude,
                    altitude,
                },
                Self::Geodetic {
                    latitude: latitude1,
                    longitude: longitude1,
                    altitude: altitude1,
                },
            ) => Some(Self::Geodetic {
                latitude: between(latitude, latitude1),
                // The shorter way around the globe.
                longitude: between(
                    longitude,
                    longitude1 - 360.0 * ((longitude1 - longitude) / 360.0).round(),
                ),
                altitude: between(altitude, altitude1),
            }),
            _ => None,
        }
    }
}
