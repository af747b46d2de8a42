//! A chunk that is not opened: its index, checked against the records that it points to.

use std::collections::BTreeMap;

use mcap::records::{ChunkIndex, op};

use super::{
    contents::{Segment, SegmentKind},
    error::ReadError,
    message_index::{MESSAGE_INDEX_ENTRY, MESSAGE_INDEX_PREFIX},
    record::Raw,
    scan::{Bodies, Next, Walker},
};

/// A chunk as its index describes it.
pub struct IndexedChunk<'a> {
    index: &'a ChunkIndex,
    pub segment: Segment,
    /// The offsets of its message indexes, with their channels, in the order of the file.
    message_indexes: Vec<(u64, u16)>,
    /// Where the last of them ends.
    pub end: u64,
}

impl<'a> IndexedChunk<'a> {
    /// Reads a chunk index; `None` if the number of messages on each channel does not follow from it.
    pub fn of(index: &'a Raw<ChunkIndex>) -> Option<Self> {
        let record = &index.record;
        let chunk_end = record.chunk_start_offset.checked_add(record.chunk_length)?;
        let end = chunk_end.checked_add(record.message_index_length)?;
        let mut message_indexes: Vec<(u64, u16)> = record
            .message_index_offsets
            .iter()
            .map(|(&id, &offset)| (offset, id))
            .collect();
        message_indexes.sort_unstable();
        if message_indexes.first()?.0 != chunk_end {
            return None;
        }
        let ends = message_indexes
            .iter()
            .skip(1)
            .map(|&(offset, _)| offset)
            .chain([end]);
        let mut message_counts = BTreeMap::new();
        for (&(offset, id), end) in message_indexes.iter().zip(ends) {
            let entries = end.checked_sub(offset)?.checked_sub(MESSAGE_INDEX_PREFIX)?;
            if entries % MESSAGE_INDEX_ENTRY != 0 {
                return None;
            }
            if entries > 0 {
                message_counts.insert(id, entries / MESSAGE_INDEX_ENTRY);
            }
        }
        let times = (!message_counts.is_empty())
            .then_some((record.message_start_time, record.message_end_time));
        Some(Self {
            index: record,
            segment: Segment {
                offset: record.chunk_start_offset,
                length: record.chunk_length,
                times,
                message_counts,
                kind: SegmentKind::Chunk {
                    index: index.clone(),
                    is_indexed: true,
                },
            },
            message_indexes,
            end,
        })
    }

    /// Whether the file has it, with the same times, and directly after it these message indexes and nothing else.
    pub fn is_there(&self, records: &mut Walker) -> Result<bool, ReadError> {
        let segment = &self.segment;
        records.go_to(segment.offset);
        let Next::Record(chunk) = records.step()? else {
            return Ok(false);
        };
        let (start, end) = (self.index.message_start_time, self.index.message_end_time);
        let times = [start.to_le_bytes(), end.to_le_bytes()].concat();
        if chunk.opcode != op::CHUNK
            || chunk.end() - chunk.offset != segment.length
            || records.body(&chunk, times.len() as u64)? != times
        {
            return Ok(false);
        }
        for &(offset, id) in &self.message_indexes {
            let Next::Record(frame) = records.step()? else {
                return Ok(false);
            };
            if frame.opcode != op::MESSAGE_INDEX || frame.offset != offset {
                return Ok(false);
            }
            // What else it says is checked where it is used.
            if records.body(&frame, size_of::<u16>() as u64)? != id.to_le_bytes() {
                return Ok(false);
            }
        }
        Ok(records.position() == self.end)
    }
}
