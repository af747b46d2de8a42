//! Picking messages out of an uncompressed chunk by its message indexes.

use std::{collections::BTreeSet, ops::Range};

use mcap::records::op;

use super::{
    contents::{Segment, SegmentKind},
    error::ReadError,
    file::LogFile,
    message_index::message_index,
    record::{FRAME_LENGTH, RawMessage, Records, split_frame},
};

/// Messages that start no further apart are read together, and from the start of the last of them so much, because its
/// length is not known yet. To read so much in vain costs about as much as to ask the system once more.
const WINDOW: u64 = 4096;

/// Bytes of the record of an uncompressed chunk before its content: its frame, two times, the content's length and
/// checksum, the empty name of the compression, and the length again.
const CONTENT_OFFSET: u64 = FRAME_LENGTH as u64 + 8 + 8 + 8 + 4 + 4 + 8;

/// Picks messages out of one chunk after the other, reusing its buffers.
#[derive(Default)]
pub struct SparseReader {
    entries: Vec<Entry>,
    records: Vec<u8>,
}

/// What an index says of a message.
struct Entry {
    channel_id: u16,
    log_time: u64,
    /// Of its record among those of the chunk.
    offset: u64,
}

impl SparseReader {
    /// The records of a chunk's messages on the wanted channels, in the order of the file. `None` where they cannot
    /// be picked, because the chunk is compressed or not indexed or an index lies, or where that is not worth it.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(
        &mut self,
        file: &LogFile,
        segment: &Segment,
        wanted: &BTreeSet<u16>,
    ) -> Result<Option<Records<'_>>, ReadError> {
        let channels = segment.channels_among(wanted);
        let is_pickable = match &segment.kind {
            SegmentKind::Chunk { index, is_indexed } => {
                *is_indexed && index.record.compression.is_empty()
            }
            SegmentKind::Loose => false,
        };
        // Where all are wanted there is nothing to leave out.
        if !is_pickable || channels.len() == segment.message_counts.len() {
            return Ok(None);
        }
        self.entries.clear();
        for channel_id in channels {
            let Some(index) = message_index(file, segment, channel_id)? else {
                return Ok(None);
            };
            self.entries.extend(index.iter().map(|entry| Entry {
                channel_id,
                log_time: entry.log_time,
                offset: entry.offset,
            }));
        }
        self.entries.sort_unstable_by_key(|entry| entry.offset);
        let length = segment.length.saturating_sub(CONTENT_OFFSET);
        let is_within = (self.entries.last()).is_some_and(|last| last.offset < length);
        if !is_within || runs(&self.entries).map(reach).sum::<u64>() > length / 2 {
            return Ok(None);
        }
        let start = segment.offset + CONTENT_OFFSET;
        let content = start..start + length;
        let packed = gather(file, content, &self.entries, &mut self.records)?;
        Ok(packed.map(|packed| Records::new(&self.records[..packed])))
    }
}

/// The entries of messages that are read together, which lie in the order of the file.
fn runs(entries: &[Entry]) -> impl Iterator<Item = &[Entry]> {
    entries.chunk_by(|one, next| next.offset - one.offset <= WINDOW)
}

/// How much is read from the start of a run's first message.
fn reach(run: &[Entry]) -> u64 {
    run[run.len() - 1].offset - run[0].offset + WINDOW
}

/// Reads the messages of entries that lie within the content, packed behind one another at the start of `records`.
/// How long that is; `None` if one of them is not what its entry says, or two overlap.
fn gather(
    file: &LogFile,
    content: Range<u64>,
    entries: &[Entry],
    records: &mut Vec<u8>,
) -> Result<Option<usize>, ReadError> {
    let length = content.end - content.start;
    let mut packed = 0;
    // Where the message before ends.
    let mut end = 0;
    for run in runs(entries) {
        let (run_start, place) = (run[0].offset, packed);
        let reach = reach(run).min(length - run_start);
        file.read_after(records, place, content.start + run_start, reach)?;
        for entry in run {
            let start = place + (entry.offset - run_start) as usize;
            let Some((op::MESSAGE, body)) = split_frame(&records[start..]) else {
                return Ok(None);
            };
            let overlaps = entry.offset < end;
            end = (entry.offset + FRAME_LENGTH as u64).saturating_add(body);
            if overlaps || end > length {
                return Ok(None);
            }
            let (needed, kept) = (end - run_start, records.len());
            if let missing @ 1.. = needed.saturating_sub((kept - place) as u64) {
                file.read_after(records, kept, content.start + end - missing, missing)?;
            }
            let stop = place + needed as usize;
            let message = RawMessage::parse(&records[start + FRAME_LENGTH..stop]);
            let said = (entry.channel_id, entry.log_time);
            if message.map(|message| (message.channel_id, message.log_time)) != Some(said) {
                return Ok(None);
            }
            records.copy_within(start..stop, packed);
            packed += stop - start;
        }
    }
    Ok(Some(packed))
}
