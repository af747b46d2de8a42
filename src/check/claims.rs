//! How a log was read.

use super::{
    reading::{AttitudeReading, VectorReading},
    verdict::Reading,
};

/// How the series of a log were read. A series that is not claimed is not judged.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Claims {
    /// The velocity.
    pub velocity: Option<VectorReading>,
    /// The attitude.
    pub attitude: Option<AttitudeReading>,
    /// The angular rates.
    pub angular_rate: Option<VectorReading>,
    /// The accelerations.
    pub acceleration: Option<VectorReading>,
    /// The angle below the horizon at which the camera is said to be held, in radians.
    pub depression: Option<f64>,
    /// By how many seconds positions and velocities may be apart by their nature: a receiver's are late, as much as
    /// [`RECEIVER_LAG`]; an estimator's are not.
    pub lag_s: f64,
    /// By how many seconds the velocity is stamped too late.
    pub velocity_late_by_s: f64,
}

/// How late a satellite receiver's positions may be, in seconds. ArduPilot and PX4 assume 0.1 to 0.22 s by default
/// (`GPS_DELAY_MS`, `EKF2_GPS_DELAY`), and what travels through a middleware comes later still.
pub const RECEIVER_LAG: f64 = 0.3;

/// How late an estimator's positions or velocities may be against each other, in seconds: they are published together.
pub const ESTIMATE_LAG: f64 = 0.05;

impl Claims {
    /// The same with one series read in another way.
    pub(super) fn with(&self, reading: &Reading) -> Self {
        let mut claims = self.clone();
        match *reading {
            Reading::Velocity(velocity) => claims.velocity = Some(velocity),
            Reading::Attitude(attitude) => claims.attitude = Some(attitude),
            Reading::AngularRate(rate) => claims.angular_rate = Some(rate),
            Reading::Acceleration(acceleration) => claims.acceleration = Some(acceleration),
            Reading::ShiftedVelocity { late_by_s } => claims.velocity_late_by_s += late_by_s,
            Reading::Gimbal { .. } => {}
        }
        claims
    }
}
