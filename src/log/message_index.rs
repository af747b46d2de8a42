//! Message indexes: reading those that follow a chunk, as far as they can be trusted, and making new ones.

use std::collections::BTreeMap;

use mcap::records::{MessageIndex, MessageIndexEntry, op};

use super::{
    contents::{Segment, SegmentKind},
    error::ReadError,
    file::LogFile,
    record::{FRAME_LENGTH, parse, push_record, serialize, split_frame},
};

/// The bytes of a message index before its entries (frame, channel id, length), and of one entry.
pub const MESSAGE_INDEX_PREFIX: u64 = FRAME_LENGTH as u64 + 2 + 4;
pub const MESSAGE_INDEX_ENTRY: u64 = 8 + 8;

/// A longer message index is not used: it takes more memory than the chunk of even a million messages does.
const LONGEST: u64 = 32 * 1024 * 1024;

/// The entries of a channel's message index; `None` if the segment has no index of that channel, or a very long one, or
/// one that does not list as many messages as the channel has there.
pub fn message_index(
    file: &LogFile,
    segment: &Segment,
    channel_id: u16,
) -> Result<Option<Vec<MessageIndexEntry>>, ReadError> {
    let SegmentKind::Chunk { index, .. } = &segment.kind else {
        return Ok(None);
    };
    let offset = index.record.message_index_offsets.get(&channel_id);
    let count = segment.message_counts.get(&channel_id);
    let (Some(&offset), Some(&count)) = (offset, count) else {
        return Ok(None);
    };
    // The length that follows from the count, regardless of what the record itself claims.
    let length = MESSAGE_INDEX_PREFIX.saturating_add(count.saturating_mul(MESSAGE_INDEX_ENTRY));
    if length > LONGEST || offset.saturating_add(length) > file.length() {
        return Ok(None);
    }
    let record = file.read(offset, length)?;
    let (frame, body) = record.split_at(FRAME_LENGTH);
    let index = split_frame(frame)
        .filter(|(opcode, _)| *opcode == op::MESSAGE_INDEX)
        .and_then(|_| parse::<MessageIndex>(body).ok())
        .filter(|index| index.channel_id == channel_id && index.records.len() as u64 == count);
    Ok(index.map(|index| index.records))
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
