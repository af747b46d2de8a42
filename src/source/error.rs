//! Why a log's telemetry is not found or is ambiguous.

mod instead;

use std::{collections::BTreeSet, path::PathBuf, sync::Arc};

use serde::{Serialize, Serializer};

use super::{
    bind::BindError,
    profile::{Alternative, Profile, convention::AngleUnit},
    request::HowAsked,
    runner_up::{RunnerUp, nearest_first},
};
use crate::{
    decode::{
        error::quote,
        path::{FieldPath, Literal, MessagePath},
    },
    log::ReadError,
    sample::Kind,
    text::{self, Foreign},
};
pub use instead::{Candidate, Instead, LogTopic, OtherTopics, PathReading};

/// Why a log's telemetry is not found or is ambiguous.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum TelemetryError {
    #[error(
        "{}: no usable telemetry\nprofiles that were tried:{}{instead}",
        text::path(path),
        nearest_first(tried)
    )]
    NotFound {
        path: PathBuf,
        /// Each profile, and how nearly it fits.
        tried: Vec<RunnerUp>,
        instead: Box<Instead>,
    },

    #[error(
        "{}: {} fit equally well",
        text::path(path),
        text::join(topics, " and ")
    )]
    SeveralTopicsFit {
        path: PathBuf,
        /// The role for which one has to be chosen.
        role: Kind,
        topics: Vec<Foreign>,
    },

    #[error(
        "{}: several profiles fit equally well{}", text::path(path),
        fits.iter().map(|(profile, topic)| format!("\n  {profile}: {topic}")).collect::<String>()
    )]
    SeveralProfilesFit {
        path: PathBuf,
        /// Each profile and the topic where it finds the attitude or, if that was given, what it adds to it.
        fits: Vec<(Foreign, Foreign)>,
    },

    #[error(
        "{}: has the telemetry of several vehicles, in the namespaces {}{}", text::path(path),
        text::join(namespaces.iter().map(written), ", "),
        if namespaces.iter().any(|namespace| namespace.is_empty()) { " (/ is the one without a namespace)" } else { "" }
    )]
    SeveralVehicles {
        path: PathBuf,
        /// The prefixes of their topics; empty for a vehicle without one.
        namespaces: BTreeSet<Foreign>,
    },

    #[error(
        "{}: the path of the {} has several meanings in this log{}", text::path(path), role.name(),
        readings.iter().map(|reading| format!("\n  {reading}")).collect::<String>()
    )]
    SeveralReadings {
        path: PathBuf,
        role: Kind,
        /// Each of them, with its topic in quotes.
        readings: Vec<PathReading>,
    },

    #[error(
        "{}: there is no topic in the namespace {namespace}{instead}",
        text::path(path)
    )]
    NoSuchNamespace {
        path: PathBuf,
        namespace: Foreign,
        instead: Box<Instead>,
    },

    #[error(
        "{}: the given {} does not fit: {misfit}{instead}", text::path(path), role.name()
    )]
    RoleDoesNotFit {
        path: PathBuf,
        role: Kind,
        misfit: Box<Misfit>,
        instead: Box<Instead>,
    },

    #[error(
        "{}: the profile `{profile}` does not fit: {misfit}{instead}",
        text::path(path)
    )]
    ProfileDoesNotFit {
        path: PathBuf,
        profile: Foreign,
        misfit: Box<Misfit>,
        instead: Box<Instead>,
    },

    #[error(
        "{}: {topic} has an angle of {}, which cannot be {}, as which the {}'s angles were read", text::path(path),
        round(*angle), unit.name(), role.name()
    )]
    ImpossibleAngle {
        path: PathBuf,
        role: Kind,
        topic: Foreign,
        angle: f64,
        /// The unit as which it was read.
        unit: AngleUnit,
        asked: HowAsked,
    },

    #[error(
        "{}: several sources write to {topic}: its `{field}` is {}",
        text::path(path),
        text::join(ids, " or ")
    )]
    SeveralSources {
        path: PathBuf,
        topic: Foreign,
        role: Kind,
        /// The field that tells them apart.
        field: FieldPath,
        /// Its values.
        ids: Vec<Literal>,
        /// How to name the first of them.
        example: Box<[MessagePath]>,
    },

    /// The log cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
}

/// A large number with its leading digits.
fn round(number: f64) -> String {
    match number < 1e9 {
        true => format!("{number:.1}"),
        false => format!("{number:e}"),
    }
}

impl TelemetryError {
    /// Whether something fits, and something else fits equally well.
    pub(super) fn is_ambiguity(&self) -> bool {
        matches!(
            self,
            Self::SeveralTopicsFit { .. }
                | Self::SeveralProfilesFit { .. }
                | Self::SeveralVehicles { .. }
        )
    }
}

/// A namespace as a request writes it.
fn written(namespace: &Foreign) -> Foreign {
    match namespace.is_empty() {
        true => "/".into(),
        false => namespace.clone(),
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
        topics: Vec<Foreign>,
    },

    #[error("{}: {}", .0.topic, .0.cause)]
    Messages(TopicMisfit),

    #[error(
        "an alternative of `{}` would never be used, because no message has the field of its `when` or `valid`: \
         {}: {}",
        role.name(), misfit.topic, misfit.cause
    )]
    Condition { role: Kind, misfit: TopicMisfit },

    #[error("the messages on {topic} have none")]
    NotWithAttitude { topic: Foreign },

    #[error("the profile `{profile}` has no {}", role.name())]
    NotInProfile { profile: Foreign, role: Kind },

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

    #[error(
        "no topic has messages of type {}{}",
        text::join(schemas, " or "),
        closest(nearest)
    )]
    NoSuchType {
        /// The types, any of which would do.
        schemas: Vec<Foreign>,
        /// A topic whose messages are of the type, but are missing a field.
        nearest: Option<TopicMisfit>,
    },
}

impl Misfit {
    /// The same without the topic that comes nearest, if its messages do not even have a field by which the profile knows
    /// its own.
    pub(super) fn unless_strange(self, profile: &Profile) -> Self {
        let select = |alternative: &Alternative| alternative.location.select.clone();
        let known_by = profile.alternatives(Kind::Attitude).iter().flat_map(select);
        let known_by: Vec<FieldPath> = known_by.map(|filter| filter.field).collect();
        match self {
            Self::NoSuchFields { fields, nearest } => Self::NoSuchFields {
                fields,
                nearest: nearest.filter(|one| !known_by.iter().any(|field| one.cause.lacks(field))),
            },
            other => other,
        }
    }

    /// Whether something in the log comes near.
    pub(super) fn is_near(&self) -> bool {
        match self {
            Self::NoMessages { .. } | Self::NotInProfile { .. } | Self::OnlyATopic { .. } => false,
            Self::NoSuchFields { nearest, .. } | Self::NoSuchType { nearest, .. } => {
                nearest.is_some()
            }
            Self::Messages(_) | Self::Condition { .. } | Self::NotWithAttitude { .. } => true,
        }
    }
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
fn listed(names: &[Foreign]) -> String {
    const LISTED: usize = 3;
    match names.len().saturating_sub(LISTED) {
        0 => text::join(names, " or "),
        1 => format!("{} or one other", text::join(&names[..LISTED], ", ")),
        more => format!("{} or {more} others", text::join(&names[..LISTED], ", ")),
    }
}

/// Why the messages on a topic do not fit.
#[derive(Debug, Clone, Serialize)]
pub struct TopicMisfit {
    /// The topic.
    pub topic: Foreign,
    #[serde(serialize_with = "as_text")]
    cause: Arc<BindError>,
}

impl TopicMisfit {
    pub(super) fn new(topic: &str, cause: BindError) -> Self {
        Self {
            topic: topic.into(),
            cause: cause.into(),
        }
    }

    /// How many fields are missing in its messages.
    pub(super) fn missing_fields(&self) -> usize {
        self.cause.missing_fields()
    }

    /// Whether its messages have what is wanted, but it is not known how to read it.
    pub(super) fn is_of_frames(&self) -> bool {
        self.cause.is_of_frames()
    }

    /// Whether its messages are not what was wanted, as opposed to what was wanted being incomplete.
    pub(super) fn is_of_schema(&self) -> bool {
        self.cause.is_of_schema()
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
