//! What is known at times that are asked for, and what happens in between: what viewers are shown is made of it.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::{
    Pose,
    orientation::{Attitude, Gimbal},
    track::{Interpolate, Never},
};
use crate::sample::{DropReason, Kind};

/// Something about one time. Moments come in the order of their times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Moment {
    /// Drone and camera at a time that was asked for, or why they are not known.
    Asked {
        /// Nanoseconds of log time.
        time: u64,
        /// Both attitudes.
        attitudes: Result<Attitudes, DropReason>,
    },
    /// The drone's velocity over ground at the time of a sample, north, east, down, m/s.
    Velocity {
        /// Nanoseconds of log time.
        time: u64,
        /// The velocity.
        ned: Vector3<f64>,
    },
    /// Something that happened.
    Incident(Incident),
}

/// How drone and camera are oriented.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitudes {
    /// The drone's attitude (FRD to NED).
    pub q_ned_drone: UnitQuaternion<f64>,
    /// The camera's attitude.
    pub r_ned_camera: Rotation3<f64>,
}

/// Something that happened during a flight, from one time to another in nanoseconds of log time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incident {
    /// When it began.
    pub from: u64,
    /// When it ended.
    pub to: u64,
    /// What it was.
    pub kind: IncidentKind,
}

/// What can happen during a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum IncidentKind {
    /// No attitude for longer than the maximum gap.
    Gap,
    /// The attitude estimator was reset.
    Reset,
    /// The time of the log went back.
    ClockStep,
    /// The camera turned by this angle, in radians, while the drone did not.
    Flip(f64),
    /// The drone turned this fast, in rad/s, which none does.
    Spin(f64),
    /// The velocity changed this fast, in m/s², which none does.
    Leap(f64),
}

impl From<Pose> for Attitudes {
    fn from(pose: Pose) -> Self {
        Self {
            q_ned_drone: pose.attitude.q_ned_drone,
            r_ned_camera: pose.r_ned_camera,
        }
    }
}

impl From<Never> for DropReason {
    fn from(never: Never) -> Self {
        match never {
            Never::For(reason) => reason,
            Never::OutOfReach(Kind::Gimbal) => Gimbal::IN_GAP,
            Never::OutOfReach(_) => Attitude::IN_GAP,
        }
    }
}
