//! A log in the MCAP container: what it contains and where, and its messages.
//!
//! A [`Log`] is opened from its summary if that accounts for everything, otherwise by reading it from start to end. One
//! that comes through a pipe is read [while it is passed on](stream). Either way its messages are in
//! [segments](contents::Segment): chunks, or runs of messages outside chunks.

pub(crate) mod chunk;
pub mod contents;
pub mod file;
pub(crate) mod fingerprint;
pub(crate) mod message_index;
pub mod record;
pub(crate) mod scan;
pub mod stream;
pub(crate) mod summary;

mod error;
mod foreign;
mod indexed_chunk;
mod message_times;
mod partial_chunk;
mod segment;
mod step_back;

use std::{
    collections::{BTreeMap, BTreeSet},
    ops::ControlFlow,
    path::Path,
};

use mcap::records::{DataEnd, Header, Metadata, MetadataIndex, op};

use contents::{Contents, Segment};
use file::LogFile;
use record::{Records, parse};
use scan::{Bodies, Collector, Frame, Next, Walker};
use summary::{DATA_END_LENGTH, Ending, Rest};

pub use crate::fs::Access;
pub use error::{ChunkFault, Damage, ReadError, RecordKind};
pub use foreign::ForeignFormat;
pub use segment::SegmentReader;
pub use step_back::StepBack;

/// [`Log::first_payloads`] leaves out payloads that are longer than this.
pub const LONGEST_EXAMPLE: usize = 64 * 1024;

/// An open log.
#[derive(Debug)]
pub struct Log {
    /// Where its bytes are.
    pub file: LogFile,
    /// The log's first record: the profile that it follows, the library that wrote it.
    pub header: Header,
    /// Where the data section ends: at its DataEnd record, at the footer if there is none, or after the last whole
    /// record of a log that breaks off.
    pub data_end: u64,
    /// The checksum of the data section, if the log has one.
    pub data_crc: Option<u32>,
    /// What it contains.
    pub contents: Contents,
    /// Why all of the log had to be read to find out what it contains, if it had to be.
    pub scanned: Option<ScanReason>,
    /// Where a log that was not closed breaks off, or one that was closed ends before the file does. The bytes from here
    /// on, if any, could not be read.
    pub breaks_off_at: Option<u64>,
}

/// Why a log was read from start to end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScanReason {
    /// It was not closed properly.
    NotClosed,
    /// It has no summary, or one whose checksum is wrong.
    NoSummary,
    /// The summary leaves something out or contradicts the file.
    IncompleteSummary,
}

impl Log {
    /// Opens a log for reading and finds out what it contains.
    ///
    /// # Errors
    /// The file cannot be read, is not an MCAP, or is damaged where it is needed.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::read(LogFile::open(path, Access::Read)?)
    }

    /// Finds out what the log in a file contains.
    ///
    /// # Errors
    /// The file cannot be read, is not an MCAP, or is damaged where it is needed.
    pub fn read(file: LogFile) -> Result<Self, ReadError> {
        let header = read_header(&file)?;
        let ending = Ending::read(&file, 0)?;
        if let Some(Ending {
            data_end,
            data_crc,
            summary: Some(summary),
        }) = &ending
            && let Some(contents) = summary.account_for(&file, *data_end)?
        {
            return Ok(Self {
                header,
                data_end: *data_end,
                data_crc: *data_crc,
                contents,
                scanned: None,
                breaks_off_at: None,
                file,
            });
        }
        Self::scan(file, header, ending)
    }

    /// Reads the log from start to end. Its `ending`, if it has one, says where that is.
    fn scan(file: LogFile, header: Header, ending: Option<Ending>) -> Result<Self, ReadError> {
        let end = (ending.as_ref()).map_or(file.length(), |ending| ending.data_end);
        let mut walker = Walker::new(&file, mcap::MAGIC.len() as u64, end);
        let mut collector = Collector::default();
        let stop = loop {
            match walker.step()? {
                Next::Record(frame) => {
                    if let Some(stop) = Stop::at(&mut walker, &frame)? {
                        break stop;
                    }
                    collector.record(&mut walker, &frame)?;
                }
                Next::End => break Stop::End { offset: end },
                Next::Torn { offset } => break Stop::Torn { offset },
            }
        };
        let close = stop.close(&file, ending)?;
        let log = Self::read_to_end(file, header, close, stop, collector)?;
        // Its summary, even if it agrees with what was found, was not enough to find it.
        let scanned = log.scanned.or(Some(ScanReason::IncompleteSummary));
        Ok(Self { scanned, ..log })
    }

    /// Makes a log from all of its records, up to where reading stopped, and from what was found in them.
    fn read_to_end(
        file: LogFile,
        header: Header,
        close: Close,
        stop: Stop,
        mut collector: Collector,
    ) -> Result<Self, ReadError> {
        let ending = close.ending;
        let mut data_crc = ending.as_ref().and_then(|ending| ending.data_crc);
        let mut breaks_off_at = close.surplus;
        let data_end = match stop {
            Stop::DataEnd { offset, crc, .. } => {
                data_crc = crc;
                offset
            }
            Stop::Torn { offset } if ending.is_some() => {
                return Err(file.damaged(offset, Damage::NotARecord));
            }
            Stop::Torn { offset } => {
                breaks_off_at = Some(offset);
                offset
            }
            Stop::End { offset } => {
                breaks_off_at = ending.is_none().then_some(offset);
                offset
            }
            Stop::Footer { offset, .. } => offset,
        };
        let defined_in_chunks = std::mem::take(&mut collector.defined_in_chunks);
        let steps_back = std::mem::take(&mut collector.steps_back);
        let mut contents = collector.finish();
        contents.statistics = contents.recount();
        contents.steps_back = Some(steps_back);
        let scanned = match ending.map(|ending| ending.summary) {
            None => Some(ScanReason::NotClosed),
            Some(None) => Some(ScanReason::NoSummary),
            Some(Some(summary)) => {
                let is_complete =
                    summary.complete(&mut contents) && summary.repeats(&defined_in_chunks);
                (!is_complete).then_some(ScanReason::IncompleteSummary)
            }
        };
        Ok(Self {
            file,
            header,
            data_end,
            data_crc,
            contents,
            scanned,
            breaks_off_at,
        })
    }

    /// Whether all of the log could be read.
    pub fn is_readable_to_its_end(&self) -> bool {
        self.breaks_off_at
            .is_none_or(|offset| offset == self.file.length())
    }

    /// The Metadata records with this name.
    pub fn metadata(&self, name: &str) -> Result<Vec<Metadata>, ReadError> {
        let named = (self.contents.metadata.iter()).filter(|index| index.record.name == name);
        named.map(|index| self.metadata_at(&index.record)).collect()
    }

    fn metadata_at(&self, index: &MetadataIndex) -> Result<Metadata, ReadError> {
        (chunk::check_length(index.length))
            .map_err(|damage| self.file.damaged(index.offset, damage))?;
        let bytes = self.file.read(index.offset, index.length)?;
        let record = Records::new(&bytes).next().and_then(Result::ok);
        record
            .filter(|record| record.opcode == op::METADATA)
            .and_then(|record| parse(record.body).ok())
            .ok_or_else(|| {
                let damage = Damage::Malformed(RecordKind::Metadata);
                self.file.damaged(index.offset, damage)
            })
    }

    /// The payloads of the first messages of channels, in the order of the file: at most `most` of each, none longer
    /// than 64 KiB, from the first segment that has any.
    ///
    /// # Errors
    /// A segment cannot be read or is damaged.
    pub fn first_payloads(
        &self,
        channel_ids: &BTreeSet<u16>,
        most: usize,
    ) -> Result<BTreeMap<u16, Vec<Vec<u8>>>, ReadError> {
        let mut segments = SegmentReader::new(self);
        let mut payloads: BTreeMap<u16, Vec<Vec<u8>>> = BTreeMap::new();
        let mut pending = channel_ids.clone();
        for segment in &self.contents.segments {
            let here = segment.channels_among(&pending);
            if here.is_empty() {
                continue;
            }
            let mut unfilled = here.len();
            for message in segments.read(segment, &here)? {
                let message = message?;
                let of_channel = payloads.entry(message.channel_id).or_default();
                if of_channel.len() == most || message.payload.len() > LONGEST_EXAMPLE {
                    continue;
                }
                of_channel.push(message.payload.to_vec());
                unfilled -= usize::from(of_channel.len() == most);
                if unfilled == 0 {
                    break;
                }
            }
            pending.retain(|id| !here.contains(id));
        }
        Ok(payloads)
    }

    /// Passes the payloads of a channel's messages to `take`, in the order of the file, until it breaks off. Of the
    /// segments that have any, at most that many are read, the first ones.
    ///
    /// # Errors
    /// A segment cannot be read or is damaged.
    pub fn visit_payloads(
        &self,
        channel_id: u16,
        most_segments: usize,
        mut take: impl FnMut(&[u8]) -> ControlFlow<()>,
    ) -> Result<(), ReadError> {
        let mut segments = SegmentReader::new(self);
        let has_any = |segment: &&Segment| segment.message_counts.contains_key(&channel_id);
        let with_messages = self.contents.segments.iter().filter(has_any);
        for segment in with_messages.take(most_segments) {
            for message in segments.read(segment, &[channel_id].into())? {
                if take(message?.payload).is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}

/// Where reading a log record by record stopped.
enum Stop {
    /// Reading stopped at the DataEnd record, which may have the data section's checksum.
    DataEnd {
        offset: u64,
        end: u64,
        crc: Option<u32>,
    },
    /// Reading stopped at the footer of a log without a DataEnd record.
    Footer { offset: u64, end: u64 },
    /// Reading stopped where the data section should end, after a whole record.
    End { offset: u64 },
    /// Reading stopped before the data section's end, because there is no whole record.
    Torn { offset: u64 },
}

impl Stop {
    /// Reading stops at a record, if that ends the data.
    fn at(bodies: &mut impl Bodies, frame: &Frame) -> Result<Option<Self>, ReadError> {
        let (offset, end) = (frame.offset, frame.end());
        Ok(match frame.opcode {
            op::DATA_END => {
                let body = bodies.body(frame, DATA_END_LENGTH as u64)?;
                let crc = parse(body).map_or(0, |end: DataEnd| end.data_section_crc);
                Some(Self::DataEnd {
                    offset,
                    end,
                    crc: (crc != 0).then_some(crc),
                })
            }
            op::FOOTER => Some(Self::Footer { offset, end }),
            _ => None,
        })
    }

    /// Checks that the data does not go on after the record that ends it: that this is the one of the file's `ending`,
    /// or that at most a summary follows, perhaps with the closing magic and something that is not a part of the log.
    fn close(&self, file: &LogFile, ending: Option<Ending>) -> Result<Close, ReadError> {
        let (offset, end, kind) = match *self {
            Self::DataEnd { offset, end, .. } => (offset, end, RecordKind::DataEnd),
            Self::Footer { offset, end } => (offset, end, RecordKind::Footer),
            Self::End { .. } | Self::Torn { .. } => {
                return Ok(Close {
                    ending,
                    surplus: None,
                });
            }
        };
        if (ending.as_ref()).is_some_and(|ending| ending.data_end == offset) {
            return Ok(Close {
                ending,
                surplus: None,
            });
        }
        let surplus = match Rest::after(file, kind, end)? {
            Rest::Summary if ending.is_none() => None,
            // The file's ending is that of the other log.
            Rest::Surplus { start, is_log } if is_log || ending.is_none() => Some(start),
            _ => return Err(file.damaged(offset, Damage::EarlyEnd(kind))),
        };
        Ok(Close {
            ending: None,
            surplus,
        })
    }
}

/// How a log ends after its data.
struct Close {
    /// The end of the file, if it is that of the log.
    ending: Option<Ending>,
    /// Where the log ends before the file does.
    surplus: Option<u64>,
}

/// Checks the magic bytes and reads the header.
fn read_header(file: &LogFile) -> Result<Header, ReadError> {
    let magic_length = mcap::MAGIC.len() as u64;
    let start = file.read(0, file.length().min(magic_length))?;
    if start != mcap::MAGIC {
        let start = file.read(0, file.length().min(ForeignFormat::EXAMINED))?;
        return Err(not_mcap(file.path(), &start));
    }
    let mut walker = Walker::new(file, magic_length, file.length());
    if let Next::Record(frame) = walker.step()?
        && frame.opcode == op::HEADER
        && let Ok(header) = parse(walker.whole(&frame)?)
    {
        return Ok(header);
    }
    Err(file.damaged(magic_length, Damage::NoHeader))
}

/// Why a file that starts with these bytes is not a log.
fn not_mcap(path: &Path, start: &[u8]) -> ReadError {
    let path = path.to_owned();
    match start {
        [] => ReadError::Empty { path },
        start => ReadError::NotMcap {
            path,
            format: ForeignFormat::of(start),
        },
    }
}
