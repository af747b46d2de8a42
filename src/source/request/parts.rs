//! The parts of an argument: paths of one topic, and words after colons.

use std::str::FromStr;

use serde::de::{DeserializeOwned, IntoDeserializer, value::Error as NotOneOf};

use super::BadArgument;
use crate::{
    decode::path::{FieldPath, Filter, MessagePath, split},
    sample::Kind,
    source::profile::convention::{Axes, BodyAxes, Convention, NotAConvention, WorldAxes},
};

/// The parts of an argument: the topic, which of its messages, their fields, and the words after the colons.
pub struct Parts {
    pub topic: String,
    /// What the messages must satisfy.
    pub filters: Vec<Filter>,
    /// Whether the topic was in quotes anywhere.
    pub quoted: bool,
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
    pub fn has(&self, group: Group) -> bool {
        self.0.iter().any(|word| group.has(word))
    }

    /// Rejects unknown words.
    pub fn check(&self, known: Vocabulary) -> Result<(), BadArgument> {
        let is_unknown = |word: &&String| !known.iter().any(|group| group.has(word));
        match self.0.iter().find(is_unknown) {
            None => Ok(()),
            Some(word) => Err(match word.parse::<Convention>() {
                Err(problem @ NotAConvention::LeftHanded { .. }) => {
                    BadArgument::Convention(problem)
                }
                _ => BadArgument::UnknownWord {
                    word: word.into(),
                    known: known.iter().map(|group| group.words).collect(),
                },
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
pub type Vocabulary = &'static [Group];

/// Words of which an argument has at most one.
#[derive(Debug, Clone, Copy)]
pub struct Group {
    /// All of them, or the usual ones.
    pub words: &'static [&'static str],
    /// Whether others belong to them too.
    others: fn(&str) -> bool,
}

impl Group {
    const fn of(words: &'static [&'static str]) -> Self {
        Self {
            words,
            others: |_| false,
        }
    }

    fn has(&self, word: &str) -> bool {
        self.words.contains(&word) || (self.others)(word)
    }
}

const ANGLE_UNITS: Group = Group::of(&["radians", "degrees", "centidegrees"]);
const QUATERNION_ORDERS: Group = Group::of(&["wxyz", "xyzw"]);
const EULER_ORDERS: Group = Group::of(&[
    "yaw-pitch-roll",
    "yaw-roll-pitch",
    "pitch-yaw-roll",
    "pitch-roll-yaw",
    "roll-yaw-pitch",
    "roll-pitch-yaw",
]);
pub const REFERENCES: Group = Group::of(&["earth", "heading", "airframe"]);
const CONVENTIONS: Group = Group {
    words: &["frd-ned", "flu-enu"],
    others: |word| word.parse::<Convention>().is_ok(),
};
const AXES: Group = Group {
    words: &["ned", "enu", "neu", "body-frd", "body-flu"],
    others: |word| word.parse::<Axes>().is_ok(),
};
const WORLD_AXES: Group = Group {
    words: &["ned", "enu"],
    others: |word| word.parse::<WorldAxes>().is_ok(),
};
const BODY_AXES: Group = Group {
    words: &["frd", "flu"],
    others: |word| word.parse::<BodyAxes>().is_ok(),
};
const RATE_UNITS: Group = Group::of(&["rad/s", "deg/s"]);
const ACCELERATION_UNITS: Group = Group::of(&["m/s2", "g"]);
const SPEED_UNITS: Group = Group::of(&["m/s", "cm/s", "mm/s"]);
const DIRECTIONS: Group = Group::of(&["up", "down"]);
const GLOBE_UNITS: Group = Group::of(&["radians", "degrees", "degE7"]);
const LENGTH_UNITS: Group = Group::of(&["m", "cm", "mm"]);
pub const TIME_UNITS: Vocabulary = &[Group::of(&["s", "ms", "us", "ns"])];

/// The words that a role's argument can have.
pub fn vocabulary(role: Kind) -> Vocabulary {
    match role {
        Kind::Attitude => &[ANGLE_UNITS, EULER_ORDERS, QUATERNION_ORDERS, CONVENTIONS],
        Kind::Velocity => &[AXES, SPEED_UNITS],
        Kind::Gimbal => &[
            ANGLE_UNITS,
            DIRECTIONS,
            EULER_ORDERS,
            QUATERNION_ORDERS,
            REFERENCES,
            CONVENTIONS,
        ],
        Kind::Position => &[GLOBE_UNITS, WORLD_AXES, LENGTH_UNITS],
        Kind::Height => &[LENGTH_UNITS],
        Kind::AngularRate => &[BODY_AXES, RATE_UNITS],
        Kind::Acceleration => &[BODY_AXES, ACCELERATION_UNITS],
    }
}

impl FromStr for Parts {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let mut words = split(text, ':').into_iter();
        let mut paths = split(words.next().unwrap_or_default(), ',').into_iter();
        let first: MessagePath = paths.next().unwrap_or_default().trim().parse()?;
        let mut fields: Vec<FieldPath> = first.field.into_iter().collect();
        let mut quoted = first.quoted;
        for path in paths {
            let path: MessagePath = path.trim().parse()?;
            if path.topic != first.topic {
                return Err(BadArgument::SeveralTopics {
                    topics: [first.topic.into(), path.topic.into()],
                });
            }
            if path.filters != first.filters {
                return Err(BadArgument::SeveralSelections {
                    topic: first.topic.into(),
                });
            }
            quoted |= path.quoted;
            fields.extend(path.field);
        }
        Ok(Self {
            topic: first.topic,
            filters: first.filters,
            quoted,
            fields,
            words: Words(words.map(str::to_owned).collect()),
        })
    }
}
