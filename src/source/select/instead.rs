//! Finding what a log has instead of what was looked for.

use std::{cmp::Reverse, collections::BTreeSet};

use mcap::records::Channel;

use super::LogSearch;
use crate::{
    decode::{path::FieldPath, schema::MessageSchema},
    sample::Kind,
    similar,
    source::{
        bind::{Binder, ChannelName},
        error::{Candidate, Instead, LogTopic, Misfit, OtherTopics, PathReading},
        profile::{Alternative, Profile},
        request::RoleArgument,
    },
    text::Foreign,
};

/// How many topics an error lists as candidates at most, and how many others.
const LISTED: usize = 8;

impl LogSearch<'_> {
    /// What the log has instead of the role that was requested of it in vain.
    pub fn instead_of_request(&self, role: Kind, misfit: &Misfit) -> Instead {
        let requested = match self.requested.get(&role) {
            Some(RoleArgument::Fields(alternative)) => Some(&**alternative),
            _ => None,
        };
        let mut instead = self.instead_of(role, misfit, requested);
        instead.readings = requested.map_or_else(Vec::new, |one| self.longer_readings(one));
        instead
    }

    /// What the log has instead of what a profile names in vain.
    pub fn instead_of_profile(&self, profile: &Profile, misfit: &Misfit) -> Instead {
        let role = role_of(profile, misfit);
        let alternatives = profile.alternatives(role);
        let mut instead = self.instead_of(role, misfit, alternatives.first());
        let readings = alternatives
            .iter()
            .flat_map(|one| self.longer_readings(one));
        instead.readings = readings.collect();
        instead
    }

    /// What the log has instead of an attitude that any profile knows.
    pub fn instead_of_any(&self) -> Instead {
        self.instead(Kind::Attitude, Vec::new(), None)
    }

    /// What the log has instead of a namespace.
    pub fn instead_of_namespace(&self, namespace: &str) -> Instead {
        let slashes = |topic: &str| -> Vec<usize> {
            topic.match_indices('/').map(|(place, _)| place).collect()
        };
        let namespaces: BTreeSet<&str> = (self.topics.keys())
            .flat_map(|topic| slashes(topic).into_iter().map(|end| &topic[..end]))
            .filter(|namespace| !namespace.is_empty())
            .collect();
        let meant = similar::topics(namespace, namespaces);
        self.instead(Kind::Attitude, meant, None)
    }

    fn instead_of(&self, role: Kind, misfit: &Misfit, looked_for: Option<&Alternative>) -> Instead {
        let meant = match misfit {
            Misfit::Messages(misfit) if !misfit.is_of_schema() => {
                return Instead {
                    meant: Vec::new(),
                    readings: Vec::new(),
                    role,
                    candidates: Vec::new(),
                    others: OtherTopics::Beside,
                };
            }
            Misfit::NoMessages { topics } => {
                let first = topics.first().map_or("", |topic| topic.as_str());
                similar::topics(first, self.topics.keys().copied())
            }
            _ => Vec::new(),
        };
        self.instead(role, meant, looked_for)
    }

    fn instead(&self, role: Kind, meant: Vec<&str>, looked_for: Option<&Alternative>) -> Instead {
        let profiles = Profile::built_in();
        let known = profiles
            .iter()
            .flat_map(|profile| profile.alternatives(role));
        let alternatives: Vec<&Alternative> = looked_for.into_iter().chain(known).collect();
        let mut candidates: Vec<(usize, Reverse<u64>, Candidate)> = Vec::new();
        let mut others = Vec::new();
        let mut seen = BTreeSet::new();
        for (channel, count) in self.log.contents.channels_with_messages() {
            if !seen.insert(channel.topic.as_str()) {
                continue;
            }
            let topic = self.log_topic(channel);
            match self.first_that_fits(channel, &alternatives) {
                Some((place, fields)) => {
                    // What was looked for comes first, then what was likely meant.
                    let place = match (looked_for.is_some() && place == 0, &meant) {
                        (true, _) => 0,
                        (false, meant) if meant.contains(&channel.topic.as_str()) => 1,
                        _ => 2,
                    };
                    candidates.push((place, Reverse(count), Candidate { topic, fields }));
                }
                None => others.push(topic),
            }
        }
        candidates
            .sort_by(|(a, m, one), (b, n, other)| (a, m, &one.topic).cmp(&(b, n, &other.topic)));
        let unlisted = candidates.split_off(candidates.len().min(LISTED));
        others.extend(unlisted.into_iter().map(|(_, _, one)| one.topic));
        others.sort();
        Instead {
            meant: meant.into_iter().map(Foreign::from).collect(),
            readings: Vec::new(),
            role,
            candidates: candidates.into_iter().map(|(_, _, one)| one).collect(),
            others: match others.len() {
                0..=LISTED => OtherTopics::Listed(others),
                count => OtherTopics::Counted(count),
            },
        }
    }

    fn log_topic(&self, channel: &Channel) -> LogTopic {
        let schema = self.log.contents.schema_of(channel);
        LogTopic {
            topic: (&channel.topic).into(),
            message_encoding: (&channel.message_encoding).into(),
            schema: schema.map(|schema| schema.name.as_str().into()),
        }
    }

    /// The place of the first alternative whose fields a channel's messages have, and the fields.
    fn first_that_fits(
        &self,
        channel: &Channel,
        alternatives: &[&Alternative],
    ) -> Option<(usize, Vec<FieldPath>)> {
        let name = ChannelName {
            topic: &channel.topic,
            schema: self.schema_name(channel),
        };
        // More of them may show more fields, but a stream does not keep more of all channels.
        let examples = self.first_messages(channel).ok()?;
        let schema = self.log.contents.schema_of(channel);
        let schema = MessageSchema::of(channel, schema, &examples, self.proof).ok()?;
        let fits = |alternative: &&Alternative| {
            let mut binder = Binder::new(&schema, name);
            alternative.location.is_for(name.schema)
                && binder
                    .attempt(|binder| binder.role(&alternative.fields))
                    .is_ok()
        };
        let place = alternatives.iter().position(fits)?;
        let fields = alternatives[place].fields.fields();
        Some((place, fields.into_iter().cloned().collect()))
    }

    /// What the paths of an alternative also mean in this log, if they have no quotes: those readings whose topics have
    /// messages.
    fn longer_readings(&self, alternative: &Alternative) -> Vec<PathReading> {
        let mut readings = alternative.longer_readings();
        readings.retain(|reading| self.topics.contains_key(reading.topic.as_str()));
        readings
    }

    /// What the paths of an alternative mean in this log, if they mean several things that all can be read.
    pub fn ambiguous_readings(&self, alternative: &Alternative) -> Option<Vec<PathReading>> {
        let longer = self.longer_readings(alternative);
        if longer.is_empty() {
            return None;
        }
        let [topic] = &alternative.location.topics[..] else {
            return None;
        };
        let fields = alternative.fields.fields().into_iter().cloned().collect();
        let topic = topic.into();
        let mut readings = vec![PathReading { topic, fields }];
        readings.extend(longer);
        readings.retain(|reading| self.can_be_read(reading));
        (readings.len() > 1).then_some(readings)
    }

    /// Whether the messages on a topic have the fields.
    fn can_be_read(&self, reading: &PathReading) -> bool {
        let channels = self.topics.get(reading.topic.as_str());
        let mut channels = channels.into_iter().flatten();
        channels.any(|channel| {
            let schema = self.schema(channel);
            let has = |field| {
                schema
                    .as_ref()
                    .is_ok_and(|schema| schema.kind_of(field).is_ok())
            };
            reading.fields.iter().all(has)
        })
    }
}

/// The role of a profile that a misfit is about.
fn role_of(profile: &Profile, misfit: &Misfit) -> Kind {
    let named = match misfit {
        Misfit::NoMessages { topics } => topics.first(),
        Misfit::Condition { role, .. } => return *role,
        Misfit::Messages(misfit) => Some(&misfit.topic),
        _ => None,
    };
    let is_about = |kind: &Kind| {
        let alternatives = profile.alternatives(*kind).iter();
        let mut topics = alternatives.flat_map(|one| &one.location.topics);
        // In whatever namespace.
        topics.any(|topic| named.is_some_and(|named| named.ends_with(topic.as_str())))
    };
    Kind::LISTED
        .into_iter()
        .find(is_about)
        .unwrap_or(Kind::Attitude)
}
