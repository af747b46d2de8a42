//! The first messages of JSON channels, for what their schemas do not tell.

use std::{
    cell::OnceCell,
    collections::{BTreeMap, BTreeSet},
};

use serde_json::Value;

use crate::{error::Error, log::Log};

/// How many messages of a channel are examples at most.
const MOST: usize = 10;

/// The first messages of every JSON channel, read from the log when first asked for.
#[derive(Debug)]
pub struct Examples<'a> {
    log: &'a Log,
    messages: OnceCell<BTreeMap<u16, Vec<Value>>>,
}

impl<'a> Examples<'a> {
    pub fn new(log: &'a Log) -> Self {
        Self {
            log,
            messages: OnceCell::new(),
        }
    }

    /// The first messages of a channel, of those that are JSON.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn of(&self, channel_id: u16) -> Result<&[Value], Error> {
        let messages = match self.messages.get() {
            Some(messages) => messages,
            None => {
                let read = self.read()?;
                self.messages.get_or_init(|| read)
            }
        };
        Ok(messages.get(&channel_id).map_or(&[], Vec::as_slice))
    }

    fn read(&self) -> Result<BTreeMap<u16, Vec<Value>>, Error> {
        let channels = self.log.contents.definitions.channels.values();
        let json: BTreeSet<u16> = channels
            .filter(|channel| channel.record.message_encoding == "json")
            .map(|channel| channel.record.id)
            .collect();
        let payloads = self.log.first_payloads(&json, MOST)?;
        let parse = |payloads: Vec<Vec<u8>>| {
            let values = payloads.iter().map(|json| serde_json::from_slice(json));
            values.filter_map(Result::ok).collect()
        };
        Ok((payloads.into_iter())
            .map(|(channel_id, payloads)| (channel_id, parse(payloads)))
            .collect())
    }
}
