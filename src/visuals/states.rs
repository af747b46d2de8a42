//! Whether everything that is shown is known, tick by tick, and what happened: gaps, resets, jumps.

use super::{
    flight::{Flight, Tick},
    stage::Stage,
};
use crate::{
    derived::visual::{Event, State},
    sample::DropReason,
    transform::IncidentKind,
};

/// The state in which everything is known.
pub const OK: &str = "ok";

/// The states in which it is known where the camera looks, but not how fast the drone moves, or where it is.
pub const VELOCITY_INVALID: &str = "velocity invalid";
/// See [`VELOCITY_INVALID`].
pub const POSITION_INVALID: &str = "position invalid";

/// The states in which it is not known where the camera looks.
pub const NO_ATTITUDE: [&str; 5] = [
    GAP,
    RESET,
    HEADING_UNDEFINED,
    NO_GIMBAL_ANGLE,
    ATTITUDE_UNKNOWN,
];

const GAP: &str = "gap";
const RESET: &str = "estimator reset";
const HEADING_UNDEFINED: &str = "heading undefined";
const NO_GIMBAL_ANGLE: &str = "no gimbal angle";
const ATTITUDE_UNKNOWN: &str = "no attitude";

/// A velocity or a position that is missing for less than this, in nanoseconds, is not: at the start and at the end of a
/// log not all topics begin and end at once.
const LEAST: u64 = 1_000_000_000;

/// As many events as are written of one flight.
const MOST_EVENTS: usize = 1000;

/// Ticks in the same state, by their times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// The time of the first tick, nanoseconds.
    pub from: u64,
    /// The time of the first tick in another state, or of the last tick.
    pub to: u64,
    /// The epoch that it is in.
    pub epoch: u32,
    /// The state.
    pub state: State,
}

/// The states of a flight, in the order of their times.
pub fn spans(flight: &Flight, stage: &Stage) -> Vec<Span> {
    let has_velocities = flight.ticks.iter().any(|tick| tick.velocity.is_some());
    let name = |tick: &Tick| match tick.attitudes {
        Err(reason) => missing(reason),
        Ok(_) if has_velocities && tick.velocity.is_none() => VELOCITY_INVALID,
        Ok(_) if stage.has_positions && tick.position.is_none() => POSITION_INVALID,
        Ok(_) => OK,
    };
    let all = flight.ticks.iter().map(|tick| Span {
        from: tick.time,
        to: tick.time,
        epoch: tick.epoch,
        state: State { name: name(tick) },
    });
    let mut joined = join(all);
    for span in &mut joined {
        let is_invalid = [VELOCITY_INVALID, POSITION_INVALID].contains(&span.state.name);
        if is_invalid && span.to - span.from < LEAST {
            span.state = State { name: OK };
        }
    }
    join(joined.into_iter())
}

/// Joins adjacent spans of one state.
fn join(spans: impl Iterator<Item = Span>) -> Vec<Span> {
    let mut joined: Vec<Span> = Vec::new();
    for span in spans {
        match joined.last_mut().filter(|last| last.epoch == span.epoch) {
            Some(last) if last.state == span.state => last.to = span.to,
            Some(last) => {
                last.to = span.from;
                joined.push(span);
            }
            None => joined.push(span),
        }
    }
    joined
}

/// The state in which it is not known how drone and camera are oriented.
fn missing(reason: DropReason) -> &'static str {
    match reason {
        DropReason::UndefinedHeading => HEADING_UNDEFINED,
        DropReason::InAttitudeGap => GAP,
        DropReason::AcrossAttitudeReset => RESET,
        DropReason::OutsideGimbal | DropReason::InGimbalGap => NO_GIMBAL_ANGLE,
        _ => ATTITUDE_UNKNOWN,
    }
}

/// Something that happened, and when.
#[derive(Debug, Clone, PartialEq)]
pub struct Happening {
    /// The epoch.
    pub epoch: u32,
    /// When it began, nanoseconds.
    pub from: u64,
    /// What it was.
    pub event: Event,
}

/// What happened, epoch by epoch in the order of the times when it began; the first thousand of it.
pub fn events(flight: &Flight, spans: &[Span]) -> Vec<Happening> {
    let incidents = flight.incidents.iter().map(|&(epoch, incident)| {
        let seconds = (incident.to - incident.from) as f64 / 1e9;
        let (kind, text) = words(incident.kind, seconds);
        Happening {
            epoch,
            from: incident.from,
            event: Event {
                end: incident.to,
                kind,
                text,
            },
        }
    });
    // Gaps and resets are incidents, with their exact times.
    let not_incidents = |span: &&Span| ![OK, GAP, RESET].contains(&span.state.name);
    let states = spans.iter().filter(not_incidents).map(|span| {
        let kind = span.state.name;
        let seconds = (span.to - span.from) as f64 / 1e9;
        let text = format!("{kind} for {seconds:.1} s");
        Happening {
            epoch: span.epoch,
            from: span.from,
            event: Event {
                end: span.to,
                kind,
                text,
            },
        }
    });
    let mut all: Vec<Happening> = incidents.chain(states).collect();
    all.sort_by_key(|happening| (happening.epoch, happening.from));
    all.truncate(MOST_EVENTS);
    all
}

fn words(kind: IncidentKind, seconds: f64) -> (&'static str, String) {
    match kind {
        IncidentKind::Gap => (GAP, format!("no attitude for {seconds:.1} s")),
        IncidentKind::Reset => (
            RESET,
            "the attitude estimator was reset: the attitude jumped, the camera did not".to_owned(),
        ),
        IncidentKind::ClockStep => (
            "clock step",
            "the time of the log went back before this".to_owned(),
        ),
        IncidentKind::Flip(turn) => (
            "jump",
            format!(
                "the camera turned by {:.0}° while the drone did not: its nose passed the vertical",
                turn.to_degrees()
            ),
        ),
        IncidentKind::Spin(rate) => (
            "jump",
            format!(
                "a turn at {:.0} °/s, which no drone makes",
                rate.to_degrees()
            ),
        ),
        IncidentKind::Leap(acceleration) => (
            "jump",
            format!("the velocity changed by {acceleration:.0} m/s², which no drone's does"),
        ),
    }
}
