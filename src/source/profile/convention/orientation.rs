//! How an orientation is written: between which frames it turns, and in which order its angles turn.

use std::{fmt, str::FromStr};

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::{
    geometry::{
        RollPitchYaw,
        axes::{BodyAxes, WorldAxes},
    },
    sample::GimbalReference,
};

/// The frames between which an orientation turns: out of the drone's axes (or the camera's) into those of the world.
/// Written as both, as in `frd-ned` or `flu-enu`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
pub struct Convention {
    body: BodyAxes,
    world: WorldAxes,
}

/// A text that is not a convention.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotAConvention {
    /// It does not name two frames.
    #[error(
        "an orientation turns from the drone's axes to the world's, as in `frd-ned` or `flu-enu`: three letters out of \
         f or b, l or r, u or d, and three out of n or s, e or w, u or d"
    )]
    NotAxes,
    /// One of them is left-handed.
    #[error(
        "`{letters}` are left-handed axes, and there is no rotation between these and right-handed ones"
    )]
    LeftHanded {
        /// The letters of the frame.
        letters: String,
    },
}

impl Convention {
    /// Turns front, right, down into north, east, down: aerospace, MAVLink, PX4.
    pub const FRD_NED: Self = Self {
        body: BodyAxes::FRD,
        world: WorldAxes::NED,
    };
    /// Turns front, left, up into east, north, up: ROS (REP 103, <https://www.ros.org/reps/rep-0103.html>).
    pub const FLU_ENU: Self = Self {
        body: BodyAxes::FLU,
        world: WorldAxes::ENU,
    };

    /// Makes a convention of two frames.
    ///
    /// # Errors
    /// One of them is left-handed, and there is no rotation between such axes and right-handed ones.
    pub fn new(body: BodyAxes, world: WorldAxes) -> Result<Self, NotAConvention> {
        let left_handed = |letters| NotAConvention::LeftHanded { letters };
        match (body.is_right_handed(), world.is_right_handed()) {
            (true, true) => Ok(Self { body, world }),
            (false, _) => Err(left_handed(body.to_string())),
            (true, false) => Err(left_handed(world.to_string())),
        }
    }

    /// The drone's axes.
    pub fn body(self) -> BodyAxes {
        self.body
    }

    /// The world's axes.
    pub fn world(self) -> WorldAxes {
        self.world
    }

    /// How an orientation in this convention becomes `q_ned_frd`.
    pub fn attitude(self) -> FrameChange {
        FrameChange {
            before: self.q_frd_body().inverse(),
            after: self.q_ned_world(),
        }
    }

    /// How a gimbal's orientation in this convention becomes one between frames with z axes down. What is measured from
    /// the drone's heading or its airframe turns into the drone's axes.
    pub fn gimbal(self, reference: GimbalReference) -> FrameChange {
        match reference {
            GimbalReference::Earth => self.attitude(),
            GimbalReference::Heading | GimbalReference::Airframe => FrameChange {
                before: self.q_frd_body().inverse(),
                after: self.q_frd_body(),
            },
        }
    }

    fn q_frd_body(self) -> UnitQuaternion<f64> {
        self.body.rotation().unwrap_or_default()
    }

    fn q_ned_world(self) -> UnitQuaternion<f64> {
        self.world.rotation().unwrap_or_default()
    }
}

/// A change of the two frames between which an orientation turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrameChange {
    before: UnitQuaternion<f64>,
    after: UnitQuaternion<f64>,
}

impl FrameChange {
    /// The orientation between the new frames.
    pub fn apply(&self, orientation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        if *self == Self::default() {
            return orientation;
        }
        self.after * orientation * self.before
    }
}

impl FromStr for Convention {
    type Err = NotAConvention;

    fn from_str(text: &str) -> Result<Self, NotAConvention> {
        let (body, world) = text.split_once('-').ok_or(NotAConvention::NotAxes)?;
        let not_axes = |_| NotAConvention::NotAxes;
        Self::new(
            body.parse().map_err(not_axes)?,
            world.parse().map_err(not_axes)?,
        )
    }
}

impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.body, self.world)
    }
}

impl TryFrom<String> for Convention {
    type Error = NotAConvention;

    fn try_from(text: String) -> Result<Self, NotAConvention> {
        text.parse()
    }
}

impl From<Convention> for String {
    fn from(convention: Convention) -> Self {
        convention.to_string()
    }
}

/// The order in which roll, pitch and yaw turn: each about an axis that the ones before it have turned (intrinsic).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EulerOrder {
    /// `R = Rz(yaw) Ry(pitch) Rx(roll)` (321): aerospace, MAVLink, ROS.
    #[default]
    YawPitchRoll,
    /// `R = Rz(yaw) Rx(roll) Ry(pitch)` (312): the joints of most three-axis gimbals
    /// (<https://github.com/ArduPilot/ardupilot/issues/24919>).
    YawRollPitch,
    /// `R = Ry(pitch) Rz(yaw) Rx(roll)`.
    PitchYawRoll,
    /// `R = Ry(pitch) Rx(roll) Rz(yaw)`.
    PitchRollYaw,
    /// `R = Rx(roll) Rz(yaw) Ry(pitch)`.
    RollYawPitch,
    /// `R = Rx(roll) Ry(pitch) Rz(yaw)`.
    RollPitchYaw,
}

impl EulerOrder {
    /// The name in profiles and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::YawPitchRoll => "yaw-pitch-roll",
            Self::YawRollPitch => "yaw-roll-pitch",
            Self::PitchYawRoll => "pitch-yaw-roll",
            Self::PitchRollYaw => "pitch-roll-yaw",
            Self::RollYawPitch => "roll-yaw-pitch",
            Self::RollPitchYaw => "roll-pitch-yaw",
        }
    }

    /// The rotation of these angles, radians.
    pub fn rotation(self, angles: RollPitchYaw) -> UnitQuaternion<f64> {
        if self == Self::YawPitchRoll {
            return angles.to_quaternion();
        }
        let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angles.roll);
        let pitch = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angles.pitch);
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angles.yaw);
        match self {
            Self::YawPitchRoll => yaw * pitch * roll,
            Self::YawRollPitch => yaw * roll * pitch,
            Self::PitchYawRoll => pitch * yaw * roll,
            Self::PitchRollYaw => pitch * roll * yaw,
            Self::RollYawPitch => roll * yaw * pitch,
            Self::RollPitchYaw => roll * pitch * yaw,
        }
    }
}
