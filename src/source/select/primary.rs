//! Which of several sources on a topic is the primary one, where messages on another topic say so.

use std::{collections::BTreeMap, ops::ControlFlow};

use mcap::records::Channel;

use super::LogSearch;
use crate::{
    decode::{
        field::{Shape, Wanted},
        path::{Comparison, FieldPath, Filter, Literal},
        schema::MessageDecoder,
        value::Slots,
    },
    log::ReadError,
    sample::Kind,
    source::{
        pattern::Pattern,
        profile::{Primary, Profile},
    },
};

/// How many messages are looked at, and in how many segments: an estimator changes its lane seldom.
const MESSAGES: u64 = 10_000;
const SEGMENTS: usize = 100;

impl LogSearch<'_> {
    /// Has the alternatives that read a primary source select the one that most messages of the log name.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn settle_primaries(&self, profile: &mut Profile) -> Result<(), ReadError> {
        let mut known: Vec<(Primary, Option<i64>)> = Vec::new();
        for kind in Kind::ALL {
            for alternative in profile.alternatives_mut(kind) {
                let Some(primary) = &alternative.location.primary else {
                    continue;
                };
                let number = match known.iter().find(|(one, _)| one == primary) {
                    Some((_, number)) => *number,
                    None => {
                        let number = self.most_named(primary)?;
                        known.push((primary.clone(), number));
                        number
                    }
                };
                // Messages of the only source that is recorded, the first one, need not have its number.
                let has_number = |&number: &i64| {
                    number != 0 || self.any_has(&alternative.location.topics, &primary.among)
                };
                let filter = number.filter(has_number).map(|number| Filter {
                    field: primary.among.clone(),
                    comparison: Comparison::Equal,
                    value: Literal::Number(number.into()),
                });
                alternative.location.select.extend(filter);
            }
        }
        Ok(())
    }

    /// The number that most messages have in a field; `None` if none has any.
    fn most_named(&self, primary: &Primary) -> Result<Option<i64>, ReadError> {
        let mut counts: BTreeMap<i64, u64> = BTreeMap::new();
        let mut seen = 0;
        for channel in self.channels_on(&primary.topics) {
            let Some((decoder, mut slots)) = self.number(channel, &primary.field) else {
                continue;
            };
            self.log.visit_payloads(channel.id, SEGMENTS, |payload| {
                slots.clear();
                if decoder.decode(payload, &mut slots).is_ok()
                    && let Some(number) = slots.values[0].number()
                {
                    *counts.entry(number as i64).or_default() += 1;
                }
                seen += 1;
                match seen < MESSAGES {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(()),
                }
            })?;
        }
        let most = counts.into_iter().max_by_key(|(_, count)| *count);
        Ok(most.map(|(number, _)| number))
    }

    /// Whether messages on any of the topics have the field.
    fn any_has(&self, topics: &[String], field: &FieldPath) -> bool {
        let mut channels = self.channels_on(topics);
        channels.any(|channel| self.number(channel, field).is_some())
    }

    fn channels_on(&self, topics: &[String]) -> impl Iterator<Item = &Channel> {
        let patterns = topics.iter().map(|topic| Pattern::new("", topic));
        let patterns: Vec<Pattern> = patterns.collect();
        let is_meant = move |topic: &str| patterns.iter().any(|pattern| pattern.is_match(topic));
        let channels = self.topics.iter().filter(move |(topic, _)| is_meant(topic));
        channels.flat_map(|(_, channels)| channels.iter().copied())
    }

    /// How to read a number in the messages of a channel, if they have it.
    fn number(&self, channel: &Channel, field: &FieldPath) -> Option<(MessageDecoder, Slots)> {
        let wanted = Wanted {
            path: field.clone(),
            shape: Shape::Number,
        };
        self.schema(channel).ok()?.decoder(&[wanted]).ok()
    }
}
