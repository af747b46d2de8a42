//! Frames and rotations: where a stabilised camera looks, and rotations and velocities in its axes.
//!
//! All frames are right-handed, all angles radians:
//!
//! | frame | x | y | z |
//! | --- | --- | --- | --- |
//! | NED (world) | north | east | down |
//! | drone (FRD) | front | right | down |
//! | camera | where it looks | right | down |
//!
//! `r_ab` has the axes of frame b as its columns, in coordinates of a: `v_a = r_ab * v_b`.
//!
//! Roll, pitch and yaw are fixed-axis angles, `R = Rz(yaw) Ry(pitch) Rx(roll)`, which is the same as the
//! intrinsic sequence yaw, pitch, roll (ZYX, the aerospace convention). Quaternions are Hamilton's.

pub mod axes;
pub mod geodetic;
pub mod local_frame;

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// If the projection of the unit nose axis on the ground is shorter than this, the drone's nose points straight up or
/// down and its heading does not exist.
pub const MIN_GROUND_PROJECTION: f64 = 1e-9;

/// Below this `cos(pitch)`, roll and yaw turn about the same axis and only their sum is known.
const GIMBAL_LOCK: f64 = 1e-9;

/// The fixed angle of the camera's optical axis below the horizon, positive down: a gimbal pitch of −30° is
/// a depression angle of 30°. Greater than −90° and at most 90° (nadir).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepressionAngle {
    degrees: f64,
}

/// A depression angle out of range: it must be greater than −90° and at most 90°.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a depression angle of {0}° is out of range: it must be greater than -90 and at most 90 \
     (a gimbal pitch of -90° is a depression angle of 90°)"
)]
pub struct DepressionOutOfRange(pub f64);

impl DepressionAngle {
    /// Creates the angle from degrees below the horizon.
    ///
    /// # Errors
    /// The angle is outside −90 < degrees ≤ 90, or not a number.
    pub fn from_degrees(degrees: f64) -> Result<Self, DepressionOutOfRange> {
        if degrees > -90.0 && degrees <= 90.0 {
            Ok(Self { degrees })
        } else {
            Err(DepressionOutOfRange(degrees))
        }
    }

    /// The angle in degrees, as it was given.
    pub fn degrees(self) -> f64 {
        self.degrees
    }

    /// The angle in radians.
    pub fn radians(self) -> f64 {
        self.degrees.to_radians()
    }
}

/// Fixed-axis roll, pitch and yaw in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollPitchYaw {
    /// Angle about x, −π to π.
    pub roll: f64,
    /// Angle about y, −π/2 to π/2 if it was extracted from a rotation.
    pub pitch: f64,
    /// Angle about z, −π to π.
    pub yaw: f64,
}

impl RollPitchYaw {
    /// Extracts roll, pitch and yaw from a rotation, `R = Rz(yaw) Ry(pitch) Rx(roll)`.
    ///
    /// The textbook arcsines (`pitch = asin(−R31)`, …) stop at ±90°; these `atan2` forms agree with them there and hold
    /// up to ±180°. Yaw is what is left of the turn once pitch and this roll are undone, so the triple rebuilds the
    /// rotation even if roll and yaw are nearly the same turn and each is ill-defined by itself. At gimbal lock roll is
    /// set to 0 and yaw takes the whole turn.
    pub fn from_rotation(r: &Rotation3<f64>) -> Self {
        let cos_pitch = length_of_part(r[(2, 1)], r[(2, 2)]);
        let (roll, sin_roll, cos_roll) = if cos_pitch < GIMBAL_LOCK {
            (0.0, 0.0, 1.0)
        } else {
            let (y, x) = (r[(2, 1)], r[(2, 2)]);
            (y.atan2(x), y / cos_pitch, x / cos_pitch)
        };
        // The second column of R Rx(−roll), which is Rz(yaw)'s: (−sin yaw, cos yaw, 0).
        let minus_sin_yaw = cos_roll * r[(0, 1)] - sin_roll * r[(0, 2)];
        let cos_yaw = cos_roll * r[(1, 1)] - sin_roll * r[(1, 2)];
        Self {
            roll,
            pitch: (-r[(2, 0)]).atan2(cos_pitch),
            yaw: (-minus_sin_yaw).atan2(cos_yaw),
        }
    }

    /// The rotation `Rz(yaw) Ry(pitch) Rx(roll)`.
    pub fn to_rotation(self) -> Rotation3<f64> {
        Rotation3::from_euler_angles(self.roll, self.pitch, self.yaw)
    }

    /// The same rotation as a quaternion.
    pub fn to_quaternion(self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_euler_angles(self.roll, self.pitch, self.yaw)
    }
}

/// Where the camera looks: `R_ned_camera` for the drone's attitude `q_ned_drone` (FRD to NED), or `None` if the drone's
/// nose points straight up or down ([`MIN_GROUND_PROJECTION`]) and has no heading.
///
/// The gimbal cancels the drone's roll and pitch, so the camera yaws with the drone's nose and looks down by
/// the depression angle: `R_ned_camera = Rz(ψ) Ry(−θ)`, where ψ is the heading of the nose axis. In terms
/// of vectors that is the nose axis projected on the ground, tilted down by θ, with a horizontal y axis; this
/// closed form also holds at nadir, where that construction's `tan θ` does not.
///
/// ```
/// use flightcam::geometry::{DepressionAngle, RollPitchYaw, camera_orientation};
///
/// // The drone heads east, banking; a camera at nadir looks straight down all the same.
/// let drone = RollPitchYaw { roll: 0.3, pitch: -0.1, yaw: std::f64::consts::FRAC_PI_2 };
/// let nadir = DepressionAngle::from_degrees(90.0)?;
/// let camera = camera_orientation(&drone.to_quaternion(), nadir).expect("the nose is not vertical");
/// let optical_axis = camera.matrix().column(0).into_owned();
/// assert!((optical_axis - nalgebra::Vector3::z()).norm() < 1e-12);
/// # Ok::<(), flightcam::geometry::DepressionOutOfRange>(())
/// ```
pub fn camera_orientation(
    q_ned_drone: &UnitQuaternion<f64>,
    depression: DepressionAngle,
) -> Option<Rotation3<f64>> {
    let (sin_heading, cos_heading) = heading_sin_cos(q_ned_drone)?;
    let (sin_depression, cos_depression) = depression.radians().sin_cos();
    Some(Rotation3::from_matrix_unchecked(Matrix3::new(
        cos_heading * cos_depression,
        -sin_heading,
        -cos_heading * sin_depression,
        sin_heading * cos_depression,
        cos_heading,
        -sin_heading * sin_depression,
        sin_depression,
        0.0,
        cos_depression,
    )))
}

/// The drone's heading alone, `Rz(ψ)`: turns coordinates of a level drone with the same heading into NED. `None` if the
/// nose points straight up or down ([`MIN_GROUND_PROJECTION`]).
pub fn heading_rotation(q_ned_drone: &UnitQuaternion<f64>) -> Option<Rotation3<f64>> {
    let (sin_heading, cos_heading) = heading_sin_cos(q_ned_drone)?;
    Some(Rotation3::from_matrix_unchecked(Matrix3::new(
        cos_heading,
        -sin_heading,
        0.0,
        sin_heading,
        cos_heading,
        0.0,
        0.0,
        0.0,
        1.0,
    )))
}

/// The length of two components of a unit vector, which cannot overflow: `hypot` takes ten times as long.
fn length_of_part(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// Sine and cosine of the heading ψ of the nose axis.
fn heading_sin_cos(q_ned_drone: &UnitQuaternion<f64>) -> Option<(f64, f64)> {
    let nose = q_ned_drone * Vector3::x();
    let ground = length_of_part(nose.x, nose.y);
    (ground >= MIN_GROUND_PROJECTION).then(|| (nose.y / ground, nose.x / ground))
}

/// How the camera turned between two moments, in the axes that it had at the first: `R_12 = R_1ᵀ R_2`.
pub fn relative_rpy(
    r_ned_camera1: &Rotation3<f64>,
    r_ned_camera2: &Rotation3<f64>,
) -> RollPitchYaw {
    RollPitchYaw::from_rotation(&(r_ned_camera1.inverse() * r_ned_camera2))
}

/// A velocity over ground (m/s, NED) in the axes of the camera: `v_camera = R_ned_cameraᵀ v_ned`.
pub fn velocity_in_camera(
    r_ned_camera: &Rotation3<f64>,
    velocity_ned: &Vector3<f64>,
) -> Vector3<f64> {
    r_ned_camera.inverse_transform_vector(velocity_ned)
}

/// Spherical linear interpolation along the shorter arc, `q0 (q0⁻¹ q1)^u`, for 0 ≤ u ≤ 1 (Shoemake,
/// "Animating rotation with quaternion curves", 1985).
///
/// Unlike `nalgebra`'s slerp it renormalises and stays accurate for tiny angles: the power is taken with `atan2` of the
/// half angle's sine and cosine, not with an arccosine, which loses all precision below 1e-8.
pub fn slerp(q0: &UnitQuaternion<f64>, q1: &UnitQuaternion<f64>, u: f64) -> UnitQuaternion<f64> {
    let step = (q0.inverse() * q1).into_inner();
    // q and −q are the same rotation; the one with a positive scalar part is the shorter arc.
    let step = if step.w < 0.0 { -step } else { step };
    let sin_half = step.imag().norm();
    if sin_half == 0.0 {
        return *q0;
    }
    let half = sin_half.atan2(step.w);
    let part = Quaternion::from_parts(
        (u * half).cos(),
        step.imag() * ((u * half).sin() / sin_half),
    );
    UnitQuaternion::from_quaternion(q0.into_inner() * part)
}
