//! What series show by themselves.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use super::{
    claims::Claims,
    jumps::ToAndFro,
    reading::{AttitudeReading, Form},
    recorder::Recorder,
    residual::median,
    track::{self, Timed},
};
use crate::{
    geometry::heading_rotation,
    sample::{GimbalReference, Kind},
};

/// The share of a flight that is most of it, and that is nearly all of it.
const MOST: f64 = 0.5;
const NEARLY_ALL: f64 = 0.95;

/// How far a drone leans that does not fly upright, and one that flies level, in radians: 60° and 35°.
pub const ON_ITS_SIDE: f64 = 1.05;
const LEVEL: f64 = 0.61;

/// How far above the horizon a camera points up, in radians: 15°.
const UP: f64 = 0.26;

/// How far the heading must turn before the order of a quaternion is plain, in radians: a quarter turn.
const TURNED: f64 = std::f64::consts::FRAC_PI_2;

/// How far a camera is from where it is said to be that is elsewhere, in radians: 10°.
const ELSEWHERE: f64 = 0.175;

/// Fewer samples than this show nothing.
const ENOUGH: usize = 20;

/// What one series by itself shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Oddity {
    /// All samples are at one time: whatever recorded them did not stamp them.
    OneTime {
        /// Of this kind.
        of: Kind,
        /// How many.
        samples: u64,
    },
    /// The series jumps to and fro, as those of several sources do.
    ToAndFro {
        /// Of this kind.
        of: Kind,
        /// How often, and how far.
        #[serde(flatten)]
        jumps: ToAndFro,
    },
    /// The quaternion's scalar part is plainly in the other place: read in the other order, the drone is level while it
    /// turns; as it is read, its nose stays where it is and it rolls over.
    ScalarElsewhere {
        /// The share of the samples that are level in the other order.
        level: f64,
        /// The reading that fits.
        fits: AttitudeReading,
    },
    /// The log's gimbal holds the camera elsewhere than it is said to be.
    NotAtDepression {
        /// The share of the samples that are more than 10° off.
        share: f64,
        /// The median angle below the horizon at which the gimbal holds it, in degrees.
        median_deg: f64,
    },
    /// The drone leans by more than 60° most of the time. Tailsitters do; or it is another thing's attitude.
    OnItsSide {
        /// The share of the samples.
        share: f64,
    },
    /// The gimbal points up nearly all the time. Under a bridge it may; or its sign is wrong.
    GimbalUp {
        /// The share of the samples.
        share: f64,
    },
}

impl Oddity {
    /// Whether it is certain that something is wrong.
    pub fn is_certain(&self) -> bool {
        !matches!(self, Self::OnItsSide { .. } | Self::GimbalUp { .. })
    }
}

impl Recorder {
    /// What each series shows by itself.
    pub(super) fn oddities(&self, claims: &Claims) -> Vec<Oddity> {
        let mut oddities = Vec::new();
        for of in Kind::LISTED {
            if let Some(samples) = self.times[of as usize].all_at_one_time() {
                oddities.push(Oddity::OneTime { of, samples });
            }
        }
        let jumps = [
            (Kind::Attitude, self.turns.of_rotations()),
            (Kind::Velocity, self.speeds.of_vectors()),
            (Kind::Gimbal, self.gimbal_turns.of_rotations()),
        ];
        let to_and_fro = |(of, jumps): (Kind, Option<ToAndFro>)| {
            jumps.map(|jumps| Oddity::ToAndFro { of, jumps })
        };
        oddities.extend(jumps.into_iter().filter_map(to_and_fro));
        let attitudes = &self.attitudes.samples;
        if let Some(claimed) = claims.attitude {
            let elsewhere = scalar_elsewhere(attitudes, claimed);
            let is_plain = elsewhere.is_some();
            oddities.extend(elsewhere);
            oddities.extend(on_its_side(attitudes).filter(|_| !is_plain));
        }
        oddities.extend(self.gimbal_up());
        oddities.extend(claims.depression.and_then(|angle| self.not_at(angle)));
        oddities
    }

    fn gimbal_up(&self) -> Option<Oddity> {
        let gimbals = self.gimbals.samples.iter();
        // What is measured from the airframe moves with it.
        let gimbals = gimbals.filter(|sample| sample.value.reference != GimbalReference::Airframe);
        let share = share_of(gimbals.map(|sample| {
            let axis = sample.value.orientation * Vector3::x();
            -axis.z > UP.sin()
        }))?;
        (share >= NEARLY_ALL).then_some(Oddity::GimbalUp { share })
    }

    /// Whether the gimbal holds the camera elsewhere than at an angle below the horizon, in radians.
    fn not_at(&self, depression: f64) -> Option<Oddity> {
        let angles = self.gimbals.samples.iter().filter_map(|sample| {
            let axis = sample.value.orientation * Vector3::x();
            let axis = match sample.value.reference {
                GimbalReference::Airframe => {
                    track::at(&self.attitudes.samples, sample.time)? * axis
                }
                GimbalReference::Earth | GimbalReference::Heading => axis,
            };
            Some(axis.z.clamp(-1.0, 1.0).asin())
        });
        let angles: Vec<f64> = angles.collect();
        let share = share_of(
            angles
                .iter()
                .map(|angle| (angle - depression).abs() > ELSEWHERE),
        )?;
        let median_deg = median(angles)?.to_degrees();
        (share >= MOST).then_some(Oddity::NotAtDepression { share, median_deg })
    }
}

fn leans_more_than(attitude: UnitQuaternion<f64>, angle: f64) -> bool {
    (attitude * Vector3::z()).z < angle.cos()
}

fn on_its_side(attitudes: &[Timed<UnitQuaternion<f64>>]) -> Option<Oddity> {
    let leans = attitudes
        .iter()
        .map(|sample| leans_more_than(sample.value, ON_ITS_SIDE));
    let share = share_of(leans)?;
    (share >= MOST).then_some(Oddity::OnItsSide { share })
}

fn scalar_elsewhere(
    attitudes: &[Timed<UnitQuaternion<f64>>],
    claimed: AttitudeReading,
) -> Option<Oddity> {
    let Form::Quaternion { scalar_last } = claimed.form else {
        return None;
    };
    let fits = AttitudeReading {
        form: Form::Quaternion {
            scalar_last: !scalar_last,
        },
        ..claimed
    };
    let upright = attitudes
        .iter()
        .map(|sample| !leans_more_than(sample.value, ON_ITS_SIDE));
    if share_of(upright)? >= MOST {
        return None;
    }
    let reread = fits.instead_of(&claimed)?;
    let others: Vec<_> = attitudes
        .iter()
        .map(|sample| reread.apply(sample.value))
        .collect();
    let level = share_of(others.iter().map(|other| !leans_more_than(*other, LEVEL)))?;
    let first = heading_rotation(others.first()?)?;
    let turned = others.iter().filter_map(heading_rotation);
    let turned = turned
        .map(|heading| first.angle_to(&heading))
        .fold(0.0, f64::max);
    (level >= NEARLY_ALL && turned >= TURNED).then_some(Oddity::ScalarElsewhere { level, fits })
}

/// The share for which something is true, if there are enough.
fn share_of(all: impl Iterator<Item = bool>) -> Option<f64> {
    let (mut count, mut of_which) = (0_usize, 0_usize);
    for is_so in all {
        count += 1;
        of_which += usize::from(is_so);
    }
    (count >= ENOUGH).then(|| of_which as f64 / count as f64)
}
