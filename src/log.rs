//! A log in the MCAP container: what it holds, where its bytes lie, and its messages.
//!
//! A [`Log`] is opened from its summary where that accounts for everything, else by reading it from start to
//! end. Either way its messages lie in [segments](contents::Segment): chunks, or runs of messages outside
//! chunks.

pub mod contents;
pub mod record;

mod chunk;
mod file;
mod foreign;
mod scan;
mod summary;

use std::{borrow::Cow, path::Path};

use mcap::records::{DataEnd, Header, Metadata, MetadataIndex, Record, op};

use crate::error::Error;
use chunk::ChunkDecoder;
use contents::{Contents, Segment, SegmentKind};
use file::LogFile;
use record::{FRAME_LENGTH, RawMessage, Records, parse};
use scan::{Collector, Step, Walker};
use summary::Ending;

/// An open log.
#[derive(Debug)]
pub struct Log {
    pub file: LogFile,
    pub header: Header,
    /// Where the data section ends: its DataEnd record, the footer where there is none, or the end of the
    /// last whole record of a log that breaks off.
    pub data_end: u64,
    /// The checksum of the data section, where the log has one.
    pub data_crc: Option<u32>,
    pub contents: Contents,
    /// Why what the log holds had to be found by reading all of it, where it had to.
    pub scanned: Option<ScanReason>,
    /// Where a log that was not closed breaks off: bytes from here on, if any, could not be read.
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
    /// Opens a log and learns what it holds.
    ///
    /// # Errors
    /// The file cannot be read, is not an MCAP, or is damaged where it is needed.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let file = LogFile::open(path)?;
        let header = read_header(&file)?;
        let ending = Ending::read(&file)?;
        let summary = match ending {
            Some(Ending {
                data_end,
                data_crc,
                summary: Some(summary),
            }) => {
                if let Some(contents) = summary.account_for(&file, data_end)? {
                    return Ok(Self {
                        file,
                        header,
                        data_end,
                        data_crc,
                        contents,
                        scanned: None,
                        breaks_off_at: None,
                    });
                }
                Some((ScanReason::IncompleteSummary, Some(summary)))
            }
            Some(_) => Some((ScanReason::NoSummary, None)),
            None => None,
        };
        let (reason, summary) = summary.unwrap_or((ScanReason::NotClosed, None));
        let mut log = Self::scan(file, header, reason)?;
        if let Some(summary) = summary {
            summary.supplement(&mut log.contents);
            log.contents.statistics = log.contents.recount();
        }
        Ok(log)
    }

    fn scan(file: LogFile, header: Header, reason: ScanReason) -> Result<Self, Error> {
        let mut walker = Walker::new(&file, mcap::MAGIC.len() as u64, file.len());
        let mut collector = Collector::default();
        let mut data_crc = None;
        let mut breaks_off_at = None;
        let data_end = loop {
            match walker.step()? {
                Step::Record(frame) if frame.opcode == op::DATA_END => {
                    let crc = parse(walker.body(&frame, u64::MAX)?)
                        .map_or(0, |end: DataEnd| end.data_section_crc);
                    data_crc = (crc != 0).then_some(crc);
                    break frame.offset;
                }
                Step::Record(frame) if frame.opcode == op::FOOTER => break frame.offset,
                Step::Record(frame) => collector.record(&mut walker, &frame)?,
                Step::End => {
                    breaks_off_at = Some(file.len());
                    break file.len();
                }
                Step::Torn { offset } => {
                    breaks_off_at = Some(offset);
                    break offset;
                }
            }
        };
        let mut contents = collector.finish();
        contents.statistics = contents.recount();
        Ok(Self {
            file,
            header,
            data_end,
            data_crc,
            contents,
            scanned: Some(reason),
            breaks_off_at,
        })
    }

    /// Whether no bytes of the log were left unread because they make no sense.
    pub fn is_readable_to_its_end(&self) -> bool {
        self.breaks_off_at
            .is_none_or(|offset| offset == self.file.len())
    }

    /// The Metadata records of one name.
    pub fn metadata(&self, name: &str) -> Result<Vec<Metadata>, Error> {
        let named = (self.contents.metadata.iter()).filter(|index| index.record.name == name);
        named.map(|index| self.metadata_at(&index.record)).collect()
    }

    fn metadata_at(&self, index: &MetadataIndex) -> Result<Metadata, Error> {
        let bytes = self.file.read(index.offset, index.length)?;
        let record = Records::new(&bytes).next().and_then(Result::ok);
        record
            .filter(|record| record.opcode == op::METADATA)
            .and_then(|record| parse(record.body).ok())
            .ok_or_else(|| {
                self.file
                    .corrupt(index.offset, "the metadata record there cannot be read")
            })
    }

    /// The payload of the first message of a channel, in the order of the file.
    pub fn first_payload(&self, channel_id: u16) -> Result<Option<Vec<u8>>, Error> {
        let mut messages = SegmentReader::new(self);
        let holds = |segment: &&Segment| segment.message_counts.contains_key(&channel_id);
        for segment in self.contents.segments.iter().filter(holds) {
            for message in messages.read(segment)? {
                let message = message?;
                if message.channel_id == channel_id {
                    return Ok(Some(message.payload.to_vec()));
                }
            }
        }
        Ok(None)
    }
}

/// Reads the messages of one segment after the other, reusing its buffers.
pub struct SegmentReader<'a> {
    file: &'a LogFile,
    raw: Vec<u8>,
    decoder: ChunkDecoder,
}

impl<'a> SegmentReader<'a> {
    pub fn new(log: &'a Log) -> Self {
        Self {
            file: &log.file,
            raw: Vec::new(),
            decoder: ChunkDecoder::default(),
        }
    }

    /// The messages of a segment, in the order of the file.
    ///
    /// # Errors
    /// The segment cannot be read or is damaged.
    pub fn read(
        &mut self,
        segment: &Segment,
    ) -> Result<impl Iterator<Item = Result<RawMessage<'_>, Error>>, Error> {
        let file = self.file;
        file.read_into(&mut self.raw, segment.offset, segment.length)?;
        let content = match segment.kind {
            SegmentKind::Loose => &self.raw,
            SegmentKind::Chunk { .. } => {
                let body = self.raw.get(FRAME_LENGTH..).unwrap_or_default();
                let (
                    Some(&op::CHUNK),
                    Ok(Record::Chunk {
                        header,
                        data: Cow::Borrowed(compressed),
                    }),
                ) = (self.raw.first(), mcap::parse_record(op::CHUNK, body))
                else {
                    return Err(file.corrupt(segment.offset, "there should be a chunk"));
                };
                self.decoder.decode(&header, compressed).map_err(|fault| {
                    file.corrupt(
                        segment.offset,
                        format!("the chunk there is unreadable: {fault}"),
                    )
                })?
            }
        };
        let offset = segment.offset;
        let malformed =
            move || file.corrupt(offset, "what starts there holds a record that breaks off");
        Ok(
            Records::new(content).filter_map(move |record| match record {
                Ok(record) if record.opcode == op::MESSAGE => {
                    Some(RawMessage::parse(record.body).ok_or_else(malformed))
                }
                Ok(_) => None,
                Err(_) => Some(Err(malformed())),
            }),
        )
    }
}

/// Checks the magic bytes and reads the header.
fn read_header(file: &LogFile) -> Result<Header, Error> {
    if file.len() == 0 {
        return Err(Error::Empty {
            path: file.path().into(),
        });
    }
    let magic_length = mcap::MAGIC.len() as u64;
    let start = file.read(0, file.len().min(magic_length))?;
    if start != mcap::MAGIC {
        return Err(Error::NotMcap {
            path: file.path().into(),
            advice: foreign::advice(&start),
        });
    }
    let mut walker = Walker::new(file, magic_length, file.len());
    if let Step::Record(frame) = walker.step()?
        && frame.opcode == op::HEADER
        && let Ok(header) = parse(walker.body(&frame, u64::MAX)?)
    {
        return Ok(header);
    }
    Err(file.corrupt(
        magic_length,
        "there should be the header, the log's first record",
    ))
}
