//! The summary of the result: what the log had, in its own bytes, and what was added.

use std::collections::BTreeMap;

use mcap::records::{ChunkIndex, Footer, MessageIndex, Statistics, SummaryOffset, op};

use super::data_section::Added;
use crate::log::{
    contents::{Contents, SegmentKind},
    message_index::push_message_indexes,
    record::{Raw, push_record, serialize},
};

/// Everything after the data section, which ends at `start`: the summary, its offsets, the footer and the magic bytes.
///
/// `contents` is what the log had, with its new positions. Its records are written byte for byte, so that fields which
/// a later version of the format has appended to them survive.
pub fn encode(contents: &Contents, added: &Added, start: u64) -> Vec<u8> {
    let mut groups = Groups {
        start,
        bytes: Vec::new(),
        offsets: Vec::new(),
    };

    let schemas = contents.definitions.schemas.values();
    let schemas = schemas.map(|schema| schema.body.clone());
    groups.push(op::SCHEMA, schemas.chain(added.schemas.values().cloned()));

    let channels = contents.definitions.channels.values();
    let channels = channels.map(|channel| channel.body.clone());
    groups.push(
        op::CHANNEL,
        channels.chain(added.channels.values().cloned()),
    );

    let statistics = merge_statistics(contents, added);
    groups.push(op::STATISTICS, [serialize(&statistics)].into_iter());

    // Readers that find a chunk index look for messages nowhere else. If there are messages outside chunks, the result
    // has none, so that readers look everywhere.
    if !contents.has_loose_messages() {
        let chunks = contents
            .segments
            .iter()
            .filter_map(|segment| match &segment.kind {
                SegmentKind::Chunk { index, .. } => {
                    Some((index.record.chunk_start_offset, index.body.clone()))
                }
                SegmentKind::Loose => None,
            });
        let new_chunks =
            (added.chunk_indexes.iter()).map(|index| (index.chunk_start_offset, serialize(index)));
        let in_order: BTreeMap<u64, Vec<u8>> = chunks.chain(new_chunks).collect();
        groups.push(op::CHUNK_INDEX, in_order.into_values());
    }

    let attachments = contents.attachments.iter().map(|index| index.body.clone());
    let new_attachments = added.attachment_indexes.iter().map(serialize);
    groups.push(op::ATTACHMENT_INDEX, attachments.chain(new_attachments));

    let metadata = contents.metadata.iter().map(|index| index.body.clone());
    let new_metadata = added.metadata_indexes.iter().map(serialize);
    groups.push(op::METADATA_INDEX, metadata.chain(new_metadata));

    let mut unknown: BTreeMap<u8, Vec<Vec<u8>>> = BTreeMap::new();
    for (opcode, body) in &contents.unknown_summary {
        unknown.entry(*opcode).or_default().push(body.clone());
    }
    for (opcode, bodies) in unknown {
        groups.push(opcode, bodies.into_iter());
    }
    groups.finish()
}

/// New message indexes of a chunk, to be written at `position`. Puts their offsets into its chunk index.
pub fn encode_message_indexes(
    chunk: &mut Raw<ChunkIndex>,
    indexes: Vec<MessageIndex>,
    position: u64,
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let offsets = push_message_indexes(indexes, position, &mut bytes);
    chunk.change(|chunk| {
        chunk.message_index_offsets = offsets;
        chunk.message_index_length = bytes.len() as u64;
    });
    bytes
}

fn merge_statistics(contents: &Contents, added: &Added) -> Statistics {
    let mut merged = contents.statistics.clone();
    if let Some((start, end)) = added.times {
        // The times of a log without messages do not count.
        let is_first = merged.message_count == 0;
        let times = (merged.message_start_time, merged.message_end_time);
        let (earliest, latest) = if is_first { (start, end) } else { times };
        merged.message_start_time = earliest.min(start);
        merged.message_end_time = latest.max(end);
    }
    merged.message_count += added.message_counts.values().sum::<u64>();
    merged.schema_count += added.schemas.len() as u16;
    merged.channel_count += added.channels.len() as u32;
    merged.attachment_count += added.attachment_indexes.len() as u32;
    merged.metadata_count += added.metadata_indexes.len() as u32;
    merged.chunk_count += added.chunk_indexes.len() as u32;
    merged.channel_message_counts.extend(&added.message_counts);
    merged
}

/// A summary section, built group by group.
struct Groups {
    start: u64,
    bytes: Vec<u8>,
    offsets: Vec<SummaryOffset>,
}

impl Groups {
    fn position(&self) -> u64 {
        self.start + self.bytes.len() as u64
    }

    /// Appends the records of one kind.
    fn push(&mut self, group_opcode: u8, bodies: impl Iterator<Item = Vec<u8>>) {
        let group_start = self.position();
        for body in bodies {
            push_record(&mut self.bytes, group_opcode, &body);
        }
        let group_length = self.position() - group_start;
        if group_length > 0 {
            self.offsets.push(SummaryOffset {
                group_opcode,
                group_start,
                group_length,
            });
        }
    }

    fn finish(mut self) -> Vec<u8> {
        let summary_offset_start = self.position();
        for offset in &self.offsets {
            push_record(&mut self.bytes, op::SUMMARY_OFFSET, &serialize(offset));
        }
        let footer = Footer {
            summary_start: self.start,
            summary_offset_start,
            summary_crc: 0,
        };
        push_record(&mut self.bytes, op::FOOTER, &serialize(&footer));
        // The checksum is the footer's last field, and covers everything before it, including the start of the footer.
        let crc_at = self.bytes.len() - size_of::<u32>();
        let crc = crc32fast::hash(&self.bytes[..crc_at]);
        self.bytes[crc_at..].copy_from_slice(&crc.to_le_bytes());
        self.bytes.extend_from_slice(mcap::MAGIC);
        self.bytes
    }
}
