//! A flight at regular times, the ticks: how drone and camera were oriented, how the drone moved and where it was.
//!
//! Ticks are kept until the flight is over, because some of what is shown of each depends on all of them, such as its
//! size. Each takes less than two hundred bytes.

use nalgebra::{UnitQuaternion, Vector3};

use super::{options::VisualOptions, series::Series, stage::altitude};
use crate::{
    sample::{DropReason, HeightSample, Position, PositionSample, Tally},
    transform::{Incident, MaxGap, Moment},
};

/// As many ticks as are kept: 18 hours at 30 Hz.
const MOST_TICKS: usize = 2_000_000;

/// As many incidents as are kept. More of them say that the log is unusable, not what happened.
const MOST_INCIDENTS: usize = 1000;

/// Receivers have a new position several times a second, and logs repeat the last one until then. One that is repeated
/// for longer than this, in nanoseconds, stays where it is.
const LONGEST_REPEAT: u64 = 1_000_000_000;

/// What is known at one time.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    /// Nanoseconds of log time.
    pub time: u64,
    /// The part of the log that it is in, if the clock was set back in between.
    pub epoch: u32,
    /// How drone and camera are oriented, or why that is not known.
    pub attitudes: Result<TickAttitudes, DropReason>,
    /// The drone's velocity over ground, north, east, down, m/s.
    pub velocity: Option<Vector3<f64>>,
    /// Where the drone is.
    pub position: Option<Position>,
    /// The altitude of the ground below it, as the log counts altitudes, metres. While a flight is recorded, it is known
    /// only where the log says it.
    pub ground: Option<f64>,
}

/// How drone and camera are oriented.
#[derive(Debug, Clone, Copy)]
pub struct TickAttitudes {
    /// The drone's attitude (FRD to NED).
    pub q_ned_drone: UnitQuaternion<f64>,
    /// The camera's attitude.
    pub q_ned_camera: UnitQuaternion<f64>,
}

/// A whole flight.
#[derive(Debug, Clone, Default)]
pub struct Flight {
    /// Its ticks, epoch by epoch, in the order of their times.
    pub ticks: Vec<Tick>,
    /// What happened, and in which epoch, in the same order.
    pub incidents: Vec<(u32, Incident)>,
    /// What became of the positions.
    pub positions: Tally,
    /// What became of the heights above the ground.
    pub heights: Tally,
    /// Whether there were more ticks than can be kept.
    pub is_cut_short: bool,
}

/// Records a flight.
#[derive(Debug)]
pub struct FlightRecorder {
    max_gap: MaxGap,
    /// Ticks per second.
    rate: f64,
    flight: Flight,
    epoch: u32,
    /// The time of the first tick of the epoch, and the number in it of the next.
    grid: Option<(u64, u64)>,
    /// The time of the last sample.
    last: u64,
    /// The number of ticks whose attitudes are settled.
    settled: usize,
    velocities: Series<Vector3<f64>>,
    positions: Series<Position>,
    /// When the last position was last repeated.
    repeated: Option<u64>,
    /// Heights above the ground that wait for the next position, and their times. Between two heights, the ground is
    /// interpolated: the drone may have climbed and sunk again out of the sensor's range.
    heights: Vec<(u64, f64)>,
    grounds: Series<f64>,
}

impl FlightRecorder {
    /// Records ticks at the rate of these options. Nothing is interpolated across longer gaps than `max_gap`.
    pub fn new(options: &VisualOptions, max_gap: MaxGap) -> Self {
        Self {
            max_gap,
            rate: options.tick_rate(),
            flight: Flight::default(),
            epoch: 0,
            grid: None,
            last: 0,
            settled: 0,
            velocities: Series::new(max_gap),
            positions: Series::new(max_gap),
            repeated: None,
            heights: Vec::new(),
            grounds: Series::new(max_gap),
        }
    }

    /// Adds the ticks up to the time of the next sample, and asks for the attitudes at each.
    pub fn go_to(&mut self, time: u64, mut ask: impl FnMut(u64)) {
        let (start, mut next) = self.grid.unwrap_or((time, 0));
        let is_gap = self.grid.is_some() && !self.max_gap.spans(self.last, time);
        while self.at(start, next) <= time && !self.flight.is_cut_short {
            self.add(self.at(start, next), &mut ask);
            next += 1;
            // One tick shows that nothing is known in a gap.
            if is_gap && self.at(start, next - 1) > self.last {
                next = next.max(self.number(start, time));
            }
        }
        self.grid = Some((start, next));
        self.last = time;
    }

    /// The time of a tick of the grid.
    fn at(&self, start: u64, number: u64) -> u64 {
        start.saturating_add((number as f64 * 1e9 / self.rate).round() as u64)
    }

    /// The number of the first tick of the grid that is not before a time.
    fn number(&self, start: u64, time: u64) -> u64 {
        ((time - start) as f64 * self.rate / 1e9).ceil() as u64
    }

    fn add(&mut self, time: u64, ask: &mut impl FnMut(u64)) {
        if self.flight.ticks.len() == MOST_TICKS {
            self.flight.is_cut_short = true;
            return;
        }
        ask(time);
        self.flight.ticks.push(Tick {
            time,
            epoch: self.epoch,
            attitudes: Err(DropReason::OutsideAttitude),
            velocity: None,
            position: None,
            ground: None,
        });
    }

    /// Takes what the transform knows of a time.
    pub fn take(&mut self, moment: Moment) {
        match moment {
            Moment::Asked { attitudes, .. } => {
                self.flight.ticks[self.settled].attitudes = attitudes.map(|both| TickAttitudes {
                    q_ned_drone: both.q_ned_drone,
                    q_ned_camera: UnitQuaternion::from_rotation_matrix(&both.r_ned_camera),
                });
                self.settled += 1;
            }
            Moment::Velocity { time, ned } => {
                (self.velocities).push(time, ned, &mut self.flight.ticks, |tick, velocity| {
                    tick.velocity = Some(velocity);
                });
            }
            Moment::Incident(incident) => {
                if self.flight.incidents.len() < MOST_INCIDENTS {
                    self.flight.incidents.push((self.epoch, incident));
                }
            }
        }
    }

    /// Takes a position.
    pub fn take_position(&mut self, sample: &PositionSample) {
        let (time, position) = (sample.stamp.log_time, sample.position);
        let is_repeated = self.positions.last().is_some_and(|(earlier, last)| {
            last == position && time.saturating_sub(earlier) < LONGEST_REPEAT
        });
        let tally = &mut self.flight.positions;
        if !position.is_a_place() {
            return tally.count_dropped(DropReason::NotAPlace, 1);
        }
        if is_repeated {
            self.repeated = Some(time);
            return tally.count_dropped(DropReason::RepeatedPosition, 1);
        }
        tally.used += 1;
        self.push_position(time, position);
    }

    /// Takes a height above the ground.
    pub fn take_height(&mut self, sample: &HeightSample) {
        let time = sample.stamp.log_time;
        // Without a position for so long, none of them says where the ground is.
        if let Some(&(first, _)) = self.heights.first()
            && !self.max_gap.spans(first, time)
        {
            self.drop_heights();
        }
        self.heights.push((time, sample.metres));
    }

    /// Finds where the ground was at the heights that waited for this position.
    fn place_heights(&mut self, time: u64, position: Position) {
        for (at, height) in self.heights.drain(..) {
            let Some(place) = self.positions.value_at(at, (time, position)) else {
                (self.flight.heights).count_dropped(DropReason::UnknownPosition, 1);
                continue;
            };
            self.flight.heights.used += 1;
            let ground = altitude(&place) - height;
            (self.grounds).push(at, ground, &mut self.flight.ticks, |tick, ground| {
                tick.ground = Some(ground);
            });
        }
    }

    fn drop_heights(&mut self) {
        let count = self.heights.drain(..).len() as u64;
        (self.flight.heights).count_dropped(DropReason::UnknownPosition, count);
    }

    fn push_position(&mut self, time: u64, position: Position) {
        self.repeated = None;
        self.place_heights(time, position);
        (self.positions).push(time, position, &mut self.flight.ticks, |tick, position| {
            tick.position = Some(position);
        });
    }

    /// Begins a new epoch: what follows has times that are not related to those so far.
    pub fn begin_epoch(&mut self) {
        self.epoch += 1;
        self.grid = None;
        self.close();
    }

    /// Ends the flight.
    pub fn finish(mut self) -> Flight {
        self.close();
        self.flight
    }

    fn close(&mut self) {
        // No other position follows, so the last one holds for as long as it is repeated.
        if let (Some(time), Some((_, last))) = (self.repeated, self.positions.last()) {
            self.push_position(time, last);
        }
        if let Some((time, last)) = self.positions.last() {
            self.place_heights(time, last);
        }
        self.drop_heights();
        let ticks = &mut self.flight.ticks;
        self.velocities
            .end(ticks, |tick, velocity| tick.velocity = Some(velocity));
        self.positions
            .end(ticks, |tick, position| tick.position = Some(position));
        self.grounds
            .end(ticks, |tick, ground| tick.ground = Some(ground));
    }
}
