//! What viewers have trouble with, in words.

use flightcam::{FarMessages, ViewerWarning};
use indicatif::HumanCount;

use super::{first_few, plural};

/// Something in a log that viewers have trouble with, and what enrich changes about it.
pub fn viewer_warning(warning: &ViewerWarning) -> String {
    match warning {
        ViewerWarning::EarlyMessages(far) => format!(
            "{} before all others, so a viewer's time axis begins there and the rest is squeezed into its end: {}",
            distance(far, far.rest[0] - far.times[1]),
            topics(far)
        ),
        ViewerWarning::LateMessages(far) => format!(
            "{} after all others, so a viewer's time axis ends there and the rest is squeezed into its start: {}",
            distance(far, far.times[0] - far.rest[1]),
            topics(far)
        ),
        ViewerWarning::FastTopics { topics } => {
            let have = if topics.len() == 1 { "has" } else { "have" };
            let named = topics.iter();
            let named = named.map(|fast| format!("{} ({:.0} Hz)", fast.topic, fast.rate_hz));
            format!(
                "{} {have} more than the 60 messages per second that viewers draw: {}",
                plural(topics.len() as u64, "topic"),
                first_few(named)
            )
        }
        ViewerWarning::UnindexedChunks { unindexed, chunks } => {
            let lack = if *unindexed == 1 { "lacks" } else { "lack" };
            format!(
                "{} of {} {lack} message indexes, without which readers such as Foxglove's refuse a chunk; enrich \
                 writes the missing ones",
                HumanCount(*unindexed),
                plural(*chunks, "chunk")
            )
        }
        other => format!("{other:?}"),
    }
}

/// The topics of messages, and how many each has.
fn topics(far: &FarMessages) -> String {
    let topics = far.topics.iter();
    first_few(topics.map(|(topic, messages)| format!("{topic} ({})", HumanCount(*messages))))
}

/// How many messages are how far away.
fn distance(far: &FarMessages, nanoseconds: u64) -> String {
    const DAYS_IN_A_YEAR: f64 = 365.25;
    let are = if far.messages == 1 { "is" } else { "are" };
    let messages = plural(far.messages, "message");
    let topics = plural(far.topics.len() as u64, "topic");
    let days = nanoseconds as f64 / 1e9 / 60.0 / 60.0 / 24.0;
    let distance = match days / DAYS_IN_A_YEAR {
        years if years >= 1.0 => plural(years.round() as u64, "year"),
        _ => plural(days.round() as u64, "day"),
    };
    let seconds = far.times.map(|time| format!("{:.3} s", time as f64 / 1e9));
    let at = match &seconds {
        [start, end] if start == end => format!("at {start}"),
        [start, end] => format!("from {start} to {end}"),
    };
    format!("{messages} on {topics}, {at} in log time, {are} {distance}")
}
