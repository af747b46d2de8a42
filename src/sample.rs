//! What flows from the reader to the transform: the drone's state as the log has it, one moment at a time.

use std::{
    collections::BTreeMap,
    fmt,
    ops::{Index, IndexMut},
};

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize, Serializer};

use crate::geometry::axes::Axes;

/// A sample's times, in nanoseconds since the log's epoch (that of 1970, or the vehicle's boot).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stamp {
    /// The time of the sample and of what is derived from it: when the recorder received the message, unless
    /// the profile or the user asks for another.
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
    /// Counts the estimator's jumps (PX4 `quat_reset_counter`), if the log has such a count.
    pub reset_counter: Option<u64>,
}

/// The drone's velocity at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocitySample {
    /// Its times.
    pub stamp: Stamp,
    /// The velocity over ground, m/s.
    pub velocity: Velocity,
}

/// A velocity over ground in m/s, in the axes in which the log has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Velocity {
    /// North, east, down.
    Ned(Vector3<f64>),
    /// The drone's front, right, down. Where those point depends on the attitude at its time.
    Frd(Vector3<f64>),
}

/// What the drone's velocity is taken from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum VelocityFrom {
    /// The messages that have it.
    #[default]
    Messages,
    /// The change of the position from one message to the next.
    Position,
}

impl VelocityFrom {
    /// The kind of sample that it is taken from.
    pub fn kind(self) -> Kind {
        match self {
            Self::Messages => Kind::Velocity,
            Self::Position => Kind::Position,
        }
    }

    /// The name in scripts and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Messages => "messages",
            Self::Position => "position",
        }
    }

    /// How many of these samples it takes for a velocity.
    pub fn needed(self) -> u64 {
        match self {
            Self::Messages => 1,
            Self::Position => 3,
        }
    }
}

impl Serialize for VelocityFrom {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Where the gimbal holds the camera at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GimbalSample {
    /// Its times.
    pub stamp: Stamp,
    /// Turns the camera's coordinates into those of the reference.
    pub orientation: UnitQuaternion<f64>,
    /// What the orientation is measured from.
    pub reference: GimbalReference,
}

/// What a gimbal's orientation is measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GimbalReference {
    /// North, east, down: yaw from north, roll and pitch from the horizon.
    Earth,
    /// The drone's heading, horizontally: yaw from the nose, roll and pitch from the horizon.
    Heading,
    /// The airframe's front, right, down: the angles of the joints.
    Airframe,
}

impl GimbalReference {
    /// The name in profiles and options.
    pub fn name(self) -> &'static str {
        match self {
            GimbalReference::Earth => "earth",
            GimbalReference::Heading => "heading",
            GimbalReference::Airframe => "airframe",
        }
    }
}

/// Where the drone is at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionSample {
    /// Its times.
    pub stamp: Stamp,
    /// The place.
    pub position: Position,
    /// Counts the estimator's jumps, if the log has such counts.
    pub resets: Option<u64>,
}

/// A place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Position {
    /// A position on the globe.
    Geodetic {
        /// Degrees north.
        latitude: f64,
        /// Degrees east.
        longitude: f64,
        /// Metres above whatever the log takes for zero.
        altitude: f64,
    },
    /// Metres north, east and down of an origin of the log's own.
    Local(Vector3<f64>),
}

/// How fast the drone turns at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngularRateSample {
    /// Its times.
    pub stamp: Stamp,
    /// Radians per second about the drone's front, right and down axes.
    pub rate: Vector3<f64>,
}

/// What an accelerometer measures at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationSample {
    /// Its times.
    pub stamp: Stamp,
    /// The specific force in m/s² along the drone's front, right and down axes: one g upwards for a drone that hovers.
    pub force: Vector3<f64>,
}

/// One usable reading of the drone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sample {
    /// How the drone was oriented.
    Attitude(AttitudeSample),
    /// How it moved.
    Velocity(VelocitySample),
    /// Where its gimbal held the camera.
    Gimbal(GimbalSample),
    /// Where it was.
    Position(PositionSample),
    /// How fast it turned.
    AngularRate(AngularRateSample),
    /// What its accelerometer felt.
    Acceleration(AccelerationSample),
}

impl Velocity {
    /// Takes components in m/s in some axes.
    pub fn in_axes(axes: Axes, components: Vector3<f64>) -> Self {
        match axes {
            Axes::World(axes) => Self::Ned(axes.to_own(components)),
            Axes::Body(axes) => Self::Frd(axes.to_own(components)),
        }
    }
}

impl Sample {
    /// Its times.
    pub fn stamp(&self) -> Stamp {
        match self {
            Sample::Attitude(sample) => sample.stamp,
            Sample::Velocity(sample) => sample.stamp,
            Sample::Gimbal(sample) => sample.stamp,
            Sample::Position(sample) => sample.stamp,
            Sample::AngularRate(sample) => sample.stamp,
            Sample::Acceleration(sample) => sample.stamp,
        }
    }

    /// What it is a reading of.
    pub fn kind(&self) -> Kind {
        match self {
            Sample::Attitude(_) => Kind::Attitude,
            Sample::Velocity(_) => Kind::Velocity,
            Sample::Gimbal(_) => Kind::Gimbal,
            Sample::Position(_) => Kind::Position,
            Sample::AngularRate(_) => Kind::AngularRate,
            Sample::Acceleration(_) => Kind::Acceleration,
        }
    }
}

/// What a sample is a reading of. The order is that of samples at equal times: what is derived from an attitude
/// needs the gimbal, and what is derived from a velocity needs both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Kind {
    /// Where the gimbal holds the camera.
    Gimbal,
    /// How the drone is oriented.
    Attitude,
    /// How it moves.
    Velocity,
    /// Where it is.
    Position,
    /// How fast it turns. Only a check reads it.
    AngularRate,
    /// What its accelerometer feels. Only a check reads it.
    Acceleration,
}

impl Kind {
    /// All kinds, in their order.
    pub const ALL: [Kind; 6] = [
        Kind::Gimbal,
        Kind::Attitude,
        Kind::Velocity,
        Kind::Position,
        Kind::AngularRate,
        Kind::Acceleration,
    ];

    /// All kinds, in the order in which they are listed.
    pub const LISTED: [Kind; Self::ALL.len()] = [
        Kind::Attitude,
        Kind::Velocity,
        Kind::Gimbal,
        Kind::Position,
        Kind::AngularRate,
        Kind::Acceleration,
    ];

    /// The kinds that are looked for unless a log is checked.
    pub const USUAL: [Kind; 4] = [Kind::Attitude, Kind::Velocity, Kind::Gimbal, Kind::Position];

    /// The name in profiles, scripts and options.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Gimbal => "gimbal",
            Kind::Attitude => "attitude",
            Kind::Velocity => "velocity",
            Kind::Position => "position",
            Kind::AngularRate => "angular_rate",
            Kind::Acceleration => "acceleration",
        }
    }
}

impl Serialize for Kind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

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
}

/// A tally for each kind of sample.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tallies([Tally; Kind::ALL.len()]);

impl Tallies {
    /// Adds the counts of another stage.
    pub fn merge(&mut self, other: &Tallies) {
        for kind in Kind::ALL {
            self[kind].used += other[kind].used;
            self[kind].unselected += other[kind].unselected;
            for (&reason, &count) in &other[kind].dropped {
                self[kind].count_dropped(reason, count);
            }
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
