//! A sample in the units that people think in.

use nalgebra::UnitQuaternion;
use serde::Serialize;

use crate::sample::{GimbalReference, Position, Sample, Velocity};

/// The first usable sample of a kind, in the units that people think in.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
// The fields are degrees, metres per second and metres, in the axes that they name.
#[allow(missing_docs)]
pub enum FirstSample {
    /// How the drone is oriented, from north, east, down.
    Attitude {
        roll_deg: f64,
        pitch_deg: f64,
        yaw_deg: f64,
    },
    /// Where the gimbal holds the camera.
    Gimbal {
        roll_deg: f64,
        pitch_deg: f64,
        yaw_deg: f64,
        reference: GimbalReference,
    },
    /// A velocity over ground in world axes.
    VelocityNed { north: f64, east: f64, down: f64 },
    /// A velocity over ground in the drone's axes.
    VelocityFrd { front: f64, right: f64, down: f64 },
    /// A place on the globe.
    PositionGeodetic {
        latitude: f64,
        longitude: f64,
        altitude: f64,
    },
    /// A place in the log's own coordinates.
    PositionLocal { north: f64, east: f64, down: f64 },
    /// A height above the ground.
    Height { metres: f64 },
    /// Radians per second about the drone's axes.
    AngularRate { front: f64, right: f64, down: f64 },
    /// A specific force in metres per second squared, in the drone's axes.
    Acceleration { front: f64, right: f64, down: f64 },
}

impl From<&Sample> for FirstSample {
    fn from(sample: &Sample) -> Self {
        match sample {
            Sample::Attitude(sample) => {
                let [roll_deg, pitch_deg, yaw_deg] = degrees(&sample.orientation);
                Self::Attitude {
                    roll_deg,
                    pitch_deg,
                    yaw_deg,
                }
            }
            Sample::Gimbal(sample) => {
                let [roll_deg, pitch_deg, yaw_deg] = degrees(&sample.orientation);
                Self::Gimbal {
                    roll_deg,
                    pitch_deg,
                    yaw_deg,
                    reference: sample.reference,
                }
            }
            Sample::Velocity(sample) => match sample.velocity {
                Velocity::Ned(velocity) => {
                    let [north, east, down] = velocity.into();
                    Self::VelocityNed { north, east, down }
                }
                Velocity::Frd(velocity) => {
                    let [front, right, down] = velocity.into();
                    Self::VelocityFrd { front, right, down }
                }
            },
            Sample::Position(sample) => match sample.position {
                Position::Geodetic {
                    latitude,
                    longitude,
                    altitude,
                } => Self::PositionGeodetic {
                    latitude,
                    longitude,
                    altitude,
                },
                Position::Local(place) => {
                    let [north, east, down] = place.into();
                    Self::PositionLocal { north, east, down }
                }
            },
            Sample::Height(sample) => Self::Height {
                metres: sample.metres,
            },
            Sample::AngularRate(sample) => {
                let [front, right, down] = sample.rate.into();
                Self::AngularRate { front, right, down }
            }
            Sample::Acceleration(sample) => {
                let [front, right, down] = sample.force.into();
                Self::Acceleration { front, right, down }
            }
        }
    }
}

fn degrees(orientation: &UnitQuaternion<f64>) -> [f64; 3] {
    let (roll, pitch, yaw) = orientation.euler_angles();
    [roll, pitch, yaw].map(f64::to_degrees)
}
