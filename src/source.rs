//! How a log says it: the profile that fits, the channels that it names, and their messages → samples.

pub mod profile;

mod channel;
mod field;
mod json;
mod protobuf;

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
};

use mcap::records::Channel;

use crate::{
    error::Error,
    log::{Log, record::RawMessage},
    sample::{DropReason, Kind, Sample},
};
use channel::ChannelSource;
pub use field::FieldPath;
use profile::{AngleUnit, Orientation, Profile, ProfileChoice};

/// How many names a message lists at most.
const LISTED: usize = 40;

/// The telemetry of one log: which channels have it, and how to read their messages.
#[derive(Debug)]
pub struct Source {
    pub profile: Profile,
    pub attitude_topic: String,
    /// The topic with the velocity, or why there is none.
    pub velocity_topic: Result<String, String>,
    channels: BTreeMap<u16, ChannelSource>,
}

/// Why a profile does not fit a log, in words.
type Misfit = String;

/// Why a channel's messages cannot be read as a profile says.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
enum Unresolved {
    #[error(
        "its messages are encoded as `{message_encoding}` with schema encoding `{schema_encoding}`; \
         flightcam reads protobuf and JSON"
    )]
    Encoding {
        message_encoding: String,
        schema_encoding: String,
    },
    #[error("{problem}")]
    Schema { problem: String },
    #[error("it has no field `{path}`; {message} has {}", list(available))]
    NoSuchField {
        path: FieldPath,
        message: String,
        available: Vec<String>,
    },
    #[error("its field `{path}` does not exist, because `{name}` is not a single message")]
    NotAMessage { path: FieldPath, name: String },
    #[error("its field `{path}` is not a number but a {kind}")]
    NotANumber { path: FieldPath, kind: &'static str },
}

impl Source {
    /// Finds the telemetry of a log.
    ///
    /// # Errors
    /// The profile does not fit the log, or none does; the message says what was looked for.
    pub fn select(log: &Log, choice: &ProfileChoice) -> Result<Self, Error> {
        match choice {
            ProfileChoice::Given(profile) => {
                let source = Self::fit(log, profile)?;
                source.map_err(|problem| Error::ProfileDoesNotFit {
                    path: log.file.path().into(),
                    profile: profile.name.clone(),
                    problem,
                })
            }
            ProfileChoice::Automatic => {
                let mut details = String::from("looked for:");
                for profile in Profile::built_in()
                    .iter()
                    .filter(|profile| profile.automatic)
                {
                    match Self::fit(log, profile)? {
                        Ok(source) => return Ok(source),
                        Err(misfit) => {
                            let _ = write!(details, "\n  {}: {misfit}", profile.name);
                        }
                    }
                }
                let _ = write!(details, "\ntopics of the log: {}", describe_topics(log));
                details.push_str(
                    "\nflightcam reads protobuf and JSON messages; where the telemetry is in some of those, \
                     describe it in a profile of your own (--profile FILE.toml, explained in the README)",
                );
                Err(Error::NoTelemetry {
                    path: log.file.path().into(),
                    details,
                })
            }
        }
    }

    fn fit(log: &Log, profile: &Profile) -> Result<Result<Self, Misfit>, Error> {
        let own_velocity = profile
            .velocity
            .as_ref()
            .map(|role| !role.topics.is_empty());
        let attitude_kinds: &[Kind] = match own_velocity {
            Some(false) => &[Kind::Attitude, Kind::Velocity],
            Some(true) | None => &[Kind::Attitude],
        };
        let found = match profile.attitude.topics.as_slice() {
            [] => find_by_fields(log, profile, attitude_kinds)?,
            topics => match find_by_name(log, topics) {
                Some(topic) => bind(log, profile, &topic, attitude_kinds)?,
                None => Err(not_in_log("attitude", topics)),
            },
        };
        let (attitude_topic, mut channels) = match found {
            Ok(found) => found,
            Err(misfit) => return Ok(Err(misfit)),
        };
        let velocity_topic = match &profile.velocity {
            None => Err(format!("the profile `{}` has no velocity", profile.name)),
            Some(role) if role.topics.is_empty() => Ok(attitude_topic.clone()),
            Some(role) => match find_by_name(log, &role.topics) {
                Some(topic) => match bind(log, profile, &topic, &[Kind::Velocity])? {
                    Ok((topic, more)) => {
                        channels.extend(more);
                        Ok(topic)
                    }
                    Err(misfit) => return Ok(Err(misfit)),
                },
                None => Err(not_in_log("velocity", &role.topics)),
            },
        };
        Ok(Ok(Self {
            profile: profile.clone(),
            attitude_topic,
            velocity_topic,
            channels,
        }))
    }

    /// What the profile found in the log, in words.
    pub fn reason(&self) -> String {
        let (fields, _) = self.profile.attitude_fields();
        let names: Vec<String> = fields.iter().map(FieldPath::to_string).collect();
        format!("{} has {}", self.attitude_topic, names.join(", "))
    }

    /// The channels that have telemetry.
    pub fn channel_ids(&self) -> BTreeSet<u16> {
        self.channels.keys().copied().collect()
    }

    /// Reads one message. `emit` gets a sample, or why there is none, for each kind that the channel has.
    pub fn read(
        &mut self,
        message: &RawMessage,
        emit: impl FnMut(Kind, Result<Sample, DropReason>),
    ) {
        if let Some(channel) = self.channels.get_mut(&message.channel_id) {
            channel.read(message, emit);
        }
    }

    /// What the user should look at twice, after all messages were read.
    pub fn suspicion(&self) -> Option<String> {
        let Orientation::Euler {
            unit: AngleUnit::Radians,
            ..
        } = self.profile.attitude.orientation
        else {
            return None;
        };
        let largest = self.channels.values().map(ChannelSource::largest_angle);
        let largest = largest.fold(0.0, f64::max);
        (largest > std::f64::consts::TAU).then(|| {
            format!(
                "the largest angle is {largest:.1}, which is more than a full turn in radians; \
                 if {} is in degrees, use --profile flat-deg",
                self.attitude_topic
            )
        })
    }
}

type Bound = (String, BTreeMap<u16, ChannelSource>);

/// The first of the topics that has messages.
fn find_by_name(log: &Log, topics: &[String]) -> Option<String> {
    let has_messages = |topic: &&String| channels_with_messages(log).any(|c| c.topic == **topic);
    topics.iter().find(has_messages).cloned()
}

/// The one topic whose messages have all of the fields.
fn find_by_fields(
    log: &Log,
    profile: &Profile,
    kinds: &[Kind],
) -> Result<Result<Bound, Misfit>, Error> {
    let topics: BTreeSet<&str> = channels_with_messages(log)
        .map(|channel| channel.topic.as_str())
        .collect();
    let mut fitting: Vec<Bound> = Vec::new();
    for topic in topics {
        if let Ok(bound) = bind(log, profile, topic, kinds)? {
            fitting.push(bound);
        }
    }
    if fitting.len() > 1 {
        let topics: Vec<String> = fitting.into_iter().map(|(topic, _)| topic).collect();
        return Ok(Err(format!(
            "{} fit equally well; choose one with `topics` under [attitude] in a profile of your own",
            list(&topics)
        )));
    }
    Ok(fitting.pop().ok_or_else(|| {
        let (mut fields, _) = profile.attitude_fields();
        if kinds.contains(&Kind::Velocity) {
            fields.extend(profile.velocity.iter().flat_map(|role| role.fields()));
        }
        let fields: Vec<String> = fields.iter().map(FieldPath::to_string).collect();
        format!(
            "no topic has messages with the fields {} (protobuf or JSON)",
            fields.join(", ")
        )
    }))
}

/// Resolves the profile's fields against every channel of a topic.
fn bind(
    log: &Log,
    profile: &Profile,
    topic: &str,
    kinds: &[Kind],
) -> Result<Result<Bound, Misfit>, Error> {
    let mut bound = BTreeMap::new();
    for channel in channels_with_messages(log).filter(|channel| channel.topic == topic) {
        match ChannelSource::new(log, channel, profile, kinds)? {
            Ok(source) => {
                bound.insert(channel.id, source);
            }
            Err(unresolved) => return Ok(Err(format!("{topic}: {unresolved}"))),
        }
    }
    Ok(Ok((topic.to_owned(), bound)))
}

fn channels_with_messages(log: &Log) -> impl Iterator<Item = &Channel> {
    let counts = &log.contents.statistics.channel_message_counts;
    log.contents
        .channels
        .values()
        .map(|channel| &channel.record)
        .filter(|channel| counts.get(&channel.id).is_some_and(|&count| count > 0))
}

fn not_in_log(what: &str, topics: &[String]) -> String {
    format!("no messages on {} ({what})", topics.join(" or "))
}

fn describe_topics(log: &Log) -> String {
    let described: BTreeSet<String> = channels_with_messages(log)
        .map(|channel| {
            let schema = log.contents.schema_of(channel);
            let schema = schema.map_or("no schema", |schema| schema.name.as_str());
            format!("{} ({}, {schema})", channel.topic, channel.message_encoding)
        })
        .collect();
    if described.is_empty() {
        return "none that has messages".to_owned();
    }
    list(&Vec::from_iter(described))
}

/// Names joined by commas, the first [`LISTED`] of them.
fn list(names: &[String]) -> String {
    let mut listed = names[..names.len().min(LISTED)].join(", ");
    if names.len() > LISTED {
        let _ = write!(listed, " and {} more", names.len() - LISTED);
    }
    listed
}
