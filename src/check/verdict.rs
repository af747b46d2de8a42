//! Verdicts: what a log's own numbers say about how it was read.

use serde::Serialize;

use super::{
    oddity::Oddity,
    reading::{AttitudeReading, VectorReading},
    residual::is_worse,
};
use crate::sample::GimbalReference;

/// What is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Subject {
    /// The axes and the unit of the velocity's horizontal part.
    VelocityHorizontal,
    /// Those of its vertical part.
    VelocityVertical,
    /// The time of the velocity.
    VelocityTime,
    /// How the attitude turns.
    AttitudeTurns,
    /// Where the attitude has up and down.
    AttitudeTilt,
    /// Whether the attitude leans and heads as the velocity changes.
    AttitudeAndVelocity,
    /// What the gimbal's tilt is measured from.
    GimbalTilt,
    /// What the gimbal's yaw is measured from.
    GimbalYaw,
}

/// What it is judged by, the strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Witness {
    /// Positions as latitude, longitude and height, whose axes are their own.
    GeodeticPosition,
    /// The angular rates.
    AngularRates,
    /// The attitude and the accelerations together against the change of the velocity.
    Inertia,
    /// The accelerations, which show gravity.
    Gravity,
    /// A drone's lean, which accelerates it.
    Lean,
    /// Positions in axes that may be misread in the same way as the velocity.
    LocalPosition,
    /// The drone's attitude.
    Attitude,
}

impl Witness {
    /// Whether its axes are its own, so that what agrees with it is proven.
    pub fn has_own_axes(self) -> bool {
        !matches!(self, Self::LocalPosition | Self::Lean | Self::Attitude)
    }

    /// The unit of the motion that it is about.
    pub(super) fn unit_of_motion(self) -> &'static str {
        match self {
            Self::GeodeticPosition | Self::LocalPosition => "m",
            Self::Inertia => "m/s",
            Self::Lean | Self::Gravity => "m/s²",
            Self::AngularRates | Self::Attitude => "rad",
        }
    }
}

/// How something is read, or what would have to be read so.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reading {
    /// The velocity.
    Velocity(VectorReading),
    /// The attitude.
    Attitude(AttitudeReading),
    /// The angular rates.
    AngularRate(VectorReading),
    /// The accelerations.
    Acceleration(VectorReading),
    /// The gimbal.
    Gimbal {
        /// What its angles are measured from.
        reference: GimbalReference,
        /// Whether its y and z axes have the opposite signs.
        flipped: bool,
    },
    /// The velocity, if its time is shifted by so many seconds.
    ShiftedVelocity {
        /// Positive: the velocity was stamped too late.
        late_by_s: f64,
    },
}

/// A reading and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Candidate {
    /// The reading.
    pub reading: Reading,
    /// The residual as a share of the motion: 0 fits exactly, from 1 on it explains nothing.
    pub residual: f64,
}

impl Candidate {
    /// Whether one of the two fits so much better that it can be told from the other.
    pub fn is_told_from(&self, other: &Self) -> bool {
        let (best, worst) = match self.residual < other.residual {
            true => (self, other),
            false => (other, self),
        };
        is_worse(worst.residual, best.residual)
    }
}

/// The verdict on a reading.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Outcome {
    /// It fits, no other reading does, and the witness has axes of its own.
    Proven,
    /// It fits, and no other reading does.
    Consistent,
    /// It certainly does not fit.
    Contradicted {
        /// The readings that do, the likeliest first. Each is what one of the series would have to be read as.
        fits: Vec<Reading>,
    },
    /// It cannot be told.
    Undecidable {
        /// Why.
        why: Undecided,
    },
}

/// Why something cannot be told.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum Undecided {
    /// There are not enough samples of both at the same times.
    FewSamples,
    /// The drone moved less than is needed.
    HardlyMoved {
        /// The least motion that is needed.
        needed: f64,
    },
    /// The reading fits, but others fit nearly as well.
    Tied {
        /// The others.
        with: Vec<Reading>,
    },
    /// No reading fits.
    NothingFits,
    /// Another reading fits better, but not so that it would be certain.
    Doubtful {
        /// The best.
        better: Vec<Reading>,
    },
    /// The motion is so steady that times further apart would look the same.
    Unresolved,
}

/// How much motion there was.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Motion {
    /// The median of the windows that were judged.
    pub median: f64,
    /// Its unit.
    pub unit: &'static str,
    /// How many windows were judged.
    pub windows: usize,
}

/// How far the times of two series are apart.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shift {
    /// Positive: the velocity was stamped too late.
    pub late_by_s: f64,
    /// What the shift is known to.
    pub resolution_s: f64,
}

/// What was found about one subject by one witness.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// What is judged.
    pub subject: Subject,
    /// What it is judged by.
    pub witness: Witness,
    /// The verdict.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// How much motion there was, if there was any to judge.
    pub motion: Option<Motion>,
    /// The reading as it is, and the best of the others.
    pub candidates: Vec<Candidate>,
    /// How far the times are apart.
    pub shift: Option<Shift>,
}

impl Verdict {
    /// Whether the reading fits.
    pub fn fits(&self) -> bool {
        matches!(self.outcome, Outcome::Proven | Outcome::Consistent)
    }

    /// Whether the reading does not fit, or perhaps not.
    pub(super) fn does_not_fit(&self) -> bool {
        match &self.outcome {
            Outcome::Proven | Outcome::Consistent => false,
            Outcome::Contradicted { .. } => true,
            Outcome::Undecidable { why } => {
                matches!(why, Undecided::NothingFits | Undecided::Doubtful { .. })
            }
        }
    }

    /// Whether something is certainly wrong.
    pub fn is_contradicted(&self) -> bool {
        matches!(self.outcome, Outcome::Contradicted { .. })
    }
}

/// What a flight's own numbers say about how its log was read.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Findings {
    /// What one series says about another.
    pub verdicts: Vec<Verdict>,
    /// What series show by themselves.
    pub oddities: Vec<Oddity>,
    /// If something is contradicted: the readings under which nothing is any more, the likeliest first. Each is what one
    /// series would have to be read as, or several together.
    pub explanations: Vec<Vec<Reading>>,
}

impl Findings {
    /// The readings that fit, the likeliest first: the explanations or, if there are none, the order of numbers in which a
    /// quaternion's scalar part is where it belongs.
    pub fn fitting(&self) -> Vec<Vec<Reading>> {
        let elsewhere = self.oddities.iter().find_map(|oddity| match oddity {
            Oddity::ScalarElsewhere { fits, .. } => Some(vec![Reading::Attitude(*fits)]),
            _ => None,
        });
        match self.explanations.is_empty() {
            true => elsewhere.into_iter().collect(),
            false => self.explanations.clone(),
        }
    }

    /// Whether something is certainly wrong.
    pub fn is_contradicted(&self) -> bool {
        self.verdicts.iter().any(Verdict::is_contradicted)
            || self.oddities.iter().any(Oddity::is_certain)
    }
}
