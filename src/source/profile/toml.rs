//! Profiles as TOML: what serde does not do by itself.

mod forms;
mod keys;

use std::ops::Range;

use serde::Deserialize;
use toml::{
    Spanned,
    de::{DeArray, DeTable, DeValue, ValueDeserializer},
};

use super::{
    AccelerationFields, Alternative, AngularRateFields, AttitudeFields, CameraSetup, Coordinates,
    GimbalFields, HeightFields, Location, Profile, RoleFields, Roles, SampleTime, VelocityFields,
    Written,
    error::{BadRole, NotAProfile, Problem},
    yes,
};
use forms::Form;

use crate::{
    decode::path::{Filter, MessagePath},
    sample::Kind,
    similar,
    source::pattern::VEHICLE,
};

/// The keys of a role below which there are paths.
const WITH_PATHS: [&str; 9] = [
    "orientation",
    "vector",
    "field",
    "geodetic",
    "local",
    "valid",
    "when",
    "reset_counter",
    "time",
];

/// What a field may be tested for, one of these.
const TESTS: &[&str] = &["is", "is_integer", "says", "contains", "has_bits"];

/// The keys of a profile apart from its roles.
#[derive(Deserialize)]
struct Header {
    name: String,
    #[serde(default)]
    description: String,
    #[serde(default = "yes")]
    automatic: bool,
    #[serde(default)]
    fallback: bool,
    #[serde(default)]
    namespaced: bool,
    #[serde(default)]
    time: SampleTime,
    #[serde(default)]
    camera: CameraSetup,
    /// In which forms the messages of its alternatives are written.
    #[serde(default)]
    forms: Vec<Form>,
}

/// What is wrong, and where in the text.
type Found = (Range<usize>, Problem);

/// Reads a profile from TOML.
pub fn parse(text: &str) -> Result<Profile, NotAProfile> {
    let document = DeTable::parse(text).map_err(NotAProfile::Syntax)?;
    let line = |place: Range<usize>| {
        let before = &text.as_bytes()[..place.start.min(text.len())];
        before.iter().filter(|byte| **byte == b'\n').count() + 1
    };
    let profile = read(document).map_err(|(place, problem)| NotAProfile::Content {
        line: line(place),
        problem,
    })?;
    match profile.alternatives(Kind::Attitude) {
        [] => Err(NotAProfile::NoAttitude),
        _ => Ok(profile),
    }
}

fn read(document: Spanned<DeTable>) -> Result<Profile, Found> {
    let whole = document.span();
    let mut table = document.into_inner();
    let roles = Kind::LISTED.map(Kind::name);
    check_keys(&table, "", &[keys::of::<Header>(), &roles].concat())?;
    let given = Kind::LISTED.map(|role| (role, table.remove(role.name())));
    let header = Spanned::new(whole.clone(), DeValue::Table(table));
    let header = Header::deserialize(ValueDeserializer::from(header));
    let header = header.map_err(|problem| of_serde(&whole, None, problem))?;
    let mut roles = Roles::default();
    for (role, given) in given {
        let alternatives = match given {
            None => Vec::new(),
            Some(given) => read_role(role, given, &header)?,
        };
        roles[role as usize] = alternatives;
    }
    Ok(Profile {
        name: header.name,
        description: header.description,
        automatic: header.automatic,
        fallback: header.fallback,
        namespaced: header.namespaced,
        time: header.time,
        camera: header.camera,
        roles,
    })
}

/// Reads the alternatives of a role. A single one need not be in a list: `[attitude]` for `[[attitude]]`.
fn read_role(
    role: Kind,
    given: Spanned<DeValue>,
    header: &Header,
) -> Result<Vec<Alternative>, Found> {
    let place = given.span();
    let list = match given.into_inner() {
        DeValue::Array(list) => list.into_iter().collect(),
        single => vec![Spanned::new(place, single)],
    };
    let mut alternatives: Vec<Alternative> = Vec::new();
    let in_forms = list.iter().flat_map(|given| match &header.forms[..] {
        [] => vec![given.clone()],
        forms => forms.iter().map(|form| form.of(given)).collect(),
    });
    for given in in_forms {
        let place = given.span();
        let alternative = read_alternative(role, given)?;
        let topics = &alternative.location.topics;
        if !header.namespaced && topics.iter().any(|topic| topic.contains(VEHICLE)) {
            return Err((place, Problem::VehicleWithoutNamespace));
        }
        let first = alternatives.first();
        let has_first_topics = first.map(|first| !first.location.topics.is_empty());
        if role == Kind::Attitude && has_first_topics.is_some_and(|has| has == topics.is_empty()) {
            return Err((place, Problem::TopicsOfSome));
        }
        alternatives.push(alternative);
    }
    Ok(alternatives)
}

fn read_alternative(role: Kind, mut given: Spanned<DeValue>) -> Result<Alternative, Found> {
    let place = given.span();
    let of_role = |(place, problem)| (place, Problem::Role { role, problem });
    let mut lifted = None;
    if let DeValue::Table(table) = given.get_mut() {
        check_keys(table, role.name(), &keys_of(role))?;
        if let Some(DeValue::Table(when)) = table.get("when").map(Spanned::get_ref) {
            let within = format!("{}.when", role.name());
            check_keys(when, &within, &[&["field"], TESTS].concat())?;
        }
        check_choices(role, &place, table).map_err(of_role)?;
        lifted = lift_messages(&place, table).map_err(of_role)?;
    }
    let wrong = |problem| of_serde(&place, Some(role), problem);
    let mut location =
        Location::deserialize(ValueDeserializer::from(given.clone())).map_err(wrong)?;
    let fields = RoleFields::read(role, ValueDeserializer::from(given)).map_err(wrong)?;
    fields
        .check()
        .map_err(|problem| of_role((place.clone(), problem)))?;
    if let Some(messages) = lifted {
        location.topics = vec![messages.topic];
        location.select.extend(messages.filters);
        location.written = messages.written;
    }
    Ok(Alternative { location, fields })
}

fn of_serde(place: &Range<usize>, role: Option<Kind>, problem: toml::de::Error) -> Found {
    let place = problem.span().unwrap_or_else(|| place.clone());
    (place, Problem::Serde { role, problem })
}

/// The keys that an alternative of a role may have.
fn keys_of(role: Kind) -> Vec<&'static str> {
    let of_fields = match role {
        Kind::Attitude => keys::of::<AttitudeFields>(),
        Kind::Velocity => keys::of::<VelocityFields>(),
        Kind::Gimbal => keys::of::<GimbalFields>(),
        Kind::Position => keys::of::<Coordinates>(),
        Kind::Height => keys::of::<HeightFields>(),
        Kind::AngularRate => keys::of::<AngularRateFields>(),
        Kind::Acceleration => keys::of::<AccelerationFields>(),
    };
    [keys::of::<Location>(), of_fields].concat()
}

/// Checks that a table, which is the value of `within`, has only known keys.
fn check_keys(table: &DeTable, within: &str, known: &[&'static str]) -> Result<(), Found> {
    let mut keys = table.keys();
    let Some(unknown) = keys.find(|key| !known.contains(&key.get_ref().as_ref())) else {
        return Ok(());
    };
    let key: &str = unknown.get_ref();
    let meant = similar::names(key, known.iter().copied());
    let dot = if within.is_empty() { "" } else { "." };
    let problem = Problem::UnknownKey {
        key: format!("{within}{dot}{key}").into(),
        meant: meant.into_iter().next().map(Into::into),
    };
    Err((unknown.span(), problem))
}

/// What is wrong with a role, and where in the text.
type FoundInRole = (Range<usize>, BadRole);

/// Checks that a role has exactly one of the keys that exclude each other.
fn check_choices(role: Kind, place: &Range<usize>, table: &DeTable) -> Result<(), FoundInRole> {
    if role == Kind::Position {
        one_of(place, table, "a position", &["geodetic", "local"])?;
    }
    if let Some(orientation) = table.get("orientation")
        && let DeValue::Table(ways) = orientation.get_ref()
    {
        let known: &[&str] = match role {
            Kind::Gimbal => &["quaternion", "euler", "pitch"],
            _ => &["quaternion", "euler"],
        };
        one_of(&orientation.span(), ways, "an orientation", known)?;
    }
    if let Some(when) = table.get("when")
        && let DeValue::Table(tests) = when.get_ref()
    {
        one_of(&when.span(), tests, "`when`", TESTS)?;
    }
    Ok(())
}

fn one_of(
    place: &Range<usize>,
    table: &DeTable,
    what: &'static str,
    keys: &'static [&'static str],
) -> Result<(), FoundInRole> {
    let problem = match keys.iter().filter(|key| table.contains_key(**key)).count() {
        1 => return Ok(()),
        0 => BadRole::NoneOf { what, keys },
        _ => BadRole::SeveralOf { what, keys },
    };
    Err((place.clone(), problem))
}

/// The messages that paths are of.
struct Messages {
    topic: String,
    filters: Vec<Filter>,
    written: Written,
}

/// If an alternative's paths name their topic, as in `/imu{id==1}.orientation`, takes it and its filters out of them.
fn lift_messages(
    place: &Range<usize>,
    alternative: &mut DeTable,
) -> Result<Option<Messages>, FoundInRole> {
    let mut lifted = None;
    for key in WITH_PATHS {
        if let Some(value) = alternative.get_mut(key) {
            lift_from(value, &mut lifted)?;
        }
    }
    let Some(Messages { topic, filters, .. }) = &lifted else {
        return Ok(None);
    };
    if alternative.contains_key("topics") {
        let topic = topic.into();
        return Err((place.clone(), BadRole::TopicTwice { topic }));
    }
    if !filters.is_empty() && alternative.contains_key("select") {
        let filters: Vec<String> = filters.iter().cloned().map(String::from).collect();
        let filter = filters.concat().into();
        return Err((place.clone(), BadRole::SelectTwice { filter }));
    }
    Ok(lifted)
}

fn lift_from(
    value: &mut Spanned<DeValue>,
    lifted: &mut Option<Messages>,
) -> Result<(), FoundInRole> {
    let place = value.span();
    match value.get_mut() {
        // A field may have a name in quotes, too.
        DeValue::String(text) if text.trim_start_matches('"').starts_with('/') => {
            let path: MessagePath = text
                .parse()
                .map_err(|bad| (place.clone(), BadRole::from(bad)))?;
            let field = path.field.ok_or_else(|| {
                let path = text.as_ref().into();
                (place.clone(), BadRole::NoField { path })
            })?;
            *text = String::from(field).into();
            let known = lifted.get_or_insert_with(|| Messages {
                topic: path.topic.clone(),
                filters: path.filters.clone(),
                written: Written::InPaths,
            });
            if path.quoted {
                known.written = Written::Exactly;
            }
            let topics = || [(&known.topic).into(), (&path.topic).into()];
            match (known.topic == path.topic, known.filters == path.filters) {
                (true, true) => Ok(()),
                (false, _) => Err((place, BadRole::SeveralTopics { topics: topics() })),
                (true, false) => {
                    let topic = path.topic.into();
                    Err((place, BadRole::SeveralSelections { topic }))
                }
            }
        }
        DeValue::Array(values) => lift_from_all(values, lifted),
        // The text that a field is compared with may look like a path, as ROS 1's frame ids do.
        DeValue::Table(table) => (table.iter_mut())
            .filter(|(key, _)| !["says", "contains"].contains(&key.get_ref().as_ref()))
            .try_for_each(|(_, value)| lift_from(value, lifted)),
        _ => Ok(()),
    }
}

fn lift_from_all(values: &mut DeArray, lifted: &mut Option<Messages>) -> Result<(), FoundInRole> {
    values
        .iter_mut()
        .try_for_each(|value| lift_from(value, lifted))
}

/// The alternatives of all roles, each a list under the role's name.
pub mod roles {
    use serde::{Serializer, ser::SerializeMap};

    use super::super::Roles;
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
}
