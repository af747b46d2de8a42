//! The sources that a channel's messages come from, by the fields that tell them apart.

use crate::{
    decode::{path::Literal, value::FieldValue},
    source::bind::BoundId,
};

/// A field that takes more values than this does not tell sources apart: it counts something.
const MOST_SOURCES: usize = 16;

/// The values of the fields that tell sources apart, in the messages that were read.
#[derive(Debug, Clone)]
pub struct SeenIds {
    /// For each of the fields, the values in the order in which they were seen.
    values: Vec<Vec<Literal>>,
    /// For each, which of them the last message had.
    last: Vec<usize>,
}

impl SeenIds {
    /// Begins with no value of any of these fields.
    pub fn new(ids: &[BoundId]) -> Self {
        Self {
            values: vec![Vec::new(); ids.len()],
            last: vec![0; ids.len()],
        }
    }

    /// Notes the source of a message.
    pub fn note(&mut self, ids: &[BoundId], values: &[FieldValue]) {
        for ((id, known), last) in ids.iter().zip(&mut self.values).zip(&mut self.last) {
            let value = &values[id.slot];
            if known.get(*last).is_some_and(|known| known.equals(value)) {
                continue;
            }
            let place = known.iter().position(|known| known.equals(value));
            *last = place.unwrap_or_else(|| {
                if known.len() <= MOST_SOURCES {
                    known.extend(Literal::of(value));
                }
                known.len().saturating_sub(1)
            });
        }
    }

    /// Adds what a clone has seen in other messages.
    pub fn merge(&mut self, clone: &Self) {
        for (known, more) in self.values.iter_mut().zip(&clone.values) {
            for id in more {
                if !known.contains(id) && known.len() <= MOST_SOURCES {
                    known.push(id.clone());
                }
            }
        }
    }

    /// The first field that had several values, by its place among the fields, and these.
    pub fn several(&self) -> Option<(usize, &[Literal])> {
        let several = 2..=MOST_SOURCES;
        let mut fields = self.values.iter().enumerate();
        fields
            .find(|(_, values)| several.contains(&values.len()))
            .map(|(place, values)| (place, values.as_slice()))
    }
}
