//! The gimbal's angles against the drone's own: what they are measured from.
//!
//! A gimbal holds the camera steady while the drone rocks. So if its angles are measured from the airframe, they must
//! counter the drone's, and those of the camera, put together from both, are steadier than either. If they are measured
//! from the horizon, they are steady themselves, and put together with the drone's they rock as the drone does.

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    recorder::ReadGimbal,
    residual::median,
    track::{self, LONGEST_GAP, Timed},
};
use crate::sample::GimbalReference;

/// How long a window is at least, in seconds, and how many windows are needed.
const WINDOW: f64 = 1.0;
const FEWEST_WINDOWS: usize = 8;

/// The share of windows that is judged: those in which the drone moves most.
const SHARE: f64 = 0.4;

/// The least median change of the drone's tilt, and of its heading, in radians: 3° and 20°.
pub const LEAST_TILT: f64 = 0.05;
pub const LEAST_TURN: f64 = 0.35;

/// Windows in which the heading turns further are not looked at, in radians: near half a turn, a turn to the right and one
/// to the left are alike.
const FARTHEST_TURN: f64 = 2.0;

/// Up to this share of the drone's motion, something is steady; from the other share on, it moves with the drone.
const STEADY: f64 = 0.3;
const MOVES: f64 = 0.6;

/// A gimbal's orientation and the drone's attitude at the same time.
type Held = (UnitQuaternion<f64>, UnitQuaternion<f64>);

/// Pairs of moments.
pub struct Moments {
    windows: Vec<[Held; 2]>,
    reference: GimbalReference,
}

/// What the motion of a gimbal shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown {
    /// That the drone moved too little.
    TooLittle,
    /// The reading as it is makes the camera steady, as no other does.
    Fits,
    /// The reading is possible, but so are others.
    Possible,
    /// Only another reading makes the camera steady.
    Another {
        reference: GimbalReference,
        flipped: bool,
    },
}

/// What was found, and how much the drone moved, in radians, in how many windows.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    pub shown: Shown,
    pub motion: f64,
    pub windows: usize,
    /// How much the camera moves with the drone under the reading, as a share of the drone's motion.
    pub residual: f64,
}

impl Moments {
    /// Pairs of moments a second apart; `None` if there are too few.
    pub fn new(
        gimbals: &[Timed<ReadGimbal>],
        attitudes: &[Timed<UnitQuaternion<f64>>],
    ) -> Option<Self> {
        let reference = gimbals.first()?.value.reference;
        let mut windows = Vec::new();
        let mut start: Option<(f64, Held)> = None;
        for gimbal in gimbals
            .iter()
            .filter(|one| one.value.reference == reference)
        {
            if start.is_some_and(|(time, _)| gimbal.time - time < WINDOW) {
                continue;
            }
            let Some(attitude) = track::at(attitudes, gimbal.time) else {
                continue;
            };
            let now = (gimbal.value.orientation, attitude);
            if let Some((time, before)) = start
                && gimbal.time - time <= WINDOW + LONGEST_GAP
            {
                windows.push([before, now]);
            }
            start = Some((gimbal.time, now));
        }
        (windows.len() >= FEWEST_WINDOWS).then_some(Self { windows, reference })
    }

    /// The reading as it is.
    pub fn reference(&self) -> GimbalReference {
        self.reference
    }

    /// What the tilt shows.
    pub fn tilt(&self) -> Option<Found> {
        let up_in = |q: UnitQuaternion<f64>| q.inverse() * Vector3::z();
        let change = |window: &[Held; 2], of: &dyn Fn(Held) -> UnitQuaternion<f64>| {
            (up_in(of(window[1])) - up_in(of(window[0]))).norm()
        };
        let (windows, motion) =
            self.most_moving(|window| change(window, &|(_, attitude)| attitude))?;
        let share = |of: &dyn Fn(Held) -> UnitQuaternion<f64>| {
            let changes = windows.iter().map(|window| change(window, of));
            median(changes).map_or(f64::NAN, |change| change / motion)
        };
        // The camera, if the angles are measured from the horizon or from the airframe, each as they are or flipped; and
        // how it is turned from the airframe, if they are measured from the horizon.
        let level = [false, true].map(|flip| share(&|(gimbal, _)| flipped(gimbal, flip)));
        let joints =
            [false, true].map(|flip| share(&|(gimbal, drone)| drone * flipped(gimbal, flip)));
        let fixed = [false, true].map(|flip| {
            share(&|(gimbal, drone)| level_part(drone).inverse() * flipped(gimbal, flip))
        });
        let fixed_in_earth = [false, true]
            .map(|flip| share(&|(gimbal, drone)| drone.inverse() * flipped(gimbal, flip)));
        let fixed = [0, 1].map(|flip| fixed[flip].min(fixed_in_earth[flip]));
        let is_airframe = self.reference == GimbalReference::Airframe;
        let level_reference = match self.reference {
            GimbalReference::Earth => GimbalReference::Earth,
            _ => GimbalReference::Heading,
        };
        let (claimed, shown) = if motion < LEAST_TILT {
            (f64::NAN, Shown::TooLittle)
        } else if is_airframe {
            let shown = match () {
                () if joints[0] <= STEADY => Shown::Fits,
                () if level[0] < MOVES || joints[0] < MOVES => Shown::Possible,
                () if joints[1] <= STEADY => Shown::Another {
                    reference: GimbalReference::Airframe,
                    flipped: true,
                },
                () if fixed[0] <= STEADY && joints[0] >= 2.0 * MOVES => Shown::Another {
                    reference: level_reference,
                    flipped: false,
                },
                () => Shown::Possible,
            };
            (joints[0], shown)
        } else {
            let shown = match () {
                () if level[0] < MOVES => Shown::Possible,
                () if joints[0] <= STEADY => Shown::Another {
                    reference: GimbalReference::Airframe,
                    flipped: false,
                },
                () if joints[1] <= STEADY => Shown::Another {
                    reference: GimbalReference::Airframe,
                    flipped: true,
                },
                () if fixed[0] <= STEADY => Shown::Fits,
                () => Shown::Possible,
            };
            (level[0], shown)
        };
        Some(Found {
            shown,
            motion,
            windows: windows.len(),
            residual: claimed,
        })
    }

    /// What the yaw shows.
    pub fn yaw(&self) -> Option<Found> {
        let turn =
            |window: &[Held; 2], of: &dyn Fn(Held) -> f64| wrapped(of(window[1]) - of(window[0]));
        let heading = |(_, drone): Held| yaw_of(drone);
        let yaw = |(gimbal, _): Held| yaw_of(gimbal);
        let (windows, motion) = self.most_moving(|window| {
            let turned = turn(window, &heading).abs();
            if turned <= FARTHEST_TURN { turned } else { 0.0 }
        })?;
        let share = |factor: f64, yaw_factor: f64| {
            let turns = windows.iter().map(|window| {
                wrapped(yaw_factor * turn(window, &yaw) + factor * turn(window, &heading)).abs()
            });
            median(turns).map_or(f64::NAN, |turned| turned / motion)
        };
        let (own, with, against) = (share(0.0, 1.0), share(-1.0, 1.0), share(1.0, 1.0));
        let is_earth = self.reference == GimbalReference::Earth;
        let shown = match () {
            () if motion < LEAST_TURN => Shown::TooLittle,
            () if own < MOVES => Shown::Possible,
            () if is_earth && against <= STEADY => Shown::Another {
                reference: GimbalReference::Heading,
                flipped: false,
            },
            () if !is_earth && with <= STEADY => Shown::Another {
                reference: GimbalReference::Earth,
                flipped: false,
            },
            () if is_earth && with <= STEADY => Shown::Fits,
            () if !is_earth && against <= STEADY => Shown::Fits,
            () => Shown::Possible,
        };
        Some(Found {
            shown,
            motion,
            windows: windows.len(),
            residual: match is_earth {
                true => own.min(with),
                false => own.min(against),
            },
        })
    }

    /// The windows in which something moves most, and the median of its motion there.
    fn most_moving(&self, motion: impl Fn(&[Held; 2]) -> f64) -> Option<(Vec<[Held; 2]>, f64)> {
        let mut windows = self.windows.clone();
        windows.sort_by(|a, b| motion(b).total_cmp(&motion(a)));
        let count = (windows.len() as f64 * SHARE).ceil() as usize;
        windows.truncate(count.max(FEWEST_WINDOWS));
        let motion = median(windows.iter().map(motion))?;
        Some((windows, motion))
    }
}

/// An orientation whose y and z axes have the opposite signs, on both sides.
fn flipped(q: UnitQuaternion<f64>, flip: bool) -> UnitQuaternion<f64> {
    let half_turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    match flip {
        true => half_turn * q * half_turn,
        false => q,
    }
}

/// The drone's attitude without its heading.
fn level_part(drone: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_of(drone));
    heading.inverse() * drone
}

/// Where the y axis points horizontally, from east: the heading, even if x points up or down.
fn yaw_of(q: UnitQuaternion<f64>) -> f64 {
    let right = q * Vector3::y();
    (-right.x).atan2(right.y)
}

fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    (angle + PI).rem_euclid(TAU) - PI
}
