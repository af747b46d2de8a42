//! Which of several sources on a topic is the primary one, where messages on another topic say so.

use std::{collections::BTreeMap, ops::ControlFlow};

use super::LogSearch;
use crate::{
    decode::{
        field::{Shape, Wanted},
        path::{Comparison, Filter, Literal},
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
        let mut known: Vec<(Primary, Option<Filter>)> = Vec::new();
        for kind in Kind::ALL {
            for alternative in profile.alternatives_mut(kind) {
                let Some(primary) = &alternative.location.primary else {
                    continue;
                };
                let filter = match known.iter().find(|(one, _)| one == primary) {
                    Some((_, filter)) => filter.clone(),
                    None => {
                        let number = self.most_named(primary)?;
                        let filter = number.map(|number| Filter {
                            field: primary.among.clone(),
                            comparison: Comparison::Equal,
                            value: Literal::Number(number.into()),
                        });
                        known.push((primary.clone(), filter.clone()));
                        filter
                    }
                };
                alternative.location.select.extend(filter);
            }
        }
        Ok(())
    }

    /// The number that most messages have in a field; `None` if none has any.
    fn most_named(&self, primary: &Primary) -> Result<Option<i64>, ReadError> {
        let patterns: Vec<Pattern> = primary
            .topics
            .iter()
            .map(|topic| Pattern::new("", topic))
            .collect();
        let is_meant = |topic: &str| patterns.iter().any(|pattern| pattern.is_match(topic));
        let channels = self.topics.iter().filter(|(topic, _)| is_meant(topic));
        let mut counts: BTreeMap<i64, u64> = BTreeMap::new();
        let mut seen = 0;
        for channel in channels.flat_map(|(_, channels)| channels) {
            let wanted = Wanted {
                path: primary.field.clone(),
                shape: Shape::Number,
            };
            let Ok(schema) = self.schema(channel) else {
                continue;
            };
            let Ok((decoder, mut slots)) = schema.decoder(&[wanted]) else {
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
}
