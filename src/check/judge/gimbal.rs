//! What a gimbal's angles are measured from.

use super::Flight;
use crate::{
    check::{
        gimbal::{Found, LEAST_TILT, LEAST_TURN, Moments, Shown},
        verdict::{Candidate, Motion, Outcome, Reading, Subject, Undecided, Verdict, Witness},
    },
    sample::GimbalReference,
};

impl Flight<'_> {
    pub(super) fn of_the_gimbal(&self) -> Vec<Verdict> {
        let gimbals = &self.recorder.gimbals.samples;
        let Some(moments) = Moments::new(gimbals, &self.attitudes) else {
            return Vec::new();
        };
        let claimed = moments.reference();
        let found = [
            (Subject::GimbalTilt, moments.tilt()),
            (Subject::GimbalYaw, moments.yaw()),
        ];
        let found = found.into_iter();
        let found = found.filter_map(|(subject, found)| Some(verdict(subject, claimed, found?)));
        found.collect()
    }
}

fn verdict(subject: Subject, claimed: GimbalReference, found: Found) -> Verdict {
    let outcome = match found.shown {
        Shown::Fits => Outcome::Consistent,
        Shown::Another { reference, flipped } => Outcome::Contradicted {
            fits: vec![reading(reference, flipped)],
        },
        Shown::TooLittle => Outcome::Undecidable {
            why: Undecided::HardlyMoved {
                needed: match subject {
                    Subject::GimbalYaw => LEAST_TURN,
                    _ => LEAST_TILT,
                },
            },
        },
        Shown::Possible => Outcome::Undecidable {
            why: Undecided::Tied { with: Vec::new() },
        },
    };
    Verdict {
        subject,
        witness: Witness::Attitude,
        outcome,
        motion: Some(Motion {
            median: found.motion,
            unit: Witness::Attitude.unit_of_motion(),
            windows: found.windows,
        }),
        candidates: vec![Candidate {
            reading: reading(claimed, false),
            residual: found.residual,
        }],
        shift: None,
    }
}

fn reading(reference: GimbalReference, flipped: bool) -> Reading {
    Reading::Gimbal { reference, flipped }
}
