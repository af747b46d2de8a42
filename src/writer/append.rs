//! Appending to a log: new messages, provenance, the original's end, summary.

use std::{borrow::Cow, collections::BTreeMap, io::Write, path::PathBuf};

use mcap::records::AttachmentHeader;

use super::{
    Layout, LogWriter, Written, channels::NewChannels, chunk::Batch, data_section::DataSection,
    error::WriteError, original, provenance, summary,
};
use crate::{
    log::{
        Log, ReadError, SegmentReader,
        contents::{Contents, SegmentKind},
    },
    messages::{Format, Message},
};

/// Appends new channels to a log.
pub struct Appender<'a, W> {
    log: &'a Log,
    /// The output's path, for errors.
    path: PathBuf,
    section: DataSection<W>,
    /// The attachment with the log's end. Made before the first write, which may overwrite that end.
    tail: Vec<u8>,
    channels: NewChannels<'a>,
    batch: Batch,
    /// What the log contains, with the message indexes that its chunks lacked.
    contents: Cow<'a, Contents>,
}

impl<'a, W: Write> Appender<'a, W> {
    /// Starts after the log's data section, where `out` is positioned. The new messages are written in `format`; errors
    /// call the output `path`.
    ///
    /// # Errors
    /// The output cannot be written, or the log cannot be read.
    pub fn begin(log: &'a Log, out: W, path: PathBuf, format: Format) -> Result<Self, WriteError> {
        let failed = |source| WriteError::output(&path, source);
        let tail = original::encode(log)?;
        let mut section = DataSection::new(out, log.data_end, log.data_crc).map_err(failed)?;
        let contents = match log.contents.has_loose_messages() {
            true => Cow::Borrowed(&log.contents),
            false => index_chunks(log, log.data_end, |bytes| {
                section.write(bytes).map_err(failed)
            })?,
        };
        Ok(Self {
            section,
            tail,
            log,
            path,
            channels: NewChannels::new(log, format),
            batch: Batch::default(),
            contents,
        })
    }
}

impl<W: Write> LogWriter for Appender<'_, W> {
    fn write(&mut self, message: Message) -> Result<(), WriteError> {
        // The messages of a chunk are in the order of their times, so that a viewer that seeks finds few chunks.
        if (self.batch.times()).is_some_and(|(_, end)| message.log_time() < end) {
            self.write_batch()?;
        }
        self.channels
            .push(&message, &mut self.batch, &mut self.section.added)?;
        match self.batch.is_full() {
            true => self.write_batch(),
            false => Ok(()),
        }
    }

    fn finish(mut self: Box<Self>, facts: BTreeMap<String, String>) -> Result<Written, WriteError> {
        self.write_batch()?;
        let messages = self.channels.messages();
        let Self {
            log,
            path,
            mut section,
            tail,
            contents,
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
            .and_then(|()| section.finish(|added, start| summary::encode(&contents, added, start)))
            .map_err(|source| WriteError::output(&path, source))?;
        Ok(Written {
            messages,
            times: added.times,
            kept: log.data_end,
            length,
            checksum_was_wrong: false,
        })
    }
}

impl<W: Write> Appender<'_, W> {
    fn write_batch(&mut self) -> Result<(), WriteError> {
        let (section, batch) = (&mut self.section, &mut self.batch);
        // A chunk index would hide the messages outside chunks.
        let written = match self.log.contents.has_loose_messages() {
            false => section.write_chunk(batch),
            true => section.write_loose(batch),
        };
        written.map_err(|source| WriteError::output(&self.path, source))
    }
}

/// Makes the message indexes that a log's chunks lack, without which a seeking reader refuses a chunk. They are to be
/// written at `position`, with `write`. Returns what the log contains together with them.
///
/// # Errors
/// Those of `write`, or the log cannot be read.
pub(super) fn index_chunks<E: From<ReadError>>(
    log: &Log,
    mut position: u64,
    mut write: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<Cow<'_, Contents>, E> {
    let mut contents = Cow::Borrowed(&log.contents);
    let mut reader = SegmentReader::new(log);
    for (number, segment) in log.contents.segments.iter().enumerate() {
        if let SegmentKind::Chunk {
            index,
            is_indexed: false,
        } = &segment.kind
        {
            let indexes = reader.message_indexes(segment)?;
            let mut index = index.clone();
            let bytes = summary::encode_message_indexes(&mut index, indexes, position);
            write(&bytes)?;
            position += bytes.len() as u64;
            contents.to_mut().segments[number].kind = SegmentKind::Chunk {
                index,
                is_indexed: true,
            };
        }
    }
    Ok(contents)
}
