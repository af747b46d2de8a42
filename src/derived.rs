//! What flows from the transform to the writer: the camera's motion, one moment at a time.

pub mod visual;

use std::collections::BTreeSet;

use nalgebra::{Rotation3, Vector3};

use crate::{
    geometry::RollPitchYaw,
    sample::{Kind, Stamp},
};

/// A derived value and the times of the sample that it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derived {
    /// The times of the sample.
    pub stamp: Stamp,
    /// The value itself.
    pub value: Value,
}

/// What was derived.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Value {
    /// How the camera turned since the previous attitude sample, in the axes that it had at that sample.
    RelativeRpy {
        /// Nanoseconds since the previous sample.
        interval: u64,
        /// The turn, radians.
        rpy: RollPitchYaw,
    },
    /// The camera's attitude, `R_ned_camera`.
    Orientation(Rotation3<f64>),
    /// The drone's velocity over ground in the camera's axes, m/s.
    CameraVelocity(Vector3<f64>),
}

/// The quantities that can be derived. Each has a topic of its own in the result; at equal times they come in
/// this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// How the camera turned since the previous attitude sample.
    RelativeRpy,
    /// The camera's attitude.
    Orientation,
    /// The drone's velocity in the camera's axes.
    CameraVelocity,
}

impl Quantity {
    /// All quantities, in their order.
    pub const ALL: [Quantity; 3] = [
        Quantity::RelativeRpy,
        Quantity::Orientation,
        Quantity::CameraVelocity,
    ];

    /// The kinds of sample that it is derived from, and how many usable ones of each it takes to derive the first
    /// value. From then on there is one value for each sample of the last kind.
    pub fn needs(self) -> &'static [(Kind, u64)] {
        match self {
            Quantity::RelativeRpy => &[(Kind::Attitude, 2)],
            Quantity::Orientation => &[(Kind::Attitude, 1)],
            Quantity::CameraVelocity => &[(Kind::Attitude, 1), (Kind::Velocity, 1)],
        }
    }

    /// The kinds of sample that any of the quantities is derived from.
    pub fn all_needed_kinds() -> BTreeSet<Kind> {
        let needs = Self::ALL.into_iter().flat_map(Self::needs);
        needs.map(|&(kind, _)| kind).collect()
    }

    /// The topic that it is written to.
    pub fn topic(self) -> &'static str {
        match self {
            Quantity::RelativeRpy => "/camera/relative_rpy",
            Quantity::Orientation => "/camera/orientation",
            Quantity::CameraVelocity => "/camera/velocity",
        }
    }

    /// The frame that its components are expressed in, as messages name it.
    pub fn frame_id(self) -> &'static str {
        match self {
            Quantity::RelativeRpy => "previous_camera",
            Quantity::Orientation => "ned",
            Quantity::CameraVelocity => "camera",
        }
    }
}

impl Value {
    /// Whether all of its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let are_finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        match self {
            Self::RelativeRpy { rpy, .. } => are_finite(&[rpy.roll, rpy.pitch, rpy.yaw]),
            Self::Orientation(r_ned_camera) => are_finite(r_ned_camera.matrix().as_slice()),
            Self::CameraVelocity(velocity) => are_finite(velocity.as_slice()),
        }
    }
}

impl Derived {
    /// Which quantity it is.
    pub fn quantity(&self) -> Quantity {
        match self.value {
            Value::RelativeRpy { .. } => Quantity::RelativeRpy,
            Value::Orientation(_) => Quantity::Orientation,
            Value::CameraVelocity(_) => Quantity::CameraVelocity,
        }
    }
}
