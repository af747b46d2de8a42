//! How derived messages were made: a Metadata record that says so, and by which they are recognised.

use std::collections::BTreeMap;

use mcap::records::Metadata;

use super::Layout;
use crate::{
    derived::Quantity,
    error::{Error, Lost},
    log::Log,
};

/// The name of the Metadata record.
pub const NAME: &str = "flightcam";

/// The key under which the tool's version stands.
const VERSION: &str = "version";

/// The key under which the topics stand that a run wrote, joined by commas.
const TOPICS: &str = "topics";

/// The key under which the layout stands.
const LAYOUT: &str = "layout";

/// The Metadata record for a run: which tool, which topics, and whatever else the caller knows of it.
pub(super) fn record(
    quantities: impl Iterator<Item = Quantity>,
    layout: Layout,
    facts: BTreeMap<String, String>,
) -> Metadata {
    let topics: Vec<&str> = quantities.map(Quantity::topic).collect();
    let mut metadata = facts;
    metadata.insert(VERSION.to_owned(), env!("CARGO_PKG_VERSION").to_owned());
    metadata.insert(TOPICS.to_owned(), topics.join(","));
    metadata.insert(LAYOUT.to_owned(), layout.name().to_owned());
    Metadata {
        name: NAME.to_owned(),
        metadata,
    }
}

/// Checks that the log has none of the topics yet, be it from an earlier run, of which it is `lost` how to undo
/// it, or from somebody else.
///
/// # Errors
/// It has one; the error tells whose it is.
pub(super) fn check_topics_are_free(log: &Log, lost: Lost) -> Result<(), Error> {
    for quantity in Quantity::ALL {
        let mut channels = log
            .contents
            .definitions
            .channels
            .values()
            .map(|channel| &channel.record);
        let Some(channel) = channels.find(|channel| channel.topic == quantity.topic()) else {
            continue;
        };
        let records = log.metadata(NAME)?;
        let ours = records.iter().find(|record| {
            let topics = record.metadata.get(TOPICS);
            topics.is_some_and(|topics| topics.split(',').any(|topic| topic == quantity.topic()))
        });
        let path = log.file.path().to_owned();
        return Err(match ours {
            Some(record) => Error::AlreadyEnriched {
                path,
                topic: quantity.topic(),
                made_by: say(record),
                reason: lost,
            },
            None => Error::TopicTaken {
                path,
                topic: quantity.topic(),
                schema: log
                    .contents
                    .schema_of(channel)
                    .map_or("no schema".to_owned(), |schema| {
                        format!("schema `{}`", schema.name)
                    }),
            },
        });
    }
    Ok(())
}

/// How a log was made by flightcam, in words.
///
/// # Errors
/// The log cannot be read.
pub(super) fn describe(log: &Log) -> Result<String, Error> {
    let records = log.metadata(NAME)?;
    Ok(records.last().map_or("?".to_owned(), say))
}

/// Why a log that has no attachment with the original's end has none.
pub(super) fn why_no_way_back(log: &Log) -> Result<Lost, Error> {
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

fn say(record: &Metadata) -> String {
    let get = |key| record.metadata.get(key).map_or("?", String::as_str);
    format!(
        "version {}, camera {}, profile {}",
        get(VERSION),
        get("camera"),
        get("profile")
    )
}
