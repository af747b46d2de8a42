//! How derived messages were made: the Metadata record that says so, and by which they are recognised.

use std::{collections::BTreeMap, fmt};

use mcap::records::Metadata;
use serde::Serialize;

use super::{Layout, error::WriteError, original::Lost};
use crate::{
    log::{Log, ReadError},
    messages::Topic,
    text::Foreign,
};

/// The name of the Metadata record.
pub const NAME: &str = "flightcam";

/// The key of flightcam's version.
const VERSION: &str = "version";

/// The key of the topics that a run wrote, joined by commas.
pub(crate) const TOPICS: &str = "topics";

/// The key of the layout.
const LAYOUT: &str = "layout";

/// The Metadata record of a run: the version, the topics, the layout, and what else the caller knows about it.
pub(super) fn record(
    topics: impl Iterator<Item = Topic>,
    layout: Layout,
    facts: BTreeMap<String, String>,
) -> Metadata {
    let topics: Vec<&str> = topics.map(Topic::name).collect();
    let mut metadata = facts;
    metadata.insert(VERSION.to_owned(), env!("CARGO_PKG_VERSION").to_owned());
    metadata.insert(TOPICS.to_owned(), topics.join(","));
    metadata.insert(LAYOUT.to_owned(), layout.name().to_owned());
    Metadata {
        name: NAME.to_owned(),
        metadata,
    }
}

/// Checks that the log has none of the topics yet, neither from an earlier run, which cannot be undone for the reason
/// `lost`, nor from another program.
///
/// # Errors
/// It has one; the error says from where.
pub(super) fn check_are_free(log: &Log, topics: Vec<Topic>, lost: Lost) -> Result<(), WriteError> {
    for topic in topics.into_iter().map(Topic::name) {
        let mut channels = log
            .contents
            .definitions
            .channels
            .values()
            .map(|channel| &channel.record);
        let Some(channel) = channels.find(|channel| channel.topic == topic) else {
            continue;
        };
        let records = log.metadata(NAME)?;
        let ours = records.iter().find(|record| {
            let topics = record.metadata.get(TOPICS);
            topics.is_some_and(|topics| topics.split(',').any(|written| written == topic))
        });
        let path = log.file.path().to_owned();
        return Err(match ours {
            Some(record) => WriteError::AlreadyEnriched {
                path,
                topic,
                earlier: Box::new(EarlierRun::of(record)),
                reason: lost,
            },
            None => WriteError::TopicTaken {
                path,
                topic,
                schema: (log.contents.schema_of(channel)).map(|schema| schema.name.as_str().into()),
            },
        });
    }
    Ok(())
}

/// The run of flightcam that wrote a log.
///
/// # Errors
/// The log cannot be read.
pub(super) fn earlier_run(log: &Log) -> Result<EarlierRun, ReadError> {
    let records = log.metadata(NAME)?;
    Ok(records.last().map(EarlierRun::of).unwrap_or_default())
}

/// Why a log has no attachment with the original's end.
pub(super) fn why_no_way_back(log: &Log) -> Result<Lost, ReadError> {
    let records = log.metadata(NAME)?;
    let is_interleaved = |record: &Metadata| {
        record.metadata.get(LAYOUT).map(String::as_str) == Some(Layout::Interleaved.name())
    };
    Ok(match records.last() {
        None => Lost::NotEnriched,
        Some(record) if is_interleaved(record) => Lost::Interleaved,
        Some(_) => Lost::Rewritten,
    })
}

/// How an earlier run of flightcam made a log, as its Metadata record describes it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct EarlierRun {
    /// The version of flightcam.
    pub version: Option<Foreign>,
    /// The camera, in words.
    pub camera: Option<Foreign>,
    /// The name of the profile.
    pub profile: Option<Foreign>,
}

impl EarlierRun {
    fn of(record: &Metadata) -> Self {
        let get = |key| record.metadata.get(key).map(Foreign::from);
        Self {
            version: get(VERSION),
            camera: get("camera"),
            profile: get("profile"),
        }
    }
}

impl fmt::Display for EarlierRun {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            version,
            camera,
            profile,
        } = self;
        let unknown = &Foreign::from("?");
        let [version, camera, profile] =
            [version, camera, profile].map(|fact| fact.as_ref().unwrap_or(unknown));
        write!(f, "version {version}, camera {camera}, profile {profile}")
    }
}
