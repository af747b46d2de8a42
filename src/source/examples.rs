//! The first messages of JSON channels, for what their schemas do not tell.

use std::{
    cell::OnceCell,
    collections::{BTreeMap, BTreeSet},
};

use crate::{error::Error, log::Log};

/// How many messages of a channel are examples at most.
const MOST: usize = 10;

/// The first messages of every JSON channel, read from the log when first asked for.
pub struct Examples<'a> {
    log: &'a Log,
    payloads: OnceCell<BTreeMap<u16, Vec<Vec<u8>>>>,
}

impl<'a> Examples<'a> {
    pub fn new(log: &'a Log) -> Self {
        Self {
            log,
            payloads: OnceCell::new(),
        }
    }

    /// The first messages of a channel.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn of(&self, channel_id: u16) -> Result<Vec<Vec<u8>>, Error> {
        let payloads = match self.payloads.get() {
            Some(payloads) => payloads,
            None => {
                let channels = self.log.contents.definitions.channels.values();
                let json: BTreeSet<u16> = channels
                    .filter(|channel| channel.record.message_encoding == "json")
                    .map(|channel| channel.record.id)
                    .collect();
                let read = self.log.first_payloads(&json, MOST)?;
                self.payloads.get_or_init(|| read)
            }
        };
        Ok(payloads.get(&channel_id).cloned().unwrap_or_default())
    }
}
