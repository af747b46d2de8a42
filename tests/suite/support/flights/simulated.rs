//! A flight as a drone's sensors and estimator report it, at any time.

use nalgebra::{UnitQuaternion, Vector3};

use super::recording::Reference;
use crate::support::manoeuvres::{Manoeuvre, Measured, STEP, Sensors, State, fly, measure};

/// A simulated flight, with what was measured at each of its steps.
#[derive(Debug)]
pub struct Simulated {
    states: Vec<State>,
    measured: Measured,
    /// What the gimbal's angles are measured from.
    reference: Reference,
}

impl Simulated {
    pub fn new(manoeuvre: Manoeuvre, seconds: f64, reference: Reference) -> Self {
        let seed = 3;
        let every_step = 1.0 / STEP;
        let sensors = Sensors {
            position_hz: every_step,
            velocity_hz: every_step,
            attitude_hz: every_step,
            imu_hz: every_step,
            ..Sensors::default()
        };
        let states = fly(manoeuvre, seconds, 4.0, seed);
        Self {
            measured: measure(&states, sensors, seed),
            states,
            reference,
        }
    }

    /// How long it takes.
    pub fn seconds(&self) -> f64 {
        (self.states.len() - 1) as f64 * STEP
    }

    pub fn attitude(&self, time: f64) -> UnitQuaternion<f64> {
        let ((from, to), share) = between(&self.measured.attitudes, time);
        from.slerp(&to, share)
    }

    pub fn velocity(&self, time: f64) -> Vector3<f64> {
        let ((from, to), share) = between(&self.measured.velocities, time);
        from.lerp(&to, share)
    }

    pub fn geodetic(&self, time: f64) -> [f64; 3] {
        let ((from, to), share) = between(&self.measured.places, time);
        Vector3::from(from).lerp(&to.into(), share).into()
    }

    pub fn local(&self, time: f64) -> Vector3<f64> {
        let place = (time / STEP) as usize;
        let share = time / STEP - place as f64;
        let [from, to] = [place, place + 1].map(|place| self.states[place].position);
        from.lerp(&to, share)
    }

    /// The angular rates and the specific force.
    pub fn felt(&self, time: f64) -> [Vector3<f64>; 2] {
        [&self.measured.rates, &self.measured.forces].map(|series| {
            let ((from, to), share) = between(series, time);
            from.lerp(&to, share)
        })
    }

    /// How a gimbal holds the camera that keeps it level, looks ahead and slowly up and down.
    pub fn gimbal(&self, time: f64) -> UnitQuaternion<f64> {
        let attitude = self.attitude(time);
        let nose = attitude * Vector3::x();
        let yaw = match self.reference {
            Reference::Heading => 0.0,
            Reference::Earth | Reference::Airframe => nose.y.atan2(nose.x),
        };
        let pitch = -0.5 + 0.2 * (0.1 * time).sin();
        let level = UnitQuaternion::from_euler_angles(0.0, pitch, yaw);
        match self.reference {
            Reference::Airframe => attitude.inverse() * level,
            Reference::Earth | Reference::Heading => level,
        }
    }
}

/// The values before and after a time, and how far it is from the one to the other.
fn between<T: Copy>(series: &[(f64, T)], time: f64) -> ((T, T), f64) {
    let place = (time / STEP) as usize;
    let [from, to] = [place, place + 1].map(|place| series[place.min(series.len() - 1)].1);
    ((from, to), time / STEP - place as f64)
}
