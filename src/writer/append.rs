//! Appending to a log: new messages, provenance, the original's end, summary.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    path::PathBuf,
};

use mcap::records::{AttachmentHeader, ChunkIndex};

use super::{
    Layout, LogWriter, Written, channels::NewChannels, chunk::Batch, original, provenance,
    section::Section, summary,
};
use crate::{
    derived::Derived,
    error::Error,
    log::{Log, SegmentReader, contents::SegmentKind},
    messages::Format,
};

/// Bytes of a new chunk before compression: so few that a viewer that seeks loads little.
const CHUNK_SIZE: usize = 1024 * 1024;

/// Appends new channels to a log.
pub struct Appender<'a, W> {
    log: &'a Log,
    /// What is written to, for errors.
    path: PathBuf,
    section: Section<W>,
    /// What the log has behind its data section. Had before the first write, because that may replace it.
    tail: Vec<u8>,
    channels: NewChannels<'a>,
    batch: Batch,
    /// The chunk indexes of chunks that had no message indexes until now, by the chunks' offsets.
    reindexed: BTreeMap<u64, ChunkIndex>,
}

impl<'a, W: Write> Appender<'a, W> {
    /// Starts behind the log's data section, which is where `out` goes on. The new messages will be in the
    /// `format`; errors call what is written to `path`.
    ///
    /// # Errors
    /// The output cannot be written, or the log cannot be read.
    pub fn begin(log: &'a Log, out: W, path: PathBuf, format: Format) -> Result<Self, Error> {
        let section = Section::new(out, log.data_end, log.data_crc);
        let mut appender = Self {
            section: section.map_err(|source| write_error(&path, source))?,
            tail: original::encode(log)?,
            log,
            path,
            channels: NewChannels::new(log, format),
            batch: Batch::default(),
            reindexed: BTreeMap::new(),
        };
        if !log.contents.has_loose_messages() {
            appender.write_missing_indexes()?;
        }
        Ok(appender)
    }
}

impl<W: Write> LogWriter for Appender<'_, W> {
    fn write(&mut self, derived: &Derived) -> Result<(), Error> {
        self.channels
            .push(derived, &mut self.batch, &mut self.section.added)?;
        if self.batch.records().len() < CHUNK_SIZE {
            return Ok(());
        }
        self.write_batch()
    }

    fn finish(mut self: Box<Self>, facts: BTreeMap<String, String>) -> Result<Written, Error> {
        self.write_batch()?;
        let messages = self.channels.messages();
        let Self {
            log,
            path,
            mut section,
            tail,
            reindexed,
            ..
        } = *self;
        let record = provenance::record(messages.keys().copied(), Layout::Append, facts);
        // An attachment has a time; the original's end belongs to the end of its messages.
        let log_time = log.contents.statistics.message_end_time;
        let attachment = AttachmentHeader {
            log_time,
            create_time: log_time,
            name: original::NAME.to_owned(),
            media_type: original::MEDIA_TYPE.to_owned(),
        };
        let (length, added) = section
            .write_metadata(&record)
            .and_then(|()| section.write_attachment(attachment, &tail))
            .and_then(|()| {
                section
                    .finish(|added, start| summary::encode(&log.contents, added, &reindexed, start))
            })
            .map_err(|source| write_error(&path, source))?;
        Ok(Written {
            messages,
            times: added.times,
            kept: log.data_end,
            length,
        })
    }
}

impl<W: Write> Appender<'_, W> {
    fn write_batch(&mut self) -> Result<(), Error> {
        let (section, batch) = (&mut self.section, &mut self.batch);
        // A chunk index would hide the messages that lie outside chunks.
        let written = match self.log.contents.has_loose_messages() {
            false => section.write_chunk(batch),
            true => section.write_loose(batch),
        };
        written.map_err(|source| write_error(&self.path, source))
    }

    /// Writes the message indexes that the log's chunks lack, without which a seeking reader refuses a chunk.
    fn write_missing_indexes(&mut self) -> Result<(), Error> {
        let mut reader = SegmentReader::new(self.log);
        for segment in &self.log.contents.segments {
            if let SegmentKind::Chunk {
                index,
                is_indexed: false,
            } = &segment.kind
            {
                let indexes = reader.message_indexes(segment)?;
                let mut bytes = Vec::new();
                let position = self.section.position();
                let chunk = summary::encode_message_indexes(index, &indexes, position, &mut bytes);
                let written = self.section.write(&bytes);
                written.map_err(|source| write_error(&self.path, source))?;
                self.reindexed.insert(segment.offset, chunk);
            }
        }
        Ok(())
    }
}

pub(super) fn write_error(path: &std::path::Path, source: io::Error) -> Error {
    Error::io("cannot write the output", path, source)
}
