//! How the camera is mounted on the drone, and where it therefore looks.
//!
//! Frames and angles are those of [`geometry`](crate::geometry): NED, drone (FRD) and camera, `v_a = r_ab * v_b`.

use std::collections::BTreeSet;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use crate::{
    derived::{Quantity, visual::Calibration},
    geometry::{DepressionAngle, RollPitchYaw, camera_orientation, heading_rotation},
    sample::{GimbalReference, Kind},
};

/// How the camera is mounted on the drone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Camera {
    /// A camera on a gimbal that cancels the drone's roll and pitch and holds a fixed angle below the horizon:
    /// `R_ned_camera = Rz(ψ + yaw_offset) Ry(−θ)`, where ψ is the heading of the drone's nose.
    Stabilised {
        /// θ, the angle of the optical axis below the horizon.
        depression: DepressionAngle,
        /// How far to the right of the nose the camera looks, radians.
        yaw_offset: f64,
    },
    /// A camera bolted to the airframe: it rolls and pitches with the drone,
    /// `R_ned_camera = R_ned_drone R_drone_camera`.
    Fixed(Mount),
    /// A camera on a gimbal whose orientation is in the log.
    Gimbal,
}

/// Why it is not known how the camera is mounted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// Neither the log nor the options say.
    #[error("the log does not say where the camera looks, and no angle is given")]
    Unknown,
    /// A mount with roll or pitch was given together with a depression angle.
    #[error(
        "a mount with roll or pitch contradicts a depression angle: a gimballed camera does not tilt with the drone"
    )]
    TiltedMount,
    /// Both a mount and the location of a gimbal's angles were given.
    #[error(
        "a mount contradicts a gimbal: a camera that is bolted to the airframe follows no gimbal"
    )]
    GimbalAndMount,
}

impl Camera {
    /// The kinds of sample from which the camera's motion is derived.
    pub(crate) fn needed_kinds(&self) -> BTreeSet<Kind> {
        let mut kinds = Quantity::all_needed_kinds();
        if *self == Camera::Gimbal {
            kinds.insert(Kind::Gimbal);
        }
        kinds
    }

    /// Where the camera looks: `R_ned_camera` for the drone's attitude `q_ned_drone` (FRD to NED), or `None` if it
    /// follows the heading of a nose that points straight up or down
    /// ([`MIN_GROUND_PROJECTION`](crate::geometry::MIN_GROUND_PROJECTION)).
    ///
    /// `gimbal` returns the gimbal's orientation at that time, camera to reference, and its reference. It is called
    /// only if the camera follows the gimbal.
    ///
    /// ```
    /// use std::convert::Infallible;
    /// use flightcam::{camera::Camera, geometry::RollPitchYaw, sample::GimbalReference};
    ///
    /// let rpy = |roll, pitch, yaw| RollPitchYaw { roll, pitch, yaw }.to_quaternion();
    /// let drone = rpy(0.3, -0.1, 1.2);
    /// let gimbal = || Ok::<_, Infallible>((rpy(0.0, -0.5, 0.0), GimbalReference::Heading));
    /// let camera = Camera::Gimbal.orientation(&drone, gimbal)?.expect("the nose is not vertical");
    /// let down = camera.matrix()[(2, 0)];
    /// assert!((down - 0.5f64.sin()).abs() < 1e-12);
    /// # Ok::<(), Infallible>(())
    /// ```
    ///
    /// # Errors
    /// Those of `gimbal`.
    pub fn orientation<E>(
        &self,
        q_ned_drone: &UnitQuaternion<f64>,
        gimbal: impl FnOnce() -> Result<(UnitQuaternion<f64>, GimbalReference), E>,
    ) -> Result<Option<Rotation3<f64>>, E> {
        Ok(match *self {
            Camera::Stabilised {
                depression,
                yaw_offset,
            } => camera_orientation(q_ned_drone, depression)
                .map(|r_ned_ahead| turned_right(&r_ned_ahead, yaw_offset)),
            Camera::Fixed(mount) => Some(q_ned_drone.to_rotation_matrix() * mount.to_rotation()),
            Camera::Gimbal => {
                let (orientation, reference) = gimbal()?;
                reference_rotation(q_ned_drone, reference)
                    .map(|r_ned_reference| r_ned_reference * orientation.to_rotation_matrix())
            }
        })
    }
}

/// Computes `Rz(angle) R`.
fn turned_right(r: &Rotation3<f64>, angle: f64) -> Rotation3<f64> {
    // Multiplying by the identity can turn -0 into 0, which flips the sign of a 180° angle.
    if angle == 0.0 {
        return *r;
    }
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle) * r
}

/// Computes `R_ned_reference`; `None` if the reference is the heading and the nose is vertical.
fn reference_rotation(
    q_ned_drone: &UnitQuaternion<f64>,
    reference: GimbalReference,
) -> Option<Rotation3<f64>> {
    match reference {
        GimbalReference::Earth => Some(Rotation3::identity()),
        GimbalReference::Heading => heading_rotation(q_ned_drone),
        GimbalReference::Airframe => Some(q_ned_drone.to_rotation_matrix()),
    }
}

/// The fixed orientation of a camera on the airframe, `R_drone_camera = Rz(yaw) Ry(pitch) Rx(roll)`.
///
/// If all are zero, the camera looks ahead; positive angles turn it to the right, up, and clockwise as seen from
/// behind. Roll 0°, pitch −30°, yaw 0° looks ahead and 30° down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    degrees: [f64; 3],
}

/// Roll, pitch and yaw of a mount in degrees, at least one of them out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a mount of roll {}°, pitch {}°, yaw {}° is out of range: roll and yaw must be from -180 to 180, pitch \
     from -90 to 90 (0,-30,0 looks ahead and 30° down)", .0[0], .0[1], .0[2]
)]
pub struct MountOutOfRange(pub [f64; 3]);

impl Mount {
    /// Creates a mount from roll, pitch (up) and yaw (to the right) in degrees.
    ///
    /// # Errors
    /// Roll or yaw outside −180 to 180, pitch outside −90 to 90, or one is not a number.
    pub fn from_degrees(roll: f64, pitch: f64, yaw: f64) -> Result<Self, MountOutOfRange> {
        let degrees = [roll, pitch, yaw];
        // This comparison is false for NaN.
        let in_range = |(angle, limit): (f64, f64)| angle.abs() <= limit;
        if degrees.into_iter().zip([180.0, 90.0, 180.0]).all(in_range) {
            Ok(Self { degrees })
        } else {
            Err(MountOutOfRange(degrees))
        }
    }

    /// Roll, pitch and yaw in degrees, as they were given.
    pub fn degrees(self) -> [f64; 3] {
        self.degrees
    }

    /// The rotation `R_drone_camera`, which turns camera coordinates into those of the drone (FRD).
    pub fn to_rotation(self) -> Rotation3<f64> {
        let [roll, pitch, yaw] = self.degrees.map(f64::to_radians);
        RollPitchYaw { roll, pitch, yaw }.to_rotation()
    }
}

/// How wide and how high the camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldOfView {
    degrees: [f64; 2],
}

/// Angles of a field of view in degrees, at least one of them out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a field of view of {}° by {}° is out of range: both angles must be from 0.1 to 170", .0[0], .0[1]
)]
pub struct FieldOfViewOutOfRange(pub [f64; 2]);

impl FieldOfView {
    /// Creates a field of view from its whole angle from left to right and from top to bottom, in degrees.
    ///
    /// # Errors
    /// One is less than 0.1, more than 170, or not a number.
    pub fn from_degrees(horizontal: f64, vertical: f64) -> Result<Self, FieldOfViewOutOfRange> {
        let degrees = [horizontal, vertical];
        match degrees.iter().all(|angle| (0.1..=170.0).contains(angle)) {
            true => Ok(Self { degrees }),
            false => Err(FieldOfViewOutOfRange(degrees)),
        }
    }

    /// The angles from left to right and from top to bottom, in degrees.
    pub fn degrees(self) -> [f64; 2] {
        self.degrees
    }

    /// A pinhole camera that sees as much, with square pixels as nearly as whole rows allow.
    pub fn calibration(self) -> Calibration {
        /// The pixels of a picture in a row, which the angles do not say.
        const WIDTH: u32 = 1920;
        let [right, down] = self.degrees.map(|angle| (angle / 2.0).to_radians().tan());
        let half = f64::from(WIDTH) / 2.0;
        let height = (f64::from(WIDTH) * down / right).round().clamp(1.0, 1e6);
        Calibration {
            width: WIDTH,
            height: height as u32,
            focal: [half / right, height / 2.0 / down],
            centre: [half, height / 2.0],
        }
    }
}
