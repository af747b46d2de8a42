//! All topics of a log.

use std::{collections::BTreeMap, path::PathBuf};

use serde::Serialize;

use crate::{
    error::Error,
    log::{Access, Log},
    report::lossy,
    run::Input,
    text::Foreign,
    watch::Watch,
};

/// All topics of a log that have messages. Scripts read it as JSON, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TopicList {
    /// The log.
    #[serde(serialize_with = "lossy")]
    pub input: PathBuf,
    /// The topics, by name.
    pub topics: Vec<ListedTopic>,
}

/// A topic, or one of a topic's channels if their messages differ in kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ListedTopic {
    /// Its name.
    pub topic: Foreign,
    /// How its messages are encoded.
    pub encoding: Foreign,
    /// Their type; empty if they have none.
    pub schema: Foreign,
    /// How many there are.
    pub messages: u64,
    /// Messages per second between the first and the last; absent if these are at one time.
    pub rate_hz: Option<f64>,
}

/// Lists all topics of a log that have messages.
///
/// # Errors
/// The log cannot be read or is changed meanwhile.
pub fn topics<'a>(input: impl Into<Input<'a>>, watch: &Watch) -> Result<TopicList, Error> {
    let log = Log::read(input.into().open(Access::Read, watch)?)?;
    let ids = (log.contents.channels_with_messages()).map(|(channel, _)| channel.id);
    let ends = log.message_time_ends(&ids.collect(), [0, u64::MAX])?;
    log.file.grown_by()?;
    let mut listed: BTreeMap<[Foreign; 3], (u64, Option<[u64; 2]>)> = BTreeMap::new();
    for (channel, count) in log.contents.channels_with_messages() {
        let schema = log.contents.schema_of(channel);
        let schema = schema.map_or("", |schema| schema.name.as_str());
        let kind = [&channel.topic, &channel.message_encoding, schema].map(Foreign::from);
        let (messages, span) = listed.entry(kind).or_default();
        *messages += count;
        if let Some(&[start, end]) = ends.get(&channel.id) {
            let [from, to] = span.unwrap_or([start, end]);
            *span = Some([from.min(start), to.max(end)]);
        }
    }
    let listed = listed.into_iter();
    Ok(TopicList {
        input: log.file.path().into(),
        topics: listed
            .map(
                |([topic, encoding, schema], (messages, span))| ListedTopic {
                    topic,
                    encoding,
                    schema,
                    messages,
                    rate_hz: span.and_then(|span| rate(messages, span)),
                },
            )
            .collect(),
    })
}

fn rate(messages: u64, [start, end]: [u64; 2]) -> Option<f64> {
    let seconds = (end - start) as f64 / 1e9;
    (seconds > 0.0).then(|| (messages - 1) as f64 / seconds)
}
