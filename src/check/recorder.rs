//! What is kept of a flight to judge it by: thinned samples of all kinds, and what is counted of each.
//!
//! Memory is bounded whatever the length of the log: at most 25 samples of a kind a second, in at most 48 stretches of
//! 20 s. When there are more, every other stretch is dropped, so those that are kept are spread over the whole flight.

use nalgebra::{UnitQuaternion, Vector3};

use super::{jumps::Jumps, times::Times, track::Timed};
use crate::{
    geometry::geodetic::Geodetic,
    sample::{GimbalReference, Kind, Position, Sample, Velocity},
};

/// How long a stretch is, in nanoseconds.
const STRETCH: u64 = 20_000_000_000;

/// How many stretches are kept at most.
const MOST_STRETCHES: u64 = 48;

/// The least time between two samples that are kept, in nanoseconds.
const SPACING: u64 = 40_000_000;

/// That of accelerations, which are averaged and compared over seconds.
const ACCELERATION_SPACING: u64 = 100_000_000;

/// A velocity as it was read: its numbers in NED, or in the drone's FRD.
#[derive(Debug, Clone, Copy)]
pub struct ReadVelocity {
    pub vector: Vector3<f64>,
    pub is_body: bool,
}

/// A gimbal's orientation as it was read.
#[derive(Debug, Clone, Copy)]
pub struct ReadGimbal {
    pub orientation: UnitQuaternion<f64>,
    pub reference: GimbalReference,
}

/// A position in metres north, east and down of the first.
#[derive(Debug, Clone, Copy)]
pub struct ReadPosition {
    pub metres: Vector3<f64>,
    pub is_geodetic: bool,
}

/// Keeps what is needed of a flight's samples, which come in the order of their times.
#[derive(Debug, Default)]
pub struct Recorder {
    clock: Clock,
    pub(super) attitudes: Thinned<UnitQuaternion<f64>>,
    pub(super) velocities: Thinned<ReadVelocity>,
    pub(super) positions: Thinned<ReadPosition>,
    pub(super) gimbals: Thinned<ReadGimbal>,
    pub(super) rates: Averaged,
    pub(super) accelerations: Averaged,
    /// The first position on the globe.
    origin: Option<Geodetic>,
    pub(super) turns: Jumps<4>,
    pub(super) gimbal_turns: Jumps<4>,
    pub(super) speeds: Jumps<3>,
    pub(super) times: [Times; Kind::ALL.len()],
}

/// Which stretches are kept.
#[derive(Debug)]
struct Clock {
    /// The time of the first sample.
    first: Option<u64>,
    /// Every how many stretches one is kept.
    stride: u64,
    /// The last stretch that has a sample.
    last: u64,
    /// How many were kept.
    kept: u64,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            first: None,
            stride: 1,
            last: u64::MAX,
            kept: 0,
        }
    }
}

/// When a sample is kept.
enum Due {
    /// In seconds since the first sample.
    Now(f64),
    /// Not before this time.
    Later(u64),
}

/// Samples of a kind.
#[derive(Debug)]
pub struct Thinned<T> {
    /// The next sample that is kept is not before.
    due: u64,
    pub(super) samples: Vec<Timed<T>>,
}

/// Means of samples, over the time from one to the next.
#[derive(Debug, Default)]
pub struct Averaged {
    pub(super) means: Thinned<Vector3<f64>>,
    sum: Vector3<f64>,
    /// The sum of times since the first sample that was added, in nanoseconds.
    since: u64,
    offsets: u64,
    count: u32,
}

impl<T> Default for Thinned<T> {
    fn default() -> Self {
        Self {
            due: 0,
            samples: Vec::new(),
        }
    }
}

impl Recorder {
    /// Takes the next sample.
    #[inline]
    pub fn push(&mut self, sample: &Sample) {
        let time = sample.stamp().log_time;
        self.times[sample.kind() as usize].push(time);
        match sample {
            Sample::Attitude(sample) => {
                let coordinates = sample.orientation.coords;
                self.turns.push_rotation(time, coordinates.into());
                if self.attitudes.is_due(time) {
                    self.keep(time, sample.orientation, |recorder| &mut recorder.attitudes);
                }
            }
            Sample::Velocity(sample) => {
                let (vector, is_body) = match sample.velocity {
                    Velocity::Ned(vector) => (vector, false),
                    Velocity::Frd(vector) => (vector, true),
                };
                self.speeds.push_vector(time, vector.into());
                if self.velocities.is_due(time) {
                    let velocity = ReadVelocity { vector, is_body };
                    self.keep(time, velocity, |recorder| &mut recorder.velocities);
                }
            }
            Sample::Gimbal(sample) => {
                let coordinates = sample.orientation.coords;
                (self.gimbal_turns).push_rotation(time, coordinates.into());
                if self.gimbals.is_due(time) {
                    let gimbal = ReadGimbal {
                        orientation: sample.orientation,
                        reference: sample.reference,
                    };
                    self.keep(time, gimbal, |recorder| &mut recorder.gimbals);
                }
            }
            Sample::Position(sample) => {
                if self.positions.is_due(time) {
                    let position = self.place(sample.position);
                    self.keep(time, position, |recorder| &mut recorder.positions);
                }
            }
            // There is nothing to compare it with.
            Sample::Height(_) => {}
            Sample::AngularRate(sample) => {
                self.average(time, sample.rate, SPACING, |recorder| &mut recorder.rates);
            }
            Sample::Acceleration(sample) => {
                self.average(time, sample.force, ACCELERATION_SPACING, |recorder| {
                    &mut recorder.accelerations
                });
            }
        }
    }

    fn place(&mut self, position: Position) -> ReadPosition {
        match position {
            Position::Geodetic {
                latitude,
                longitude,
                altitude,
            } => {
                // Also what is no place, as in a wrong unit: it contradicts the velocity.
                let place = Geodetic {
                    latitude: latitude.to_radians(),
                    longitude: longitude.to_radians(),
                    altitude,
                };
                let origin = self.origin.get_or_insert(place);
                ReadPosition {
                    metres: origin.in_ned(origin.change_to(&place)),
                    is_geodetic: true,
                }
            }
            Position::Local(metres) => ReadPosition {
                metres,
                is_geodetic: false,
            },
        }
    }

    fn keep<T>(&mut self, time: u64, value: T, of: impl Fn(&mut Self) -> &mut Thinned<T>) {
        match self.due(time) {
            Due::Now(seconds) => {
                let kept = of(self);
                kept.due = time.saturating_add(SPACING);
                kept.samples.push(Timed {
                    time: seconds,
                    value,
                });
            }
            Due::Later(due) => of(self).due = due,
        }
    }

    fn average(
        &mut self,
        time: u64,
        value: Vector3<f64>,
        spacing: u64,
        of: impl Fn(&mut Self) -> &mut Averaged,
    ) {
        let averaged = of(self);
        if !averaged.means.is_due(time) {
            // Not of a stretch that is not kept.
            if averaged.means.due - time <= spacing {
                averaged.add(time, value);
            }
            return;
        }
        if let Some((mean_time, mean)) = of(self).take() {
            self.keep(mean_time, mean, |recorder| &mut of(recorder).means);
        }
        let averaged = of(self);
        averaged.means.due = averaged.means.due.max(time.saturating_add(spacing));
        averaged.add(time, value);
    }

    /// Whether a sample is in a stretch that is kept.
    fn due(&mut self, time: u64) -> Due {
        let first = *self.clock.first.get_or_insert(time);
        let since_first = time.saturating_sub(first);
        let stretch = since_first / STRETCH;
        if !stretch.is_multiple_of(self.clock.stride) {
            let next = (stretch / self.clock.stride + 1).saturating_mul(self.clock.stride);
            return Due::Later(first.saturating_add(next.saturating_mul(STRETCH)));
        }
        if stretch != self.clock.last {
            self.clock.last = stretch;
            self.clock.kept += 1;
            if self.clock.kept > MOST_STRETCHES {
                self.thin_out();
                return self.due(time);
            }
        }
        Due::Now(since_first as f64 / 1e9)
    }

    /// Drops every other stretch.
    fn thin_out(&mut self) {
        self.clock.stride *= 2;
        let stride = self.clock.stride;
        let is_kept = |time: f64| ((time * 1e9) as u64 / STRETCH).is_multiple_of(stride);
        self.attitudes.retain(is_kept);
        self.velocities.retain(is_kept);
        self.positions.retain(is_kept);
        self.gimbals.retain(is_kept);
        self.rates.means.retain(is_kept);
        self.accelerations.means.retain(is_kept);
        // Without the one that is about to begin.
        self.clock.kept = (self.clock.kept - 1).div_ceil(2);
        self.clock.last = u64::MAX;
    }
}

impl<T> Thinned<T> {
    #[inline]
    fn is_due(&self, time: u64) -> bool {
        time >= self.due
    }

    fn retain(&mut self, is_kept: impl Fn(f64) -> bool) {
        self.samples.retain(|sample| is_kept(sample.time));
    }
}

impl Averaged {
    fn add(&mut self, time: u64, value: Vector3<f64>) {
        if self.count == 0 {
            self.since = time;
        }
        self.sum += value;
        self.offsets += time.saturating_sub(self.since);
        self.count += 1;
    }

    fn take(&mut self) -> Option<(u64, Vector3<f64>)> {
        let count = self.count;
        if count == 0 {
            return None;
        }
        let mean = self.sum / f64::from(count);
        let time = self.since + self.offsets / u64::from(count);
        self.sum = Vector3::zeros();
        self.offsets = 0;
        self.count = 0;
        Some((time, mean))
    }
}
