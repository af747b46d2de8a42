//! What flows from the reader to the transform: what a log says of the drone, one moment at a time.

use std::{
    collections::BTreeMap,
    ops::{Index, IndexMut},
};

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Serialize, Serializer};

/// A message's two times, in nanoseconds since the log's epoch (that of 1970, or the vehicle's boot).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stamp {
    /// When the recorder received the message. This is the time of a sample.
    pub log_time: u64,
    /// When the message was published.
    pub publish_time: u64,
}

/// The drone's attitude at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeSample {
    /// Its times.
    pub stamp: Stamp,
    /// `q_ned_drone`: turns FRD coordinates into NED.
    pub orientation: UnitQuaternion<f64>,
    /// Counts the estimator's jumps (PX4 `quat_reset_counter`), where the log has such a count.
    pub reset_counter: Option<u64>,
}

/// The drone's velocity at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocitySample {
    /// Its times.
    pub stamp: Stamp,
    /// Over ground, m/s, NED.
    pub velocity_ned: Vector3<f64>,
}

/// One usable reading of the drone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sample {
    /// How the drone lay.
    Attitude(AttitudeSample),
    /// How it moved.
    Velocity(VelocitySample),
}

impl Sample {
    /// Its times.
    pub fn stamp(&self) -> Stamp {
        match self {
            Sample::Attitude(sample) => sample.stamp,
            Sample::Velocity(sample) => sample.stamp,
        }
    }

    /// What it is a reading of.
    pub fn kind(&self) -> Kind {
        match self {
            Sample::Attitude(_) => Kind::Attitude,
            Sample::Velocity(_) => Kind::Velocity,
        }
    }
}

/// What a sample is a reading of. The order is that of samples at equal times: a velocity needs the attitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// How the drone lies.
    Attitude,
    /// How it moves.
    Velocity,
}

/// Why a reading was not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DropReason {
    /// The message's bytes do not decode as its schema says.
    Undecodable,
    /// A field that the message may leave out is not in it.
    MissingField,
    /// A number is infinite or not a number.
    NonFinite,
    /// A quaternion that is not four numbers, or has a length outside 0.5 to 2.
    NotARotation,
    /// The log itself marks it invalid.
    MarkedInvalid,
    /// An earlier sample of the same kind has the same time.
    DuplicateTime,
    /// The drone's nose points straight up or down: the camera has no heading.
    UndefinedHeading,
    /// A velocity before the first attitude or after the last.
    OutsideAttitude,
    /// A velocity between two attitudes that are too far apart to interpolate.
    InAttitudeGap,
    /// A velocity between two attitudes across a reset of the estimator.
    AcrossAttitudeReset,
}

impl DropReason {
    /// As scripts name it.
    pub fn name(self) -> &'static str {
        match self {
            DropReason::Undecodable => "undecodable",
            DropReason::MissingField => "missing_field",
            DropReason::NonFinite => "non_finite",
            DropReason::NotARotation => "not_a_rotation",
            DropReason::MarkedInvalid => "marked_invalid",
            DropReason::DuplicateTime => "duplicate_time",
            DropReason::UndefinedHeading => "undefined_heading",
            DropReason::OutsideAttitude => "outside_attitude",
            DropReason::InAttitudeGap => "in_attitude_gap",
            DropReason::AcrossAttitudeReset => "across_attitude_reset",
        }
    }

    /// In words, as the report says it.
    pub fn describe(self) -> &'static str {
        match self {
            DropReason::Undecodable => "not decodable",
            DropReason::MissingField => "without a field that is needed",
            DropReason::NonFinite => "with a number that is not finite",
            DropReason::NotARotation => "with a quaternion that is no rotation",
            DropReason::MarkedInvalid => "marked invalid by the log",
            DropReason::DuplicateTime => "at the time of an earlier sample",
            DropReason::UndefinedHeading => {
                "with the nose straight up or down, where there is no heading"
            }
            DropReason::OutsideAttitude => "before the first or after the last usable attitude",
            DropReason::InAttitudeGap => "in a gap of the attitude",
            DropReason::AcrossAttitudeReset => "across a reset of the attitude estimator",
        }
    }
}

impl Serialize for DropReason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// How many readings of one kind were used, and how many dropped, by reason.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Readings that were used.
    pub used: u64,
    /// Readings that were not.
    pub dropped: BTreeMap<DropReason, u64>,
}

impl Tally {
    /// Counts readings that were not used.
    pub fn count_dropped(&mut self, reason: DropReason, count: u64) {
        if count > 0 {
            *self.dropped.entry(reason).or_default() += count;
        }
    }

    /// All readings, used or not.
    pub fn total(&self) -> u64 {
        self.used + self.dropped.values().sum::<u64>()
    }
}

/// A tally for each kind of sample.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tallies {
    /// Of the attitude samples.
    pub attitude: Tally,
    /// Of the velocity samples.
    pub velocity: Tally,
}

impl Tallies {
    /// Adds the counts of another stage.
    pub fn merge(&mut self, other: &Tallies) {
        for kind in [Kind::Attitude, Kind::Velocity] {
            self[kind].used += other[kind].used;
            for (&reason, &count) in &other[kind].dropped {
                self[kind].count_dropped(reason, count);
            }
        }
    }
}

impl Index<Kind> for Tallies {
    type Output = Tally;

    fn index(&self, kind: Kind) -> &Tally {
        match kind {
            Kind::Attitude => &self.attitude,
            Kind::Velocity => &self.velocity,
        }
    }
}

impl IndexMut<Kind> for Tallies {
    fn index_mut(&mut self, kind: Kind) -> &mut Tally {
        match kind {
            Kind::Attitude => &mut self.attitude,
            Kind::Velocity => &mut self.velocity,
        }
    }
}
