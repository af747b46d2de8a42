//! The orientations that are tracked: the drone's and the gimbal's.

use nalgebra::UnitQuaternion;

use super::track::Interpolate;
use crate::{
    geometry::slerp,
    sample::{AttitudeSample, DropReason, GimbalReference, GimbalSample, Kind},
};

/// The drone's attitude.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attitude {
    pub(super) q_ned_drone: UnitQuaternion<f64>,
    /// The log's count of resets: each moves what the estimator takes for north and level.
    resets: Option<u64>,
}

/// Where the gimbal holds the camera.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gimbal {
    pub(super) q_reference_camera: UnitQuaternion<f64>,
    pub(super) reference: GimbalReference,
}

impl Attitude {
    /// Whether the estimator was not reset between the two, as far as the log says.
    pub(super) fn has_same_origin(&self, other: &Self) -> bool {
        is_same_origin(self.resets, other.resets)
    }
}

/// Whether an estimator was not reset between two counts of its resets, as far as these are known.
pub(super) fn is_same_origin(a: Option<u64>, b: Option<u64>) -> bool {
    a.zip(b).is_none_or(|(a, b)| a == b)
}

impl From<&AttitudeSample> for Attitude {
    fn from(sample: &AttitudeSample) -> Self {
        Self {
            q_ned_drone: sample.orientation,
            resets: sample.reset_counter,
        }
    }
}

impl From<&GimbalSample> for Gimbal {
    fn from(sample: &GimbalSample) -> Self {
        Self {
            q_reference_camera: sample.orientation,
            reference: sample.reference,
        }
    }
}

impl Interpolate for Attitude {
    const KIND: Kind = Kind::Attitude;
    const OUTSIDE: DropReason = DropReason::OutsideAttitude;
    const IN_GAP: DropReason = DropReason::InAttitudeGap;

    fn interpolate(&self, later: &Self, fraction: f64) -> Result<Self, DropReason> {
        if !self.has_same_origin(later) {
            return Err(DropReason::AcrossAttitudeReset);
        }
        Ok(Self {
            q_ned_drone: slerp(&self.q_ned_drone, &later.q_ned_drone, fraction),
            resets: self.resets,
        })
    }
}

impl Interpolate for Gimbal {
    const KIND: Kind = Kind::Gimbal;
    const OUTSIDE: DropReason = DropReason::OutsideGimbal;
    const IN_GAP: DropReason = DropReason::InGimbalGap;

    fn interpolate(&self, later: &Self, fraction: f64) -> Result<Self, DropReason> {
        if self.reference != later.reference {
            return Err(DropReason::InGimbalGap);
        }
        Ok(Self {
            q_reference_camera: slerp(
                &self.q_reference_camera,
                &later.q_reference_camera,
                fraction,
            ),
            reference: self.reference,
        })
    }
}
