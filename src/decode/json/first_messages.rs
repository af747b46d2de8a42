//! The first messages of JSON channels, which show what their schemas leave open.

use std::{
    cell::OnceCell,
    collections::{BTreeMap, BTreeSet},
};

use mcap::records::Channel;
use serde_json::Value;

use super::non_finite;
use crate::log::{Log, ReadError};

/// The first messages of JSON channels.
#[derive(Debug)]
pub enum FirstMessages<'a> {
    /// Those of all JSON channels of a log, read on first use.
    OfLog {
        log: &'a Log,
        messages: OnceCell<BTreeMap<u16, Vec<Value>>>,
    },
    /// Those of a single channel, returned whichever channel is asked for.
    Given(Vec<Value>),
}

impl<'a> FirstMessages<'a> {
    /// How many messages of each channel are examined.
    pub const COUNT: usize = 10;

    /// Whether a channel's fields can only be known from its messages. This is so for JSON, whose schema may be empty.
    pub fn tell_the_fields_of(channel: &Channel) -> bool {
        channel.message_encoding == "json"
    }

    pub fn new(log: &'a Log) -> Self {
        Self::OfLog {
            log,
            messages: OnceCell::new(),
        }
    }

    /// Wraps the first messages of a single channel.
    pub fn given(payloads: &[Vec<u8>]) -> Self {
        Self::Given(parse(payloads))
    }

    /// The first messages of a channel; null for one that is not valid JSON.
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

/// What is not JSON shows no field.
fn parse(payloads: &[Vec<u8>]) -> Vec<Value> {
    let values = payloads.iter().map(|json| non_finite::parse(json));
    values.map(Result::unwrap_or_default).collect()
}
