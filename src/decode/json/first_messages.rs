//! The first messages of JSON channels, which show what their schemas leave open.

use std::{
    cell::OnceCell,
    collections::{BTreeMap, BTreeSet},
    ops::ControlFlow,
};

use mcap::records::Channel;
use serde_json::Value;

use super::{fault, non_finite};
use crate::{
    decode::fault::Fault,
    log::{LONGEST_EXAMPLE, Log, ReadError},
};

/// The first messages of JSON channels.
#[derive(Debug)]
pub enum FirstMessages<'a> {
    /// Those of all JSON channels of a log, read on first use.
    OfLog {
        log: &'a Log,
        channels: OnceCell<BTreeMap<u16, Examples>>,
    },
    /// Those of a single channel, returned whichever channel is asked for.
    Given(Vec<Value>),
}

/// The first messages of a channel.
#[derive(Debug, Default)]
pub struct Examples {
    first: Vec<Value>,
    /// What is wrong with them if none is JSON.
    fault: Option<Fault>,
    /// These and those that follow, read if these do not show enough.
    more: OnceCell<Vec<Value>>,
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
            channels: OnceCell::new(),
        }
    }

    /// Wraps the first messages of a single channel.
    pub fn given(payloads: &[Vec<u8>]) -> Self {
        Self::Given(parse_all(payloads))
    }

    /// The first messages of a channel; null for one that is not valid JSON.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn of(&self, channel_id: u16) -> Result<&[Value], ReadError> {
        let (log, channels) = match self {
            Self::OfLog { log, channels } => (log, channels),
            Self::Given(messages) => return Ok(messages),
        };
        if channels.get().is_none() {
            let read = read(log)?;
            channels.get_or_init(|| read);
        }
        let examples = channels
            .get()
            .and_then(|channels| channels.get(&channel_id));
        Ok(examples.map_or(&[], |examples| &examples.first))
    }

    /// What is wrong with a channel's first messages if none of them is JSON.
    pub fn fault_of(&self, channel_id: u16) -> Option<&Fault> {
        match self {
            Self::OfLog { channels, .. } => channels.get()?.get(&channel_id)?.fault.as_ref(),
            Self::Given(_) => None,
        }
    }

    /// More of a channel's first messages, for fields that are null at first; `None` if they are not known yet.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn more_of(&self, channel_id: u16) -> Result<Option<&[Value]>, ReadError> {
        let Self::OfLog { log, channels } = self else {
            return Ok(None);
        };
        self.of(channel_id)?;
        let examples = channels
            .get()
            .and_then(|channels| channels.get(&channel_id));
        let Some(Examples { more, .. }) = examples else {
            return Ok(Some(&[]));
        };
        if more.get().is_none() {
            let read = read_more(log, channel_id)?;
            more.get_or_init(|| read);
        }
        Ok(more.get().map(Vec::as_slice))
    }
}

fn read(log: &Log) -> Result<BTreeMap<u16, Examples>, ReadError> {
    let channels = log.contents.definitions.channels.values();
    let json: BTreeSet<u16> = channels
        .filter(|channel| FirstMessages::tell_the_fields_of(&channel.record))
        .map(|channel| channel.record.id)
        .collect();
    let payloads = log.first_payloads(&json, FirstMessages::COUNT)?;
    let examples = |payloads: Vec<_>| Examples {
        first: parse_all(&payloads),
        fault: fault_of_all(&payloads),
        more: OnceCell::new(),
    };
    Ok((payloads.into_iter())
        .map(|(channel_id, payloads)| (channel_id, examples(payloads)))
        .collect())
}

/// Reads more messages of a channel. The bounds are such that a log and the excerpt of it that is kept of a stream,
/// which has all of the channel's messages, give the same ones.
fn read_more(log: &Log, channel_id: u16) -> Result<Vec<Value>, ReadError> {
    /// How many messages are examined at most.
    const MESSAGES: usize = 1000;
    /// How many bytes they have at most.
    const BYTES: usize = 4 * 1024 * 1024;
    /// How many segments are read at most: other channels may have most of what is in them.
    const SEGMENTS: usize = 100;
    let mut messages = Vec::new();
    let mut bytes = 0;
    log.visit_payloads(channel_id, SEGMENTS, |payload| {
        if payload.len() <= LONGEST_EXAMPLE {
            bytes += payload.len();
            messages.push(parse(payload));
        }
        match messages.len() < MESSAGES && bytes < BYTES {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    })?;
    Ok(messages)
}

fn parse_all(payloads: &[Vec<u8>]) -> Vec<Value> {
    payloads.iter().map(|payload| parse(payload)).collect()
}

/// What is wrong with the first of some messages if none of them is JSON.
fn fault_of_all(payloads: &[Vec<u8>]) -> Option<Fault> {
    let mut faults = payloads.iter().map(|payload| fault::of_message(payload));
    let first = faults.next()??;
    faults.all(|fault| fault.is_some()).then_some(first)
}

/// What is not JSON shows no field.
fn parse(payload: &[u8]) -> Value {
    non_finite::parse(payload).unwrap_or_default()
}
