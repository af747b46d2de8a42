//! What is shown of one tick, in the frames of viewers.

use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::{
    flight::{Flight, Tick, TickAttitudes},
    stage::{Place, Stage},
};
use crate::{
    derived::visual::{Display, Frame, Location, Odometry, Pose, Transform},
    geometry::RollPitchYaw,
    transform::IncidentKind,
};

/// Ticks further apart than this many seconds say nothing about how fast the camera turns.
const LONGEST_STEP: f64 = 0.25;

/// Turns north, east, down into east, north, up, which is its own inverse: half a turn about the axis between north and
/// east.
pub fn q_map_ned() -> UnitQuaternion<f64> {
    use std::f64::consts::FRAC_1_SQRT_2;
    UnitQuaternion::new_unchecked(Quaternion::new(0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0))
}

/// The same for a vector, without rounding.
pub fn map_of(ned: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(ned.y, ned.x, -ned.z)
}

/// Turns coordinates of the optical frame (right, down, where the camera looks) into those of the camera.
pub fn q_camera_optical() -> UnitQuaternion<f64> {
    let columns = [Vector3::y(), Vector3::z(), Vector3::x()];
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_basis_unchecked(&columns))
}

/// Where the frames that never move are in their parents.
pub fn static_transforms() -> Vec<Transform> {
    let position = Vector3::zeros();
    let transform = |parent, child, orientation| Transform {
        parent,
        child,
        pose: Pose {
            position,
            orientation,
        },
    };
    vec![
        transform(Frame::Map, Frame::Ned, q_map_ned()),
        transform(Frame::Camera, Frame::CameraOptical, q_camera_optical()),
    ]
}

/// Rounds a number to 28 significant bits, four parts in a thousand million: nobody sees more of it, and what viewers are
/// shown takes a third less room.
pub fn rounded(number: f64) -> f64 {
    /// The bits of a double that are left out.
    const REST: u32 = 52 - 27;
    let half = 1 << (REST - 1);
    f64::from_bits((number.to_bits() + half) & (u64::MAX << REST))
}

fn rounded_vector(vector: Vector3<f64>) -> Vector3<f64> {
    vector.map(rounded)
}

fn rounded_pose(position: Vector3<f64>, orientation: UnitQuaternion<f64>) -> Pose {
    Pose {
        position: rounded_vector(position),
        orientation: UnitQuaternion::new_unchecked(Quaternion::from(
            orientation.coords.map(rounded),
        )),
    }
}

/// One tick of a flight.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    pub tick: &'a Tick,
    pub attitudes: TickAttitudes,
    pub place: Option<Place>,
    /// How fast the camera turns about its own axes, rad/s.
    pub rate: Option<Vector3<f64>>,
}

impl<'a> View<'a> {
    /// What is shown of a tick, if it is known how drone and camera are oriented.
    pub fn of(flight: &'a Flight, number: usize, stage: &Stage) -> Option<Self> {
        let tick = &flight.ticks[number];
        Some(Self {
            tick,
            attitudes: tick.attitudes.ok()?,
            place: stage.place(tick),
            rate: rate(flight, number),
        })
    }

    /// Where the drone is, north, east, down. If the log has no positions at all, it stays at the origin; if it has none
    /// now, that is not known.
    fn position(&self, stage: &Stage) -> Option<Vector3<f64>> {
        match self.place {
            Some(place) => Some(place.ned),
            None if stage.has_positions => None,
            None => Some(Vector3::zeros()),
        }
    }

    /// Where drone and camera are in their parents, if it is known where the drone is.
    pub fn transforms(&self, stage: &Stage) -> Option<Vec<Transform>> {
        let position = self.position(stage)?;
        let TickAttitudes {
            q_ned_drone,
            q_ned_camera,
        } = self.attitudes;
        Some(vec![
            Transform {
                parent: Frame::Ned,
                child: Frame::Drone,
                pose: rounded_pose(position, q_ned_drone),
            },
            Transform {
                parent: Frame::Drone,
                child: Frame::Camera,
                pose: rounded_pose(Vector3::zeros(), q_ned_drone.inverse() * q_ned_camera),
            },
        ])
    }

    /// Where the frame is from which viewers follow the drone.
    pub fn viewpoint(&self, stage: &Stage) -> Option<Transform> {
        Some(Transform {
            parent: Frame::Map,
            child: Frame::DroneEnu,
            pose: rounded_pose(map_of(&self.position(stage)?), UnitQuaternion::identity()),
        })
    }

    /// The camera's pose in the map, if it is known where it is.
    pub fn pose(&self) -> Option<Pose> {
        let place = self.place?;
        let orientation = q_map_ned() * self.attitudes.q_ned_camera;
        Some(rounded_pose(map_of(&place.ned), orientation))
    }

    /// Where the camera is and how it moves, if all of that is known.
    pub fn odometry(&self) -> Option<Odometry> {
        Some(Odometry {
            pose: self.pose()?,
            velocity: (self.attitudes.q_ned_camera).inverse_transform_vector(&self.tick.velocity?),
            angular_velocity: self.rate?,
        })
    }

    /// Where the camera is on the globe, if that is known.
    pub fn location(&self) -> Option<Location> {
        let place = self.place?.geodetic?;
        Some(Location {
            latitude_deg: place.latitude.to_degrees(),
            longitude_deg: place.longitude.to_degrees(),
            altitude: place.altitude,
            heading: self.angles().yaw.rem_euclid(std::f64::consts::TAU),
            velocity_enu: self.tick.velocity.map(|ned| map_of(&ned)),
        })
    }

    /// Roll, pitch and yaw of the camera from north, east, down.
    pub fn angles(&self) -> RollPitchYaw {
        RollPitchYaw::from_rotation(&self.attitudes.q_ned_camera.to_rotation_matrix())
    }

    /// Numbers for people; `unwrapped` is the heading without steps, in degrees.
    pub fn display(&self, unwrapped: f64) -> Display {
        let angles = self.angles();
        let velocity = self.tick.velocity;
        Display {
            heading: wrapped(angles.yaw.to_degrees()),
            heading_unwrapped: unwrapped as f32,
            tilt: angles.pitch.to_degrees() as f32,
            roll: angles.roll.to_degrees() as f32,
            rates: (self.rate).map(|rate| <[f64; 3]>::from(rate).map(|r| r.to_degrees() as f32)),
            speed: velocity.map(|ned| ned.norm() as f32),
            ground_speed: velocity.map(|ned| ned.xy().norm() as f32),
            climb: velocity.map(|ned| -ned.z as f32),
            height: self.place.map(|place| place.height as f32),
        }
    }
}

/// An angle in degrees from 0 up to, but not including, 360.
fn wrapped(degrees: f64) -> f32 {
    let rounded = degrees.rem_euclid(360.0) as f32;
    // Rounding may give 360 itself.
    if rounded >= 360.0 { 0.0 } else { rounded }
}

/// How fast the camera turns at a tick about its own axes, rad/s: from the tick before to the one after it, or from one
/// side only at an end. Nothing is known across a reset of the estimator or a long step.
fn rate(flight: &Flight, number: usize) -> Option<Vector3<f64>> {
    let ticks = &flight.ticks;
    let here = &ticks[number];
    let usable = |other: usize| {
        let tick = ticks.get(other)?;
        let step = here.time.abs_diff(tick.time) as f64 / 1e9;
        let is_near = tick.epoch == here.epoch && step <= LONGEST_STEP;
        (is_near && tick.attitudes.is_ok() && !flight.is_reset_between(tick.time, here.time))
            .then_some(tick)
    };
    let before = number.checked_sub(1).and_then(usable).unwrap_or(here);
    let after = usable(number + 1).unwrap_or(here);
    let seconds = after
        .time
        .checked_sub(before.time)
        .filter(|&span| span > 0)? as f64
        / 1e9;
    let [q0, q1] = [before, after].map(|tick| tick.attitudes.ok().map(|both| both.q_ned_camera));
    Some((q0?.inverse() * q1?).scaled_axis() / seconds)
}

impl Flight {
    /// Whether the attitude estimator was reset between two times, in either order.
    fn is_reset_between(&self, a: u64, b: u64) -> bool {
        let (from, to) = (a.min(b), a.max(b));
        self.incidents.iter().any(|(_, incident)| {
            incident.kind == IncidentKind::Reset && incident.from < to && incident.to > from
        })
    }
}
