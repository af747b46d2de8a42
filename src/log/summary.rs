//! The summary section: what a log says of itself, and how far that can be believed.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{AttachmentIndex, Channel, ChunkIndex, Footer, MetadataIndex, Statistics, op};

use super::{
    contents::{Contents, Schema, Segment, SegmentKind},
    file::LogFile,
    record::{FRAME_LENGTH, Raw, Records, parse, split_frame},
    scan::{Collector, Step, Walker},
};
use crate::error::Error;

/// Bytes of a footer record's body: where the summary and its offsets start, and a checksum.
const FOOTER_LENGTH: usize = 8 + 8 + 4;

/// Bytes of a DataEnd record's body: a checksum.
const DATA_END_LENGTH: usize = 4;

/// The bytes of a message index before its entries (frame, channel id, length), and of one entry.
const MESSAGE_INDEX_PREFIX: u64 = FRAME_LENGTH as u64 + 2 + 4;
const MESSAGE_INDEX_ENTRY: u64 = 8 + 8;

/// The end of a log that was closed properly.
pub struct Ending {
    /// Where the data section ends: the DataEnd record, or the footer where there is none.
    pub data_end: u64,
    /// The data section's checksum, where the log has one.
    pub data_crc: Option<u32>,
    /// The summary, unless there is none or it is damaged.
    pub summary: Option<Summary>,
}

/// The records of a summary section.
#[derive(Default)]
pub struct Summary {
    schemas: BTreeMap<u16, Schema>,
    channels: BTreeMap<u16, Raw<Channel>>,
    chunk_indexes: Vec<Raw<ChunkIndex>>,
    attachments: Vec<Raw<AttachmentIndex>>,
    metadata: Vec<Raw<MetadataIndex>>,
    statistics: Option<Statistics>,
    unknown: Vec<(u8, Vec<u8>)>,
}

impl Ending {
    /// Reads the end of the file; `None` where it does not end as a closed log does.
    pub fn read(file: &LogFile) -> Result<Option<Self>, Error> {
        let tail = (FRAME_LENGTH + FOOTER_LENGTH + mcap::MAGIC.len()) as u64;
        let Some(footer_offset) = file.len().checked_sub(tail) else {
            return Ok(None);
        };
        let tail = file.read(footer_offset, tail)?;
        let (footer_record, magic) = tail.split_at(FRAME_LENGTH + FOOTER_LENGTH);
        let is_footer = split_frame(footer_record) == Some((op::FOOTER, FOOTER_LENGTH as u64));
        let Ok(footer) = parse::<Footer>(&footer_record[FRAME_LENGTH..]) else {
            return Ok(None);
        };
        if magic != mcap::MAGIC || !is_footer {
            return Ok(None);
        }

        let summary_start = match footer.summary_start {
            0 => footer_offset,
            start => start,
        };
        let data_end_length = (FRAME_LENGTH + DATA_END_LENGTH) as u64;
        let Some(data_end) = summary_start.checked_sub(data_end_length) else {
            return Ok(None);
        };
        if summary_start > footer_offset {
            return Ok(None);
        }
        let record = file.read(data_end, data_end_length)?;
        let (frame, crc) = record.split_at(FRAME_LENGTH);
        if split_frame(frame) != Some((op::DATA_END, DATA_END_LENGTH as u64)) {
            return Ok(None);
        }
        let crc = u32::from_le_bytes(crc.try_into().expect("it is four bytes long"));

        let section = file.read(summary_start, footer_offset - summary_start)?;
        let intact = footer.summary_crc == 0 || {
            let mut hasher = crc32fast::Hasher::new();
            hasher.update(&section);
            hasher.update(&footer_record[..FRAME_LENGTH + 8 + 8]);
            hasher.finalize() == footer.summary_crc
        };
        Ok(Some(Self {
            data_end,
            data_crc: (crc != 0).then_some(crc),
            summary: (footer.summary_start != 0 && intact)
                .then(|| Summary::parse(&section))
                .flatten(),
        }))
    }
}

impl Summary {
    fn parse(section: &[u8]) -> Option<Self> {
        let mut summary = Self::default();
        for record in Records::new(section) {
            let record = record.ok()?;
            let body = record.body;
            match record.opcode {
                op::SCHEMA => {
                    let schema = Schema::parse(body)?;
                    summary.schemas.entry(schema.id).or_insert(schema);
                }
                op::CHANNEL => {
                    let channel = Raw::<Channel>::parse(body).ok()?;
                    let channels = &mut summary.channels;
                    channels.entry(channel.record.id).or_insert(channel);
                }
                op::CHUNK_INDEX => summary.chunk_indexes.push(Raw::parse(body).ok()?),
                op::ATTACHMENT_INDEX => summary.attachments.push(Raw::parse(body).ok()?),
                op::METADATA_INDEX => summary.metadata.push(Raw::parse(body).ok()?),
                op::STATISTICS => summary.statistics = Some(parse(body).ok()?),
                op::SUMMARY_OFFSET => {}
                opcode => summary.unknown.push((opcode, body.to_vec())),
            }
        }
        summary
            .chunk_indexes
            .sort_by_key(|index| index.record.chunk_start_offset);
        Some(summary)
    }

    /// What the log holds, if this summary and the records between the indexed chunks account for all of it
    /// without a contradiction; else `None`, and the log has to be read from start to end.
    ///
    /// No chunk is opened for this: how many messages an indexed chunk has, of which channel, follows from
    /// the lengths of its message indexes.
    pub fn account_for(&self, file: &LogFile, data_end: u64) -> Result<Option<Contents>, Error> {
        let Some(statistics) = &self.statistics else {
            return Ok(None);
        };
        let contents = Contents {
            schemas: self.schemas.clone(),
            channels: self.channels.clone(),
            attachments: self.attachments.clone(),
            metadata: self.metadata.clone(),
            unknown_summary: self.unknown.clone(),
            ..Contents::default()
        };
        let mut collector = Collector::with(contents);
        let mut position = mcap::MAGIC.len() as u64;
        let mut found = BTreeSet::new();
        let chunks = self.chunk_indexes.iter().map(Some).chain([None]);
        for chunk in chunks {
            let gap_end = chunk.map_or(data_end, |index| index.record.chunk_start_offset);
            if gap_end < position || gap_end > data_end {
                return Ok(None);
            }
            let mut walker = Walker::new(file, position, gap_end);
            loop {
                match walker.step()? {
                    Step::Record(frame) if frame.opcode == op::CHUNK => return Ok(None),
                    Step::Record(frame) => {
                        collector.record(&mut walker, &frame)?;
                        found.insert(frame.offset);
                    }
                    Step::End => break,
                    Step::Torn { .. } => return Ok(None),
                }
            }
            if let Some(index) = chunk {
                let Some((segment, end)) = indexed_chunk(index) else {
                    return Ok(None);
                };
                collector.contents.segments.push(segment);
                position = end;
            }
        }

        let mut contents = collector.finish();
        contents.statistics = contents.recount();
        let recount = &contents.statistics;
        let mut counts = statistics.channel_message_counts.clone();
        counts.retain(|_, count| *count > 0);
        let indexed_offsets = (self.attachments.iter().map(|index| index.record.offset))
            .chain(self.metadata.iter().map(|index| index.record.offset));
        let consistent = counts == recount.channel_message_counts
            && statistics.message_count == recount.message_count
            && statistics.message_start_time == recount.message_start_time
            && statistics.message_end_time == recount.message_end_time
            && statistics.chunk_count == recount.chunk_count
            && indexed_offsets
                .into_iter()
                .all(|offset| found.contains(&offset))
            && contents
                .channel_ids()
                .iter()
                .all(|id| contents.channels.contains_key(id))
            && contents
                .schema_ids()
                .iter()
                .all(|id| contents.schemas.contains_key(id));
        Ok(consistent.then_some(contents))
    }

    /// Adds to what a scan found what only the summary says, and takes over the bytes of those of its
    /// records that the scan confirmed.
    pub fn supplement(self, contents: &mut Contents) {
        for (id, schema) in self.schemas {
            contents.schemas.entry(id).or_insert(schema);
        }
        for (id, channel) in self.channels {
            contents.channels.entry(id).or_insert(channel);
        }
        contents.unknown_summary = self.unknown;

        let mut bytes: BTreeMap<_, _> = self
            .chunk_indexes
            .into_iter()
            .map(|index| (index.record.chunk_start_offset, index))
            .collect();
        for segment in &mut contents.segments {
            if let SegmentKind::Chunk { index, .. } = &mut segment.kind
                && let Some(confirmed) = bytes
                    .remove(&segment.offset)
                    .filter(|said| said.record == index.record)
            {
                *index = confirmed;
            }
        }
        confirm(&mut contents.attachments, self.attachments);
        confirm(&mut contents.metadata, self.metadata);
    }
}

fn confirm<T: PartialEq>(scanned: &mut [Raw<T>], said: Vec<Raw<T>>) {
    for said in said {
        if let Some(same) = scanned.iter_mut().find(|same| same.record == said.record) {
            *same = said;
        }
    }
}

/// A chunk as its index says it, and where its message indexes end; `None` where the index does not tell
/// how many messages of which channels there are.
fn indexed_chunk(index: &Raw<ChunkIndex>) -> Option<(Segment, u64)> {
    let record = &index.record;
    let chunk_end = record.chunk_start_offset.checked_add(record.chunk_length)?;
    let end = chunk_end.checked_add(record.message_index_length)?;
    let mut offsets: Vec<(u64, u16)> = record
        .message_index_offsets
        .iter()
        .map(|(&id, &offset)| (offset, id))
        .collect();
    offsets.sort_unstable();
    if offsets.first()?.0 != chunk_end {
        return None;
    }
    let ends = offsets
        .iter()
        .skip(1)
        .map(|&(offset, _)| offset)
        .chain([end]);
    let mut message_counts = BTreeMap::new();
    for (&(offset, id), end) in offsets.iter().zip(ends) {
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
    Some((
        Segment {
            offset: record.chunk_start_offset,
            length: record.chunk_length,
            times,
            message_counts,
            kind: SegmentKind::Chunk {
                index: index.clone(),
                missing_indexes: Vec::new(),
            },
        },
        end,
    ))
}
