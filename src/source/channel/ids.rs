//! The sources that a channel's messages come from, by the fields that tell them apart.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::{decode::value::FieldValue, source::bind::BoundId, text::Foreign};

/// A field that takes more values than this does not tell sources apart: it counts something.
const MOST_SOURCES: usize = 16;

/// The values of the fields that tell sources apart, in the messages that were read.
#[derive(Debug, Clone, Default)]
pub struct SeenIds {
    /// For each of the fields, the values in the order in which they were seen.
    values: Vec<Vec<Id>>,
    /// For each, which of them the last message had.
    last: Vec<usize>,
}

/// A value that identifies a source.
#[derive(Debug, Clone, PartialEq)]
pub enum Id {
    /// A number.
    Number(f64),
    /// A text.
    Text(Foreign),
}

impl SeenIds {
    /// Notes the source of a message.
    pub fn note(&mut self, ids: &[BoundId], values: &[FieldValue]) {
        self.values.resize(ids.len(), Vec::new());
        self.last.resize(ids.len(), 0);
        for ((id, known), last) in ids.iter().zip(&mut self.values).zip(&mut self.last) {
            let value = &values[id.slot];
            if known.get(*last).is_some_and(|known| known.is(value)) {
                continue;
            }
            let place = known.iter().position(|known| known.is(value));
            *last = place.unwrap_or_else(|| {
                if known.len() <= MOST_SOURCES {
                    known.extend(Id::of(value));
                }
                known.len().saturating_sub(1)
            });
        }
    }

    /// Adds what a clone has seen in other messages.
    pub fn merge(&mut self, clone: &Self) {
        self.values
            .resize(clone.values.len().max(self.values.len()), Vec::new());
        self.last.resize(self.values.len(), 0);
        for (known, more) in self.values.iter_mut().zip(&clone.values) {
            for id in more {
                if !known.contains(id) && known.len() <= MOST_SOURCES {
                    known.push(id.clone());
                }
            }
        }
    }

    /// The first field that had several values, by its place among the fields, and these.
    pub fn several(&self) -> Option<(usize, &[Id])> {
        let several = 2..=MOST_SOURCES;
        let mut fields = self.values.iter().enumerate();
        fields
            .find(|(_, values)| several.contains(&values.len()))
            .map(|(place, values)| (place, values.as_slice()))
    }
}

impl Id {
    fn of(value: &FieldValue) -> Option<Self> {
        let text = || {
            value
                .text()
                .map(|text| Self::Text(String::from_utf8_lossy(text).as_ref().into()))
        };
        value.number().map(Self::Number).or_else(text)
    }

    fn is(&self, value: &FieldValue) -> bool {
        match self {
            Self::Number(known) => value.number() == Some(*known),
            Self::Text(known) => value.text() == Some(known.as_str().as_bytes()),
        }
    }
}

/// As a selector in a path writes it.
impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => write!(f, "\"{text}\""),
        }
    }
}

impl Serialize for Id {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => number.serialize(serializer),
            Self::Text(text) => text.serialize(serializer),
        }
    }
}
