//! What a log contains, according to its summary and to what was scanned.

use std::{
    collections::{BTreeMap, BTreeSet, btree_map::Entry},
    ops::Range,
};

use mcap::records::{
    AttachmentIndex, Channel, ChunkIndex, MetadataIndex, SchemaHeader, Statistics, op,
};

use super::{
    error::Damage,
    record::{MAX_RECORD, Raw, TEXT_ENTRY, parse},
    step_back::StepBack,
};

/// An index of the log's records; its size does not depend on the message count.
#[derive(Debug, Clone, Default)]
pub struct Contents {
    /// The schemas and channels that are defined.
    pub definitions: Definitions,
    /// Where the messages are, in the order of the file.
    pub segments: Vec<Segment>,
    /// Where the attachments are.
    pub attachments: Vec<Raw<AttachmentIndex>>,
    /// Where the Metadata records are.
    pub metadata: Vec<Raw<MetadataIndex>>,
    /// Statistics of what is listed here, regardless of the log's own.
    pub statistics: Statistics,
    /// Channel ids that the log's summary mentions, though perhaps nothing else does.
    pub mentioned_channel_ids: BTreeSet<u16>,
    /// Whether the log's own summary has an index of its chunks, by which readers seek.
    pub has_chunk_index: bool,
    /// How far the log times on each channel go back, if all messages were read in the order of the file.
    pub steps_back: Option<BTreeMap<u16, StepBack>>,
    /// Records of the summary section of unknown kinds: opcode and body.
    pub unknown_summary: Vec<(u8, Vec<u8>)>,
}

/// How much more of a log may be kept in memory, apart from what grows with its messages. All definitions, names and
/// unknown records of a real log take a few megabytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room(u64);

impl Default for Room {
    fn default() -> Self {
        Self(MAX_RECORD)
    }
}

impl Room {
    /// Takes up that many bytes.
    ///
    /// # Errors
    /// There is not that much room left.
    pub fn take(&mut self, length: usize) -> Result<(), Damage> {
        let left = self.0.checked_sub(length as u64);
        self.0 = left.ok_or(Damage::TooMuch)?;
        Ok(())
    }
}

/// Schemas and channels by id; of several records with the same id, the first.
#[derive(Debug, Clone, Default)]
pub struct Definitions {
    /// Schemas by id.
    pub schemas: BTreeMap<u16, SchemaRecord>,
    /// Channels by id.
    pub channels: BTreeMap<u16, Raw<Channel>>,
}

impl Definitions {
    /// Adds a schema or a channel from the body of its record. Returns its id if it is new; `None` if the body cannot
    /// be read.
    pub fn add(&mut self, opcode: u8, body: &[u8]) -> Option<Option<u16>> {
        fn insert<T>(known: &mut BTreeMap<u16, T>, id: u16, new: T) -> Option<u16> {
            match known.entry(id) {
                Entry::Occupied(_) => None,
                Entry::Vacant(place) => {
                    place.insert(new);
                    Some(id)
                }
            }
        }
        Some(if opcode == op::SCHEMA {
            let schema = SchemaRecord::parse(body)?;
            insert(&mut self.schemas, schema.id, schema)
        } else {
            let channel = Raw::<Channel>::parse(body).ok()?;
            insert(&mut self.channels, channel.record.id, channel)
        })
    }

    /// About how many bytes of memory a definition takes: the body of its record and, which may be far more, the map
    /// that a channel has in it.
    pub(super) fn size(&self, opcode: u8, id: u16) -> usize {
        if opcode == op::SCHEMA {
            return self.schemas.get(&id).map_or(0, |schema| schema.body.len());
        }
        self.channels.get(&id).map_or(0, |channel| {
            let entries = channel.record.metadata.iter();
            let sizes = entries.map(|(key, value)| TEXT_ENTRY as usize + key.len() + value.len());
            channel.body.len() + sizes.sum::<usize>()
        })
    }
}

/// A schema, as its record defines it.
#[derive(Debug, Clone)]
pub struct SchemaRecord {
    /// The schema's id. It is not 0, which means "no schema".
    pub id: u16,
    /// The name of the channel's message type.
    pub name: String,
    /// The language in which it is written: `protobuf`, `jsonschema`, …
    pub encoding: String,
    /// The whole body of the schema's record.
    pub body: Vec<u8>,
    data: Range<usize>,
}

impl SchemaRecord {
    /// Reads the body of a schema record; `None` if it breaks off.
    pub fn parse(body: &[u8]) -> Option<Self> {
        let header: SchemaHeader = parse(body).ok()?;
        // Both strings are prefixed with their lengths, and so is the data after them.
        let prefix = 2 + 4 + header.name.len() + 4 + header.encoding.len();
        let (length, data) = body.get(prefix..)?.split_first_chunk()?;
        let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
        data.get(..length)?;
        let start = prefix + 4;
        Some(Self {
            id: header.id,
            name: header.name,
            encoding: header.encoding,
            body: body.to_vec(),
            data: start..start + length,
        })
    }

    /// Whether both are the same schema, apart from their ids and any fields that later versions of the format add.
    pub fn defines_the_same(&self, other: &Self) -> bool {
        (&self.name, &self.encoding, self.data()) == (&other.name, &other.encoding, other.data())
    }

    /// The definition itself, in the schema's encoding.
    pub fn data(&self) -> &[u8] {
        &self.body[self.data.clone()]
    }
}

/// A part of the file that contains messages: a chunk, or a run of messages outside chunks.
#[derive(Debug, Clone)]
pub struct Segment {
    /// Where its first record starts.
    pub offset: u64,
    /// Bytes from there to the end of its last record (message indexes not included).
    pub length: u64,
    /// Log times of its earliest and latest message; `None` if it has no message.
    pub times: Option<(u64, u64)>,
    /// Messages by channel id.
    pub message_counts: BTreeMap<u16, u64>,
    /// What holds the messages.
    pub kind: SegmentKind,
}

impl Segment {
    /// Those of these channels that have messages in it.
    pub fn channels_among(&self, channel_ids: &BTreeSet<u16>) -> BTreeSet<u16> {
        let here = self.message_counts.keys().copied();
        here.filter(|id| channel_ids.contains(id)).collect()
    }
}

/// What holds the messages of a segment.
#[derive(Debug, Clone)]
pub enum SegmentKind {
    /// A chunk.
    Chunk {
        /// Its record in the summary.
        index: Raw<ChunkIndex>,
        /// Whether the log has message indexes for all of the chunk's messages. If it does not, the chunk index
        /// points to none.
        is_indexed: bool,
    },
    /// Messages outside chunks. No index can point to them.
    Loose,
}

impl Contents {
    /// Whether there are messages outside chunks. Readers that find a chunk index look nowhere else.
    pub fn has_loose_messages(&self) -> bool {
        self.segments
            .iter()
            .any(|segment| matches!(segment.kind, SegmentKind::Loose))
    }

    /// The channel ids that occur anywhere in the log.
    pub fn channel_ids(&self) -> BTreeSet<u16> {
        let segments = self.segments.iter().flat_map(|s| s.message_counts.keys());
        self.definitions
            .channels
            .keys()
            .chain(segments)
            .chain(&self.mentioned_channel_ids)
            .copied()
            .collect()
    }

    /// The schema ids that occur anywhere in the log.
    pub fn schema_ids(&self) -> BTreeSet<u16> {
        let named = self
            .definitions
            .channels
            .values()
            .map(|channel| channel.record.schema_id);
        self.definitions
            .schemas
            .keys()
            .copied()
            .chain(named)
            .filter(|&id| id != 0)
            .collect()
    }

    /// The schema of a channel; `None` if it has none or names one that the log does not contain.
    pub fn schema_of(&self, channel: &Channel) -> Option<&SchemaRecord> {
        self.definitions.schemas.get(&channel.schema_id)
    }

    /// The channels that have messages, and how many.
    pub fn channels_with_messages(&self) -> impl Iterator<Item = (&Channel, u64)> {
        self.definitions.channels.values().filter_map(|channel| {
            let counts = &self.statistics.channel_message_counts;
            let count = *counts.get(&channel.record.id)?;
            (count > 0).then_some((&channel.record, count))
        })
    }

    /// Statistics of what is listed here, regardless of the log's own.
    pub fn recount(&self) -> Statistics {
        let mut counts = BTreeMap::new();
        for (&id, &count) in self.segments.iter().flat_map(|s| &s.message_counts) {
            *counts.entry(id).or_default() += count;
        }
        let times = || self.segments.iter().filter_map(|segment| segment.times);
        let chunks = self
            .segments
            .iter()
            .filter(|segment| matches!(segment.kind, SegmentKind::Chunk { .. }));
        Statistics {
            message_count: counts.values().sum(),
            // At most 65535: the id 0 means "no schema".
            schema_count: self.definitions.schemas.len() as u16,
            channel_count: self.definitions.channels.len() as u32,
            attachment_count: self.attachments.len() as u32,
            metadata_count: self.metadata.len() as u32,
            chunk_count: chunks.count() as u32,
            message_start_time: times().map(|(start, _)| start).min().unwrap_or(0),
            message_end_time: times().map(|(_, end)| end).max().unwrap_or(0),
            channel_message_counts: counts,
        }
    }
}
