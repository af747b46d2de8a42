//! The summary section: what a log says about itself, and how far that can be trusted.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{AttachmentIndex, ChunkIndex, Footer, MetadataIndex, Statistics, op};

use super::{
    contents::{Contents, Definitions, Room, SegmentKind},
    error::{Damage, ReadError, RecordKind},
    file::LogFile,
    indexed_chunk::IndexedChunk,
    record::{FRAME_LENGTH, Raw, parse, split, split_frame},
    scan::{Bodies, Collector, DefinedInChunk, Frame, Next, Walker},
};

/// Bytes of a footer record's body: where the summary and its offsets start, and a checksum.
const FOOTER_LENGTH: usize = 8 + 8 + 4;

/// Bytes of a DataEnd record's body: a checksum.
pub const DATA_END_LENGTH: usize = 4;

/// How much of a summary is read at once: all of most.
const WINDOW: u64 = 1024 * 1024;

/// How much is read at once of what surrounds the content of a chunk: usually its message indexes and the next chunk's
/// header.
const CHUNK_WINDOW: u64 = 4096;

/// The end of a log that was closed properly.
pub struct Ending {
    /// Where the data section ends: at the DataEnd record, or at the footer if there is none.
    pub data_end: u64,
    /// The data section's checksum, if the log has one.
    pub data_crc: Option<u32>,
    /// The summary, unless there is none or it is damaged.
    pub summary: Option<Summary>,
}

/// The records of a summary section.
#[derive(Default)]
pub struct Summary {
    definitions: Definitions,
    chunk_indexes: Vec<Raw<ChunkIndex>>,
    attachments: Vec<Raw<AttachmentIndex>>,
    metadata: Vec<Raw<MetadataIndex>>,
    statistics: Option<Statistics>,
    unknown: Vec<(u8, Vec<u8>)>,
}

impl Ending {
    /// Reads the end of the file; `None` if it is not the end of a log that was closed, with a data section that ends
    /// at `earliest` or later.
    ///
    /// # Errors
    /// The file cannot be read, or what belongs before the DataEnd record is after it.
    pub fn read(file: &LogFile, earliest: u64) -> Result<Option<Self>, ReadError> {
        let tail = (FRAME_LENGTH + FOOTER_LENGTH + mcap::MAGIC.len()) as u64;
        let Some(footer_offset) = file.length().checked_sub(tail) else {
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
        if data_end < earliest || summary_start > footer_offset {
            return Ok(None);
        }
        let record = file.read(data_end, data_end_length)?;
        let Some((frame, crc)) = record.split_last_chunk() else {
            return Ok(None);
        };
        if split_frame(frame) != Some((op::DATA_END, DATA_END_LENGTH as u64)) {
            return Ok(None);
        }
        let crc = u32::from_le_bytes(*crc);

        let is_intact = footer.summary_crc == 0 || {
            let mut hasher = checksum(file, summary_start, footer_offset)?;
            hasher.update(&footer_record[..FRAME_LENGTH + 8 + 8]);
            hasher.finalize() == footer.summary_crc
        };
        let mut section = Section {
            file,
            records: Walker::new(file, summary_start, footer_offset).reading_ahead(WINDOW),
            data_end,
            holds_log: false,
        };
        let summary = match is_intact && footer.summary_start != 0 {
            true => section.parse()?,
            false => section.skip().map(|()| None)?,
        };
        if section.holds_log {
            return Ok(None);
        }
        Ok(Some(Self {
            data_end,
            data_crc: (crc != 0).then_some(crc),
            summary,
        }))
    }
}

/// The records of a summary section, which follow the DataEnd record at `data_end`.
struct Section<'a> {
    file: &'a LogFile,
    records: Walker<'a>,
    data_end: u64,
    /// Whether it turned out that the log was closed in it and another follows, to which the file's end belongs.
    holds_log: bool,
}

impl Section<'_> {
    /// The next record; an error where a record belongs before DataEnd. Another log is not looked into.
    fn step(&mut self) -> Result<Next, ReadError> {
        let next = self.records.step()?;
        if let Next::Record(frame) = next
            && !belongs_after_data(frame.opcode)
        {
            if frame.opcode == op::FOOTER
                && let Some(end) = end_of_magic(self.file, frame.end())?
                && end_of_magic(self.file, end)?.is_some()
            {
                self.holds_log = true;
                return Ok(Next::Torn { offset: end });
            }
            let (offset, kind) = match frame.opcode {
                op::FOOTER => (frame.offset, RecordKind::Footer),
                _ => (self.data_end, RecordKind::DataEnd),
            };
            return Err(self.records.damaged(offset, Damage::EarlyEnd(kind)));
        }
        Ok(next)
    }

    /// Only checks that all records belong there.
    fn skip(&mut self) -> Result<(), ReadError> {
        self.records.skip_zeros();
        while let Next::Record(_) = self.step()? {}
        Ok(())
    }

    /// Reads them; `None` if that is not possible.
    fn parse(&mut self) -> Result<Option<Summary>, ReadError> {
        let mut summary = Summary::default();
        let mut room = Room::default();
        loop {
            let frame = match self.step()? {
                Next::Record(frame) => frame,
                Next::End => break,
                // What comes after it still has to belong there, but where that is is known only after zeros.
                Next::Torn { .. } => {
                    if !self.holds_log {
                        self.skip()?;
                    }
                    return Ok(None);
                }
            };
            if frame.opcode == op::SUMMARY_OFFSET {
                continue;
            }
            let kept = summary.add(&frame, self.records.whole(&frame)?);
            let damaged = |damage| self.records.damaged(frame.offset, damage);
            match kept {
                Some(length) => room.take(length).map_err(damaged)?,
                // Nothing else may have it, so it cannot be found by reading the log.
                None if matches!(frame.opcode, op::SCHEMA | op::CHANNEL) => {
                    return Err(damaged(Damage::Malformed(RecordKind::Definition)));
                }
                None => {
                    self.skip()?;
                    return Ok(None);
                }
            }
        }
        summary
            .chunk_indexes
            .sort_by_key(|index| index.record.chunk_start_offset);
        Ok(Some(summary))
    }
}

/// Whether a record may follow the end of the data.
fn belongs_after_data(opcode: u8) -> bool {
    match opcode {
        op::SCHEMA | op::CHANNEL | op::STATISTICS | op::SUMMARY_OFFSET => true,
        op::CHUNK_INDEX | op::ATTACHMENT_INDEX | op::METADATA_INDEX => true,
        opcode => opcode == 0 || opcode > op::DATA_END,
    }
}

/// What follows the record that ends the data of a log.
pub enum Rest {
    /// Nothing but what belongs there, as far as it can be read, and zeros.
    Summary,
    /// A record that belongs before that one.
    Data,
    /// Something else, which starts here, after the closing magic or where a record should be. It may be another log.
    Surplus { start: u64, is_log: bool },
}

impl Rest {
    /// Finds out what follows the record of this kind that ends at `start`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn after(file: &LogFile, kind: RecordKind, start: u64) -> Result<Self, ReadError> {
        let mut records = Walker::new(file, start, file.length());
        records.skip_zeros();
        let mut after_footer = kind == RecordKind::Footer;
        loop {
            if after_footer && let Some(end) = end_of_magic(file, records.position())? {
                let only_zeros = file.end_of_zeros(end, file.length())? == file.length();
                return Ok(match only_zeros {
                    true => Self::Summary,
                    false => Self::Surplus {
                        start: end,
                        is_log: end_of_magic(file, end)?.is_some(),
                    },
                });
            }
            let frame = match records.step()? {
                Next::Record(frame) => frame,
                Next::End => return Ok(Self::Summary),
                Next::Torn { offset } => return Self::torn(file, offset, after_footer),
            };
            after_footer = frame.opcode == op::FOOTER;
            if !after_footer && !belongs_after_data(frame.opcode) {
                return Ok(Self::Data);
            }
        }
    }
}

impl Rest {
    /// Tells where a summary was cut short from where something else begins, at which there is no whole record.
    fn torn(file: &LogFile, offset: u64, after_footer: bool) -> Result<Self, ReadError> {
        let length = file.length();
        let start = file.read(offset, (FRAME_LENGTH as u64).min(length - offset))?;
        let opcode = start.first().copied().unwrap_or(0);
        let is_cut = match after_footer {
            true => mcap::MAGIC.starts_with(&start),
            // A log does not have the unknown kinds.
            false => opcode <= op::DATA_END && belongs_after_data(opcode) || opcode == op::FOOTER,
        };
        let is_zeros = || Ok(file.end_of_zeros(offset, length)? == length);
        Ok(match (opcode != 0 && is_cut) || is_zeros()? {
            true => Self::Summary,
            false => Self::Surplus {
                start: offset,
                is_log: false,
            },
        })
    }
}

/// Where the magic bytes at `start` end; `None` if there are none.
fn end_of_magic(file: &LogFile, start: u64) -> Result<Option<u64>, ReadError> {
    let length = mcap::MAGIC.len() as u64;
    if file.length().saturating_sub(start) < length {
        return Ok(None);
    }
    let is_there = file.read(start, length)? == mcap::MAGIC;
    Ok(is_there.then_some(start + length))
}

/// The checksum of some of a file's bytes.
fn checksum(file: &LogFile, start: u64, end: u64) -> Result<crc32fast::Hasher, ReadError> {
    let mut hasher = crc32fast::Hasher::new();
    file.for_each_piece(start, end, |piece| {
        hasher.update(piece);
        Ok(())
    })?;
    Ok(hasher)
}

impl Summary {
    /// Takes a record. Returns how much of it is kept, apart from what grows with the log's messages; `None` if it
    /// cannot be read.
    fn add(&mut self, frame: &Frame, body: &[u8]) -> Option<usize> {
        Some(match frame.opcode {
            op::SCHEMA | op::CHANNEL => {
                let new = self.definitions.add(frame.opcode, body)?;
                new.map_or(0, |id| self.definitions.size(frame.opcode, id))
            }
            op::CHUNK_INDEX => {
                let (index, appended): (ChunkIndex, _) = split(body).ok()?;
                let kept = index.compression.len() + appended.len();
                self.chunk_indexes.push(Raw {
                    record: index,
                    body: body.to_vec(),
                });
                kept
            }
            op::ATTACHMENT_INDEX => {
                self.attachments.push(Raw::parse(body).ok()?);
                body.len()
            }
            op::METADATA_INDEX => {
                self.metadata.push(Raw::parse(body).ok()?);
                body.len()
            }
            op::STATISTICS => {
                self.statistics = Some(parse(body).ok()?);
                0
            }
            opcode => {
                self.unknown.push((opcode, body.to_vec()));
                body.len()
            }
        })
    }

    /// What the log contains, if this summary and the records between the chunks that it describes account for all of
    /// it without a contradiction; else `None`, and the log has to be read from start to end.
    ///
    /// A chunk whose index is complete is not opened: how many messages it has on each channel follows from the lengths
    /// of its message indexes, which have to be where the index says, with nothing in between.
    pub fn account_for(
        &self,
        file: &LogFile,
        data_end: u64,
    ) -> Result<Option<Contents>, ReadError> {
        if self.statistics.is_none() {
            return Ok(None);
        }
        let mut collector = Collector::with(Contents {
            definitions: self.definitions.clone(),
            ..Contents::default()
        });
        let mut position = mcap::MAGIC.len() as u64;
        let mut records = Walker::new(file, position, data_end).reading_ahead(CHUNK_WINDOW);
        for chunk in self.chunk_indexes.iter().filter_map(IndexedChunk::of) {
            if chunk.segment.offset < position
                || chunk.end > data_end
                || !collect(&mut collector, file, position, chunk.segment.offset)?
                || !chunk.is_there(&mut records)?
            {
                return Ok(None);
            }
            collector.contents.segments.push(chunk.segment);
            position = chunk.end;
        }
        if !collect(&mut collector, file, position, data_end)? {
            return Ok(None);
        }
        let mut contents = collector.finish();
        Ok(self.complete(&mut contents).then_some(contents))
    }

    /// Adds what only the summary has to everything that was found in the log, and counts it. Returns whether the
    /// summary neither omits nor contradicts anything.
    pub fn complete(&self, contents: &mut Contents) -> bool {
        let confirmed = self.supplement(contents);
        contents.statistics = contents.recount();
        let statistics = self.statistics.as_ref();
        confirmed && statistics.is_some_and(|statistics| agree(statistics, contents))
    }

    /// Whether this repeats the definitions in chunks that a reader who trusts it would not open.
    pub fn repeats(&self, defined: &[DefinedInChunk]) -> bool {
        let chunks = self.chunk_indexes.iter().filter_map(IndexedChunk::of);
        let chunks: BTreeSet<u64> = chunks.map(|chunk| chunk.segment.offset).collect();
        let Definitions { schemas, channels } = &self.definitions;
        let is_repeated = |defined: &DefinedInChunk| match defined.opcode {
            op::SCHEMA => schemas.contains_key(&defined.id),
            _ => channels.contains_key(&defined.id),
        };
        (defined.iter()).all(|defined| !chunks.contains(&defined.chunk) || is_repeated(defined))
    }

    /// Adds the definitions that only the summary has to what was found in the log, and uses the summary's bytes of
    /// those records that say the same. Returns whether everything that the summary points to was found.
    fn supplement(&self, contents: &mut Contents) -> bool {
        let Definitions { schemas, channels } = &mut contents.definitions;
        for (id, said) in &self.definitions.schemas {
            let found = schemas.entry(*id).or_insert_with(|| said.clone());
            if found.defines_the_same(said) {
                *found = said.clone();
            }
        }
        for (id, said) in &self.definitions.channels {
            let found = channels.entry(*id).or_insert_with(|| said.clone());
            if found.record == said.record {
                *found = said.clone();
            }
        }
        contents.unknown_summary = self.unknown.clone();
        contents.has_chunk_index = !self.chunk_indexes.is_empty();
        let counted = self
            .statistics
            .iter()
            .flat_map(|s| s.channel_message_counts.keys());
        let indexed =
            (self.chunk_indexes.iter()).flat_map(|i| i.record.message_index_offsets.keys());
        contents.mentioned_channel_ids = counted.chain(indexed).copied().collect();

        let chunks = contents
            .segments
            .iter_mut()
            .filter_map(|segment| match &mut segment.kind {
                SegmentKind::Chunk { index, .. } => Some(index),
                SegmentKind::Loose => None,
            });
        let indexes = [
            take_over(chunks, &self.chunk_indexes, |index| {
                index.chunk_start_offset
            }),
            take_over(
                contents.attachments.iter_mut(),
                &self.attachments,
                |index| index.offset,
            ),
            take_over(contents.metadata.iter_mut(), &self.metadata, |index| {
                index.offset
            }),
        ];
        indexes.into_iter().all(|confirmed| confirmed)
    }
}

/// Whether a log's own statistics match what was found, and every id in use is defined.
fn agree(statistics: &Statistics, contents: &Contents) -> bool {
    let recount = &contents.statistics;
    let Definitions { schemas, channels } = &contents.definitions;
    let mut counts = statistics.channel_message_counts.clone();
    counts.retain(|_, count| *count > 0);
    counts == recount.channel_message_counts
        && statistics.message_count == recount.message_count
        && statistics.message_start_time == recount.message_start_time
        && statistics.message_end_time == recount.message_end_time
        && statistics.chunk_count == recount.chunk_count
        && statistics.schema_count == recount.schema_count
        && statistics.channel_count == recount.channel_count
        && (contents.channel_ids().iter()).all(|id| channels.contains_key(id))
        && (contents.schema_ids().iter()).all(|id| schemas.contains_key(id))
}

/// Collects the records from `start` to `end`, between chunks that are not opened. Returns whether all of them are whole,
/// and none is a message index that the index of such a chunk omits.
fn collect(
    collector: &mut Collector,
    file: &LogFile,
    start: u64,
    end: u64,
) -> Result<bool, ReadError> {
    let mut walker = Walker::new(file, start, end);
    loop {
        match walker.step()? {
            Next::Record(frame)
                if frame.opcode == op::MESSAGE_INDEX && !collector.has_open_chunk() =>
            {
                return Ok(false);
            }
            Next::Record(frame) => collector.record(&mut walker, &frame)?,
            Next::End => {
                collector.close_chunk();
                return Ok(true);
            }
            Next::Torn { .. } => return Ok(false),
        }
    }
}

/// Replaces index records that were found by those of the summary that say the same, to keep their bytes. Returns
/// whether all of those were found.
fn take_over<'a, T: PartialEq + Clone + 'a>(
    found: impl Iterator<Item = &'a mut Raw<T>>,
    said: &[Raw<T>],
    offset: impl Fn(&T) -> u64,
) -> bool {
    let mut said: BTreeMap<u64, &Raw<T>> = said
        .iter()
        .map(|said| (offset(&said.record), said))
        .collect();
    for found in found {
        let offset = offset(&found.record);
        if let Some(same) = said.get(&offset).filter(|said| said.record == found.record) {
            *found = (*same).clone();
            said.remove(&offset);
        }
    }
    said.is_empty()
}
