//! A velocity in the drone's axes, which the attitude turns into the world's.

use nalgebra::Vector3;

use super::{DISPLACEMENT, Flight, MOST_SHOWN, SMALL_SHIFTS, best_of};
use crate::check::{
    displacement::Displacement,
    reading::VectorReading,
    residual::{Decision, FITS, Residual, decide},
    track::Timed,
    verdict::{Outcome, Reading, Verdict},
};

impl Flight<'_> {
    /// Where the velocity does not fit as it is read, the attitude may be the one that is misread.
    pub(super) fn blame_the_attitude(
        &self,
        positions: &[Timed<Vector3<f64>>],
        velocity: VectorReading,
        verdicts: &mut [Verdict],
    ) {
        let Some(attitude) = self.readings.attitude else {
            return;
        };
        if !verdicts.iter().any(Verdict::does_not_fit) {
            return;
        }
        let residuals = |attitudes: &[Timed<_>]| {
            let moved = Displacement::new(positions, &self.velocities, attitudes);
            DISPLACEMENT.map(|part| {
                let judged = best_of(&SMALL_SHIFTS, |shift| {
                    part.select(moved.pairs(&velocity, shift))
                });
                judged.moves().then(|| Residual::from(&judged))
            })
        };
        let own = residuals(&self.attitudes);
        let mut fits: Vec<Reading> = Vec::new();
        for other in attitude.alternatives() {
            let Some(reread) = other.instead_of(&attitude) else {
                continue;
            };
            let attitudes = self.attitudes.iter().map(|sample| Timed {
                time: sample.time,
                value: reread.apply(sample.value),
            });
            let others = residuals(&attitudes.collect::<Vec<_>>());
            let mut parts = own.iter().flatten().zip(others.iter().flatten());
            let all_fit = others.iter().flatten().all(|residual| residual.all < FITS);
            if all_fit && parts.any(|(own, other)| decide(*own, *other) == Decision::Condemned) {
                fits.push(Reading::Attitude(other));
            }
        }
        fits.truncate(MOST_SHOWN);
        if fits.is_empty() {
            return;
        }
        for verdict in verdicts.iter_mut().filter(|verdict| verdict.does_not_fit()) {
            match &mut verdict.outcome {
                // The likeliest of each first.
                Outcome::Contradicted { fits: others } => {
                    let rest = others.split_off(others.len().min(1));
                    others.extend(fits.iter().chain(&rest));
                }
                outcome => *outcome = Outcome::Contradicted { fits: fits.clone() },
            }
        }
    }
}
