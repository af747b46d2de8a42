//! What flightcam appends to a log, read again record by record, in the order in which it is written. What is not that
//! is not flightcam's, so it would be lost if it were undone.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{Channel, ChunkHeader, Metadata, op};

use crate::{
    log::{
        ReadError,
        chunk::ChunkDecoder,
        contents::{Contents, SchemaRecord, SegmentKind},
        file::LogFile,
        message_index::MESSAGE_INDEX_ENTRY,
        record::{MAX_RECORD, MessageIndexStart, RawMessage, split},
        scan::{Bodies, Next, Walker},
    },
    messages::Topic,
    writer::provenance,
};

/// What was appended to a log, up to the attachment with its original end.
#[derive(Debug, Default)]
pub struct Added {
    /// Entries of the message indexes that the log's own chunks lacked, by channel.
    indexed: BTreeMap<u16, u64>,
    schemas: BTreeSet<u16>,
    /// The channels: their topics, and the ids of their schemas.
    channels: BTreeMap<u16, (Topic, u16)>,
    /// Where the messages are; not known as long as none came.
    placement: Option<Placement>,
}

/// Where the new messages are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Placement {
    InChunks,
    Loose,
}

/// Messages by channel.
type Counts = BTreeMap<u16, u64>;

impl Added {
    /// Reads what is from `start` on up to the attachment; `None` if flightcam did not write all of it.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(file: &LogFile, start: u64, attachment: u64) -> Result<Option<Self>, ReadError> {
        let mut added = Self::default();
        let mut chunks = ChunkDecoder::default();
        let mut records = Walker::new(file, start, attachment);
        // Messages of the latest chunk that are not indexed yet.
        let mut unindexed = Counts::new();
        let mut is_described = false;
        loop {
            let frame = match records.step()? {
                Next::Record(frame) if frame.length <= MAX_RECORD && !is_described => frame,
                Next::End if is_described => return Ok(Some(added)),
                _ => return Ok(None),
            };
            if frame.opcode != op::MESSAGE_INDEX && !unindexed.is_empty() {
                return Ok(None);
            }
            let body = records.whole(&frame)?;
            let is_ours = match frame.opcode {
                op::MESSAGE_INDEX => added.takes_index(body, &mut unindexed),
                op::CHUNK => {
                    let counts = added.take_chunk(body, &mut chunks);
                    counts.is_some_and(|counts| {
                        unindexed = counts;
                        !unindexed.is_empty()
                    })
                }
                op::METADATA => {
                    is_described = is_description(body);
                    is_described
                }
                opcode => {
                    added.is_placed(Placement::Loose)
                        && added.take(opcode, body, &mut Counts::new()).is_some()
                }
            };
            if !is_ours {
                return Ok(None);
            }
        }
    }

    /// Whether the messages so far are placed like this.
    fn is_placed(&mut self, placement: Placement) -> bool {
        *self.placement.get_or_insert(placement) == placement
    }

    /// Takes a message index: of the latest chunk, or, before any new message, of one of the log's own.
    fn takes_index(&mut self, body: &[u8], unindexed: &mut Counts) -> bool {
        let Ok((start, entries)) = split::<MessageIndexStart>(body) else {
            return false;
        };
        let length = u64::from(start.length);
        if length != entries.len() as u64 || !length.is_multiple_of(MESSAGE_INDEX_ENTRY) {
            return false;
        }
        let count = length / MESSAGE_INDEX_ENTRY;
        match self.placement {
            None => {
                *self.indexed.entry(start.channel_id).or_default() += count;
                true
            }
            Some(_) => unindexed.remove(&start.channel_id) == Some(count),
        }
    }

    /// Takes a chunk. Returns its messages by channel; `None` if flightcam did not write it.
    fn take_chunk(&mut self, body: &[u8], chunks: &mut ChunkDecoder) -> Option<Counts> {
        let (header, content) = split::<ChunkHeader>(body).ok()?;
        if header.compressed_size != content.len() as u64 || !self.is_placed(Placement::InChunks) {
            return None;
        }
        let mut counts = Counts::new();
        let (_, records) = chunks.records(body).ok()?;
        for record in records {
            let record = record.ok()?;
            self.take(record.opcode, record.body, &mut counts)?;
        }
        Some(counts)
    }

    /// Takes a schema, a channel, or a message, which is counted; `None` if flightcam did not write it.
    fn take(&mut self, opcode: u8, body: &[u8], counts: &mut Counts) -> Option<()> {
        match opcode {
            op::SCHEMA => {
                let schema = SchemaRecord::parse(body)?;
                let texts = schema.name.len() + schema.encoding.len() + schema.data().len();
                let is_new = self.schemas.insert(schema.id);
                (is_new && body.len() == 2 + 3 * 4 + texts).then_some(())
            }
            op::CHANNEL => {
                let (channel, appended) = split::<Channel>(body).ok()?;
                let topic = Topic::of_name(&channel.topic)?;
                let is_known = self.channels.values().any(|(known, _)| *known == topic);
                let same_id = self.channels.insert(channel.id, (topic, channel.schema_id));
                (!is_known && same_id.is_none() && appended.is_empty()).then_some(())
            }
            op::MESSAGE => {
                let id = RawMessage::parse(body)?.channel_id;
                *counts.entry(id).or_default() += 1;
                self.channels.contains_key(&id).then_some(())
            }
            _ => None,
        }
    }

    /// Whether this is what enriching the log `original` appends.
    pub fn is_of(&self, original: &Contents) -> bool {
        let (channel_ids, schema_ids) = (original.channel_ids(), original.schema_ids());
        let named: BTreeSet<u16> = self.channels.values().map(|(_, schema)| *schema).collect();
        let is_defined = |id| self.schemas.contains(id) || schema_ids.contains(id);
        let definitions = &original.definitions;
        let has_topic = (definitions.channels.values()).any(|channel| {
            // What another program wrote on these topics could not be told apart.
            let topic = Topic::of_name(&channel.record.topic);
            topic.is_some_and(|topic| self.channels.values().any(|(added, _)| *added == topic))
        });
        let placement = match original.has_loose_messages() {
            true => Placement::Loose,
            false => Placement::InChunks,
        };
        !has_topic
            && self.channels.keys().all(|id| !channel_ids.contains(id))
            && self.schemas.iter().all(|id| !schema_ids.contains(id))
            && self.schemas.is_subset(&named)
            && named.iter().all(is_defined)
            && self.placement == Some(placement)
            && self.indexed == missing_entries(original)
    }
}

/// Whether the body of a Metadata record is that of the record that says how the messages were made.
fn is_description(body: &[u8]) -> bool {
    let record = split::<Metadata>(body);
    record.is_ok_and(|(record, appended)| record.name == provenance::NAME && appended.is_empty())
}

/// Entries of the message indexes that a log's chunks lack, by channel. They are written anew, unless the log has
/// messages outside chunks and so gets no chunk index.
fn missing_entries(original: &Contents) -> Counts {
    let mut missing = Counts::new();
    if original.has_loose_messages() {
        return missing;
    }
    for segment in &original.segments {
        let SegmentKind::Chunk { is_indexed, .. } = segment.kind else {
            continue;
        };
        for (&id, &count) in segment.message_counts.iter().filter(|_| !is_indexed) {
            *missing.entry(id).or_default() += count;
        }
    }
    missing
}
