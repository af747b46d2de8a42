//! The attitude, by comparisons in which something else is read too.

use std::{cmp::Ordering, mem};

use super::{Change, Depth, Flight, MOST_SHOWN, SMALL_SHIFTS, best_of, candidates, open, outcome};
use crate::{
    check::{
        alternatives::{is_usual, of_vector},
        reading::{ACCELERATION_UNITS, AttitudeReading, Form, RATE_UNITS, VectorReading},
        residual::{Decision, FITS, Pair, Part, Residual, decide, is_worse},
        verdict::{Motion, Outcome, Reading, Subject, Verdict, Witness},
    },
    geometry::axes::{Axes, BodyAxes},
};

/// A drone leans for other reasons too, as gusts: a smaller residual is not held against a reading.
const LEAST_CONDEMNED: f64 = 0.75;

/// And fewer windows are not.
const FEWEST_WINDOWS: usize = 24;

/// How many readings are looked at more closely.
const SHORTLIST: usize = 16;

/// Readings whose errors differ by less than this share of the motion say the same.
const ALIKE: f64 = 0.1;

/// Another reading, of the attitude or of what it is compared with.
struct Rival {
    reading: Reading,
    residual: Residual,
}

impl Flight<'_> {
    /// What the angular rates may be read as instead.
    pub(super) fn other_rates(&self, claimed: VectorReading) -> Vec<Reading> {
        let others = of_vector(claimed, &RATE_UNITS, BodyAxes::all().map(Axes::Body));
        others.into_iter().map(Reading::AngularRate).collect()
    }

    /// What the accelerations may be read as instead.
    pub(super) fn other_accelerations(&self, claimed: VectorReading) -> Vec<Reading> {
        let others = of_vector(
            claimed,
            &ACCELERATION_UNITS,
            BodyAxes::all().map(Axes::Body),
        );
        others.into_iter().map(Reading::Acceleration).collect()
    }

    /// Judges the attitude. `others` are other readings of what it is compared with.
    pub(super) fn of_the_attitude(
        &self,
        subject: Subject,
        witness: Witness,
        part: Part,
        others: Vec<Reading>,
        pairs: impl Fn(Change, f64) -> Vec<Option<Pair>>,
    ) -> Option<Verdict> {
        let claimed = self.readings.attitude?;
        let shifts = match subject {
            Subject::AttitudeAndVelocity => &SMALL_SHIFTS[..3],
            _ => &SMALL_SHIFTS[..1],
        };
        let best = |change: Change, shifts: &[f64]| {
            best_of(shifts, |shift| part.select(pairs(change, shift)))
        };
        let mut judged = best(Change::None, shifts);
        let mut verdict = open(subject, witness, &judged, part);
        let is_still = !judged.moves();
        if is_still {
            // An attitude in the wrong unit does not move, although the drone does.
            judged = best_of(shifts, |shift| {
                let pairs = pairs(Change::None, shift).into_iter();
                part.select(pairs.map(|pair| pair.map(Pair::swapped)))
            });
            if !judged.moves() {
                return Some(verdict);
            }
        }
        let own = Residual::from(&judged);
        if self.depth == Depth::Contradictions && own.all < FITS {
            return None;
        }
        // Where the nose is has no part in how a drone leans, so an attitude that only differs in that is no rival.
        let own_pairs = pairs(Change::None, 0.0);
        let leans_alike = |change: Change| {
            let others = pairs(change, 0.0);
            let both = own_pairs.iter().zip(&others);
            let both = both.map(|(own, other)| Some(own.as_ref()?.less(other.as_ref()?)));
            witness == Witness::Lean && part.select(both).residual() < ALIKE
        };
        let residual_of = |reading: &Reading, shifts: &[f64]| {
            let judged = match reading {
                Reading::Attitude(attitude) => {
                    let reread = attitude.instead_of(&claimed)?;
                    if leans_alike(Change::Attitude(&reread)) {
                        return None;
                    }
                    best(Change::Attitude(&reread), shifts)
                }
                Reading::Velocity(vector)
                | Reading::AngularRate(vector)
                | Reading::Acceleration(vector) => best(Change::Vector(vector), shifts),
                Reading::Gimbal { .. } | Reading::ShiftedVelocity { .. } => return None,
            };
            Some(Residual::from(&judged)).filter(|residual| residual.all.is_finite())
        };
        let unshifted = Residual::from(&best(Change::None, &shifts[..1]));
        let attitudes = claimed.alternatives().into_iter().map(Reading::Attitude);
        let mut rivals: Vec<Rival> = Vec::new();
        let readings = attitudes.chain(others);
        for reading in readings.filter(|one| !is_still || is_in_other_unit(one, &claimed)) {
            let Some(residual) = residual_of(&reading, &shifts[..1]) else {
                continue;
            };
            // Readings that the comparison cannot tell apart: the likeliest comes first.
            let is_known = rivals
                .iter()
                .any(|rival| is_alike(&rival.reading, &reading) && same(rival.residual, residual));
            if !same(residual, unshifted) && !is_known {
                rivals.push(Rival { reading, residual });
            }
        }
        if is_still && rivals.is_empty() {
            return Some(verdict);
        }
        let by_residual = |a: &Rival, b: &Rival| a.residual.all.total_cmp(&b.residual.all);
        rivals.sort_by(by_residual);
        // If all fits, it does not matter what else the other series might be.
        let is_attitude = |rival: &Rival| matches!(rival.reading, Reading::Attitude(_));
        let first_attitude = rivals.iter().position(is_attitude)?;
        rivals.truncate(SHORTLIST.max(first_attitude + 1));
        if shifts.len() > 1 {
            for rival in &mut rivals {
                rival.residual = residual_of(&rival.reading, shifts).unwrap_or(rival.residual);
            }
            rivals.sort_by(by_residual);
        }
        if is_still {
            let best = rivals.first().map(|best| best.residual);
            if best.is_none_or(|best| decide(own, best) != Decision::Condemned) {
                return Some(verdict);
            }
            verdict.motion = Some(Motion {
                median: judged.motion,
                unit: witness.unit_of_motion(),
                windows: judged.windows(),
            });
        }
        verdict.candidates = candidates(
            (Reading::Attitude(claimed), own.all),
            rivals
                .iter()
                .map(|rival| (rival.reading, rival.residual.all)),
        );
        let least = rivals.first()?.residual;
        let least_of_attitude = rivals.iter().find(|rival| is_attitude(rival))?.residual;
        let near = rivals
            .iter()
            .filter(|rival| !is_worse(rival.residual.all, least.all));
        let mut near: Vec<&Rival> = near.collect();
        let is_certain = || match witness {
            Witness::Lean => {
                own.all >= LEAST_CONDEMNED
                    && own.windows >= FEWEST_WINDOWS
                    && !(self.is_on_its_side()
                        && near
                            .iter()
                            .any(|rival| renames_axes(&rival.reading, &claimed)))
            }
            _ => true,
        };
        let decision = match decide(own, least_of_attitude) {
            decision @ (Decision::Fits | Decision::Tied) => decision,
            _ => match decide(own, least) {
                Decision::Condemned if !is_certain() => Decision::Doubtful,
                decision => decision,
            },
        };
        near.sort_by(by_simplicity(&claimed, self.readings.velocity));
        verdict.outcome = match decision {
            // Gravity only tells up from down.
            Decision::Tied if subject == Subject::AttitudeTilt && own.all < FITS / 2.0 => {
                Outcome::Consistent
            }
            decision => outcome(decision, witness, || {
                near.iter()
                    .take(MOST_SHOWN)
                    .map(|rival| rival.reading)
                    .collect()
            }),
        };
        Some(verdict)
    }
}

/// Whether a reading only gives the drone's own axes other names. A tailsitter flies on its tail, and nothing in its
/// lean tells it from a drone whose nose is elsewhere.
fn renames_axes(reading: &Reading, claimed: &AttitudeReading) -> bool {
    let with_claimed_axes = |other: &AttitudeReading| AttitudeReading {
        body: claimed.body,
        ..*other
    };
    matches!(reading, Reading::Attitude(other) if with_claimed_axes(other) == *claimed)
}

/// Whether a reading is of angles in another unit.
fn is_in_other_unit(reading: &Reading, claimed: &AttitudeReading) -> bool {
    let unit = |form: Form| match form {
        Form::Angles { unit, .. } => Some(unit),
        _ => None,
    };
    match reading {
        Reading::Attitude(attitude) => unit(attitude.form) != unit(claimed.form),
        _ => false,
    }
}

/// Whether readings are of the same series.
fn is_alike(a: &Reading, b: &Reading) -> bool {
    mem::discriminant(a) == mem::discriminant(b)
}

/// The simplest first, then by residual.
fn by_simplicity(
    claimed: &AttitudeReading,
    velocity: Option<VectorReading>,
) -> impl Fn(&&Rival, &&Rival) -> Ordering {
    let changes = move |rival: &Rival| match rival.reading {
        Reading::Attitude(reading) => reading.changes_from(claimed),
        Reading::Velocity(reading) => {
            let is_usual = velocity.is_some_and(|claimed| is_usual(&reading, &claimed));
            if is_usual { 1 } else { 2 }
        }
        _ => 1,
    };
    move |a, b| {
        let by_residual = a.residual.all.total_cmp(&b.residual.all);
        changes(a).cmp(&changes(b)).then(by_residual)
    }
}

/// Whether residuals are the same because the comparison cannot tell the readings apart.
fn same(a: Residual, b: Residual) -> bool {
    (a.all - b.all).abs() < 1e-9
}
