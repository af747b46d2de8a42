//! What flows from the reader to the transform: the drone's state as the log has it, one moment at a time.

mod tally;

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize, Serializer};

use crate::geometry::{axes::Axes, geodetic::Geodetic};
pub use tally::{DropReason, Tallies, Tally};

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

impl Position {
    /// Whether there is such a place. Latitude and longitude 0 stand for an unknown one.
    pub fn is_a_place(&self) -> bool {
        match *self {
            Self::Local(place) => place.iter().all(|metres| metres.is_finite()),
            Self::Geodetic {
                latitude,
                longitude,
                altitude,
            } => {
                (latitude, longitude) != (0.0, 0.0)
                    && altitude.is_finite()
                    && Geodetic::from_degrees(latitude, longitude, altitude).is_some()
            }
        }
    }
}

/// How high the drone is above the ground at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightSample {
    /// Its times.
    pub stamp: Stamp,
    /// Metres above the ground below the drone; not negative.
    pub metres: f64,
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
    /// How high it was above the ground.
    Height(HeightSample),
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
            Sample::Height(sample) => sample.stamp,
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
            Sample::Height(_) => Kind::Height,
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
    /// How high it is above the ground. It is read only to show that to viewers.
    Height,
    /// How fast it turns. Only a check reads it.
    AngularRate,
    /// What its accelerometer feels. Only a check reads it.
    Acceleration,
}

impl Kind {
    /// All kinds, in their order.
    pub const ALL: [Kind; 7] = [
        Kind::Gimbal,
        Kind::Attitude,
        Kind::Velocity,
        Kind::Position,
        Kind::Height,
        Kind::AngularRate,
        Kind::Acceleration,
    ];

    /// All kinds, in the order in which they are listed.
    pub const LISTED: [Kind; Self::ALL.len()] = [
        Kind::Attitude,
        Kind::Velocity,
        Kind::Gimbal,
        Kind::Position,
        Kind::Height,
        Kind::AngularRate,
        Kind::Acceleration,
    ];

    /// The kinds that are always looked for.
    pub const USUAL: [Kind; 4] = [Kind::Attitude, Kind::Velocity, Kind::Gimbal, Kind::Position];

    /// The kinds that are looked for to check a log, in the order in which they are listed.
    pub const CHECKED: [Kind; 6] = [
        Kind::Attitude,
        Kind::Velocity,
        Kind::Gimbal,
        Kind::Position,
        Kind::AngularRate,
        Kind::Acceleration,
    ];

    /// The name in profiles, scripts and options.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Gimbal => "gimbal",
            Kind::Attitude => "attitude",
            Kind::Velocity => "velocity",
            Kind::Position => "position",
            Kind::Height => "height",
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
