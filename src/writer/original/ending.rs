//! The end of an enriched log, after the last record of its data: made again, to compare. Whatever else were there would
//! be lost if the log were restored.

use std::borrow::Cow;

use mcap::records::op;

use crate::{
    log::{
        Log, ReadError,
        contents::{Contents, SegmentKind},
        file::LogFile,
        record::{FRAME_LENGTH, push_record},
        scan::{Collector, Next, Walker},
        summary::DATA_END_LENGTH,
    },
    writer::{append::index_chunks, data_section::Added, summary},
};

/// What an enriched log has besides its original, from which its end follows, and its end itself.
#[derive(Debug)]
pub struct Ending {
    added: Added,
    /// Where the end begins: with the DataEnd record.
    start: u64,
    bytes: Vec<u8>,
}

impl Ending {
    /// Reads the records that were added, which are from `added` to `start`, and what the file has after them. `None` if
    /// that is much more than a summary.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(file: &LogFile, added: u64, start: u64) -> Result<Option<Self>, ReadError> {
        /// More than any summary.
        const LONGEST: u64 = 1 << 30;
        let length = file.length() - start;
        if length > LONGEST {
            return Ok(None);
        }
        let mut records = Walker::new(file, added, start);
        let mut collector = Collector::default();
        while let Next::Record(frame) = records.step()? {
            collector.record(&mut records, &frame)?;
        }
        Ok(Some(Self {
            added: to_added(collector.finish()),
            start,
            bytes: file.read(start, length)?,
        }))
    }

    /// Whether flightcam wrote it, after what it added to the log `original`. It may be cut short.
    ///
    /// This makes the summary again, so whoever changes what a summary looks like has to go on recognising those that
    /// earlier versions wrote.
    ///
    /// # Errors
    /// The original cannot be read.
    pub fn is_ours(&self, original: &Log) -> Result<bool, ReadError> {
        let contents = match original.contents.has_loose_messages() {
            true => Cow::Borrowed(&original.contents),
            false => index_chunks(original, original.data_end, |_| Ok::<(), ReadError>(()))?,
        };
        // The checksum is that of the data, whatever it is.
        let mut crc = [0; DATA_END_LENGTH];
        let there = self.bytes.get(FRAME_LENGTH..).unwrap_or_default();
        crc.iter_mut()
            .zip(there)
            .for_each(|(crc, &there)| *crc = there);
        let mut expected = Vec::new();
        push_record(&mut expected, op::DATA_END, &crc);
        let summary_start = self.start + expected.len() as u64;
        expected.extend(summary::encode(&contents, &self.added, summary_start));
        Ok(expected.starts_with(&self.bytes))
    }
}

/// What records add up to, as a summary needs it.
fn to_added(contents: Contents) -> Added {
    let statistics = contents.recount();
    let times = (statistics.message_count > 0)
        .then_some((statistics.message_start_time, statistics.message_end_time));
    let definitions = contents.definitions;
    let chunks = contents.segments.into_iter();
    Added {
        schemas: (definitions.schemas.into_iter())
            .map(|(id, schema)| (id, schema.body))
            .collect(),
        channels: (definitions.channels.into_iter())
            .map(|(id, channel)| (id, channel.body))
            .collect(),
        chunk_indexes: chunks
            .filter_map(|segment| match segment.kind {
                SegmentKind::Chunk { index, .. } => Some(index.record),
                SegmentKind::Loose => None,
            })
            .collect(),
        attachment_indexes: (contents.attachments.into_iter())
            .map(|index| index.record)
            .collect(),
        metadata_indexes: (contents.metadata.into_iter())
            .map(|index| index.record)
            .collect(),
        message_counts: statistics.channel_message_counts,
        times,
    }
}
