//! The selected messages of a log that is passed on, as a log of their own.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::Path,
};

use mcap::records::op;

use super::{Passing, spool::temporary};
use crate::log::{
    Log,
    contents::{Contents, Definitions, Segment, SegmentKind},
    error::ReadError,
    file::LogFile,
    record::{RawMessage, push_record},
};

/// Writes the selected messages to a temporary file.
pub struct Excerpt<F> {
    select: F,
    file: BufWriter<File>,
    /// The selected messages of the current record.
    messages: Vec<u8>,
    /// The number of bytes of each of the log's segments.
    lengths: Vec<u64>,
}

impl<F: FnMut(Passing) -> bool> Excerpt<F> {
    /// Collects the messages that `select` selects.
    pub fn new(select: F) -> Result<Self, ReadError> {
        Ok(Self {
            select,
            file: BufWriter::new(tempfile::tempfile().map_err(temporary)?),
            messages: Vec::new(),
            lengths: Vec::new(),
        })
    }

    /// Takes a message, given with the body of its record, if it is selected.
    pub fn consider(
        &mut self,
        definitions: &Definitions,
        segment: usize,
        message: &RawMessage,
        record: &[u8],
    ) {
        let channel = definitions.channels.get(&message.channel_id);
        let is_selected = channel.is_none_or(|channel| {
            (self.select)(Passing {
                message,
                channel: &channel.record,
                segment,
                definitions,
            })
        });
        if is_selected {
            push_record(&mut self.messages, op::MESSAGE, record);
        }
    }

    /// Writes the messages that were taken, which are in the last of `segments` segments.
    pub fn write_to(&mut self, segments: usize) -> Result<(), ReadError> {
        self.lengths.resize(segments, 0);
        if let Some(length) = self.lengths.last_mut() {
            *length += self.messages.len() as u64;
        }
        self.file.write_all(&self.messages).map_err(temporary)?;
        self.messages.clear();
        Ok(())
    }

    /// Returns the messages as a log of their own.
    pub fn finish(self, name: &Path, original: &Log) -> Result<Log, ReadError> {
        let file = self.file.into_inner();
        let file = file.map_err(|error| temporary(error.into_error()))?;
        let file = LogFile::from_file(name, file)?;
        let mut offset = 0;
        let segments = original.contents.segments.iter().zip(self.lengths);
        let segments = segments.map(|(segment, length)| {
            let segment = Segment {
                offset,
                length,
                kind: SegmentKind::Loose,
                ..segment.clone()
            };
            offset += length;
            segment
        });
        Ok(Log {
            header: original.header.clone(),
            contents: Contents {
                definitions: original.contents.definitions.clone(),
                segments: segments.collect(),
                statistics: original.contents.statistics.clone(),
                steps_back: original.contents.steps_back.clone(),
                ..Contents::default()
            },
            data_end: file.length(),
            data_crc: None,
            scanned: None,
            breaks_off_at: None,
            file,
        })
    }
}
