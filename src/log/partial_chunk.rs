//! Reading some of the messages of an uncompressed chunk, by its message indexes.

use std::{collections::BTreeSet, ops::Range};

use mcap::records::op;

use super::{
    contents::{Segment, SegmentKind},
    error::ReadError,
    file::LogFile,
    message_index::message_index,
    record::{FRAME_LENGTH, RawMessage, Records, split_frame},
};

/// Messages that start no further apart than this are read together, and this much is read from the start of the last
/// of them, whose length is not known yet. Reading that much for nothing costs about as much as another system call.
const WINDOW: u64 = 4096;

/// Bytes of the record of an uncompressed chunk before its content: its frame, two times, the content's length and
/// checksum, the empty name of the compression, and the length again.
const CONTENT_OFFSET: u64 = FRAME_LENGTH as u64 + 8 + 8 + 8 + 4 + 4 + 8;

/// Reads some of the messages of one chunk after the other, reusing its buffers.
#[derive(Default)]
pub struct PartialChunkReader {
    entries: Vec<Entry>,
    records: Vec<u8>,
}

/// The position of a message, according to an index.
struct Entry {
    channel_id: u16,
    log_time: u64,
    /// The offset of its record in the chunk's content.
    offset: u64,
}

impl PartialChunkReader {
    /// Reads the records of a chunk's messages on the wanted channels, in the order of the file. Returns `None` if they
    /// cannot be read by themselves, because the chunk is compressed or not indexed or an index is wrong, or if that is
    /// not worthwhile.
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
        let is_possible = match &segment.kind {
            SegmentKind::Chunk { index, is_indexed } => {
                *is_indexed && index.record.compression.is_empty()
            }
            SegmentKind::Loose => false,
        };
        // If all are wanted, there is nothing to leave out.
        if !is_possible || channels.len() == segment.message_counts.len() {
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

/// Groups entries, which are in the order of the file, into those of messages that are read together.
fn runs(entries: &[Entry]) -> impl Iterator<Item = &[Entry]> {
    entries.chunk_by(|one, next| next.offset - one.offset <= WINDOW)
}

/// How much to read from the start of the first message of a group.
fn reach(run: &[Entry]) -> u64 {
    run[run.len() - 1].offset - run[0].offset + WINDOW
}

/// Reads the messages of entries into the start of `records`, one directly after the other. Returns the length of that;
/// `None` if a message is not what its entry says, or two overlap.
fn gather(
    file: &LogFile,
    content: Range<u64>,
    entries: &[Entry],
    records: &mut Vec<u8>,
) -> Result<Option<usize>, ReadError> {
    let length = content.end - content.start;
    let mut packed = 0;
    // Where the previous message ends.
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
