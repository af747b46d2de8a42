//! How derived messages were made: a Metadata record that says so, and by which they are recognised.

use std::collections::BTreeMap;

use mcap::records::Metadata;

use crate::{derived::Quantity, error::Error, log::Log};

/// The name of the Metadata record.
pub const NAME: &str = "flightcam";

/// The key under which the tool's version stands.
const VERSION: &str = "version";

/// The key under which the topics stand that a run wrote, joined by commas.
const TOPICS: &str = "topics";

/// The Metadata record for a run: which tool, which topics, and whatever else the caller knows of it.
pub(super) fn record(
    quantities: impl Iterator<Item = Quantity>,
    facts: BTreeMap<String, String>,
) -> Metadata {
    let topics: Vec<&str> = quantities.map(Quantity::topic).collect();
    let mut metadata = facts;
    metadata.insert(VERSION.to_owned(), env!("CARGO_PKG_VERSION").to_owned());
    metadata.insert(TOPICS.to_owned(), topics.join(","));
    Metadata {
        name: NAME.to_owned(),
        metadata,
    }
}

/// Checks that the log has none of the topics yet, be it from an earlier run or from somebody else.
///
/// # Errors
/// It has one; the error tells whose it is.
pub fn check_topics_are_free(log: &Log) -> Result<(), Error> {
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
                made_by: describe(record),
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

fn describe(record: &Metadata) -> String {
    let get = |key| record.metadata.get(key).map_or("?", String::as_str);
    format!(
        "version {}, camera {}, profile {}",
        get(VERSION),
        get("camera"),
        get("profile")
    )
}
