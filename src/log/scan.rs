//! Finding out what a log contains from its records, where its summary does not say.

use std::collections::BTreeMap;

use binrw::BinRead;
use mcap::records::{AttachmentIndex, ChunkIndex, MetadataIndex, op};

use super::{
    chunk::ChunkDecoder,
    contents::{Contents, Definitions, Room, Segment, SegmentKind},
    error::{Damage, ReadError, RecordKind},
    file::{LogFile, leading_zeros},
    message_index::{MESSAGE_INDEX_ENTRY, MESSAGE_INDEX_PREFIX},
    record::{
        AttachmentStart, FRAME_LENGTH, Fields, MAX_RECORD, MESSAGE_HEADER_LENGTH,
        MessageIndexStart, MetadataStart, Raw, RawMessage, Unreadable, parse, split_frame,
    },
    step_back::StepBack,
};

/// How much is read at once where records follow one another closely.
const WINDOW: u64 = 64 * 1024;

/// The most bytes of messages outside chunks that make one segment, so that no reader needs to hold more.
const LOOSE_RUN: u64 = 1024 * 1024;

/// Enough of a record's body for what it starts with, if names are short.
const START: u64 = 4096;

/// A record's place in the file.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub opcode: u8,
    pub offset: u64,
    /// Bytes of its body.
    pub length: u64,
}

impl Frame {
    /// Where the next record starts.
    pub fn end(&self) -> u64 {
        self.offset + FRAME_LENGTH as u64 + self.length
    }

    /// Where its body starts.
    pub fn body_offset(&self) -> u64 {
        self.offset + FRAME_LENGTH as u64
    }
}

/// What comes next in a range of records.
#[derive(Debug, Clone, Copy)]
pub enum Next {
    Record(Frame),
    /// The range ends after a whole record.
    End,
    /// From here on there are no whole records: one is longer than the rest of the range, or has an invalid opcode.
    Torn {
        offset: u64,
    },
}

/// Where the bodies of records are.
pub trait Bodies {
    /// The first `most` bytes of a record's body, or all of it if it is shorter.
    fn body(&mut self, frame: &Frame, most: u64) -> Result<&[u8], ReadError>;

    /// A record's whole body, if it is not too long to be held in memory.
    fn whole(&mut self, frame: &Frame) -> Result<&[u8], ReadError> {
        self.check_length(frame.offset, frame.length)?;
        self.body(frame, frame.length)
    }

    /// What a record's body starts with, however long the rest is; `None` if it is not that.
    fn start<T: Fields + for<'a> BinRead<Args<'a> = ()>>(
        &mut self,
        frame: &Frame,
    ) -> Result<Option<T>, ReadError> {
        let mut most = START;
        loop {
            match parse(self.body(frame, most)?) {
                Ok(start) => return Ok(Some(start)),
                Err(Unreadable::BreaksOff { needed }) if needed <= frame.length => most = needed,
                Err(_) => return Ok(None),
            }
            self.check_length(frame.offset, most)?;
        }
    }

    /// Refuses what is too long to be held in memory, and belongs to the record at `offset`.
    fn check_length(&self, offset: u64, length: u64) -> Result<(), ReadError> {
        match length {
            0..=MAX_RECORD => Ok(()),
            _ => Err(self.damaged(offset, Damage::TooLong { length })),
        }
    }

    /// The error for a place where the log violates the format.
    fn damaged(&self, offset: u64, damage: impl Into<Damage>) -> ReadError;
}

/// Steps from record to record, reading opcodes and lengths, and bodies only when asked.
pub struct Walker<'a> {
    file: &'a LogFile,
    position: u64,
    end: u64,
    window: Vec<u8>,
    window_start: u64,
    /// How much is read at once.
    ahead: u64,
    /// Whether zeros are records, as they are to most readers: of opcode 0, which nobody knows, and of no length.
    skips_zeros: bool,
}

impl<'a> Walker<'a> {
    /// Over the records from `start` to `end`.
    pub fn new(file: &'a LogFile, start: u64, end: u64) -> Self {
        Self {
            file,
            position: start,
            end: end.min(file.length()),
            ahead: WINDOW,
            skips_zeros: false,
            window: Vec::new(),
            window_start: 0,
        }
    }

    /// The same, with that much read at once.
    pub fn reading_ahead(self, ahead: u64) -> Self {
        Self { ahead, ..self }
    }

    /// Makes the walker step over records of opcode 0, and skip those that consist of zeros in large pieces.
    pub fn skip_zeros(&mut self) {
        self.skips_zeros = true;
    }

    /// Goes on with the record at `position`.
    pub fn go_to(&mut self, position: u64) {
        self.position = position;
    }

    /// Where the next record starts.
    pub fn position(&self) -> u64 {
        self.position
    }

    pub fn step(&mut self) -> Result<Next, ReadError> {
        if self.skips_zeros {
            self.pass_zeros()?;
        }
        let offset = self.position;
        if offset >= self.end {
            return Ok(Next::End);
        }
        let torn = Ok(Next::Torn { offset });
        if self.end - offset < FRAME_LENGTH as u64 {
            return torn;
        }
        let Some((opcode, length)) = split_frame(self.bytes(offset, FRAME_LENGTH as u64)?) else {
            return torn;
        };
        let room = self.end - offset - FRAME_LENGTH as u64;
        // A file system that has lost its last blocks leaves zeros.
        if (opcode == 0 && !self.skips_zeros) || length > room {
            return torn;
        }
        let frame = Frame {
            opcode,
            offset,
            length,
        };
        self.position = frame.end();
        Ok(Next::Record(frame))
    }

    /// Goes on after all records that consist of zeros. There may be gigabytes of them.
    fn pass_zeros(&mut self) -> Result<(), ReadError> {
        let (start, frame) = (self.position, FRAME_LENGTH as u64);
        if self.end.saturating_sub(start) < frame {
            return Ok(());
        }
        self.bytes(start, frame)?;
        let window = &self.window[(start - self.window_start) as usize..];
        let zeros = leading_zeros(window);
        let mut end = start + zeros as u64;
        if zeros == window.len() {
            end = self.file.end_of_zeros(end, self.end)?;
        }
        self.position += (end.min(self.end) - start) / frame * frame;
        Ok(())
    }

    fn bytes(&mut self, offset: u64, length: u64) -> Result<&[u8], ReadError> {
        let window_end = self.window_start + self.window.len() as u64;
        if offset < self.window_start || offset + length > window_end {
            let ahead = length.max(self.ahead).min(self.file.length() - offset);
            self.file
                .read_into(&mut self.window, offset, ahead.max(length))?;
            self.window_start = offset;
        }
        let start = (offset - self.window_start) as usize;
        Ok(&self.window[start..start + length as usize])
    }
}

impl Bodies for Walker<'_> {
    fn body(&mut self, frame: &Frame, most: u64) -> Result<&[u8], ReadError> {
        self.bytes(frame.body_offset(), frame.length.min(most))
    }

    fn damaged(&self, offset: u64, damage: impl Into<Damage>) -> ReadError {
        self.file.damaged(offset, damage)
    }
}

/// Collects what a log contains from its records, which come in the order of the file.
#[derive(Default)]
pub struct Collector {
    pub contents: Contents,
    /// The definitions that occurred first in a chunk.
    pub defined_in_chunks: Vec<DefinedInChunk>,
    /// How far the log times on each channel go back.
    pub steps_back: BTreeMap<u16, StepBack>,
    chunks: ChunkDecoder,
    room: Room,
    /// The chunk that message indexes may still follow.
    open_chunk: Option<OpenChunk>,
}

/// A schema or a channel that is defined in a chunk.
pub struct DefinedInChunk {
    /// The chunk's offset.
    pub chunk: u64,
    /// The opcode of its record, schema or channel.
    pub opcode: u8,
    pub id: u16,
}

struct OpenChunk {
    index: ChunkIndex,
    times: Option<(u64, u64)>,
    message_counts: BTreeMap<u16, u64>,
    /// The message indexes after it: how many messages they list by channel, and the offset of each record.
    indexed: BTreeMap<u16, u64>,
    index_offsets: BTreeMap<u16, u64>,
    index_length: u64,
}

impl Collector {
    /// Continues with what a summary says.
    pub fn with(contents: Contents) -> Self {
        Self {
            contents,
            ..Self::default()
        }
    }

    /// Takes one record of the data section.
    pub fn record(&mut self, bodies: &mut impl Bodies, frame: &Frame) -> Result<(), ReadError> {
        self.record_and_visit(bodies, frame, |_, _, _| {})
    }

    /// Does what [`record`](Self::record) does. `visit` gets each message of a chunk, the body of its record, and what was defined
    /// before it.
    pub fn record_and_visit(
        &mut self,
        bodies: &mut impl Bodies,
        frame: &Frame,
        visit: impl FnMut(&Definitions, &RawMessage, &[u8]),
    ) -> Result<(), ReadError> {
        if frame.opcode != op::MESSAGE_INDEX {
            self.close_chunk();
        }
        match frame.opcode {
            op::SCHEMA | op::CHANNEL => {
                let body = bodies.whole(frame)?;
                let added = self.contents.definitions.add(frame.opcode, body);
                let new = added.ok_or_else(|| malformed(bodies, frame, RecordKind::Definition))?;
                if let Some(id) = new {
                    let size = self.contents.definitions.size(frame.opcode, id);
                    self.keep(bodies, frame, size)?;
                }
            }
            op::MESSAGE => {
                bodies.check_length(frame.offset, frame.length)?;
                // The payload is not needed here.
                let message = RawMessage::parse(bodies.body(frame, MESSAGE_HEADER_LENGTH as u64)?)
                    .map(|message| (message.channel_id, message.log_time));
                let (channel_id, log_time) =
                    message.ok_or_else(|| malformed(bodies, frame, RecordKind::Message))?;
                self.loose_message(frame, channel_id, log_time);
            }
            op::CHUNK => {
                let chunk = self.chunk(frame, bodies.whole(frame)?, visit);
                self.open_chunk =
                    Some(chunk.map_err(|damage| bodies.damaged(frame.offset, damage))?);
            }
            op::MESSAGE_INDEX => {
                if let Some(chunk) = &mut self.open_chunk {
                    let start = bodies.start::<MessageIndexStart>(frame)?;
                    let (channel_id, entries) = start
                        .and_then(|start| count_entries(&start, frame))
                        .ok_or_else(|| malformed(bodies, frame, RecordKind::MessageIndex))?;
                    *chunk.indexed.entry(channel_id).or_default() += entries;
                    chunk.index_offsets.insert(channel_id, frame.offset);
                    chunk.index_length += frame.end() - frame.offset;
                }
            }
            op::ATTACHMENT => {
                let start: AttachmentStart = (bodies.start(frame)?)
                    .ok_or_else(|| malformed(bodies, frame, RecordKind::Attachment))?;
                let index = Raw::new(AttachmentIndex {
                    offset: frame.offset,
                    length: frame.end() - frame.offset,
                    log_time: start.header.log_time,
                    create_time: start.header.create_time,
                    data_size: start.data_size,
                    name: start.header.name,
                    media_type: start.header.media_type,
                });
                self.keep(bodies, frame, index.body.len())?;
                self.contents.attachments.push(index);
            }
            op::METADATA => {
                let start: MetadataStart = (bodies.start(frame)?)
                    .ok_or_else(|| malformed(bodies, frame, RecordKind::Metadata))?;
                let index = Raw::new(MetadataIndex {
                    offset: frame.offset,
                    length: frame.end() - frame.offset,
                    name: start.name,
                });
                self.keep(bodies, frame, index.body.len())?;
                self.contents.metadata.push(index);
            }
            op::DATA_END => return Err(early_end(bodies, frame, RecordKind::DataEnd)),
            op::FOOTER => return Err(early_end(bodies, frame, RecordKind::Footer)),
            _ => {}
        }
        Ok(())
    }

    /// Refuses the record if what is kept of it is too much, together with what is kept already.
    fn keep(
        &mut self,
        bodies: &impl Bodies,
        frame: &Frame,
        length: usize,
    ) -> Result<(), ReadError> {
        let taken = self.room.take(length);
        taken.map_err(|damage| bodies.damaged(frame.offset, damage))
    }

    /// Everything that was collected.
    pub fn finish(mut self) -> Contents {
        self.close_chunk();
        self.contents.segments.sort_by_key(|segment| segment.offset);
        self.contents
    }

    fn loose_message(&mut self, frame: &Frame, channel_id: u16, log_time: u64) {
        let segments = &mut self.contents.segments;
        let run = segments.pop_if(|run| {
            let unbroken = run.offset + run.length == frame.offset;
            matches!(run.kind, SegmentKind::Loose) && unbroken && run.length < LOOSE_RUN
        });
        let mut run = run.unwrap_or_else(|| Segment {
            offset: frame.offset,
            length: 0,
            times: None,
            message_counts: BTreeMap::new(),
            kind: SegmentKind::Loose,
        });
        run.length = frame.end() - run.offset;
        run.times = widen(run.times, log_time);
        *run.message_counts.entry(channel_id).or_default() += 1;
        segments.push(run);
        let steps_back = self.steps_back.entry(channel_id);
        steps_back.or_default().push(log_time);
    }

    /// Takes the content of a chunk.
    fn chunk(
        &mut self,
        frame: &Frame,
        body: &[u8],
        mut visit: impl FnMut(&Definitions, &RawMessage, &[u8]),
    ) -> Result<OpenChunk, Damage> {
        let (header, records) = self.chunks.records(body)?;
        let definitions = &mut self.contents.definitions;
        let mut times = None;
        let mut message_counts = BTreeMap::new();
        for record in records {
            let record = record.map_err(|_| Damage::Torn)?;
            let position = record.offset as u64;
            let malformed = |kind| Damage::MalformedInChunk { kind, position };
            match record.opcode {
                op::SCHEMA | op::CHANNEL => {
                    let opcode = record.opcode;
                    let added = definitions.add(opcode, record.body);
                    if let Some(id) = added.ok_or_else(|| malformed(RecordKind::Definition))? {
                        self.room.take(definitions.size(opcode, id))?;
                        let chunk = frame.offset;
                        (self.defined_in_chunks).push(DefinedInChunk { chunk, opcode, id });
                    }
                }
                op::MESSAGE => {
                    let message = RawMessage::parse(record.body);
                    let message = message.ok_or_else(|| malformed(RecordKind::Message))?;
                    times = widen(times, message.log_time);
                    *message_counts.entry(message.channel_id).or_default() += 1;
                    let steps_back = self.steps_back.entry(message.channel_id);
                    steps_back.or_default().push(message.log_time);
                    visit(definitions, &message, record.body);
                }
                opcode => {
                    if let Some(kind) = RecordKind::of(opcode) {
                        return Err(Damage::MisplacedInChunk { kind, position });
                    }
                }
            }
        }
        let (message_start_time, message_end_time) = times.unwrap_or((0, 0));
        Ok(OpenChunk {
            index: ChunkIndex {
                message_start_time,
                message_end_time,
                chunk_start_offset: frame.offset,
                chunk_length: frame.end() - frame.offset,
                message_index_offsets: BTreeMap::new(),
                message_index_length: 0,
                compression: header.compression,
                compressed_size: header.compressed_size,
                uncompressed_size: header.uncompressed_size,
            },
            times,
            message_counts,
            indexed: BTreeMap::new(),
            index_offsets: BTreeMap::new(),
            index_length: 0,
        })
    }

    /// Whether message indexes may follow that belong to the latest chunk.
    pub fn has_open_chunk(&self) -> bool {
        self.open_chunk.is_some()
    }

    /// Closes the latest chunk: no more message indexes follow it. Returns whether all of its messages are indexed;
    /// `None` if there is no open chunk.
    pub fn close_chunk(&mut self) -> Option<bool> {
        let chunk = self.open_chunk.take()?;
        let mut index = chunk.index;
        let mut indexed = chunk.indexed;
        indexed.retain(|_, count| *count > 0);
        let is_indexed = indexed == chunk.message_counts;
        if is_indexed {
            index.message_index_offsets = chunk.index_offsets;
            index.message_index_length = chunk.index_length;
        }
        self.contents.segments.push(Segment {
            offset: index.chunk_start_offset,
            length: index.chunk_length,
            times: chunk.times,
            message_counts: chunk.message_counts,
            kind: SegmentKind::Chunk {
                index: Raw::new(index),
                is_indexed,
            },
        });
        Some(is_indexed)
    }

    /// The number of segments so far, including the one with the latest message.
    pub fn segments(&self) -> usize {
        self.contents.segments.len() + usize::from(self.open_chunk.is_some())
    }
}

fn widen(times: Option<(u64, u64)>, time: u64) -> Option<(u64, u64)> {
    let (start, end) = times.unwrap_or((time, time));
    Some((start.min(time), end.max(time)))
}

/// The error for a record whose body cannot be read.
fn malformed(bodies: &impl Bodies, frame: &Frame, kind: RecordKind) -> ReadError {
    bodies.damaged(frame.offset, Damage::Malformed(kind))
}

/// The error for a record that ends the data before its end.
fn early_end(bodies: &impl Bodies, frame: &Frame, kind: RecordKind) -> ReadError {
    bodies.damaged(frame.offset, Damage::EarlyEnd(kind))
}

/// The channel of a message index and the number of its entries; `None` if it is shorter than that.
fn count_entries(start: &MessageIndexStart, frame: &Frame) -> Option<(u16, u64)> {
    let length = u64::from(start.length);
    let is_there = MESSAGE_INDEX_PREFIX - FRAME_LENGTH as u64 + length <= frame.length;
    (is_there && length.is_multiple_of(MESSAGE_INDEX_ENTRY))
        .then_some((start.channel_id, length / MESSAGE_INDEX_ENTRY))
}
