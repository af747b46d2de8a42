//! The axes and the unit of the velocity.

use super::{Depth, Flight, MOST_SHOWN, SMALL_SHIFTS, best_of, candidates, open, outcome};
use crate::{
    check::{
        alternatives::{differ, of_vector, rank},
        reading::{SPEED_UNITS, VectorReading},
        residual::{Decision, FITS, Judged, Pair, Part, Residual, decide, is_worse},
        verdict::{Outcome, Reading, Subject, Undecided, Verdict, Witness},
    },
    geometry::axes::{Axes, BodyAxes, WorldAxes},
};

/// How many readings are looked at more closely.
const SHORTLIST: usize = 16;

/// Residuals below this are alike.
const NOTHING: f64 = 0.05;

/// Shifts that are tried if nothing fits within the small ones, in seconds.
const WIDE_SHIFTS: [f64; 17] = [
    0.0, -0.25, 0.25, -0.5, 0.5, -0.75, 0.75, -1.0, 1.0, -1.25, 1.25, -1.5, 1.5, -1.75, 1.75, -2.0,
    2.0,
];

/// Windows' pairs for a reading of the velocity that is late by so many seconds.
pub(super) type Pairs<'a> = &'a dyn Fn(&VectorReading, f64) -> Vec<Option<Pair>>;

/// A reading and its residual.
#[derive(Debug, Clone, Copy)]
struct Rival {
    reading: VectorReading,
    residual: Residual,
}

/// What was found about one part of the velocity.
struct PartFound {
    verdict: Verdict,
    /// The readings that this part does not rule out, if it rules out any.
    possible: Option<Vec<VectorReading>>,
}

impl Flight<'_> {
    /// What the velocity may be read as instead, the likeliest first.
    pub(super) fn other_velocities(&self, claimed: VectorReading) -> Vec<VectorReading> {
        let world = WorldAxes::all().map(Axes::World);
        let body = BodyAxes::all().map(Axes::Body);
        let body = body.filter(|_| !self.attitudes.is_empty());
        let mut others = of_vector(claimed, &SPEED_UNITS, world.chain(body));
        others.sort_by_key(|reading| rank(reading, &claimed));
        others
    }

    /// Judges the axes, the unit and the time of the velocity.
    pub(super) fn of_the_velocity(
        &self,
        witness: Witness,
        parts: [Part; 2],
        claimed: VectorReading,
        pairs: Pairs,
    ) -> Vec<Verdict> {
        let subjects = [Subject::VelocityHorizontal, Subject::VelocityVertical];
        let judged = parts.map(|part| best(part, &claimed, &SMALL_SHIFTS, pairs));
        let is_fine = |judged: &Judged| !judged.moves() || judged.residual() < FITS;
        let is_quick = self.depth == Depth::Contradictions && judged.iter().all(is_fine);
        let mut verdicts = Vec::new();
        if !is_quick {
            let others = self.other_velocities(claimed);
            let found = parts.into_iter().zip(subjects).zip(&judged);
            let found: Vec<PartFound> = found
                .map(|((part, subject), judged)| {
                    let verdict = open(subject, witness, judged, part);
                    judge_part(part, claimed, &others, verdict, judged, pairs)
                })
                .collect();
            verdicts = put_together(found, claimed, others);
        }
        verdicts.extend(self.of_the_time(witness, parts, claimed, &verdicts, pairs));
        verdicts
    }
}

fn best(part: Part, reading: &VectorReading, shifts: &[f64], pairs: Pairs) -> Judged {
    best_of(shifts, |shift| part.select(pairs(reading, shift)))
}

/// The readings in the order of their residuals.
fn ranked(part: Part, readings: &[VectorReading], shifts: &[f64], pairs: Pairs) -> Vec<Rival> {
    let rivals = readings.iter().map(|reading| Rival {
        reading: *reading,
        residual: Residual::from(&best(part, reading, shifts, pairs)),
    });
    let mut rivals: Vec<Rival> = rivals
        .filter(|rival| rival.residual.all.is_finite())
        .collect();
    rivals.sort_by(|a, b| a.residual.all.total_cmp(&b.residual.all));
    rivals
}

/// Judges one part of the velocity, of which there is an open verdict.
fn judge_part(
    part: Part,
    claimed: VectorReading,
    others: &[VectorReading],
    mut verdict: Verdict,
    judged: &Judged,
    pairs: Pairs,
) -> PartFound {
    if !judged.moves() {
        let possible = None;
        return PartFound { verdict, possible };
    }
    let mut own = Residual::from(judged);
    let readings = |rivals: &[Rival]| rivals.iter().map(|rival| rival.reading).collect::<Vec<_>>();
    let all = ranked(part, others, &SMALL_SHIFTS[..1], pairs);
    let shortlist = readings(&all[..all.len().min(SHORTLIST)]);
    let mut rivals = ranked(part, &shortlist, &SMALL_SHIFTS, pairs);
    if own.all >= FITS && rivals.first().is_none_or(|best| best.residual.all >= FITS) {
        // Nothing fits: perhaps the times are further apart.
        rivals = ranked(part, others, &WIDE_SHIFTS, pairs);
        own = Residual::from(&best(part, &claimed, &WIDE_SHIFTS, pairs));
    }
    let decision = decide_between(part, claimed, own, &rivals);
    let least = rivals.first().map_or(own.all, |best| best.residual.all);
    let near = rivals
        .iter()
        .filter(|rival| !is_worse(rival.residual.all, least));
    let mut near: Vec<VectorReading> = near.map(|rival| rival.reading).collect();
    near.sort_by_key(|reading| rank(reading, &claimed));
    verdict.candidates = candidates(
        (Reading::Velocity(claimed), own.all),
        different(part, &claimed, &rivals)
            .into_iter()
            .map(|rival| (Reading::Velocity(rival.reading), rival.residual.all)),
    );
    let shown = near
        .iter()
        .filter(|reading| differ(part, reading, &claimed));
    let shown = shown.take(MOST_SHOWN).copied().map(Reading::Velocity);
    verdict.outcome = outcome(decision, verdict.witness, || shown.collect());
    // All that this part does not rule out.
    let worst = match decision {
        Decision::Condemned => f64::max(least, NOTHING) * 1.5 + NOTHING,
        Decision::Fits => f64::max(own.all, NOTHING) * 1.5 + NOTHING,
        Decision::Tied | Decision::Doubtful | Decision::NothingFits => FITS.max(1.5 * own.all),
    };
    let possible = all.iter().filter(|rival| rival.residual.all <= worst);
    let possible = possible.map(|rival| rival.reading).chain(near);
    let is_out = matches!(decision, Decision::Condemned);
    let possible = possible.chain((!is_out).then_some(claimed)).collect();
    PartFound {
        verdict,
        possible: Some(possible),
    }
}

/// Of the rivals that mean the same in this part only the likeliest, and none that means the same as the claimed reading.
fn different<'a>(part: Part, claimed: &VectorReading, rivals: &'a [Rival]) -> Vec<&'a Rival> {
    let mut different: Vec<&Rival> = Vec::new();
    for rival in rivals {
        if !differ(part, &rival.reading, claimed) {
            continue;
        }
        let same = |shown: &&mut &Rival| !differ(part, &rival.reading, &shown.reading);
        match different.iter_mut().find(same) {
            Some(shown) if rank(&rival.reading, claimed) < rank(&shown.reading, claimed) => {
                *shown = rival;
            }
            Some(_) => {}
            None => different.push(rival),
        }
    }
    different
}

/// Decides between the claimed reading and its rivals, the best of them first.
fn decide_between(part: Part, claimed: VectorReading, own: Residual, rivals: &[Rival]) -> Decision {
    let Some(best) = rivals.first() else {
        return Decision::NothingFits;
    };
    // A reading that means the same is no rival of one that fits.
    let different = rivals
        .iter()
        .find(|rival| differ(part, &rival.reading, &claimed));
    match different.map(|different| decide(own, different.residual)) {
        Some(decision @ (Decision::Fits | Decision::Tied)) => decision,
        _ => decide(own, best.residual),
    }
}

/// Names the readings that fit in both parts. A part is condemned only by a reading that the other part does not rule out.
fn put_together(
    found: Vec<PartFound>,
    claimed: VectorReading,
    others: Vec<VectorReading>,
) -> Vec<Verdict> {
    let mut all = others;
    for PartFound { possible, .. } in &found {
        if let Some(possible) = possible {
            all.retain(|reading| possible.contains(reading));
        }
    }
    // How horizontal and vertical go together where one of them is not known: as in usual axes.
    all.sort_by_key(|reading| rank(reading, &claimed));
    let is_other_kind = all
        .first()
        .is_some_and(|best| best.is_body() != claimed.is_body());
    let is_condemned = found.iter().any(|found| found.verdict.is_contradicted());
    let fitting: Vec<Reading> = all
        .into_iter()
        .take(MOST_SHOWN)
        .map(Reading::Velocity)
        .collect();
    let mut verdicts: Vec<Verdict> = found.into_iter().map(|found| found.verdict).collect();
    for verdict in &mut verdicts {
        let why = match &mut verdict.outcome {
            Outcome::Contradicted { fits } if fitting.is_empty() => Undecided::Doubtful {
                better: std::mem::take(fits),
            },
            Outcome::Contradicted { fits } => {
                fits.clone_from(&fitting);
                continue;
            }
            // In the drone's axes instead of the world's, the other part is not what it seems either.
            Outcome::Proven | Outcome::Consistent if is_condemned && is_other_kind => {
                Undecided::Tied {
                    with: fitting.clone(),
                }
            }
            _ => continue,
        };
        verdict.outcome = Outcome::Undecidable { why };
    }
    verdicts
}
