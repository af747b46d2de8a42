//! The time of the velocity.

use nalgebra::{Rotation3, Vector3};

use super::{Flight, candidates, open, velocity::Pairs};
use crate::check::{
    reading::VectorReading,
    residual::{FITS, Judged, Pair, Part, is_worse, median},
    shift::{self, FARTHEST},
    track::Timed,
    verdict::{Outcome, Reading, Shift, Subject, Undecided, Verdict, Witness},
};

/// What an accelerometer's error and a tilt that is wrong by one or two degrees add up to in two seconds, in m/s along
/// each axis; and what a position wanders by, in metres.
const INERTIAL_ERROR: f64 = 0.3;
const WANDERING: f64 = 0.05;

/// Smaller shifts are not held against a velocity that is compared with an accelerometer, in seconds.
const INERTIAL_LAG: f64 = 0.3;

/// How far a compass may be wrong, in radians: 30°.
const COMPASS_ERROR: f64 = 0.52;

/// By how many times what it is measured to a shift must be beyond what is allowed.
const CERTAIN: f64 = 2.0;

/// A shift is not known if it is known no better than this, in seconds.
const COARSEST: f64 = 0.3;

impl Flight<'_> {
    /// Judges the time of the velocity, unless its axes are wrong or in doubt.
    pub(super) fn of_the_time(
        &self,
        witness: Witness,
        parts: [Part; 2],
        claimed: VectorReading,
        of_axes: &[Verdict],
        pairs: Pairs,
    ) -> Option<Verdict> {
        if of_axes.iter().any(Verdict::does_not_fit) {
            return None;
        }
        let at = |part: &Part, late_by: f64| part.select(pairs(&claimed, late_by));
        let part = parts.into_iter().find(|part| at(part, 0.0).moves())?;
        let systematic = match witness {
            Witness::Inertia => INERTIAL_ERROR,
            _ => WANDERING,
        };
        let subject = Subject::VelocityTime;
        let Some(measured) = shift::measure(part, systematic, |late_by| pairs(&claimed, late_by))
        else {
            let mut verdict = open(subject, witness, &at(&part, 0.0), part);
            verdict.outcome = undecidable(Undecided::Unresolved);
            return Some(verdict);
        };
        let shift = Shift {
            // What was measured may be as old as half the time between two samples when it is reported.
            resolution_s: measured.resolution_s.max(self.spacing(claimed) / 2.0),
            ..measured
        };
        let margin = (CERTAIN * measured.resolution_s).max(shift.resolution_s);
        let judged = at(&part, shift.late_by_s);
        let mut verdict = open(subject, witness, &judged, part);
        let size = shift.late_by_s.abs();
        let allowed = match witness {
            Witness::Inertia => self.readings.lag_s.max(INERTIAL_LAG),
            _ => self.readings.lag_s,
        };
        verdict.outcome = match () {
            () if judged.residual().is_nan() || judged.residual() >= FITS => {
                undecidable(Undecided::NothingFits)
            }
            () if shift.resolution_s > COARSEST || size >= FARTHEST - COARSEST => {
                undecidable(Undecided::Unresolved)
            }
            () if size - shift.resolution_s <= allowed => match witness {
                _ if size <= shift.resolution_s && witness.has_own_axes() => Outcome::Proven,
                _ => Outcome::Consistent,
            },
            () if size - margin <= allowed => undecidable(Undecided::Unresolved),
            // An attitude and an accelerometer that are a little wrong do the same in steady turns.
            () if witness == Witness::Inertia
                && !self.is_distinct(&judged, part, claimed, pairs) =>
            {
                undecidable(Undecided::Unresolved)
            }
            () => Outcome::Contradicted {
                fits: vec![Reading::ShiftedVelocity {
                    late_by_s: shift.late_by_s,
                }],
            },
        };
        verdict.candidates = candidates((Reading::Velocity(claimed), judged.residual()), []);
        verdict.shift = Some(shift);
        Some(verdict)
    }

    /// Whether times that are further apart than they may be explain the motion distinctly better than times that are
    /// not, even if these may be turned about the vertical.
    fn is_distinct(
        &self,
        shifted: &Judged,
        part: Part,
        claimed: VectorReading,
        pairs: Pairs,
    ) -> bool {
        let lag = self.readings.lag_s;
        let allowed = [-lag, -lag / 2.0, 0.0, lag / 2.0, lag].map(|late_by| {
            part.select(turned_back(pairs(&claimed, late_by)))
                .residual()
        });
        let best = allowed.into_iter().fold(f64::INFINITY, f64::min);
        shifted.residual() < FITS / 2.0 && is_worse(best, shifted.residual())
    }

    /// How far apart samples are, in seconds: those of the positions, of the velocity and of what turns it.
    fn spacing(&self, claimed: VectorReading) -> f64 {
        fn usual<T>(track: &[Timed<T>]) -> f64 {
            let steps = track.windows(2).map(|pair| pair[1].time - pair[0].time);
            median(steps).unwrap_or(0.0)
        }
        let of_the_velocity = match claimed.is_body() {
            true => usual(&self.velocities).max(usual(&self.attitudes)),
            false => usual(&self.velocities),
        };
        of_the_velocity.max(usual(&self.recorder.positions.samples))
    }
}

/// The same, with the accounts turned about the vertical as fits best, but by no more than a compass may be wrong.
fn turned_back(mut pairs: Vec<Option<Pair>>) -> Vec<Option<Pair>> {
    let (mut along, mut across) = (0.0, 0.0);
    for Pair { witness, account } in pairs.iter().flatten() {
        along += witness.xy().dot(&account.xy());
        across += account.xy().perp(&witness.xy());
    }
    let angle = f64::atan2(across, along).clamp(-COMPASS_ERROR, COMPASS_ERROR);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    for pair in pairs.iter_mut().flatten() {
        pair.account = turn * pair.account;
    }
    pairs
}

fn undecidable(why: Undecided) -> Outcome {
    Outcome::Undecidable { why }
}
