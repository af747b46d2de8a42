//! Why a log's telemetry is not found or is ambiguous.

use std::{collections::BTreeSet, fmt, path::PathBuf, sync::Arc};

use serde::{Serialize, Serializer};

use super::bind::BindError;
use crate::{
    decode::{error::quote, path::FieldPath},
    log::{Log, ReadError},
    sample::Kind,
};

/// Why a log's telemetry is not found or is ambiguous.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum TelemetryError {
    #[error(
        "{}: no usable telemetry\nlooked for:{}\n{topics}", path.display(),
        tried.iter().map(|(profile, misfit)| format!("\n  {profile}: {misfit}")).collect::<String>()
    )]
    NotFound {
        path: PathBuf,
        /// Each profile and why it does not fit.
        tried: Vec<(String, Misfit)>,
        topics: LogTopics,
    },

    #[error("{}: {} fit equally well", path.display(), topics.join(" and "))]
    SeveralTopicsFit { path: PathBuf, topics: Vec<String> },

    #[error(
        "{}: several profiles fit equally well{}", path.display(),
        fits.iter().map(|(profile, topic)| format!("\n  {profile}: {topic}")).collect::<String>()
    )]
    SeveralProfilesFit {
        path: PathBuf,
        /// Each profile and the topic where it finds the attitude.
        fits: Vec<(String, String)>,
    },

    #[error(
        "{}: has the telemetry of several vehicles, in the namespaces {}{}", path.display(),
        namespaces.iter().map(|namespace| written(namespace)).collect::<Vec<_>>().join(", "),
        if namespaces.contains("") { " (/ is the one without a namespace)" } else { "" }
    )]
    SeveralVehicles {
        path: PathBuf,
        /// The prefixes of their topics; empty for a vehicle without one.
        namespaces: BTreeSet<String>,
    },

    #[error("{}: there is no topic in the namespace {namespace}\n{topics}", path.display())]
    NoSuchNamespace {
        path: PathBuf,
        namespace: String,
        topics: LogTopics,
    },

    #[error(
        "{}: the given {} does not fit: {misfit}\n{topics}", path.display(), role.name()
    )]
    RoleDoesNotFit {
        path: PathBuf,
        role: Kind,
        misfit: Box<Misfit>,
        topics: LogTopics,
    },

    #[error("{}: the profile `{profile}` does not fit: {misfit}\n{topics}", path.display())]
    ProfileDoesNotFit {
        path: PathBuf,
        profile: String,
        misfit: Box<Misfit>,
        topics: LogTopics,
    },

    /// The log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
}

/// A namespace as a request writes it.
fn written(namespace: &str) -> &str {
    match namespace {
        "" => "/",
        namespace => namespace,
    }
}

/// Why a profile, or one of its roles, does not fit a log.
#[derive(Debug, Clone, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum Misfit {
    #[error("there is no message on {}", listed(topics))]
    NoMessages {
        /// The topics, as the profile or the user names them.
        topics: Vec<String>,
    },

    #[error("{}: {}", .0.topic, .0.cause)]
    Messages(TopicMisfit),

    #[error("the messages on {topic} have none")]
    NotWithAttitude { topic: String },

    #[error("the profile `{profile}` has no {}", role.name())]
    NotInProfile { profile: String, role: Kind },

    #[error(
        "only a topic was given for the {}, and no profile says which fields it has there",
        role.name()
    )]
    OnlyATopic { role: Kind },

    #[error(
        "no topic has messages with all of the fields {}{}",
        quote(fields),
        closest(nearest)
    )]
    NoSuchFields {
        fields: Vec<FieldPath>,
        /// A topic that has some of these fields, or may have.
        nearest: Option<TopicMisfit>,
    },

    #[error("no topic has messages of type {}{}", schemas.join(" or "), closest(nearest))]
    NoSuchType {
        /// The types, any of which would do.
        schemas: Vec<String>,
        /// A topic whose messages are of the type, but are missing a field.
        nearest: Option<TopicMisfit>,
    },
}

fn closest(nearest: &Option<TopicMisfit>) -> String {
    match nearest {
        None => String::new(),
        Some(TopicMisfit { topic, cause }) if cause.is_opaque() => {
            format!("; what {topic} has is not known: {cause}")
        }
        Some(TopicMisfit { topic, cause }) => format!("; {topic} comes closest: {cause}"),
    }
}

/// The first few of several names, any of which would do.
fn listed(names: &[String]) -> String {
    const LISTED: usize = 3;
    match names.len().saturating_sub(LISTED) {
        0 => names.join(" or "),
        1 => format!("{} or one other", names[..LISTED].join(", ")),
        more => format!("{} or {more} others", names[..LISTED].join(", ")),
    }
}

/// Why the messages on a topic do not fit.
#[derive(Debug, Clone, Serialize)]
pub struct TopicMisfit {
    /// The topic.
    pub topic: String,
    #[serde(serialize_with = "as_text")]
    cause: Arc<BindError>,
}

impl TopicMisfit {
    pub(super) fn new(topic: &str, cause: BindError) -> Self {
        Self {
            topic: topic.to_owned(),
            cause: cause.into(),
        }
    }

    /// How many fields are missing in its messages.
    pub(super) fn missing_fields(&self) -> usize {
        self.cause.missing_fields()
    }

    /// Whether the fields of its messages cannot be known.
    pub(super) fn is_opaque(&self) -> bool {
        self.cause.is_opaque()
    }
}

impl PartialEq for TopicMisfit {
    fn eq(&self, other: &Self) -> bool {
        self.topic == other.topic && self.cause.to_string() == other.cause.to_string()
    }
}

fn as_text<S: Serializer>(cause: &Arc<BindError>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(cause)
}

/// Why nothing was found.
#[derive(Debug, thiserror::Error)]
pub enum Unfit {
    /// Another profile may fit.
    #[error(transparent)]
    Misfit(#[from] Misfit),
    /// No profile will: the log cannot be read, or does not have what the user asks for.
    #[error(transparent)]
    Hopeless(#[from] TelemetryError),
}

impl From<ReadError> for Unfit {
    fn from(error: ReadError) -> Self {
        Self::Hopeless(error.into())
    }
}

/// The topics of a log that have messages, as its errors list them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct LogTopics(pub BTreeSet<LogTopic>);

/// A topic that has messages.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct LogTopic {
    /// Its name.
    pub topic: String,
    /// How its messages are encoded.
    pub message_encoding: String,
    /// The name of their type, if they have one.
    pub schema: Option<String>,
}

impl LogTopics {
    pub(super) fn of(log: &Log) -> Self {
        let channels = log.contents.channels_with_messages();
        let topics = channels.map(|(channel, _)| LogTopic {
            topic: channel.topic.clone(),
            message_encoding: channel.message_encoding.clone(),
            schema: (log.contents.schema_of(channel)).map(|schema| schema.name.clone()),
        });
        Self(topics.collect())
    }
}

impl fmt::Display for LogTopics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// How many topics are listed at most.
        const LISTED: usize = 60;
        if self.0.is_empty() {
            return f.write_str("the log has no messages");
        }
        f.write_str("topics of the log:")?;
        for topic in self.0.iter().take(LISTED) {
            let schema = topic.schema.as_deref().unwrap_or("no schema");
            write!(
                f,
                "\n  {} ({}, {schema})",
                topic.topic, topic.message_encoding
            )?;
        }
        match self.0.len().saturating_sub(LISTED) {
            0 => Ok(()),
            more => write!(f, "\n  and {more} more"),
        }
    }
}
