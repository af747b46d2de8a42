//! Which topics could have what a profile looks for by its fields, so that only their schemas are parsed.
//!
//! A schema names its fields, in whatever encoding, so a field of which the name is nowhere in it is not there. That is
//! found out in one pass over a schema for all profiles.

use std::{
    cell::OnceCell,
    collections::{BTreeMap, HashSet},
};

use mcap::records::Channel;
use serde_json::Value;

use super::LogSearch;
use crate::{
    decode::{FirstMessages, path::PathStep, schema::MessageSchema},
    log::ReadError,
    sample::Kind,
    source::{
        profile::{Alternative, Profile},
        request::Request,
    },
};

/// A name of 48 bytes or more may have its length before it, in protobuf's descriptors, as a byte that looks like a part of it.
const LONGEST_WORD: usize = 47;

/// The words by which the profiles that are tried know attitudes, in the schemas and first messages of a log's channels.
#[derive(Debug)]
pub struct Words<'a> {
    request: &'a Request,
    /// Those that each channel has. They are looked for once, when the first profile goes by what messages have.
    found: OnceCell<BTreeMap<u16, HashSet<String>>>,
}

impl<'a> Words<'a> {
    /// Those of the profiles that this request has tried.
    pub fn wanted_by(request: &'a Request) -> Self {
        Self {
            request,
            found: OnceCell::new(),
        }
    }

    fn wanted(&self) -> HashSet<String> {
        let profiles = self.request.profiles();
        let alternatives = profiles.iter().flat_map(|adapted| {
            let given = adapted.profile.alternatives(Kind::Attitude);
            given.iter().chain(adapted.attitude())
        });
        let words = alternatives.flat_map(names_of).flat_map(words_in);
        words.map(str::to_owned).collect()
    }
}

/// How much of what a profile looks for a topic has at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Prospect {
    /// Nothing.
    Hopeless,
    /// A part of it, which is worth saying if nothing else is found.
    Partial,
    /// All of it, by the names of its fields.
    Possible,
}

impl LogSearch<'_> {
    /// How much of a profile's attitude the messages of a topic have at most.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn prospect(&self, profile: &Profile, topic: &str) -> Result<Prospect, ReadError> {
        let mut best = Prospect::Hopeless;
        for channel in &self.topics[topic] {
            for alternative in profile.alternatives(Kind::Attitude) {
                best = best.max(self.prospect_of(alternative, channel)?);
            }
        }
        Ok(best)
    }

    fn prospect_of(
        &self,
        alternative: &Alternative,
        channel: &Channel,
    ) -> Result<Prospect, ReadError> {
        let schema = self.log.contents.schema_of(channel);
        if !MessageSchema::is_supported(channel, schema) {
            // What such messages have is not known, and the user should hear that.
            return Ok(Prospect::Possible);
        }
        if !alternative.location.is_for(self.schema_name(channel)) {
            return Ok(Prospect::Hopeless);
        }
        let found = self.words_of(channel.id)?;
        if self.examples.fault_of(channel.id).is_some() {
            return Ok(Prospect::Possible);
        }
        let is_there = |name: &str| {
            let has = |word: &str| found.is_some_and(|found| found.contains(word));
            name.len() > LONGEST_WORD || words_in(name).all(has)
        };
        let names = names_of(alternative);
        let (there, missing): (Vec<&str>, Vec<&str>) = names.partition(|name| is_there(name));
        Ok(match (there.is_empty(), missing.is_empty()) {
            (_, true) => Prospect::Possible,
            (true, false) => Prospect::Hopeless,
            (false, false) => Prospect::Partial,
        })
    }

    fn words_of(&self, channel_id: u16) -> Result<Option<&HashSet<String>>, ReadError> {
        let found = match self.words.found.get() {
            Some(found) => found,
            None => {
                let wanted = self.words.wanted();
                let channels = self.topics.values().flatten();
                let found = channels
                    .map(|channel| Ok((channel.id, self.find_words(channel, &wanted)?)))
                    .collect::<Result<_, ReadError>>()?;
                self.words.found.get_or_init(|| found)
            }
        };
        Ok(found.get(&channel_id))
    }

    fn find_words(
        &self,
        channel: &Channel,
        wanted: &HashSet<String>,
    ) -> Result<HashSet<String>, ReadError> {
        let schema = self.log.contents.schema_of(channel);
        let data = schema.map_or(&[][..], |schema| schema.data());
        let of_schema = data.split(|byte| !is_part_of_a_word(*byte));
        let of_schema = of_schema.filter_map(|word| std::str::from_utf8(word).ok());
        let messages = match FirstMessages::tell_the_fields_of(channel) {
            true => self.examples.of(channel.id)?,
            false => &[],
        };
        let fields = messages.iter().filter_map(Value::as_object);
        let names = fields.flat_map(|fields| fields.keys());
        let words = of_schema.chain(names.flat_map(|name| words_in(name)));
        let words = words.filter(|word| wanted.contains(*word));
        Ok(words.map(str::to_owned).collect())
    }
}

/// The names without which an alternative reads nothing: those of its outermost fields or, if it knows its messages by filters,
/// of those that they compare.
fn names_of(alternative: &Alternative) -> impl Iterator<Item = &str> {
    let filters = alternative
        .location
        .select
        .iter()
        .map(|filter| &filter.field);
    let fields = match alternative.location.select.is_empty() {
        true => alternative.fields.fields(),
        false => filters.collect(),
    };
    fields
        .into_iter()
        .filter_map(|field| match field.steps().first() {
            Some(PathStep::Name(name)) => Some(name.as_str()),
            _ => None,
        })
}

/// The words that a name is made of, which stand by themselves in a schema that has it.
fn words_in(name: &str) -> impl Iterator<Item = &str> {
    let words = name.split(|c: char| !c.is_ascii() || !is_part_of_a_word(c as u8));
    words.filter(|word| !word.is_empty())
}

fn is_part_of_a_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}
