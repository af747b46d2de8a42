//! The flight, in the conventions of its publishers.

use std::{
    f64::consts::{PI, TAU},
    rc::Rc,
};

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::simulated::Simulated;

/// The log time at which the flight begins, in nanoseconds.
const START: u64 = 1_700_000_000_000_000_000;
const MILLISECOND: u64 = 1_000_000;

/// When what was recorded. The values follow from the time: by formulas, or as they were simulated.
#[derive(Debug, Clone)]
pub struct Flight {
    pub attitude_times: Vec<u64>,
    pub velocity_times: Vec<u64>,
    pub gimbal_times: Vec<u64>,
    pub position_times: Vec<u64>,
    /// When there is a message that the log itself marks as unusable.
    pub invalid_times: Vec<u64>,
    pub simulated: Option<Rc<Simulated>>,
    /// The angles are whole numbers of these steps, degrees.
    pub step: Option<f64>,
}

/// Degrees, degrees, metres.
pub type Geodetic = [f64; 3];

/// Roll, pitch and yaw in radians, `R = Rz(yaw) Ry(pitch) Rx(roll)`.
pub type Angles = [f64; 3];

impl Flight {
    /// Attitude at 50 Hz; velocity at 10 Hz, between the attitudes; the gimbal at 30 Hz, a little longer than
    /// the attitude; positions at 5 Hz.
    pub fn new() -> Self {
        let times = |first: u64, count: u64, step: u64| -> Vec<u64> {
            (0..count)
                .map(|i| START + (first + i * step) * MILLISECOND / 3)
                .collect()
        };
        Self {
            attitude_times: times(60, 200, 60),
            velocity_times: times(75, 38, 310),
            gimbal_times: times(10, 125, 100),
            position_times: times(100, 19, 600),
            invalid_times: times(140, 18, 630),
            simulated: None,
            step: None,
        }
    }

    /// The same with angles that are whole numbers of steps, degrees, for publishers that write integers.
    pub fn in_steps_of(self, degrees: f64) -> Self {
        let step = Some(degrees);
        Self { step, ..self }
    }

    /// As [`Flight::new`], where one message has the attitude, the velocity and the position.
    pub fn in_one_message() -> Self {
        let flight = Self::new();
        Self {
            velocity_times: flight.attitude_times.clone(),
            position_times: flight.attitude_times.clone(),
            ..flight
        }
    }

    /// As [`Flight::in_one_message`], without the velocity.
    pub fn without_velocity() -> Self {
        Self {
            velocity_times: Vec::new(),
            ..Self::in_one_message()
        }
    }

    /// Of all times those that are wanted.
    pub fn only(mut self, is_wanted: impl Fn(u64) -> bool) -> Self {
        for times in [
            &mut self.attitude_times,
            &mut self.velocity_times,
            &mut self.gimbal_times,
            &mut self.position_times,
            &mut self.invalid_times,
        ] {
            times.retain(|&time| is_wanted(time));
        }
        self
    }

    /// The first second or so.
    pub fn beginning(self) -> Self {
        let attitude_end = START + 1_100 * MILLISECOND;
        let gimbal_times = self.gimbal_times.clone();
        let beginning = self.only(|time| time < attitude_end);
        Self {
            gimbal_times,
            ..beginning
        }
    }

    /// A simulated flight in its place, at the same rates.
    pub fn simulated(mut self, simulated: Simulated) -> Self {
        let end = START + (simulated.seconds() * 1e9) as u64;
        for times in [
            &mut self.attitude_times,
            &mut self.velocity_times,
            &mut self.gimbal_times,
            &mut self.position_times,
            &mut self.invalid_times,
        ] {
            if let [first, second, ..] = times[..] {
                *times = (first..end).step_by((second - first) as usize).collect();
            }
        }
        self.simulated = Some(Rc::new(simulated));
        self
    }

    /// The drone's attitude (FRD in NED) at the time of an attitude sample, or between two of them.
    pub fn attitude(&self, time: u64) -> UnitQuaternion<f64> {
        match &self.simulated {
            Some(simulated) => simulated.attitude(since_start(time)),
            None => slerp(&self.attitude_times, time, |time| self.angles(time)),
        }
    }

    /// The same as roll, pitch and yaw.
    pub fn angles(&self, time: u64) -> Angles {
        match &self.simulated {
            Some(_) => self.attitude(time).euler_angles().into(),
            None => self.in_steps(attitude(time)),
        }
    }

    /// The velocity over ground to north, east, down, in m/s.
    pub fn velocity(&self, time: u64) -> Vector3<f64> {
        match &self.simulated {
            Some(simulated) => simulated.velocity(since_start(time)),
            None => velocity(time),
        }
    }

    /// The velocity over ground in the drone's front, right, down.
    pub fn body_velocity(&self, time: u64) -> Vector3<f64> {
        self.attitude(time).inverse() * self.velocity(time)
    }

    /// How the gimbal holds the camera, its z axis down, in the axes that it is measured from.
    pub fn gimbal(&self, time: u64) -> UnitQuaternion<f64> {
        match &self.simulated {
            Some(simulated) => simulated.gimbal(since_start(time)),
            None => slerp(&self.gimbal_times, time, |time| self.gimbal_angles(time)),
        }
    }

    /// The same as roll, pitch and yaw.
    pub fn gimbal_angles(&self, time: u64) -> Angles {
        match &self.simulated {
            Some(_) => self.gimbal(time).euler_angles().into(),
            None => self.in_steps(gimbal(time)),
        }
    }

    fn in_steps(&self, angles: Angles) -> Angles {
        angles.map(|angle| match self.step {
            None => angle,
            Some(step) => ((angle.to_degrees() / step).round() * step).to_radians(),
        })
    }

    /// Where the drone is on the globe.
    pub fn geodetic(&self, time: u64) -> Geodetic {
        match &self.simulated {
            Some(simulated) => simulated.geodetic(since_start(time)),
            None => geodetic(time),
        }
    }

    /// Where the drone is to north, east, down of where it started.
    pub fn local(&self, time: u64) -> Vector3<f64> {
        match &self.simulated {
            Some(simulated) => simulated.local(since_start(time)),
            None => local(time),
        }
    }

    /// How high the drone is above the ground, in metres.
    pub fn height(&self, time: u64) -> f64 {
        60.0 + 7.0 * since_start(time).sin()
    }

    /// The angular rates about the drone's front, right, down, in rad/s, and what its accelerometer feels along them, in m/s².
    pub fn felt(&self, time: u64) -> [Vector3<f64>; 2] {
        match &self.simulated {
            Some(simulated) => simulated.felt(since_start(time)),
            None => [Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, 0.5, -9.8)],
        }
    }
}

/// The drone's attitude: through all quadrants, and more than once around.
pub fn attitude(time: u64) -> Angles {
    let t = since_start(time);
    let roll = 2.9 * (1.3 * t + 0.4).sin();
    let pitch = 1.1 * (1.9 * t + 1.0).sin();
    let yaw = 2.4 * t - 2.0 + 0.6 * (3.0 * t).sin();
    [roll, pitch, wrap(yaw)]
}

/// The velocity over ground to north, east, down, in m/s.
fn velocity(time: u64) -> Vector3<f64> {
    let t = since_start(time);
    Vector3::new(
        12.0 * (1.1 * t + 0.3).sin(),
        9.0 * (0.7 * t).cos(),
        3.0 * (2.0 * t).sin() + 1.0,
    )
}

/// The camera's orientation on the gimbal: slightly rolled, looking down, to the left and right of backwards.
fn gimbal(time: u64) -> Angles {
    let t = since_start(time);
    let roll = 0.2 * (1.1 * t).sin();
    let pitch = -0.6 + 0.3 * (1.7 * t).sin();
    let yaw = 2.8 + 0.9 * (1.2 * t).sin();
    [roll, pitch, wrap(yaw)]
}

/// Where the drone is on the globe.
fn geodetic(time: u64) -> Geodetic {
    let t = since_start(time);
    [
        47.3977 + 1e-4 * t,
        -122.5456 - 2e-4 * t,
        488.0 + 30.0 * t.sin(),
    ]
}

/// Where the drone is to north, east, down of where it started.
fn local(time: u64) -> Vector3<f64> {
    let t = since_start(time);
    Vector3::new(30.0 * t.sin(), 40.0 * t.cos(), -20.0 - 5.0 * t)
}

/// The rotation of angles.
pub fn quaternion([roll, pitch, yaw]: Angles) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

/// North, east, down as east, north, up.
pub fn enu(ned: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(ned.y, ned.x, -ned.z)
}

/// Front, right, down as front, left, up.
pub fn flu(frd: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(frd.x, -frd.y, -frd.z)
}

/// A rotation from FRD to NED as the one from FLU to ENU.
pub fn flu_in_enu(frd_in_ned: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    in_other_axes(|axis| enu(frd_in_ned * flu(axis)))
}

/// A rotation from FRD to FRD as the one from FLU to FLU.
pub fn flu_in_flu(frd_in_frd: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    in_other_axes(|axis| flu(frd_in_frd * flu(axis)))
}

/// The rotation that turns the axes so.
fn in_other_axes(turn: impl Fn(Vector3<f64>) -> Vector3<f64>) -> UnitQuaternion<f64> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(turn);
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&axes));
    UnitQuaternion::from_rotation_matrix(&rotation)
}

/// Seconds since the flight began.
fn since_start(time: u64) -> f64 {
    (time - START) as f64 / 1e9
}

fn wrap(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// The rotation at one of the times, or between two of them: as far along the shorter arc as in time. Every third
/// has the other sign, which means the same.
fn slerp(times: &[u64], time: u64, angles: impl Fn(u64) -> Angles) -> UnitQuaternion<f64> {
    let at = |place: usize| match quaternion(angles(times[place])) {
        q if place.is_multiple_of(3) => UnitQuaternion::new_unchecked(-q.into_inner()),
        q => q,
    };
    let next = times.partition_point(|&candidate| candidate < time);
    if times[next] == time {
        return at(next);
    }
    let (t0, t1) = (times[next - 1], times[next]);
    let (q0, q1) = (at(next - 1), at(next));
    let mut step = (q0.inverse() * q1).into_inner();
    if step.w < 0.0 {
        step = -step;
    }
    let half = step.imag().norm().atan2(step.w) * (time - t0) as f64 / (t1 - t0) as f64;
    let imaginary = step.imag().normalize() * half.sin();
    q0 * UnitQuaternion::new_normalize(Quaternion::from_parts(half.cos(), imaginary))
}
