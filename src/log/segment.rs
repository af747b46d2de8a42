//! The messages of a segment.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{MessageIndex, MessageIndexEntry, op};

use super::{
    Log,
    chunk::{ChunkReader, check_length},
    contents::{Segment, SegmentKind},
    error::{Damage, ReadError, RecordKind},
    file::LogFile,
    message_index::new_message_indexes,
    partial_chunk::PartialChunkReader,
    record::{RawMessage, Records},
};

/// Reads the messages of one segment after the other, reusing its buffers.
pub struct SegmentReader<'a> {
    pub(super) file: &'a LogFile,
    loose: Vec<u8>,
    chunks: ChunkReader,
    partial: PartialChunkReader,
}

impl<'a> SegmentReader<'a> {
    /// Reads the segments of a log.
    pub fn new(log: &'a Log) -> Self {
        Self {
            file: &log.file,
            loose: Vec::new(),
            chunks: ChunkReader::default(),
            partial: PartialChunkReader::default(),
        }
    }

    /// Reads the messages that a segment has on the wanted channels, in the order of the file.
    ///
    /// If the segment is an uncompressed chunk with message indexes, only these messages are read, unless they are the
    /// greater part of it or the indexes are wrong. If only these are read, the chunk's checksum is not checked,
    /// because that takes all of its bytes.
    ///
    /// # Errors
    /// The segment cannot be read or is damaged, or has messages of a channel that its index leaves out.
    pub fn read(
        &mut self,
        segment: &Segment,
        wanted: &BTreeSet<u16>,
    ) -> Result<impl Iterator<Item = Result<RawMessage<'_>, ReadError>>, ReadError> {
        let file = self.file;
        let Segment { offset, length, .. } = *segment;
        if let SegmentKind::Chunk { .. } = segment.kind {
            check_length(length).map_err(|damage| file.damaged(offset, damage))?;
        }
        let records = match self.partial.read(file, segment, wanted)? {
            Some(records) => records,
            None if matches!(segment.kind, SegmentKind::Loose) => {
                file.read_into(&mut self.loose, offset, length)?;
                Records::new(&self.loose)
            }
            None => self.chunks.read(file, offset, length)?.1,
        };
        let ids = segment.message_counts.keys();
        let is_wanted: BTreeMap<u16, bool> = ids.map(|id| (*id, wanted.contains(id))).collect();
        let messages = messages(file, offset, records);
        Ok(messages.filter_map(move |message| match message {
            Ok((_, message)) => match is_wanted.get(&message.channel_id) {
                Some(true) => Some(Ok(message)),
                Some(false) => None,
                None => {
                    let channel_id = message.channel_id;
                    Some(Err(file.damaged(offset, Damage::NotInIndex { channel_id })))
                }
            },
            Err(error) => Some(Err(error)),
        }))
    }

    /// Makes the message indexes of a chunk from its messages.
    ///
    /// # Errors
    /// The chunk cannot be read or is damaged.
    pub fn message_indexes(&mut self, chunk: &Segment) -> Result<Vec<MessageIndex>, ReadError> {
        let (_, records) = self.chunks.read(self.file, chunk.offset, chunk.length)?;
        let mut entries: BTreeMap<u16, Vec<MessageIndexEntry>> = BTreeMap::new();
        for message in messages(self.file, chunk.offset, records) {
            let (offset, message) = message?;
            let log_time = message.log_time;
            let of_channel = entries.entry(message.channel_id).or_default();
            of_channel.push(MessageIndexEntry { log_time, offset });
        }
        Ok(new_message_indexes(entries).collect())
    }
}

/// The messages among the records of the segment that starts at `start`, each with its offset in the segment's content.
fn messages<'a>(
    file: &'a LogFile,
    start: u64,
    records: Records<'a>,
) -> impl Iterator<Item = Result<(u64, RawMessage<'a>), ReadError>> {
    let malformed = move || file.damaged(start, Damage::Torn);
    records.filter_map(move |record| match record {
        Ok(record) if record.opcode == op::MESSAGE => Some(
            RawMessage::parse(record.body)
                .map(|message| (record.offset as u64, message))
                .ok_or_else(malformed),
        ),
        Ok(record) => RecordKind::of(record.opcode)
            .filter(|kind| *kind != RecordKind::Definition)
            .map(|kind| {
                let position = record.offset as u64;
                Err(file.damaged(start, Damage::MisplacedInChunk { kind, position }))
            }),
        Err(_) => Some(Err(malformed())),
    })
}
