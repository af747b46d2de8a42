//! Motion that no drone makes, as far as it is seen from one sample to the next.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use serde::Serialize;

use super::moment::IncidentKind;

/// Samples that are closer than this, in nanoseconds, are a burst: clocks and buffers, not the drone, decide what lies
/// between them, and a rotation is noise over nothing. Autopilots estimate at 1 kHz at most.
pub(super) const BURST: u64 = 1_000_000;

/// How fast an airframe turns at most, rad/s: 2000 °/s, which is where the gyroscopes of autopilots end.
const FASTEST_TURN: f64 = 34.9;

/// How fast a velocity changes at most, m/s²: ten times gravity, which is twice what racing drones reach.
const STRONGEST_ACCELERATION: f64 = 100.0;

/// Smaller changes of a velocity, m/s, may be its resolution.
const LEAST_CHANGE: f64 = 1.0;

/// The camera flips if it turns by more than this, a quarter turn, while the drone turns by less than half as much.
const FLIP: f64 = FRAC_PI_2;

/// How often something was seen, where first, and the largest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sighting {
    /// How often.
    pub count: u64,
    /// The log time of the first, nanoseconds.
    pub first: u64,
    /// The largest, in the unit of its kind.
    pub largest: f64,
}

/// Motion that no drone makes; absent where none was seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Motion {
    /// Attitude samples within a millisecond of the one before; the largest turn of the camera between two, radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bursts: Option<Sighting>,
    /// Turns of the camera that the drone did not make, as where its nose passes the vertical and its heading jumps;
    /// radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flips: Option<Sighting>,
    /// Turns of the drone faster than 2000 °/s; rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spins: Option<Sighting>,
    /// Changes of the velocity faster than 100 m/s²; m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leaps: Option<Sighting>,
}

/// Drone and camera at two adjacent attitude samples.
pub(super) struct Turn {
    /// The log time of the later one.
    pub time: u64,
    /// Nanoseconds between them.
    pub interval: u64,
    pub q_ned_drone: [UnitQuaternion<f64>; 2],
    pub r_ned_camera: [Rotation3<f64>; 2],
}

impl Motion {
    /// Whether none was seen.
    pub fn is_plausible(&self) -> bool {
        *self == Self::default()
    }

    /// Notes a turn from one attitude sample to the next. Returns what is wrong with it, if it is one that no drone makes.
    pub(super) fn note_turn(&mut self, turn: &Turn) -> Option<IncidentKind> {
        let Turn {
            time,
            interval,
            q_ned_drone: [q0, q1],
            r_ned_camera: [r0, r1],
        } = turn;
        let camera_cosine = (r0.matrix().dot(r1.matrix()) - 1.0) / 2.0;
        let camera = || camera_cosine.clamp(-1.0, 1.0).acos();
        if *interval < BURST {
            see(&mut self.bursts, *time, camera());
            return None;
        }
        // Of half the angle, which is at most a quarter turn.
        let cosine = q0.coords.dot(&q1.coords).abs().min(1.0);
        let drone = || 2.0 * cosine.acos();
        let mut incident = None;
        if camera_cosine < 0.0 && drone() < FLIP / 2.0 {
            see(&mut self.flips, *time, camera());
            incident = Some(IncidentKind::Flip(camera()));
        }
        // The angle is at most π times the sine of its half: most turns are seen to be slow without the angle itself.
        let seconds = *interval as f64 / 1e9;
        let fastest = FASTEST_TURN * seconds;
        if PI * PI * (1.0 - cosine * cosine) > fastest * fastest && drone() > fastest {
            let rate = drone() / seconds;
            see(&mut self.spins, *time, rate);
            incident = Some(IncidentKind::Spin(rate));
        }
        incident
    }

    /// Notes a change of the velocity, in axes that stay the same, over an interval in nanoseconds. Returns what is wrong
    /// with it, if it is one that no drone makes.
    pub(super) fn note_change(
        &mut self,
        time: u64,
        interval: u64,
        change: &Vector3<f64>,
    ) -> Option<IncidentKind> {
        let change = change.norm();
        let acceleration = change / (interval as f64 / 1e9);
        let is_leap =
            interval >= BURST && change > LEAST_CHANGE && acceleration > STRONGEST_ACCELERATION;
        is_leap.then(|| {
            see(&mut self.leaps, time, acceleration);
            IncidentKind::Leap(acceleration)
        })
    }
}

fn see(seen: &mut Option<Sighting>, time: u64, amount: f64) {
    let sighting = seen.get_or_insert(Sighting {
        count: 0,
        first: time,
        largest: amount,
    });
    sighting.count += 1;
    sighting.largest = sighting.largest.max(amount);
}
