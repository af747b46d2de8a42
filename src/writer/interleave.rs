//! Interleaving: each of a log's chunks is followed by what was derived from its time, for readers that use no index.
//!
//! The log's data is cut into pieces at the starts of its segments: the first piece is everything before the first
//! segment; every other one is a segment and what follows it. A value goes after all pieces that contain anything as
//! early as the value, and before the others, so if the log is in time order, the result is too. Values come in time
//! order, so the pieces are copied as their times pass, and nothing has to be held. Where the log's clock was set back,
//! a new epoch begins: only pieces of the value's own epoch count.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    ops::{ControlFlow, Range},
    path::PathBuf,
};

use crc32fast::Hasher;
use mcap::records::ChunkIndex;

use super::{
    Layout, LogWriter, Written, channels::NewChannels, chunk::Batch, data_section::DataSection,
    error::WriteError, provenance, summary,
};
use crate::{
    log::{
        Damage, Log, SegmentReader,
        contents::{Contents, Segment, SegmentKind},
        record::{Raw, RawMessage, Records},
    },
    messages::{Format, Message},
};

/// Rewrites a log with new channels among its chunks. All messages of the result are in chunks.
pub struct Interleaver<'a, W> {
    log: &'a Log,
    /// The output's path, for errors.
    path: PathBuf,
    section: DataSection<W>,
    channels: NewChannels<'a>,
    batch: Batch,
    /// The earliest time in each piece or in any piece of its epoch after it.
    starts: Vec<u64>,
    /// The pieces in which epochs begin, from the second one on.
    epoch_starts: Vec<usize>,
    /// Where the pieces of the current epoch end.
    epoch_end: usize,
    /// How many pieces have been written.
    written: usize,
    /// What the log contains, with new positions for what has been written.
    contents: Contents,
    moves: Moves,
    /// The checksum of the log's bytes so far, if the log says what it should be.
    checksum: Option<Hasher>,
    reader: SegmentReader<'a>,
    on_copied: OnCopied<'a>,
}

/// Called with the number of the log's bytes that have been written; says whether to continue.
pub type OnCopied<'a> = Box<dyn FnMut(u64) -> ControlFlow<()> + 'a>;

impl<'a, W: Write> Interleaver<'a, W> {
    /// Starts a log in `out`. The new messages are written in `format`; errors call the output `path`.
    ///
    /// # Errors
    /// The output cannot be written.
    pub fn begin(
        log: &'a Log,
        out: W,
        path: PathBuf,
        format: Format,
        on_copied: OnCopied<'a>,
    ) -> Result<Self, WriteError> {
        let section = DataSection::new(out, 0, log.data_crc.map(|_| 0));
        let starts = starts(&log.contents.segments, &[]);
        Ok(Self {
            section: section.map_err(|source| WriteError::output(&path, source))?,
            path,
            channels: NewChannels::new(log, format),
            batch: Batch::default(),
            epoch_starts: Vec::new(),
            epoch_end: starts.len(),
            starts,
            written: 0,
            contents: log.contents.clone(),
            moves: Moves::default(),
            checksum: log.data_crc.map(|_| Hasher::new()),
            reader: SegmentReader::new(log),
            on_copied,
            log,
        })
    }
}

impl<W: Write> LogWriter for Interleaver<'_, W> {
    fn divide(&mut self, epoch_starts: &[usize]) {
        // The first piece is what is before the first segment.
        self.epoch_starts = epoch_starts.iter().map(|segment| segment + 1).collect();
        self.starts = starts(&self.log.contents.segments, &self.epoch_starts);
        self.epoch_end = self.end_of_epoch(0);
    }

    fn go_to_epoch(&mut self, epoch: u32) -> Result<(), WriteError> {
        let mut begun = self.epoch_starts.iter().take(epoch as usize);
        if let Some(&start) = begun.next_back() {
            while self.written < start {
                self.write_batch()?;
                self.write_piece()?;
            }
        }
        self.epoch_end = self.end_of_epoch(epoch);
        Ok(())
    }

    fn write(&mut self, message: Message) -> Result<(), WriteError> {
        while let Some(&start) = self.starts[..self.epoch_end].get(self.written)
            && start <= message.log_time()
        {
            self.write_batch()?;
            self.write_piece()?;
        }
        self.channels
            .push(&message, &mut self.batch, &mut self.section.added)?;
        match self.batch.is_full() {
            true => self.write_batch(),
            false => Ok(()),
        }
    }

    fn finish(mut self: Box<Self>, facts: BTreeMap<String, String>) -> Result<Written, WriteError> {
        self.write_batch()?;
        while self.written < self.starts.len() {
            self.write_piece()?;
        }
        let messages = self.channels.messages();
        let Self {
            log,
            path,
            mut section,
            mut contents,
            moves,
            checksum,
            ..
        } = *self;
        // A correct checksum would make damaged data look intact.
        let checksum_was_wrong = checksum.map(Hasher::finalize) != log.data_crc;
        if checksum_was_wrong {
            section.drop_checksum();
        }
        for index in &mut contents.attachments {
            index.change(|index| index.offset = moves.of(index.offset));
        }
        for index in &mut contents.metadata {
            index.change(|index| index.offset = moves.of(index.offset));
        }
        contents.statistics = contents.recount();
        let record = provenance::record(messages.keys().copied(), Layout::Interleaved, facts);
        let (length, added) = section
            .write_metadata(&record)
            .and_then(|()| section.finish(|added, start| summary::encode(&contents, added, start)))
            .map_err(|source| WriteError::output(&path, source))?;
        Ok(Written {
            messages,
            times: added.times,
            kept: moves.length(),
            length,
            checksum_was_wrong,
        })
    }
}

impl<W: Write> Interleaver<'_, W> {
    /// Where the pieces of an epoch end. The one in which the next begins has both.
    fn end_of_epoch(&self, epoch: u32) -> usize {
        let next = self.epoch_starts.get(epoch as usize);
        next.map_or(self.starts.len(), |start| start + 1)
    }

    fn write_batch(&mut self) -> Result<(), WriteError> {
        let written = self.section.write_chunk(&mut self.batch);
        written.map_err(|source| self.failed(source))
    }

    /// Writes the next piece.
    fn write_piece(&mut self) -> Result<(), WriteError> {
        let segments = &self.log.contents.segments;
        let (number, next) = (self.written.checked_sub(1), segments.get(self.written));
        let end = next.map_or(self.log.data_end, |next| next.offset);
        let rest = match number {
            None => 0,
            Some(number) => self.write_segment(number)?,
        };
        self.copy(rest..end)?;
        self.written += 1;
        Ok(())
    }

    /// Writes the parts of a segment that change. Returns the offset from which on the bytes can be copied.
    fn write_segment(&mut self, number: usize) -> Result<u64, WriteError> {
        let segment = &self.log.contents.segments[number];
        let position = self.section.position();
        let end = segment.offset + segment.length;
        let (index, rest) = match &segment.kind {
            SegmentKind::Chunk { index, is_indexed } => {
                let mut index = index.clone();
                index.change(|index| {
                    index.chunk_start_offset = position;
                    for offset in index.message_index_offsets.values_mut() {
                        *offset = *offset - segment.offset + position;
                    }
                });
                match is_indexed {
                    true => (index, segment.offset),
                    false => {
                        self.copy(segment.offset..end)?;
                        self.write_indexes(segment, &mut index)?;
                        (index, end)
                    }
                }
            }
            SegmentKind::Loose => (Raw::new(self.gather(segment)?), end),
        };
        let written = &mut self.contents.segments[number];
        written.offset = index.record.chunk_start_offset;
        written.length = index.record.chunk_length;
        written.kind = SegmentKind::Chunk {
            index,
            is_indexed: true,
        };
        Ok(rest)
    }

    /// Writes the message indexes that a chunk lacks, without which a seeking reader refuses it.
    fn write_indexes(
        &mut self,
        chunk: &Segment,
        index: &mut Raw<ChunkIndex>,
    ) -> Result<(), WriteError> {
        let indexes = self.reader.message_indexes(chunk)?;
        let position = self.section.position();
        let bytes = summary::encode_message_indexes(index, indexes, position);
        let written = self.section.write(&bytes);
        written.map_err(|source| self.failed(source))
    }

    /// Writes messages that were outside chunks as a chunk.
    fn gather(&mut self, run: &Segment) -> Result<ChunkIndex, WriteError> {
        let file = &self.log.file;
        let bytes = file.read(run.offset, run.length)?;
        if let Some(checksum) = &mut self.checksum {
            checksum.update(&bytes);
        }
        let malformed = || file.damaged(run.offset, Damage::NotMessages);
        let mut gathered = Batch::default();
        for record in Records::new(&bytes) {
            let body = record.map_err(|_| malformed())?.body;
            let message = RawMessage::parse(body).ok_or_else(malformed)?;
            gathered.push_message(message.channel_id, message.log_time, body);
        }
        let written = self.section.write_gathered(&gathered);
        let index = written.map_err(|source| self.failed(source))?;
        if (self.on_copied)(run.offset + run.length).is_break() {
            return Err(WriteError::Cancelled);
        }
        Ok(index)
    }

    /// Copies bytes of the log as they are.
    fn copy(&mut self, range: Range<u64>) -> Result<(), WriteError> {
        self.moves.push(range.clone(), self.section.position());
        let failed = |source| WriteError::output(&self.path, source);
        let copied = |done| (self.on_copied)(done);
        let copied = self.section.copy(&self.log.file, range, failed, copied)?;
        if let (Some(checksum), Some(copied)) = (&mut self.checksum, copied) {
            checksum.combine(&copied);
        }
        Ok(())
    }

    fn failed(&self, source: io::Error) -> WriteError {
        WriteError::output(&self.path, source)
    }
}

/// The earliest time in each piece of a log with these segments, or in any piece of its epoch after it. Epochs begin in
/// the pieces `epoch_starts`.
fn starts(segments: &[Segment], epoch_starts: &[usize]) -> Vec<u64> {
    let start = |segment: &Segment| segment.times.map_or(u64::MAX, |(start, _)| start);
    // Nothing goes before the log's header.
    let mut starts: Vec<u64> = [0].into_iter().chain(segments.iter().map(start)).collect();
    for piece in (1..starts.len()).rev() {
        let is_last = epoch_starts.contains(&piece) || piece + 1 == starts.len();
        if !is_last {
            starts[piece] = starts[piece].min(starts[piece + 1]);
        }
    }
    starts
}

/// The new positions of bytes that were copied as they are.
#[derive(Default)]
struct Moves(Vec<(Range<u64>, u64)>);

impl Moves {
    /// Adds a range. Ranges come in order, and the first one starts at 0.
    fn push(&mut self, range: Range<u64>, position: u64) {
        self.0.push((range, position));
    }

    /// The new offset of the byte at `offset`, which must be in one of the ranges.
    fn of(&self, offset: u64) -> u64 {
        let next = self.0.partition_point(|(range, _)| range.start <= offset);
        let (range, position) = &self.0[next - 1];
        position + (offset - range.start)
    }

    /// The number of bytes.
    fn length(&self) -> u64 {
        self.0
            .iter()
            .map(|(range, _)| range.end - range.start)
            .sum()
    }
}
