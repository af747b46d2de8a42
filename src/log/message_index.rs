//! Message indexes: reading those that follow a chunk, as far as they can be trusted, and making new ones.

use std::collections::BTreeMap;

use mcap::records::{MessageIndex, MessageIndexEntry, op};

use super::{
    contents::{Segment, SegmentKind},
    error::ReadError,
    file::LogFile,
    record::{FRAME_LENGTH, MessageIndexStart, parse, push_record, serialize, split_frame},
};

/// The bytes of a message index before its entries (frame, channel id, length), and of one entry.
pub const MESSAGE_INDEX_PREFIX: u64 = FRAME_LENGTH as u64 + 2 + 4;
pub const MESSAGE_INDEX_ENTRY: u64 = 8 + 8;

/// The same, to slice with.
const HEAD: usize = MESSAGE_INDEX_PREFIX as usize;

/// A longer message index is not used: it takes more memory than the chunk of even a million messages does.
const LONGEST: u64 = 32 * 1024 * 1024;

/// The entries of a message index, as they are in the file.
pub struct IndexEntries(Vec<u8>);

impl IndexEntries {
    /// One after the other.
    pub fn iter(&self) -> impl Iterator<Item = MessageIndexEntry> {
        let number = |bytes: &[u8; 8]| u64::from_le_bytes(*bytes);
        let (entries, _) = self.0[HEAD..].as_chunks::<{ MESSAGE_INDEX_ENTRY as usize }>();
        entries.iter().filter_map(move |entry| {
            let (log_time, rest) = entry.split_first_chunk()?;
            let (offset, _) = rest.split_first_chunk()?;
            Some(MessageIndexEntry {
                log_time: number(log_time),
                offset: number(offset),
            })
        })
    }
}

/// The entries of a channel's message index; `None` if the segment has no index of that channel, or a very long one, or
/// one that does not list as many messages as the channel has there.
pub fn message_index(
    file: &LogFile,
    segment: &Segment,
    channel_id: u16,
) -> Result<Option<IndexEntries>, ReadError> {
    let SegmentKind::Chunk { index, .. } = &segment.kind else {
        return Ok(None);
    };
    let offset = index.record.message_index_offsets.get(&channel_id);
    let count = segment.message_counts.get(&channel_id);
    let (Some(&offset), Some(&count)) = (offset, count) else {
        return Ok(None);
    };
    // The length that follows from the count, regardless of what the record itself claims.
    let entries = count.saturating_mul(MESSAGE_INDEX_ENTRY);
    let length = MESSAGE_INDEX_PREFIX.saturating_add(entries);
    if length > LONGEST || offset.saturating_add(length) > file.length() {
        return Ok(None);
    }
    let record = file.read(offset, length)?;
    let is_index = split_frame(&record).is_some_and(|(opcode, _)| opcode == op::MESSAGE_INDEX);
    let start = parse::<MessageIndexStart>(&record[FRAME_LENGTH..HEAD]);
    let is_this = start
        .is_ok_and(|start| start.channel_id == channel_id && u64::from(start.length) == entries);
    Ok((is_index && is_this).then_some(IndexEntries(record)))
}

/// The message indexes of a chunk with these entries by channel.
pub fn new_message_indexes(
    entries: BTreeMap<u16, Vec<MessageIndexEntry>>,
) -> impl Iterator<Item = MessageIndex> {
    entries.into_iter().map(|(channel_id, mut records)| {
        records.sort_by_key(|entry| entry.log_time);
        MessageIndex {
            channel_id,
            records,
        }
    })
}

/// Appends message indexes to bytes that start at `position` in the file. Returns the offset of each, by channel.
pub fn push_message_indexes(
    indexes: impl IntoIterator<Item = MessageIndex>,
    position: u64,
    bytes: &mut Vec<u8>,
) -> BTreeMap<u16, u64> {
    let mut offsets = BTreeMap::new();
    for index in indexes {
        offsets.insert(index.channel_id, position + bytes.len() as u64);
        push_record(bytes, op::MESSAGE_INDEX, &serialize(&index));
    }
    offsets
}
