//! Reading records from a pipe and passing them on.

use std::{
    io::{self, BufReader, BufWriter, Read, Write},
    path::Path,
};

use mcap::records::{Header, op};

use super::{Named, spool::Spool};
use crate::log::{
    error::{Damage, ReadError},
    file::LogFile,
    foreign::ForeignFormat,
    not_mcap,
    record::{FRAME_LENGTH, MAX_RECORD, parse, split_frame},
    scan::{Bodies, Frame},
};

/// A record longer than this is spooled to a file as it arrives, not held in memory.
const LONG: u64 = 16 * 1024 * 1024;

/// How much of a long record is held in memory at once.
const PIECE: u64 = 1024 * 1024;

/// How much is buffered: as much as the system buffers for a pipe.
const BUFFER: usize = 64 * 1024;

/// A log between its input and its output.
pub struct Pipe<'a, R: Read, W: Write> {
    input: Named<'a, BufReader<R>>,
    output: Named<'a, BufWriter<W>>,
    /// Where the current record starts; everything before it has been passed on.
    position: u64,
    /// What has arrived of the current record; only the frame if the record is long.
    record: Vec<u8>,
    /// The chunk that message indexes may still follow, and its record unless that is long.
    chunk: Option<Frame>,
    chunk_record: Vec<u8>,
    spool: Spool,
}

impl<'a, R: Read, W: Write> Pipe<'a, R, W> {
    pub fn new(input: Named<'a, R>, output: Named<'a, W>) -> Result<Self, ReadError> {
        Ok(Self {
            input: Named::new(input.name, BufReader::with_capacity(BUFFER, input.stream)),
            output: Named::new(output.name, BufWriter::with_capacity(BUFFER, output.stream)),
            position: 0,
            record: Vec::new(),
            chunk: None,
            chunk_record: Vec::new(),
            spool: Spool::new()?,
        })
    }

    /// Where the current record starts or, between records, the next one will.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Reads, checks and passes on the magic bytes and the header.
    pub fn pass_on_header(&mut self) -> Result<Header, ReadError> {
        let magic_length = mcap::MAGIC.len() as u64;
        self.read(magic_length)?;
        if self.record != mcap::MAGIC {
            self.read(ForeignFormat::EXAMINED - magic_length)?;
            return Err(not_mcap(self.input.name, &self.record));
        }
        self.position = magic_length;

        let no_header = || ReadError::damaged(self.input.name, magic_length, Damage::NoHeader);
        let frame = self.read_frame()?;
        let frame = frame.filter(|frame| frame.opcode == op::HEADER && !is_long(frame));
        let frame = frame.ok_or_else(no_header)?;
        let is_whole = self.read_body(&frame)?;
        let header = parse(&self.record[FRAME_LENGTH..]);
        let header = header.ok().filter(|_| is_whole).ok_or_else(no_header)?;
        self.pass(mcap::MAGIC)?;
        self.pass_on(&frame)?;
        Ok(header)
    }

    /// Reads the frame of the next record; `None` if there is none.
    pub fn read_frame(&mut self) -> Result<Option<Frame>, ReadError> {
        self.record.clear();
        self.read(FRAME_LENGTH as u64)?;
        let frame = split_frame(&self.record).filter(|&(opcode, _)| opcode != 0);
        Ok(frame.map(|(opcode, length)| Frame {
            opcode,
            offset: self.position,
            length,
        }))
    }

    /// Reads the rest of the current record. Returns whether all of it arrived.
    pub fn read_body(&mut self, frame: &Frame) -> Result<bool, ReadError> {
        if !is_long(frame) {
            return self.read(frame.length);
        }
        self.spool.write(frame.offset, &self.record)?;
        let copied = self.hold_back(frame.body_offset(), frame.length)?;
        Ok(copied == frame.length)
    }

    /// The body of the current record, which must be whole.
    pub fn body(&self, frame: &Frame) -> Result<Body<'_>, ReadError> {
        let name = self.input.name;
        Ok(match is_long(frame) {
            false => Body::InMemory {
                name,
                bytes: &self.record[FRAME_LENGTH..],
            },
            true => Body::InFile {
                file: self.spool.open(name)?,
                buffer: Vec::new(),
            },
        })
    }

    /// Passes on the current record, which must be whole.
    pub fn pass_on(&mut self, frame: &Frame) -> Result<(), ReadError> {
        if is_long(frame) {
            let file = self.spool.open(self.input.name)?;
            let mut offset = frame.offset;
            while offset < frame.end() {
                let length = PIECE.min(frame.end() - offset);
                file.read_into(&mut self.record, offset, length)?;
                self.pass_record()?;
                offset += length;
            }
        } else {
            self.pass_record()?;
        }
        self.position = frame.end();
        match (frame.opcode, is_long(frame)) {
            (op::CHUNK, _) => {
                self.chunk = Some(*frame);
                std::mem::swap(&mut self.record, &mut self.chunk_record);
                Ok(())
            }
            (op::METADATA, true) if frame.length <= MAX_RECORD => Ok(()),
            (op::METADATA, false) => self.spool.write(frame.offset, &self.record),
            (_, true) => self.spool.forget(frame.offset),
            (_, false) => Ok(()),
        }
    }

    /// Keeps the latest chunk if it is not indexed, else discards it. To be called when no more message indexes follow
    /// it, and before anything after it is kept.
    pub fn settle_chunk(&mut self, is_indexed: bool) -> Result<(), ReadError> {
        let Some(chunk) = self.chunk.take() else {
            return Ok(());
        };
        match (is_indexed, is_long(&chunk)) {
            (true, true) => self.spool.forget(chunk.offset),
            (false, false) => self.spool.write(chunk.offset, &self.chunk_record),
            (true, false) | (false, true) => Ok(()),
        }
    }

    /// Holds back what has arrived of the current record, and everything after it. Returns everything that was kept, and
    /// the output.
    pub fn hold_back_the_rest(mut self) -> Result<(LogFile, Named<'a, BufWriter<W>>), ReadError> {
        flush(&mut self.output)?;
        self.spool.write(self.position, &self.record)?;
        let held_back = self.position + self.record.len() as u64;
        // A long record that breaks off has been spooled already.
        let held_back = self.spool.end()?.max(held_back);
        self.hold_back(held_back, u64::MAX)?;
        let file = self.spool.finish(self.input.name, self.position)?;
        Ok((file, self.output))
    }

    /// Reads `length` more bytes of the current record. Returns whether they arrived.
    fn read(&mut self, length: u64) -> Result<bool, ReadError> {
        read_up_to(&mut self.input, &mut self.output, &mut self.record, length)
    }

    /// Keeps at most `most` bytes of the input, which are at `offset`. Returns how many arrived.
    fn hold_back(&mut self, offset: u64, most: u64) -> Result<u64, ReadError> {
        let mut held_back = 0;
        let mut piece = Vec::new();
        loop {
            piece.clear();
            let wanted = PIECE.min(most - held_back);
            let is_all = read_up_to(&mut self.input, &mut self.output, &mut piece, wanted)?;
            self.spool.write(offset + held_back, &piece)?;
            held_back += piece.len() as u64;
            if !is_all || held_back == most {
                return Ok(held_back);
            }
        }
    }

    /// Passes on the part of the current record that is in memory.
    fn pass_record(&mut self) -> Result<(), ReadError> {
        let record = std::mem::take(&mut self.record);
        let passed = self.pass(&record);
        self.record = record;
        passed
    }

    fn pass(&mut self, bytes: &[u8]) -> Result<(), ReadError> {
        let written = self.output.stream.write_all(bytes);
        written.map_err(|source| cannot_write(self.output.name, source))?;
        self.spool.pass(bytes);
        Ok(())
    }
}

/// The body of a whole record.
pub enum Body<'a> {
    InMemory { name: &'a Path, bytes: &'a [u8] },
    InFile { file: LogFile, buffer: Vec<u8> },
}

impl Bodies for Body<'_> {
    fn body(&mut self, frame: &Frame, most: u64) -> Result<&[u8], ReadError> {
        let length = frame.length.min(most);
        match self {
            Self::InMemory { bytes, .. } => Ok(&bytes[..length as usize]),
            Self::InFile { file, buffer } => {
                file.read_into(buffer, frame.body_offset(), length)?;
                Ok(buffer)
            }
        }
    }

    fn damaged(&self, offset: u64, damage: impl Into<Damage>) -> ReadError {
        match self {
            Self::InMemory { name, .. } => ReadError::damaged(name, offset, damage),
            Self::InFile { file, .. } => file.damaged(offset, damage),
        }
    }
}

/// Passes on what was held back of a log, which is everything from `start` on.
pub fn pass_on_the_rest(
    file: &LogFile,
    start: u64,
    output: &mut Named<BufWriter<impl Write>>,
) -> Result<(), ReadError> {
    file.for_each_piece(start, file.length(), |piece| {
        let written = output.stream.write_all(piece);
        written.map_err(|source| cannot_write(output.name, source))
    })?;
    flush(output)
}

/// Reads `length` more bytes. Returns whether they arrived. Before it waits for the input, it flushes the output.
fn read_up_to(
    input: &mut Named<BufReader<impl Read>>,
    output: &mut Named<BufWriter<impl Write>>,
    bytes: &mut Vec<u8>,
    length: u64,
) -> Result<bool, ReadError> {
    if (input.stream.buffer().len() as u64) < length {
        flush(output)?;
    }
    let read = input.stream.by_ref().take(length).read_to_end(bytes);
    let read = read.map_err(|source| ReadError::io("cannot read", input.name, source))?;
    Ok(read as u64 == length)
}

fn flush(output: &mut Named<BufWriter<impl Write>>) -> Result<(), ReadError> {
    let flushed = output.stream.flush();
    flushed.map_err(|source| cannot_write(output.name, source))
}

fn cannot_write(name: &Path, source: io::Error) -> ReadError {
    ReadError::io("cannot write", name, source)
}

/// Whether a record is spooled to a file.
fn is_long(frame: &Frame) -> bool {
    frame.length > LONG
}
