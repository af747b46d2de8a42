//! What would have to be read in another way so that nothing contradicts.

use super::{Depth, Flight};
use crate::check::{
    claims::Claims,
    recorder::Recorder,
    verdict::{Outcome, Reading, Verdict, Witness},
};

/// How many explanations are looked for, and how many are tried.
const MOST: usize = 3;
const MOST_TRIED: usize = 10;

impl Recorder {
    /// Sets of readings under each of which nothing contradicts any more: single ones, or else pairs. If none does, the
    /// one that leaves the least.
    pub(super) fn explanations(&self, claims: &Claims, verdicts: &[Verdict]) -> Vec<Vec<Reading>> {
        let of_gimbal = |verdict: &&Verdict| verdict.witness == Witness::Attitude;
        let gimbal = verdicts.iter().filter(of_gimbal).flat_map(fits_of).next();
        let others: Vec<Verdict> = verdicts
            .iter()
            .filter(|verdict| !of_gimbal(verdict))
            .cloned()
            .collect();
        let mut explanations = self.of_the_drone(claims, &others);
        if explanations.is_empty() {
            explanations.extend(gimbal.map(|gimbal| vec![gimbal]));
            return explanations;
        }
        // What a gimbal's angles are measured from is judged by the attitude, which may be read in another way now.
        for explanation in &mut explanations {
            let readings = explanation
                .iter()
                .fold(claims.clone(), |claims, one| claims.with(one));
            let flight = Flight::new(self, claims, &readings, Depth::Contradictions);
            let of_the_gimbal = flight.of_the_gimbal();
            explanation.extend(of_the_gimbal.iter().flat_map(fits_of).next());
        }
        explanations
    }

    fn of_the_drone(&self, claims: &Claims, verdicts: &[Verdict]) -> Vec<Vec<Reading>> {
        let singles = to_try(verdicts);
        let mut complete = Vec::new();
        let mut best: Option<(usize, Reading, Vec<Verdict>)> = None;
        for single in singles {
            let left = self.contradictions(claims, &claims.with(&single));
            if left.is_empty() {
                complete.push(vec![single]);
            }
            if complete.len() == MOST {
                break;
            }
            if best.as_ref().is_none_or(|(least, ..)| left.len() < *least) {
                best = Some((left.len(), single, left));
            }
        }
        let Some((_, first, left)) = best.filter(|_| complete.is_empty()) else {
            return complete;
        };
        let with_first = claims.with(&first);
        for second in to_try(&left) {
            if (self.contradictions(claims, &with_first.with(&second))).is_empty() {
                complete.push(vec![first, second]);
            }
            if complete.len() == MOST {
                break;
            }
        }
        match complete.is_empty() {
            true => vec![vec![first]],
            false => complete,
        }
    }

    /// What contradicts under other readings, apart from the gimbal.
    fn contradictions(&self, claims: &Claims, readings: &Claims) -> Vec<Verdict> {
        let flight = Flight::new(self, claims, readings, Depth::Contradictions);
        let mut verdicts = flight.verdicts();
        verdicts
            .retain(|verdict| verdict.is_contradicted() && verdict.witness != Witness::Attitude);
        verdicts
    }
}

/// The readings that verdicts name, those of the strongest witnesses first.
fn to_try(verdicts: &[Verdict]) -> Vec<Reading> {
    let mut contradicted: Vec<&Verdict> = verdicts
        .iter()
        .filter(|verdict| verdict.is_contradicted())
        .collect();
    contradicted.sort_by_key(|verdict| verdict.witness);
    let mut readings: Vec<Reading> = Vec::new();
    // The first of each, then the second.
    for place in 0..4 {
        let nth = contradicted
            .iter()
            .filter_map(|verdict| fits_of(verdict).nth(place));
        for reading in nth {
            if !readings.contains(&reading) {
                readings.push(reading);
            }
        }
    }
    readings.truncate(MOST_TRIED);
    readings
}

fn fits_of(verdict: &Verdict) -> impl Iterator<Item = Reading> {
    let fits = match &verdict.outcome {
        Outcome::Contradicted { fits } => &fits[..],
        _ => &[],
    };
    fits.iter().copied()
}
