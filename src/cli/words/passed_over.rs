//! What was passed over, in words.

use flightcam::{PassedOver, SeenPlace, text};
use indicatif::HumanCount;

use super::plural;

/// A place that was passed over, for which other one, and why.
pub fn passed_over(passed_over: &PassedOver) -> String {
    let PassedOver {
        role,
        place,
        instead,
        ..
    } = passed_over;
    let role = role.name();
    let used = name(instead, place);
    let passed = name(place, instead);
    let of_profile = match place.profile == instead.profile {
        true => String::new(),
        false => format!(", which the profile {} reads", place.profile),
    };
    let why = why(place, instead);
    format!("the {role} is read from {used}, not from {passed}{of_profile}: {why}")
}

/// The topic, and the fields if that of the other place is the same.
fn name(place: &SeenPlace, other: &SeenPlace) -> String {
    let topic = &place.origin.topic;
    match *topic == other.origin.topic {
        true => format!("{} of {topic}", text::join(&place.origin.fields, ", ")),
        false => topic.to_string(),
    }
}

fn why(place: &SeenPlace, instead: &SeenPlace) -> String {
    let messages = plural(place.messages, "message");
    let looked_at = &place.looked_at;
    let (usable, read) = (looked_at.used, looked_at.total_with_unselected());
    if usable == read {
        let more = HumanCount(instead.messages);
        return format!("that has {messages}, and the other {more}");
    }
    let of_which = match read == place.messages {
        true => format!("its {messages}"),
        false => format!("{read} of its {messages} that were looked at"),
    };
    let dropped = looked_at.dropped.iter();
    let dropped = dropped.map(|(reason, count)| format!("{} {reason}", HumanCount(*count)));
    let others = (looked_at.unselected > 0)
        .then(|| format!("{} of another source", HumanCount(looked_at.unselected)));
    let reasons = text::join(dropped.chain(others), ", ");
    match usable {
        0 => format!("none of {of_which} is usable ({reasons})"),
        usable => format!("only {usable} of {of_which} are usable ({reasons})"),
    }
}
