//! Profiles as text: what serde does not do by itself.

use toml::{Table, Value};

use super::{GimbalOrientation, PITCH_ALONE, Place, Profile, convention::Convention};
use crate::{
    decode::path::MessagePath,
    sample::{GimbalReference, Kind},
    source::topic::VEHICLE,
};

/// The keys of a role below which paths are found.
const WITH_PATHS: [&str; 8] = [
    "orientation",
    "vector",
    "geodetic",
    "local",
    "valid",
    "when",
    "reset_counter",
    "time",
];

/// Reads a profile from TOML.
pub fn parse(toml: &str) -> Result<Profile, String> {
    let mut table: Table = toml
        .parse()
        .map_err(|error: toml::de::Error| error.to_string().trim().to_owned())?;
    for kind in Kind::ALL {
        let mut alternatives = match table.get_mut(kind.name()) {
            Some(Value::Table(role)) => vec![role],
            Some(Value::Array(roles)) => roles.iter_mut().filter_map(Value::as_table_mut).collect(),
            _ => Vec::new(),
        };
        for role in &mut alternatives {
            check_choices(kind, role)
                .map_err(|problem| format!("{problem}, in `{}`", kind.name()))?;
            lift_topic(role).map_err(|problem| format!("{problem}, in `{}`", kind.name()))?;
        }
    }
    let profile: Profile =
        (table.clone().try_into()).map_err(|error: toml::de::Error| in_one_line(&error))?;
    let known = Table::try_from(&profile).expect("a profile was read from TOML");
    if let Some(key) = unknown_key(&table, &known) {
        return Err(format!(
            "unknown key `{key}`; the README lists the keys of a profile"
        ));
    }
    check(&profile)?;
    Ok(profile)
}

/// Checks that of keys which exclude each other a role has one.
fn check_choices(kind: Kind, role: &Table) -> Result<(), String> {
    if kind == Kind::Position {
        one_of(role, "a position", &["geodetic", "local"])?;
    }
    if let Some(Value::Table(orientation)) = role.get("orientation") {
        let ways: &[&str] = match kind {
            Kind::Gimbal => &["quaternion", "euler", "pitch"],
            _ => &["quaternion", "euler"],
        };
        one_of(orientation, "an orientation", ways)?;
    }
    match role.get("when") {
        Some(Value::Table(when)) => one_of(when, "`when`", &["is", "says", "has_bits"]),
        _ => Ok(()),
    }
}

fn one_of(table: &Table, what: &str, keys: &[&str]) -> Result<(), String> {
    let given = keys.iter().filter(|key| table.contains_key(**key)).count();
    let choices = keys.join("`, `");
    match given {
        1 => Ok(()),
        0 => Err(format!("{what} needs one of `{choices}`")),
        _ => Err(format!("{what} takes only one of `{choices}`")),
    }
}

/// What is wrong, and in which key.
fn in_one_line(error: &toml::de::Error) -> String {
    let text = error.to_string();
    let lines: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
    lines.join(", ")
}

/// Where a role's paths name their topic, as in `/imu.orientation`, takes it out of them and into `topics`.
fn lift_topic(role: &mut Table) -> Result<(), String> {
    let mut topics: Vec<String> = Vec::new();
    for key in WITH_PATHS {
        if let Some(value) = role.get_mut(key) {
            lift_from(value, &mut topics)?;
        }
    }
    topics.dedup();
    match topics.as_slice() {
        [] => Ok(()),
        [topic] if role.contains_key("topics") => Err(format!(
            "a path names the topic {topic}, and there is `topics` as well; leave one of the two out"
        )),
        [_] => {
            let topics = topics.into_iter().map(Value::String).collect();
            role.insert("topics".to_owned(), Value::Array(topics));
            Ok(())
        }
        [one, other, ..] => Err(format!(
            "paths name the topics {one} and {other}; what belongs to one sample must come in one message"
        )),
    }
}

fn lift_from(value: &mut Value, topics: &mut Vec<String>) -> Result<(), String> {
    match value {
        Value::String(text) if text.starts_with(['/', '"']) => {
            let path: MessagePath = text.parse().map_err(|error| format!("{error}"))?;
            let field = path
                .field
                .ok_or_else(|| format!("`{text}` names no field"))?;
            topics.push(path.topic);
            *text = field.to_string();
            Ok(())
        }
        Value::Array(values) => values
            .iter_mut()
            .try_for_each(|value| lift_from(value, topics)),
        // What a field says may look like a path: frame ids of ROS 1 do.
        Value::Table(table) => (table.iter_mut())
            .filter(|(key, _)| *key != "says")
            .try_for_each(|(_, value)| lift_from(value, topics)),
        _ => Ok(()),
    }
}

/// A key that is given but not known: what was understood does not have it.
fn unknown_key(given: &Table, known: &Table) -> Option<String> {
    given.iter().find_map(|(key, value)| match known.get(key) {
        None => Some(key.clone()),
        Some(known) => unknown_key_within(value, known).map(|inner| format!("{key}.{inner}")),
    })
}

fn unknown_key_within(given: &Value, known: &Value) -> Option<String> {
    match (given, known) {
        (Value::Table(given), Value::Table(known)) => unknown_key(given, known),
        (Value::Array(given), Value::Array(known)) => {
            (given.iter().zip(known)).find_map(|(given, known)| unknown_key_within(given, known))
        }
        // One alternative may stand by itself.
        (Value::Table(_), Value::Array(known)) => unknown_key_within(given, known.first()?),
        _ => None,
    }
}

/// Checks what the types leave open.
fn check(profile: &Profile) -> Result<(), String> {
    if profile.attitude.is_empty() {
        return Err("`attitude` is empty: it takes at least one alternative".to_owned());
    }
    let named = |place: &Place| !place.topics.is_empty();
    let count = (profile.attitude.iter())
        .filter(|source| named(&source.place))
        .count();
    if count != 0 && count != profile.attitude.len() {
        return Err("some alternatives of `attitude` have `topics` and others have not; name the topics of each, or of none".to_owned());
    }
    let places = (profile.attitude.iter().map(|source| &source.place))
        .chain(profile.velocity.iter().map(|source| &source.place))
        .chain(profile.gimbal.iter().map(|source| &source.place))
        .chain(profile.position.iter().map(|source| &source.place));
    let mut topics = places.flat_map(|place| &place.topics);
    if !profile.namespaced && topics.any(|topic| topic.contains(VEHICLE)) {
        return Err(format!(
            "a topic with {VEHICLE} takes `namespaced = true`: a vehicle's number is part of its namespace"
        ));
    }
    for source in &profile.gimbal {
        if matches!(source.orientation, GimbalOrientation::Pitch(_)) {
            if source.reference == GimbalReference::Earth {
                return Err(format!("gimbal: {PITCH_ALONE}"));
            }
            if source.convention != Convention::default() {
                return Err(
                    "gimbal: a pitch alone has no convention; its sign is told by `positive`"
                        .to_owned(),
                );
            }
        }
    }
    Ok(())
}

/// A list in which a single entry may stand by itself: `[attitude]` for `[[attitude]]`.
pub mod one_or_more {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::DeserializeOwned};

    pub fn serialize<T: Serialize, S: Serializer>(
        list: &[T],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        list.serialize(serializer)
    }

    pub fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<T>, D::Error> {
        // Not an untagged enum, whose errors would not say which key is wrong.
        let value = toml::Value::deserialize(deserializer)?;
        let list = match value {
            toml::Value::Array(list) => list,
            single => vec![single],
        };
        let of_several = list.len() > 1;
        let entries = (1..).zip(list).map(|(number, entry)| {
            entry.try_into().map_err(|error: toml::de::Error| {
                let problem = super::in_one_line(&error);
                serde::de::Error::custom(match of_several {
                    true => format!("{problem}, in alternative {number}"),
                    false => problem,
                })
            })
        });
        entries.collect()
    }
}
