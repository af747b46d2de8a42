//! The parts of an argument: paths of one topic, and words after colons.

use std::str::FromStr;

use serde::de::{DeserializeOwned, IntoDeserializer, value::Error as NotOneOf};

use super::BadArgument;
use crate::{
    decode::path::{FieldPath, MessagePath},
    sample::Kind,
};

/// The parts of an argument: the topic, its fields, and the words after the colons.
pub struct Parts {
    pub topic: String,
    pub fields: Vec<FieldPath>,
    pub words: Words,
}

/// Units and conventions that have not been used yet.
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

    /// Whether one of these words is there.
    pub fn has(&self, group: &[&str]) -> bool {
        self.0.iter().any(|word| group.contains(&word.as_str()))
    }

    /// Rejects unknown words.
    pub fn check(&self, known: Vocabulary) -> Result<(), BadArgument> {
        let is_unknown = |word: &&String| !known.iter().any(|group| group.contains(&word.as_str()));
        match self.0.iter().find(is_unknown) {
            None => Ok(()),
            Some(word) => Err(BadArgument::UnknownWord {
                word: word.into(),
                known,
            }),
        }
    }

    /// Rejects unused words.
    pub fn finish(self) -> Result<(), BadArgument> {
        match self.0.into_iter().next() {
            None => Ok(()),
            Some(word) => Err(BadArgument::LeftOver { word: word.into() }),
        }
    }
}

/// The words that an argument can have, at most one from each group.
pub type Vocabulary = &'static [&'static [&'static str]];

const ANGLE_UNITS: &[&str] = &["radians", "degrees", "centidegrees"];
const QUATERNION_ORDERS: &[&str] = &["wxyz", "xyzw"];
pub const REFERENCES: &[&str] = &["earth", "heading", "airframe"];
const CONVENTIONS: &[&str] = &["frd-ned", "flu-enu"];
pub const TIME_UNITS: Vocabulary = &[&["s", "ms", "us", "ns"]];

/// The words that a role's argument can have.
pub fn vocabulary(role: Kind) -> Vocabulary {
    match role {
        Kind::Attitude => &[ANGLE_UNITS, QUATERNION_ORDERS, CONVENTIONS],
        Kind::Velocity => &[
            &["ned", "enu", "body-frd", "body-flu"],
            &["m/s", "cm/s", "mm/s"],
        ],
        Kind::Gimbal => &[
            ANGLE_UNITS,
            &["up", "down"],
            QUATERNION_ORDERS,
            REFERENCES,
            CONVENTIONS,
        ],
        Kind::Position => &[
            &["radians", "degrees", "degE7"],
            &["ned", "enu"],
            &["m", "cm", "mm"],
        ],
    }
}

impl FromStr for Parts {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let mut words = split_outside_quotes(text, ':').into_iter();
        let paths = words.next().unwrap_or_default();
        let mut topic: Option<String> = None;
        let mut fields = Vec::new();
        for path in split_outside_quotes(paths, ',') {
            let path: MessagePath = path.trim().parse()?;
            match topic {
                Some(first) if first != path.topic => {
                    return Err(BadArgument::SeveralTopics {
                        topics: [first.into(), path.topic.into()],
                    });
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

/// Splits at a separator, but not within double quotes: topics there may have characters that mean something elsewhere.
fn split_outside_quotes(text: &str, separator: char) -> Vec<&str> {
    let mut is_quoted = false;
    text.split(|character| {
        is_quoted ^= character == '"';
        character == separator && !is_quoted
    })
    .collect()
}
