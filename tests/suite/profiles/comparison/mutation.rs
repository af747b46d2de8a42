//! Profiles with one convention error each.

use toml::{Table, Value};

/// A profile in which one thing is wrong.
pub struct Mutation {
    /// What is wrong: where, what was there, and what is there now.
    pub name: String,
    /// The profile's text.
    pub profile: String,
}

const ANGLES: [&str; 4] = ["radians", "degrees", "centidegrees", "degE7"];
const LENGTHS: [&str; 3] = ["m", "cm", "mm"];
const TIMES: [&str; 4] = ["s", "ms", "us", "ns"];
const SPEEDS: [&str; 3] = ["m/s", "cm/s", "mm/s"];

/// The profile with each of its conventions replaced by each other that there is.
pub fn mutations(profile: &str) -> Vec<Mutation> {
    let profile: Table = profile.parse().expect("TOML");
    let mut mutations = Vec::new();
    for (role, alternatives) in roles(&profile) {
        for (place, alternative) in alternatives.iter().enumerate() {
            let mut variants = Vec::new();
            mutate(role, alternative, &mut variants);
            for (change, variant) in variants {
                let mut alternatives = alternatives.clone();
                alternatives[place] = variant;
                let mut profile = profile.clone();
                profile.insert(role.to_owned(), Value::Array(alternatives));
                mutations.push(Mutation {
                    name: format!("{role} {place}: {change}"),
                    profile: toml::to_string(&profile).expect("TOML"),
                });
            }
        }
    }
    mutations
}

/// The alternatives of each role.
fn roles(profile: &Table) -> impl Iterator<Item = (&'static str, Vec<Value>)> {
    let roles = ["attitude", "velocity", "gimbal", "position", "height"].into_iter();
    roles.filter_map(|role| match profile.get(role)? {
        Value::Array(alternatives) => Some((role, alternatives.clone())),
        alternative => Some((role, vec![alternative.clone()])),
    })
}

/// The conventions that a profile leaves to their defaults.
pub fn unsaid_conventions(profile: &str) -> Vec<String> {
    let profile: Table = profile.parse().expect("TOML");
    let unsaid_of = |(role, alternatives): (&'static str, Vec<Value>)| {
        let keys: &[&str] = match role {
            "attitude" => &["convention"],
            "velocity" => &["frame", "unit"],
            "gimbal" => &["convention", "reference"],
            _ => &["unit"],
        };
        let unsaid = move |alternative: Value| {
            let alternative = match role {
                // Its conventions are next to its fields.
                "position" => ["geodetic", "local"]
                    .into_iter()
                    .find_map(|kind| alternative.get(kind).cloned()),
                _ => Some(alternative),
            };
            let unsaid = keys.iter().find(|key| {
                alternative
                    .as_ref()
                    .is_none_or(|table| table.get(key).is_none())
            });
            unsaid.map(|key| format!("{role}.{key}"))
        };
        alternatives.into_iter().filter_map(unsaid)
    };
    roles(&profile).flat_map(unsaid_of).collect()
}

/// A value with one thing changed in it, and what it was.
type Variant = (String, Value);

fn mutate(role: &str, value: &Value, variants: &mut Vec<Variant>) {
    let Value::Table(table) = value else { return };
    for (key, inner) in table {
        let mut changed = replacements(role, key, inner);
        // Within: what is wrong there is wrong here.
        mutate(role, inner, &mut changed);
        variants.extend(changed.into_iter().map(|(change, inner)| {
            let mut table = table.clone();
            table.insert(key.clone(), inner);
            (format!("{key}: {change}"), Value::Table(table))
        }));
    }
}

/// What may wrongly be in a key's place.
fn replacements(role: &str, key: &str, value: &Value) -> Vec<Variant> {
    let others = |all: &[&str]| -> Vec<Variant> {
        let others = all.iter().filter(|&&other| value.as_str() != Some(other));
        others
            .map(|&other| (format!("{other} for {value}"), Value::from(other)))
            .collect()
    };
    let number = |other: i64| vec![(format!("{other} for {value}"), Value::from(other))];
    match (key, value) {
        ("convention", _) => others(&["frd-ned", "flu-enu"]),
        ("frame", _) if role == "position" => others(&["ned", "enu"]),
        ("frame", _) => others(&["ned", "enu", "body-frd", "body-flu"]),
        ("reference", _) => others(&["earth", "heading", "airframe"]),
        ("order", _) => others(&["wxyz", "xyzw"]),
        ("positive", _) => others(&["up", "down"]),
        ("unit" | "altitude_unit", Value::String(unit)) => match unit.as_str() {
            unit if ANGLES.contains(&unit) => others(&ANGLES),
            unit if LENGTHS.contains(&unit) => others(&LENGTHS),
            unit if TIMES.contains(&unit) => others(&TIMES),
            _ => others(&SPEEDS),
        },
        ("says" | "contains", _) => others(&["another frame"]),
        ("is_integer", Value::Boolean(truth)) => {
            vec![("the opposite".to_owned(), Value::from(!truth))]
        }
        ("ignore_frame_ids", _) => vec![("heeded".to_owned(), Value::from(false))],
        ("is", Value::Integer(1)) => number(2),
        ("is", _) => number(1),
        ("has_bits", Value::Integer(32)) => number(80),
        ("has_bits", _) => number(32),
        ("valid", Value::Array(fields)) => without_each(fields),
        // A message's numbers, with the scalar part taken from the wrong place.
        ("quaternion", Value::String(field)) => {
            let fields = ["x", "y", "z", "w"].map(|name| format!("{field}.{name}"));
            vec![(
                "x-first for w-first".to_owned(),
                Value::from(fields.to_vec()),
            )]
        }
        ("euler", Value::Table(angles)) => {
            let mut swapped = angles.clone();
            swapped.insert("roll".to_owned(), angles["pitch"].clone());
            swapped.insert("pitch".to_owned(), angles["roll"].clone());
            vec![("roll for pitch".to_owned(), Value::Table(swapped))]
        }
        _ => Vec::new(),
    }
}

/// A list without each of its elements in turn.
fn without_each(fields: &[Value]) -> Vec<Variant> {
    let without = |place: usize| {
        let mut rest = fields.to_vec();
        let missing = rest.remove(place);
        (format!("without {missing}"), Value::Array(rest))
    };
    (0..fields.len()).map(without).collect()
}
