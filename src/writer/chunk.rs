//! Filling a chunk, and compressing it.

use std::{collections::BTreeMap, io};

use mcap::records::{ChunkHeader, ChunkIndex, MessageIndexEntry, op};

use crate::log::{
    message_index::{new_message_indexes, push_message_indexes},
    record::{push_record, serialize},
};

/// The compression of new chunks, as MCAP names it.
const COMPRESSION: &str = "zstd";

/// Bytes of a new chunk before compression, few enough that a viewer that seeks loads little.
const FULL: usize = 1024 * 1024;

/// Records that become a chunk or, in a log that must have none, follow one another in its data section.
#[derive(Debug, Default)]
pub struct Batch {
    /// The records, as they will be in the file.
    records: Vec<u8>,
    /// The offsets in them of the messages of each channel.
    indexes: BTreeMap<u16, Vec<MessageIndexEntry>>,
    times: Option<(u64, u64)>,
}

/// A chunk and its message indexes, as they will be in the file.
pub struct Chunk {
    /// The records.
    pub bytes: Vec<u8>,
    /// Where they will be.
    pub index: ChunkIndex,
}

impl Batch {
    /// The records, as they will be in the file.
    pub fn records(&self) -> &[u8] {
        &self.records
    }

    /// Whether it is large enough to be written.
    pub fn is_full(&self) -> bool {
        self.records.len() >= FULL
    }

    /// Log times of the earliest and the latest message.
    pub fn times(&self) -> Option<(u64, u64)> {
        self.times
    }

    /// Messages by channel.
    pub fn message_counts(&self) -> impl Iterator<Item = (u16, u64)> {
        (self.indexes.iter()).map(|(&id, entries)| (id, entries.len() as u64))
    }

    /// Adds a schema or a channel.
    pub fn push_definition(&mut self, opcode: u8, body: &[u8]) {
        push_record(&mut self.records, opcode, body);
    }

    /// Adds a message, given as the body of its record.
    pub fn push_message(&mut self, channel_id: u16, log_time: u64, body: &[u8]) {
        let entry = MessageIndexEntry {
            log_time,
            offset: self.records.len() as u64,
        };
        self.indexes.entry(channel_id).or_default().push(entry);
        let (start, end) = self.times.unwrap_or((log_time, log_time));
        self.times = Some((start.min(log_time), end.max(log_time)));
        push_record(&mut self.records, op::MESSAGE, body);
    }

    /// Removes all records.
    pub fn clear(&mut self) {
        self.records.clear();
        self.indexes.clear();
        self.times = None;
    }

    /// Compresses the records into a chunk, to be written at `position` in the file.
    pub fn compress(
        &self,
        position: u64,
        compressor: &mut zstd::bulk::Compressor,
    ) -> io::Result<Chunk> {
        let compressed = compressor.compress(&self.records)?;
        let (message_start_time, message_end_time) = self.times.unwrap_or_default();
        let header = ChunkHeader {
            message_start_time,
            message_end_time,
            uncompressed_size: self.records.len() as u64,
            uncompressed_crc: crc32fast::hash(&self.records),
            compression: COMPRESSION.to_owned(),
            compressed_size: compressed.len() as u64,
        };
        let mut body = serialize(&header);
        body.extend_from_slice(&compressed);
        let mut bytes = Vec::with_capacity(body.len());
        push_record(&mut bytes, op::CHUNK, &body);
        let chunk_length = bytes.len() as u64;
        let indexes = new_message_indexes(self.indexes.clone());
        let message_index_offsets = push_message_indexes(indexes, position, &mut bytes);
        let index = ChunkIndex {
            message_start_time,
            message_end_time,
            chunk_start_offset: position,
            chunk_length,
            message_index_length: bytes.len() as u64 - chunk_length,
            message_index_offsets,
            compression: header.compression,
            compressed_size: header.compressed_size,
            uncompressed_size: header.uncompressed_size,
        };
        Ok(Chunk { bytes, index })
    }
}
