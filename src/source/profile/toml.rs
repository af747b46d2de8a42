//! Profiles as TOML: what serde does not do by itself.

use toml::{Table, Value};

use super::{
    Alternative, Profile,
    error::{BadRole, NotAProfile},
};
use crate::{
    decode::path::{Filter, MessagePath},
    sample::Kind,
    source::pattern::VEHICLE,
};

/// The keys of a role below which there are paths.
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
pub fn parse(toml: &str) -> Result<Profile, NotAProfile> {
    let mut table: Table = toml.parse().map_err(NotAProfile::Syntax)?;
    for role in Kind::ALL {
        let alternatives = match table.get_mut(role.name()) {
            Some(Value::Table(alternative)) => vec![alternative],
            Some(Value::Array(list)) => list.iter_mut().filter_map(Value::as_table_mut).collect(),
            _ => Vec::new(),
        };
        for alternative in alternatives {
            check_choices(role, alternative)
                .and_then(|()| lift_topic(alternative))
                .map_err(|problem| NotAProfile::Role { role, problem })?;
        }
    }
    let profile: Profile = table.clone().try_into().map_err(NotAProfile::Content)?;
    let known = Table::try_from(&profile).expect("a profile was read from TOML");
    if let Some(key) = unknown_key(&table, &known) {
        return Err(NotAProfile::UnknownKey { key: key.into() });
    }
    check(&profile)?;
    Ok(profile)
}

/// Checks that a role has exactly one of the keys that exclude each other.
fn check_choices(role: Kind, alternative: &Table) -> Result<(), BadRole> {
    if role == Kind::Position {
        one_of(alternative, "a position", &["geodetic", "local"])?;
    }
    if let Some(Value::Table(orientation)) = alternative.get("orientation") {
        let ways: &[&str] = match role {
            Kind::Gimbal => &["quaternion", "euler", "pitch"],
            _ => &["quaternion", "euler"],
        };
        one_of(orientation, "an orientation", ways)?;
    }
    match alternative.get("when") {
        Some(Value::Table(when)) => one_of(when, "`when`", &["is", "says", "has_bits"]),
        _ => Ok(()),
    }
}

fn one_of(table: &Table, what: &'static str, keys: &'static [&'static str]) -> Result<(), BadRole> {
    match keys.iter().filter(|key| table.contains_key(**key)).count() {
        1 => Ok(()),
        0 => Err(BadRole::NoneOf { what, keys }),
        _ => Err(BadRole::SeveralOf { what, keys }),
    }
}

/// If an alternative's paths name their topic, as in `/imu{id==1}.orientation`, moves it from them into `topics`, and
/// its filters into `select`.
fn lift_topic(alternative: &mut Table) -> Result<(), BadRole> {
    let mut messages: Vec<Messages> = Vec::new();
    for key in WITH_PATHS {
        if let Some(value) = alternative.get_mut(key) {
            lift_from(value, &mut messages)?;
        }
    }
    messages.dedup();
    let mut messages = messages.into_iter();
    let Some(Messages { topic, filters }) = messages.next() else {
        return Ok(());
    };
    if let Some(other) = messages.next() {
        return Err(match topic == other.topic {
            true => BadRole::SeveralSelections {
                topic: topic.into(),
            },
            false => BadRole::SeveralTopics {
                topics: [topic.into(), other.topic.into()],
            },
        });
    }
    if alternative.contains_key("topics") {
        return Err(BadRole::TopicTwice {
            topic: topic.into(),
        });
    }
    alternative.insert("topics".to_owned(), vec![topic].into());
    if !filters.is_empty() {
        let filters: Vec<String> = filters.into_iter().map(String::from).collect();
        if alternative.contains_key("select") {
            return Err(BadRole::SelectTwice {
                filter: filters.concat().into(),
            });
        }
        alternative.insert("select".to_owned(), filters.into());
    }
    Ok(())
}

/// The messages that a path is of.
#[derive(PartialEq)]
struct Messages {
    topic: String,
    filters: Vec<Filter>,
}

fn lift_from(value: &mut Value, messages: &mut Vec<Messages>) -> Result<(), BadRole> {
    match value {
        // A field may have a name in quotes, too.
        Value::String(text) if text.trim_start_matches('"').starts_with('/') => {
            let path: MessagePath = text.parse()?;
            let field = path.field.ok_or_else(|| BadRole::NoField {
                path: (&*text).into(),
            })?;
            messages.push(Messages {
                topic: path.topic,
                filters: path.filters,
            });
            *text = field.into();
            Ok(())
        }
        Value::Array(values) => values
            .iter_mut()
            .try_for_each(|value| lift_from(value, messages)),
        // The text that a field is compared with may look like a path, as ROS 1's frame ids do.
        Value::Table(table) => (table.iter_mut())
            .filter(|(key, _)| *key != "says")
            .try_for_each(|(_, value)| lift_from(value, messages)),
        _ => Ok(()),
    }
}

/// A given key that was not understood: `known`, what was understood, does not have it.
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
        // A single alternative need not be in a list.
        (Value::Table(_), Value::Array(known)) => unknown_key_within(given, known.first()?),
        _ => None,
    }
}

/// Checks what the types leave open.
fn check(profile: &Profile) -> Result<(), NotAProfile> {
    let attitude = profile.alternatives(Kind::Attitude);
    let with_topics =
        (attitude.iter()).filter(|alternative| !alternative.location.topics.is_empty());
    match with_topics.count() {
        _ if attitude.is_empty() => return Err(NotAProfile::NoAttitude),
        0 => {}
        count if count == attitude.len() => {}
        _ => return Err(NotAProfile::TopicsOfSome),
    }
    for role in Kind::ALL {
        for Alternative { location, fields } in profile.alternatives(role) {
            if !profile.namespaced && location.topics.iter().any(|topic| topic.contains(VEHICLE)) {
                return Err(NotAProfile::VehicleWithoutNamespace);
            }
            (fields.check()).map_err(|problem| NotAProfile::Role { role, problem })?;
        }
    }
    Ok(())
}

/// The alternatives of all roles, each a list under the role's name. A single one need not be in a list: `[attitude]`
/// for `[[attitude]]`.
pub mod roles {
    use serde::{Deserialize, Deserializer, Serializer, de::Error, ser::SerializeMap};
    use toml::{Table, Value};

    use super::super::{Alternative, Roles, error::in_one_line, fields::RoleFields};
    use crate::sample::Kind;

    pub fn serialize<S: Serializer>(roles: &Roles, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for role in Kind::LISTED {
            let alternatives = &roles[role as usize];
            // Every profile must have an attitude.
            if !alternatives.is_empty() || role == Kind::Attitude {
                map.serialize_entry(role.name(), alternatives)?;
            }
        }
        map.end()
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Roles, D::Error> {
        let mut table = Table::deserialize(deserializer)?;
        let mut roles = Roles::default();
        for role in Kind::LISTED {
            let list = match table.remove(role.name()) {
                None if role == Kind::Attitude => return Err(Error::missing_field(role.name())),
                None => continue,
                Some(Value::Array(list)) => list,
                Some(single) => vec![single],
            };
            let of_several = list.len() > 1;
            for (number, alternative) in (1..).zip(list) {
                let alternative = read(role, alternative).map_err(|error| {
                    let (problem, role) = (in_one_line(&error), role.name());
                    Error::custom(match of_several {
                        true => format!("{problem}, in alternative {number}, in `{role}`"),
                        false => format!("{problem}, in `{role}`"),
                    })
                })?;
                roles[role as usize].push(alternative);
            }
        }
        Ok(roles)
    }

    fn read(role: Kind, alternative: Value) -> Result<Alternative, toml::de::Error> {
        Ok(Alternative {
            location: alternative.clone().try_into()?,
            fields: RoleFields::read(role, alternative)?,
        })
    }
}
