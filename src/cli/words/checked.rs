//! What a check found, in words.

use flightcam::check::{
    Oddity, Verdict,
    reading::{AttitudeReading, Form},
    verdict::{Candidate, Motion, Outcome, Reading, Shift, Subject, Undecided, Witness},
};

use super::{
    plural,
    sample::{self, name},
};

/// What verdicts are about, in the order in which they are printed.
pub const SUBJECTS: [(&str, &[Subject]); 5] = [
    ("Velocity, horizontal", &[Subject::VelocityHorizontal]),
    ("Velocity, vertical", &[Subject::VelocityVertical]),
    ("Clock of the velocity", &[Subject::VelocityTime]),
    (
        "Attitude",
        &[
            Subject::AttitudeTurns,
            Subject::AttitudeTilt,
            Subject::AttitudeAndVelocity,
        ],
    ),
    ("Gimbal", &[Subject::GimbalTilt, Subject::GimbalYaw]),
];

/// A verdict in one word, the gravest first in their order.
pub fn outcome(outcome: &Outcome) -> (u8, &'static str) {
    match outcome {
        Outcome::Contradicted { .. } => (0, "wrong"),
        Outcome::Proven => (1, "proven"),
        Outcome::Consistent => (2, "consistent"),
        Outcome::Undecidable { .. } => (3, "undecidable"),
    }
}

/// By what something is judged, and the evidence.
pub fn evidence(verdict: &Verdict) -> String {
    let found = match &verdict.outcome {
        Outcome::Proven | Outcome::Consistent | Outcome::Contradicted { .. } => {
            residuals(&verdict.candidates)
        }
        Outcome::Undecidable { why } => undecided(why, verdict),
    };
    let found = match verdict.shift {
        Some(shift) if !matches!(verdict.outcome, Outcome::Undecidable { .. }) => {
            shift_in_words(shift)
        }
        _ => found,
    };
    let motion = verdict.motion.filter(|motion| motion.windows > 0);
    let motion = motion.map_or_else(String::new, |motion| {
        let windows = plural(motion.windows as u64, "window");
        format!(" (motion {}, {windows})", amount(motion, motion.median))
    });
    format!("{}: {found}{motion}", by(verdict))
}

fn by(verdict: &Verdict) -> String {
    let what = match verdict.subject {
        Subject::AttitudeTurns => "how it turns, ",
        Subject::AttitudeTilt => "up and down, ",
        Subject::AttitudeAndVelocity => "with the velocity, ",
        Subject::GimbalTilt => "tilt, ",
        Subject::GimbalYaw => "yaw, ",
        _ => "",
    };
    let witness = match verdict.witness {
        Witness::GeodeticPosition => "latitude, longitude, height",
        Witness::LocalPosition => "the local position",
        Witness::Inertia => "the accelerations",
        Witness::Lean => "how the drone leans",
        Witness::AngularRates => "the angular rates",
        Witness::Gravity => "gravity",
        Witness::Attitude => "the drone's attitude",
        _ => "the log",
    };
    format!("{what}by {witness}")
}

/// How far the reading is off, and the next one that is worse; or the best, if another is better.
fn residuals(candidates: &[Candidate]) -> String {
    let [claimed, others @ ..] = candidates else {
        return String::new();
    };
    let own = format!(
        "{} is off by {}",
        reading(&claimed.reading),
        share(claimed.residual)
    );
    match others.iter().find(|other| other.is_told_from(claimed)) {
        Some(other) => {
            let other = format!("{} by {}", reading(&other.reading), share(other.residual));
            format!("{own} of the motion, {other}")
        }
        None => format!("{own} of the motion"),
    }
}

/// A residual as a share of the motion.
fn share(residual: f64) -> String {
    match residual < 10.0 {
        true => format!("{:.0} %", residual * 100.0),
        false => format!("{residual:.0} times"),
    }
}

fn shift_in_words(
    Shift {
        late_by_s,
        resolution_s,
        ..
    }: Shift,
) -> String {
    let (late, known) = (late_by_s * 1e3, resolution_s * 1e3);
    let late = match late {
        late if late < 0.0 => format!("{:.0} ms early", -late),
        late => format!("{late:.0} ms late"),
    };
    format!("it is {late}, give or take {known:.0} ms")
}

/// An amount of motion.
fn amount(motion: Motion, amount: f64) -> String {
    match motion.unit {
        "rad" => format!("{:.1}°", amount.to_degrees()),
        unit => format!("{amount:.2} {unit}"),
    }
}

fn undecided(why: &Undecided, verdict: &Verdict) -> String {
    match why {
        Undecided::FewSamples => "too few samples of both at the same times".to_owned(),
        Undecided::HardlyMoved { needed } => match verdict.motion {
            Some(motion) => {
                let moved = amount(motion, motion.median);
                format!("it moved {moved}, and it takes {}", amount(motion, *needed))
            }
            None => "it hardly moved".to_owned(),
        },
        Undecided::Tied { with } => {
            let claimed = residuals(verdict.candidates.get(..1).unwrap_or_default());
            match with.first() {
                Some(other) => format!("{claimed}, but {} fits as well", reading(other)),
                None => format!("{claimed}, but that does not rule out others"),
            }
        }
        Undecided::NothingFits => format!("no reading fits: {}", residuals(&verdict.candidates)),
        Undecided::Doubtful { .. } => {
            format!("not clear enough: {}", residuals(&verdict.candidates))
        }
        Undecided::Unresolved => "the motion is too steady to tell".to_owned(),
    }
}

/// A reading in a few words.
pub fn reading(of: &Reading) -> String {
    match of {
        Reading::Velocity(vector) => format!("{} in {}", vector.axes, vector.unit.name),
        Reading::AngularRate(vector) => format!("rates {} in {}", vector.axes, vector.unit.name),
        Reading::Acceleration(vector) => {
            format!("accelerations {} in {}", vector.axes, vector.unit.name)
        }
        Reading::Attitude(attitude) => attitude_reading(attitude),
        Reading::Gimbal { reference, flipped } => {
            let from = sample::reference(*reference);
            match flipped {
                true => {
                    format!("measured from the {from} with pitch and yaw of the opposite signs")
                }
                false => format!("measured from the {from}"),
            }
        }
        Reading::ShiftedVelocity { late_by_s } => {
            let milliseconds = late_by_s.abs() * 1e3;
            let way = if *late_by_s > 0.0 { "earlier" } else { "later" };
            format!("{milliseconds:.0} ms {way}")
        }
        other => format!("{other:?}"),
    }
}

fn attitude_reading(attitude: &AttitudeReading) -> String {
    let AttitudeReading {
        form,
        body,
        world,
        inverse,
        north_deg,
    } = attitude;
    let mut text = format!("{body}-{world}");
    match form {
        Form::Quaternion { scalar_last: true } => text += ", scalar part last",
        Form::Quaternion { scalar_last: false } => text += ", scalar part first",
        Form::OtherAngles => {}
        Form::Angles {
            unit,
            swapped,
            opposite,
        } => {
            text += &format!(" in {}", unit.name);
            if *swapped {
                text += " with roll and pitch in each other's place";
            }
            let names = ["roll", "pitch", "yaw"].into_iter().zip(opposite);
            let opposite: Vec<&str> = names
                .filter(|(_, is_so)| **is_so)
                .map(|(name, _)| name)
                .collect();
            if !opposite.is_empty() {
                text += &format!(" with the opposite sign of {}", opposite.join(", "));
            }
        }
    }
    if *inverse {
        text += ", the other way round";
    }
    if *north_deg != 0.0 {
        text += &format!(", with north {north_deg}° to the right");
    }
    text
}

/// What a series shows by itself.
pub fn oddity(oddity: &Oddity) -> String {
    let percent = |share: &f64| format!("{:.0} %", share * 100.0);
    match oddity {
        Oddity::OneTime { of, samples } => format!(
            "all {samples} samples of the {} are at one time, so the recorder did not stamp them; --time names the \
             field that holds the time",
            name(*of)
        ),
        Oddity::ToAndFro { of, jumps } => {
            let largest = jumps.largest_of(*of);
            format!(
                "the {} jumps to and fro by up to {largest}, {} of {} times: several sources write to its topic",
                name(*of),
                jumps.jumps,
                jumps.steps
            )
        }
        Oddity::ScalarElsewhere { level, .. } => format!(
            "the scalar part of the attitude's quaternion is in the other place: read so, the drone is level for {} of \
             the flight",
            percent(level)
        ),
        Oddity::NotAtDepression { share, median_deg } => format!(
            "the log's gimbal holds the camera elsewhere than --depression says for {} of the flight; its median is \
             {median_deg:.0}° below the horizon",
            percent(share)
        ),
        Oddity::OnItsSide { share } => format!(
            "the drone leans by more than 60° for {} of the flight; is it the drone's attitude?",
            percent(share)
        ),
        Oddity::GimbalUp { share } => {
            format!("the gimbal points up for {} of the flight", percent(share))
        }
        other => format!("{other:?}"),
    }
}
