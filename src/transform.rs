//! Samples → derived values: a state machine without input or output.
//!
//! Samples go in one at a time, in time order and at equal times attitude before velocity; derived values
//! come out in time order, at equal times the relative rotation before the velocity. What is held back is
//! bounded by [`MaxGap`]: the velocities since the last attitude.

use nalgebra::Rotation3;
use serde::Serialize;

use crate::{
    derived::{Derived, Value},
    geometry::{DepressionAngle, camera_orientation, relative_rpy, slerp, velocity_in_camera},
    sample::{AttitudeSample, DropReason, Kind, Sample, Tallies, Velocity, VelocitySample},
};

/// The longest time between two attitude samples that still belong together. Across a longer one there is
/// no relative rotation and no interpolation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MaxGap {
    nanoseconds: u64,
}

/// A maximum gap that is not a positive time.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a maximum gap of {0} s is out of range: it must be greater than 0 and at most 1000000000 s"
)]
pub struct MaxGapOutOfRange(pub f64);

impl MaxGap {
    /// From seconds, rounded to the nanosecond.
    ///
    /// # Errors
    /// Less than a nanosecond, more than 1e9 seconds, or not a number.
    pub fn from_seconds(seconds: f64) -> Result<Self, MaxGapOutOfRange> {
        let nanoseconds = (seconds * 1e9).round();
        if (1.0..=1e18).contains(&nanoseconds) {
            Ok(Self {
                nanoseconds: nanoseconds as u64,
            })
        } else {
            Err(MaxGapOutOfRange(seconds))
        }
    }

    /// The gap in seconds.
    pub fn seconds(self) -> f64 {
        self.nanoseconds as f64 / 1e9
    }
}

impl Default for MaxGap {
    fn default() -> Self {
        Self {
            nanoseconds: 5_000_000_000,
        }
    }
}

/// What the transform made of the samples that it was given.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Outcome {
    /// The samples that were used, and those that were not.
    pub tallies: Tallies,
    /// How often the chain of attitude samples broke.
    pub breaks: Breaks,
}

/// How often the chain of attitude samples broke. Each used attitude sample but the first has a relative
/// rotation or is counted here.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Breaks {
    /// The previous sample with a heading lies further back than the maximum gap.
    pub gaps: u64,
    /// The log's count of attitude resets changed: the estimator jumped, the camera did not.
    pub resets: u64,
}

enum Break {
    Gap,
    Reset,
}

/// Turns samples of the drone into derived values for its camera.
#[derive(Debug)]
pub struct Transform {
    depression: DepressionAngle,
    max_gap: MaxGap,
    attitude: Option<AttitudeSample>,
    /// The last attitude sample with a defined heading, and the camera there.
    camera: Option<(AttitudeSample, Rotation3<f64>)>,
    last_velocity_time: Option<u64>,
    /// Velocities since the last attitude, waiting for the next one.
    waiting: Vec<VelocitySample>,
    /// Velocities that lie further behind the last attitude than any interpolation reaches.
    out_of_reach: u64,
    outcome: Outcome,
}

impl Transform {
    /// Before the first sample.
    pub fn new(depression: DepressionAngle, max_gap: MaxGap) -> Self {
        Self {
            depression,
            max_gap,
            attitude: None,
            camera: None,
            last_velocity_time: None,
            waiting: Vec::new(),
            out_of_reach: 0,
            outcome: Outcome::default(),
        }
    }

    /// Takes the next sample and appends to `out` what can be derived now.
    pub fn push(&mut self, sample: Sample, out: &mut Vec<Derived>) {
        match sample {
            Sample::Attitude(sample) => self.push_attitude(sample, out),
            Sample::Velocity(sample) => self.push_velocity(sample, out),
            Sample::Gimbal(_) | Sample::Position(_) => {}
        }
    }

    /// Ends the run: what still waits for an attitude will not get one.
    pub fn finish(mut self) -> Outcome {
        let unreached = self.waiting.len() as u64 + self.out_of_reach;
        self.count_dropped(Kind::Velocity, DropReason::OutsideAttitude, unreached);
        self.outcome
    }

    fn push_attitude(&mut self, sample: AttitudeSample, out: &mut Vec<Derived>) {
        let time = sample.stamp.log_time;
        if let Some(previous) = self.attitude {
            if previous.stamp.log_time == time {
                self.count_dropped(Kind::Attitude, DropReason::DuplicateTime, 1);
                return;
            }
            self.interpolate_waiting(&previous, &sample, out);
        }
        // A sample without a heading still says how the drone lay, so it is good to interpolate from.
        self.attitude = Some(sample);

        let Some(camera) = camera_orientation(&sample.orientation, self.depression) else {
            self.count_dropped(Kind::Attitude, DropReason::UndefinedHeading, 1);
            return;
        };
        self.outcome.tallies[Kind::Attitude].used += 1;
        if let Some((previous, previous_camera)) = self.camera.replace((sample, camera)) {
            match self.break_between(&previous, &sample) {
                Some(Break::Gap) => self.outcome.breaks.gaps += 1,
                Some(Break::Reset) => self.outcome.breaks.resets += 1,
                None => out.push(Derived {
                    stamp: sample.stamp,
                    value: Value::RelativeRpy {
                        interval: time - previous.stamp.log_time,
                        rpy: relative_rpy(&previous_camera, &camera),
                    },
                }),
            }
        }
    }

    fn push_velocity(&mut self, sample: VelocitySample, out: &mut Vec<Derived>) {
        let time = sample.stamp.log_time;
        if self.last_velocity_time.replace(time) == Some(time) {
            self.count_dropped(Kind::Velocity, DropReason::DuplicateTime, 1);
            return;
        }
        match self.attitude {
            None => self.count_dropped(Kind::Velocity, DropReason::OutsideAttitude, 1),
            Some(attitude) if attitude.stamp.log_time == time => {
                let camera = camera_orientation(&attitude.orientation, self.depression);
                self.derive_velocity(&sample, camera, out);
            }
            Some(attitude) if time - attitude.stamp.log_time > self.max_gap.nanoseconds => {
                self.out_of_reach += 1;
            }
            Some(_) => self.waiting.push(sample),
        }
    }

    /// Settles the velocities between two adjacent attitude samples.
    fn interpolate_waiting(
        &mut self,
        before: &AttitudeSample,
        after: &AttitudeSample,
        out: &mut Vec<Derived>,
    ) {
        let out_of_reach = std::mem::take(&mut self.out_of_reach);
        self.count_dropped(Kind::Velocity, DropReason::InAttitudeGap, out_of_reach);

        let waiting = std::mem::take(&mut self.waiting);
        let reason = match self.break_between(before, after) {
            Some(Break::Gap) => Some(DropReason::InAttitudeGap),
            Some(Break::Reset) => Some(DropReason::AcrossAttitudeReset),
            None => None,
        };
        if let Some(reason) = reason {
            self.count_dropped(Kind::Velocity, reason, waiting.len() as u64);
            return;
        }
        let start = before.stamp.log_time;
        let span = (after.stamp.log_time - start) as f64;
        for velocity in waiting {
            let fraction = (velocity.stamp.log_time - start) as f64 / span;
            let orientation = slerp(&before.orientation, &after.orientation, fraction);
            let camera = camera_orientation(&orientation, self.depression);
            self.derive_velocity(&velocity, camera, out);
        }
    }

    fn derive_velocity(
        &mut self,
        sample: &VelocitySample,
        camera: Option<Rotation3<f64>>,
        out: &mut Vec<Derived>,
    ) {
        let Some(camera) = camera else {
            self.count_dropped(Kind::Velocity, DropReason::UndefinedHeading, 1);
            return;
        };
        let (Velocity::Ned(velocity_ned) | Velocity::Frd(velocity_ned)) = sample.velocity;
        self.outcome.tallies[Kind::Velocity].used += 1;
        out.push(Derived {
            stamp: sample.stamp,
            value: Value::CameraVelocity(velocity_in_camera(&camera, &velocity_ned)),
        });
    }

    fn count_dropped(&mut self, kind: Kind, reason: DropReason, count: u64) {
        self.outcome.tallies[kind].count_dropped(reason, count);
    }

    fn break_between(&self, before: &AttitudeSample, after: &AttitudeSample) -> Option<Break> {
        if after.stamp.log_time - before.stamp.log_time > self.max_gap.nanoseconds {
            return Some(Break::Gap);
        }
        match (before.reset_counter, after.reset_counter) {
            (Some(a), Some(b)) if a != b => Some(Break::Reset),
            _ => None,
        }
    }
}
