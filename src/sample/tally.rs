//! How many samples were used, and why others were dropped.

use std::{
    collections::BTreeMap,
    fmt,
    ops::{Index, IndexMut},
};

use serde::{Serialize, Serializer};

use super::Kind;

/// Why a reading was not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum DropReason {
    /// The message's bytes cannot be decoded by its schema.
    Undecodable,
    /// The message is encoded in a version of CDR that is not supported.
    Xcdr2,
    /// The message is encoded as a CDR parameter list, which is not supported.
    ParameterList,
    /// A field that the message may leave out is not in it.
    MissingField,
    /// No condition of the profile holds for the message.
    UnmetCondition,
    /// According to the log it is measured in a frame that cannot be related to NED.
    UnknownFrame,
    /// According to the log it is measured in other axes than the profile says.
    OtherFrame,
    /// An orientation that is measured from the drone's own frame.
    OwnFrame,
    /// The message says that it has no orientation (`sensor_msgs/Imu`).
    NoOrientation,
    /// The time that the message gives for it is negative, not finite, or too large.
    BadTime,
    /// A number is infinite or not a number.
    NonFinite,
    /// A number, or what follows from it, is too large to compute with: a speed or a place beyond the largest double.
    TooLarge,
    /// A quaternion that is not four numbers, or has a length outside 0.5 to 2.
    NotARotation,
    /// The log itself marks it invalid.
    MarkedInvalid,
    /// An earlier sample of the same kind has the same time.
    DuplicateTime,
    /// An attitude closer to the one before than the user wants.
    TooClose,
    /// The drone's nose points straight up or down: the camera has no heading.
    UndefinedHeading,
    /// A position at the same place as the one before it: the log repeats it until the receiver has a new one.
    RepeatedPosition,
    /// A position so soon after the one before it that its time says little.
    InBurst,
    /// A position that does not have another shortly before and one shortly after it.
    NoNeighbours,
    /// A latitude and a longitude that there are not, or that stand for an unknown place.
    NotAPlace,
    /// A height above the ground that is less than 0, which stands for an unknown one.
    NegativeHeight,
    /// A height above the ground where it is not known where the drone was, so that it does not say where the ground is.
    UnknownPosition,
    /// A velocity before the first attitude or after the last.
    OutsideAttitude,
    /// A velocity between two attitudes that are too far apart to interpolate.
    InAttitudeGap,
    /// A velocity between two attitudes across a reset of the estimator.
    AcrossAttitudeReset,
    /// An attitude or a velocity before the first gimbal angle or after the last.
    OutsideGimbal,
    /// An attitude or a velocity between two gimbal angles that are too far apart to interpolate, or measured
    /// from different references.
    InGimbalGap,
}

impl DropReason {
    /// The name that scripts see.
    pub fn name(self) -> &'static str {
        match self {
            DropReason::Undecodable => "undecodable",
            DropReason::Xcdr2 => "xcdr2",
            DropReason::ParameterList => "parameter_list",
            DropReason::MissingField => "missing_field",
            DropReason::UnmetCondition => "unmet_condition",
            DropReason::UnknownFrame => "unknown_frame",
            DropReason::OtherFrame => "other_frame",
            DropReason::OwnFrame => "own_frame",
            DropReason::NoOrientation => "no_orientation",
            DropReason::BadTime => "bad_time",
            DropReason::NonFinite => "non_finite",
            DropReason::TooLarge => "too_large",
            DropReason::NotARotation => "not_a_rotation",
            DropReason::MarkedInvalid => "marked_invalid",
            DropReason::DuplicateTime => "duplicate_time",
            DropReason::TooClose => "too_close",
            DropReason::UndefinedHeading => "undefined_heading",
            DropReason::RepeatedPosition => "repeated_position",
            DropReason::InBurst => "in_burst",
            DropReason::NoNeighbours => "no_neighbours",
            DropReason::NotAPlace => "not_a_place",
            DropReason::NegativeHeight => "negative_height",
            DropReason::UnknownPosition => "unknown_position",
            DropReason::OutsideAttitude => "outside_attitude",
            DropReason::InAttitudeGap => "in_attitude_gap",
            DropReason::AcrossAttitudeReset => "across_attitude_reset",
            DropReason::OutsideGimbal => "outside_gimbal",
            DropReason::InGimbalGap => "in_gimbal_gap",
        }
    }

    /// Whether the sample is usable, and only where the camera looked at its time is not known.
    pub fn is_for_want_of_pose(self) -> bool {
        matches!(
            self,
            Self::UndefinedHeading
                | Self::OutsideAttitude
                | Self::InAttitudeGap
                | Self::AcrossAttitudeReset
                | Self::OutsideGimbal
                | Self::InGimbalGap
        )
    }

    /// Whether the message could not be read, as opposed to holding nothing usable.
    pub fn is_unreadable(self) -> bool {
        matches!(self, Self::Undecodable | Self::Xcdr2 | Self::ParameterList)
    }
}

impl fmt::Display for DropReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            DropReason::Undecodable => "not decodable",
            DropReason::Xcdr2 => "encoded as XCDR2, which flightcam does not read (it reads XCDR1)",
            DropReason::ParameterList => {
                "encoded as a CDR parameter list (PL_CDR), which flightcam does not read"
            }
            DropReason::MissingField => "without a field that is needed",
            DropReason::UnmetCondition => "left out by the profile's conditions (`when`)",
            DropReason::UnknownFrame => "in a frame that cannot be related to NED",
            DropReason::OtherFrame => "in a frame that contradicts the profile",
            DropReason::OwnFrame => "measured from the drone's own frame, which is no attitude",
            DropReason::NoOrientation => {
                "without an orientation, which is what orientation_covariance[0] = -1 means"
            }
            DropReason::BadTime => "with an impossible time",
            DropReason::NonFinite => "with a number that is not finite",
            DropReason::TooLarge => "with a number that is too large to compute with",
            DropReason::NotARotation => "with a quaternion that is not a rotation",
            DropReason::MarkedInvalid => "marked invalid by the log",
            DropReason::DuplicateTime => "at the time of an earlier sample",
            DropReason::TooClose => "closer to the one before than the minimum interval",
            DropReason::UndefinedHeading => {
                "with the nose straight up or down, where there is no heading"
            }
            DropReason::RepeatedPosition => "at the same place as the one before",
            DropReason::InBurst => "less than a millisecond after the one before",
            DropReason::NoNeighbours => "without another position shortly before or shortly after",
            DropReason::NotAPlace => "with a latitude or a longitude that there is not, or both 0",
            DropReason::NegativeHeight => "less than 0, which stands for an unknown height",
            DropReason::UnknownPosition => "where the position is not known",
            DropReason::OutsideAttitude => "before the first or after the last usable attitude",
            DropReason::InAttitudeGap => "in a gap of the attitude",
            DropReason::AcrossAttitudeReset => "across a reset of the attitude estimator",
            DropReason::OutsideGimbal => "before the first or after the last usable gimbal angle",
            DropReason::InGimbalGap => "in a gap of the gimbal angles",
        })
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
    /// Messages on the same topic that are of another source than the one that was selected. They are not counted as
    /// readings.
    #[serde(skip_serializing_if = "is_zero")]
    pub unselected: u64,
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

impl Tally {
    /// Counts readings that were not used.
    pub fn count_dropped(&mut self, reason: DropReason, count: u64) {
        if count > 0 {
            *self.dropped.entry(reason).or_default() += count;
        }
    }

    /// Adds the counts of another stage.
    pub fn merge(&mut self, other: &Tally) {
        self.used += other.used;
        self.unselected += other.unselected;
        for (&reason, &count) in &other.dropped {
            self.count_dropped(reason, count);
        }
    }

    /// Readings whose messages could not be read.
    pub fn unreadable(&self) -> u64 {
        let dropped = self.dropped.iter();
        let unreadable = dropped.filter(|(reason, _)| reason.is_unreadable());
        unreadable.map(|(_, count)| count).sum()
    }

    /// All readings, used or not.
    pub fn total(&self) -> u64 {
        self.used + self.dropped.values().sum::<u64>()
    }

    /// All readings, and the messages of other sources.
    pub fn total_with_unselected(&self) -> u64 {
        self.total() + self.unselected
    }
}

/// A tally for each kind of sample.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tallies([Tally; Kind::ALL.len()]);

impl Tallies {
    /// Adds the counts of another stage.
    pub fn merge(&mut self, other: &Tallies) {
        for kind in Kind::ALL {
            self[kind].merge(&other[kind]);
        }
    }
}

impl Index<Kind> for Tallies {
    type Output = Tally;

    fn index(&self, kind: Kind) -> &Tally {
        &self.0[kind as usize]
    }
}

impl IndexMut<Kind> for Tallies {
    fn index_mut(&mut self, kind: Kind) -> &mut Tally {
        &mut self.0[kind as usize]
    }
}
