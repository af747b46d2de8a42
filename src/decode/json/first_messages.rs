//! The first messages of JSON channels, for what their schemas do not say.

use std::{
    cell::OnceCell,
    collections::{BTreeMap, BTreeSet},
};

use mcap::records::Channel;
use serde_json::Value;

use crate::log::{Log, ReadError};

/// The first messages of JSON channels.
#[derive(Debug)]
pub enum FirstMessages<'a> {
    /// Of every one of a log, read from there when first asked for.
    OfLog {
        log: &'a Log,
        messages: OnceCell<BTreeMap<u16, Vec<Value>>>,
    },
    /// Of one channel, whichever is asked for.
    Given(Vec<Value>),
}

impl<'a> FirstMessages<'a> {
    /// How many messages of each channel are examined.
    pub const COUNT: usize = 10;

    /// Whether it takes messages to know a channel's fields: whether they are JSON, whose schema may be empty.
    pub fn tell_the_fields_of(channel: &Channel) -> bool {
        channel.message_encoding == "json"
    }

    pub fn new(log: &'a Log) -> Self {
        Self::OfLog {
            log,
            messages: OnceCell::new(),
        }
    }

    /// Of the one channel that has these messages.
    pub fn given(payloads: &[Vec<u8>]) -> Self {
        Self::Given(parse(payloads))
    }

    /// The first messages of a channel, of those that are JSON.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn of(&self, channel_id: u16) -> Result<&[Value], ReadError> {
        let (log, messages) = match self {
            Self::OfLog { log, messages } => (log, messages),
            Self::Given(messages) => return Ok(messages),
        };
        let messages = match messages.get() {
            Some(messages) => messages,
            None => {
                let read = read(log)?;
                messages.get_or_init(|| read)
            }
        };
        Ok(messages.get(&channel_id).map_or(&[], Vec::as_slice))
    }
}

fn read(log: &Log) -> Result<BTreeMap<u16, Vec<Value>>, ReadError> {
    let channels = log.contents.definitions.channels.values();
    let json: BTreeSet<u16> = channels
        .filter(|channel| FirstMessages::tell_the_fields_of(&channel.record))
        .map(|channel| channel.record.id)
        .collect();
    let payloads = log.first_payloads(&json, FirstMessages::COUNT)?;
    Ok((payloads.into_iter())
        .map(|(channel_id, payloads)| (channel_id, parse(&payloads)))
        .collect())
}

fn parse(payloads: &[Vec<u8>]) -> Vec<Value> {
    let values = payloads.iter().map(|json| serde_json::from_slice(json));
    values.filter_map(Result::ok).collect()
}
