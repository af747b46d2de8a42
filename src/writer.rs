//! Derived values → channels added to a log.
//!
//! By default they are [appended](Appender): the log's bytes up to the end of its data section stay as they are. They
//! are followed by the new messages, a Metadata record that says how they were made, the log's original end as an
//! attachment, and one summary of everything. Nothing of the log is lost, and all of it can be undone ([`original`]).
//! Or they are [interleaved](Interleaver): among the log's chunks, for readers that use no index.

pub mod destination;
pub mod journal;
pub mod original;
pub mod provenance;

mod append;
mod channels;
mod chunk;
pub(crate) mod copy;
mod data_section;
mod error;
mod interleave;
mod summary;

use std::collections::BTreeMap;

pub use append::Appender;
pub use error::{IdKind, SpecialFile, WriteError};
pub use interleave::Interleaver;
use serde::Serialize;

use crate::messages::{Message, Topic};

/// Where in the log the new messages are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Layout {
    /// The new messages are after the log's data, no byte of which changes, so that it can be undone.
    #[default]
    Append,
    /// Each of the log's chunks is followed by what was derived from its time, for readers that use no index. It cannot
    /// be undone.
    Interleaved,
}

impl Layout {
    /// Its name on the command line and in the log's Metadata record.
    pub fn name(self) -> &'static str {
        match self {
            Self::Append => "append",
            Self::Interleaved => "interleaved",
        }
    }
}

/// Adds messages to a log.
pub trait LogWriter {
    /// Says in which of the log's segments epochs begin, from the second one on; called before the first value. Without
    /// it, nothing is known about that.
    fn divide(&mut self, _epoch_starts: &[usize]) {}

    /// Says that the next values are of this epoch, which is not an earlier one than before.
    ///
    /// # Errors
    /// The output cannot be written, or the log cannot be read.
    fn go_to_epoch(&mut self, _epoch: u32) -> Result<(), WriteError> {
        Ok(())
    }

    /// Adds one message, and before the first of a topic its channel. What is derived comes epoch by epoch, in the order
    /// of its times.
    ///
    /// # Errors
    /// The output cannot be written, the log cannot be read, or it has no id left for a channel.
    fn write(&mut self, message: Message) -> Result<(), WriteError>;

    /// Completes the log, with `facts` on how its new messages were made.
    ///
    /// # Errors
    /// The output cannot be written, or the log cannot be read.
    fn finish(self: Box<Self>, facts: BTreeMap<String, String>) -> Result<Written, WriteError>;
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Messages by topic. One without messages has no channel.
    pub messages: BTreeMap<Topic, u64>,
    /// Log times of the earliest and the latest of them.
    pub times: Option<(u64, u64)>,
    /// Bytes of the log that are in the result unchanged.
    pub kept: u64,
    /// Bytes of the result.
    pub length: u64,
    /// Whether the log's data does not match the checksum in the log. Then the result has none.
    pub checksum_was_wrong: bool,
}
