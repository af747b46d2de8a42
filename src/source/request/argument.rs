//! The parts of an argument that tells a role's place: paths, and words behind colons.

use std::str::FromStr;

use serde::de::{DeserializeOwned, IntoDeserializer, value::Error as NotOneOf};

use super::BadArgument;
use crate::decode::path::{FieldPath, MessagePath};
use crate::source::profile::{Components, Euler, Place, Quaternion, convention::AngleUnit};

/// The parts of an argument: the topic, its fields, and the words behind the colons.
pub struct Parts {
    pub topic: String,
    pub fields: Vec<FieldPath>,
    pub words: Words,
}

/// Units and conventions that were not used yet.
pub struct Words(pub Vec<String>);

impl Words {
    /// Takes the word that names one of a type's variants, as profiles name them.
    pub fn take<T: DeserializeOwned>(&mut self) -> Option<T> {
        let read = |word: &String| {
            let word: serde::de::value::StrDeserializer<NotOneOf> =
                word.as_str().into_deserializer();
            T::deserialize(word).ok()
        };
        let place = self.0.iter().position(|word| read(word).is_some())?;
        read(&self.0.remove(place))
    }

    /// Complains of what is not among the known words.
    pub fn check(&self, known: Vocabulary) -> Result<(), BadArgument> {
        let is_unknown = |word: &&String| !known.iter().any(|group| group.contains(&word.as_str()));
        match self.0.iter().find(is_unknown) {
            None => Ok(()),
            Some(word) => Err(BadArgument(format!(
                "`{word}` has no meaning here; what can stand behind a colon is {}",
                in_words(known)
            ))),
        }
    }

    /// Complains of what was not used.
    pub fn finish(self) -> Result<(), BadArgument> {
        match self.0.first() {
            None => Ok(()),
            Some(word) => Err(BadArgument(format!(
                "`{word}` does not go with the rest of the argument"
            ))),
        }
    }
}

/// The words that an argument can have; of each group one.
pub type Vocabulary = &'static [&'static [&'static str]];

pub const ANGLE_UNITS: &[&str] = &["radians", "degrees", "centidegrees"];
pub const QUATERNION_ORDERS: &[&str] = &["wxyz", "xyzw"];
pub const REFERENCES: &[&str] = &["earth", "heading", "airframe"];
pub const CONVENTIONS: &[&str] = &["frd-ned", "flu-enu"];

fn in_words(vocabulary: Vocabulary) -> String {
    let groups = vocabulary.iter().map(|group| match group {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        group => group.concat(),
    });
    groups.collect::<Vec<_>>().join("; ")
}

impl FromStr for Parts {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let mut words = split_outside_quotes(text, ':').into_iter();
        let paths = words.next().unwrap_or_default();
        let mut topic: Option<String> = None;
        let mut fields = Vec::new();
        for path in split_outside_quotes(paths, ',') {
            let path: MessagePath =
                (path.trim().parse()).map_err(|error| BadArgument(format!("{error}")))?;
            match &topic {
                Some(first) if *first != path.topic => {
                    return Err(BadArgument(format!(
                        "{first} and {} are different topics; every path begins with its topic (/imu.roll,/imu.pitch), \
                         and what belongs to one sample must come in one message",
                        path.topic
                    )));
                }
                _ => topic = Some(path.topic),
            }
            fields.extend(path.field);
        }
        Ok(Self {
            topic: topic.unwrap_or_default(),
            fields,
            words: Words(words.map(str::to_owned).collect()),
        })
    }
}

/// Topics in double quotes may have characters that have a meaning elsewhere.
fn split_outside_quotes(text: &str, separator: char) -> Vec<&str> {
    let mut is_quoted = false;
    text.split(|character| {
        is_quoted ^= character == '"';
        character == separator && !is_quoted
    })
    .collect()
}

impl Parts {
    pub fn place(&self) -> Place {
        Place {
            topics: vec![self.topic.clone()],
            ..Place::default()
        }
    }

    /// The only field, or as many as there are components.
    pub fn components<const N: usize>(&self, what: &str) -> Result<Components<N>, BadArgument> {
        let count = self.fields.len();
        let wrong = |_| BadArgument(format!("{count} fields were given, but {what}"));
        Components::of(&self.fields).map_err(wrong)
    }

    pub fn euler(&mut self, unit: AngleUnit) -> Option<Euler> {
        let [roll, pitch, yaw] = self.fields.as_slice() else {
            return None;
        };
        Some(Euler {
            roll: roll.clone(),
            pitch: pitch.clone(),
            yaw: yaw.clone(),
            unit,
        })
    }

    pub fn quaternion(&mut self, what: &str) -> Result<Quaternion, BadArgument> {
        Ok(Quaternion {
            fields: self.components(what)?,
            order: self.words.take().unwrap_or_default(),
        })
    }
}
