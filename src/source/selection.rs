//! Finding the telemetry of a log: which profile, and which of the log's channels.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Channel;

use super::{
    Source, Unresolved,
    channel::ChannelSource,
    examples::Examples,
    list,
    profile::{Profile, ProfileChoice},
};
use crate::{error::Error, log::Log, sample::Kind};

/// How many topics a message lists at most.
const LISTED: usize = 60;

/// Why a profile does not fit a log.
enum Misfit {
    /// In words.
    Lacking(String),
    /// More than one topic would do.
    Several(Vec<String>),
    /// The log could not be read.
    Unreadable(Error),
}

impl From<Error> for Misfit {
    fn from(error: Error) -> Self {
        Self::Unreadable(error)
    }
}

/// A topic and how to read each of its channels.
struct Bound {
    topic: String,
    channels: BTreeMap<u16, ChannelSource>,
}

impl Source {
    /// Finds the telemetry of a log.
    ///
    /// # Errors
    /// The profile does not fit the log, or none does; the message says what was looked for.
    pub fn select(log: &Log, choice: &ProfileChoice) -> Result<Self, Error> {
        let examples = Examples::new(log);
        let profiles = match choice {
            ProfileChoice::Given(profile) => {
                return fit(log, &examples, profile)
                    .map_err(|misfit| misfit.into_error(log, profile));
            }
            ProfileChoice::Automatic => Profile::built_in(),
        };
        let mut looked_for = String::new();
        for profile in profiles.iter().filter(|profile| profile.automatic) {
            match fit(log, &examples, profile) {
                Err(Misfit::Lacking(problem)) => {
                    looked_for.push_str(&format!("\n  {}: {problem}", profile.name));
                }
                found => return found.map_err(|misfit| misfit.into_error(log, profile)),
            }
        }
        Err(Error::NoTelemetry {
            path: log.file.path().into(),
            looked_for,
            topics: describe_topics(log),
        })
    }
}

impl Misfit {
    /// The error for a log that this profile, and no other, should fit.
    fn into_error(self, log: &Log, profile: &Profile) -> Error {
        let path = log.file.path().to_owned();
        match self {
            Self::Lacking(problem) => Error::ProfileDoesNotFit {
                path,
                profile: profile.name.clone(),
                problem: format!("{problem}\n{}", describe_topics(log)),
            },
            Self::Several(topics) => Error::SeveralTopicsFit { path, topics },
            Self::Unreadable(error) => error,
        }
    }
}

fn fit(log: &Log, examples: &Examples, profile: &Profile) -> Result<Source, Misfit> {
    let attitude_kinds: &[Kind] = match &profile.velocity {
        Some(velocity) if velocity.topics.is_empty() => &[Kind::Attitude, Kind::Velocity],
        _ => &[Kind::Attitude],
    };
    let attitude = match profile.attitude.topics.as_slice() {
        [] => find_by_fields(log, examples, profile, attitude_kinds)?,
        topics => {
            let topic = find_by_name(log, topics).ok_or_else(|| {
                Misfit::Lacking(format!("there is no message on {}", topics.join(" or ")))
            })?;
            bind(log, examples, profile, topic, attitude_kinds)?
        }
    };
    let mut channels = attitude.channels;
    let velocity_topic = match &profile.velocity {
        None => Err(format!("the profile `{}` has no velocity", profile.name)),
        Some(role) if role.topics.is_empty() => Ok(attitude.topic.clone()),
        Some(role) => match find_by_name(log, &role.topics) {
            Some(topic) if topic == attitude.topic => {
                let both = [Kind::Attitude, Kind::Velocity];
                channels = bind(log, examples, profile, topic, &both)?.channels;
                Ok(attitude.topic.clone())
            }
            Some(topic) => {
                let velocity = bind(log, examples, profile, topic, &[Kind::Velocity])?;
                channels.extend(velocity.channels);
                Ok(velocity.topic)
            }
            None => Err(format!(
                "there is no message on {}",
                role.topics.join(" or ")
            )),
        },
    };
    Ok(Source {
        attitude_topic: attitude.topic,
        velocity_topic,
        channels,
        profile: profile.clone(),
    })
}

/// The first of the topics that has messages.
fn find_by_name<'a>(log: &Log, topics: &'a [String]) -> Option<&'a str> {
    let has_messages =
        |topic: &&String| channels_with_messages(log).any(|channel| channel.topic == **topic);
    topics.iter().find(has_messages).map(String::as_str)
}

/// The one topic whose messages have all of the fields.
fn find_by_fields(
    log: &Log,
    examples: &Examples,
    profile: &Profile,
    kinds: &[Kind],
) -> Result<Bound, Misfit> {
    let fields = profile.required_fields(kinds);
    let topics: BTreeSet<&str> = channels_with_messages(log)
        .map(|channel| channel.topic.as_str())
        .collect();
    let mut fitting: Vec<Bound> = Vec::new();
    let mut nearest = (fields.len(), String::new());
    for topic in topics {
        match resolve(log, examples, profile, topic, kinds) {
            Ok(bound) => fitting.push(bound),
            Err(Unresolved::Unreadable(error)) => return Err(error.into()),
            Err(unresolved) => {
                let lacking = match &unresolved {
                    Unresolved::NoSuchField { lacking, .. } => lacking.len(),
                    _ => fields.len(),
                };
                if lacking < nearest.0 {
                    nearest = (lacking, format!("; {topic} comes closest: {unresolved}"));
                }
            }
        }
    }
    match fitting.pop() {
        Some(bound) if fitting.is_empty() => Ok(bound),
        Some(last) => {
            let topics = fitting.into_iter().chain([last]).map(|bound| bound.topic);
            Err(Misfit::Several(topics.collect()))
        }
        None => Err(Misfit::Lacking(format!(
            "no topic has messages with all of the fields {}{}",
            list(&fields),
            nearest.1
        ))),
    }
}

/// As [`resolve`], for a topic that the profile names.
fn bind(
    log: &Log,
    examples: &Examples,
    profile: &Profile,
    topic: &str,
    kinds: &[Kind],
) -> Result<Bound, Misfit> {
    resolve(log, examples, profile, topic, kinds).map_err(|unresolved| match unresolved {
        Unresolved::Unreadable(error) => Misfit::Unreadable(error),
        other => Misfit::Lacking(format!("{topic}: {other}")),
    })
}

/// Resolves the profile's fields against every channel of a topic.
fn resolve(
    log: &Log,
    examples: &Examples,
    profile: &Profile,
    topic: &str,
    kinds: &[Kind],
) -> Result<Bound, Unresolved> {
    let mut channels = BTreeMap::new();
    for channel in channels_with_messages(log).filter(|channel| channel.topic == topic) {
        let source = ChannelSource::new(log, examples, channel, profile, kinds)?;
        channels.insert(channel.id, source);
    }
    Ok(Bound {
        topic: topic.to_owned(),
        channels,
    })
}

fn channels_with_messages(log: &Log) -> impl Iterator<Item = &Channel> {
    let counts = &log.contents.statistics.channel_message_counts;
    let channels = log.contents.definitions.channels.values();
    channels
        .map(|channel| &channel.record)
        .filter(|channel| counts.get(&channel.id).is_some_and(|&count| count > 0))
}

fn describe_topics(log: &Log) -> String {
    let described: BTreeSet<String> = channels_with_messages(log)
        .map(|channel| {
            let schema = log.contents.schema_of(channel);
            let schema = schema.map_or("no schema", |schema| schema.name.as_str());
            format!(
                "\n  {} ({}, {schema})",
                channel.topic, channel.message_encoding
            )
        })
        .collect();
    if described.is_empty() {
        return "the log has no messages".to_owned();
    }
    let more = described.len().saturating_sub(LISTED);
    let mut text = String::from("topics of the log:");
    text.extend(described.into_iter().take(LISTED));
    if more > 0 {
        text.push_str(&format!("\n  and {more} more"));
    }
    text
}
