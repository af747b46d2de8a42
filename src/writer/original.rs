//! The original of an enriched log: how it is kept in the result, and recovered from it.
//!
//! The result starts with the original's bytes up to the end of its data section. The rest of the original is in an
//! attachment of the result, the last record of its data section.

use std::{
    fs::File,
    io::{self, Read, Seek, Write},
};

use mcap::records::{AttachmentIndex, Record, op};
use prost::Message;
use sha2::{Digest, Sha256};

use super::{
    error::WriteError,
    provenance::{self, EarlierRun},
};
use crate::{
    derived::Quantity,
    log::{Damage, Log, ReadError, fingerprint::Fingerprint, record::Records},
    messages::v1::OriginalTail,
};

/// The attachment's name.
pub const NAME: &str = "flightcam/original_tail";

/// Its content is a `flightcam.v1.OriginalTail`.
pub(super) const MEDIA_TYPE: &str = "application/x-protobuf";

/// How much of the uncompressed tail is held in memory.
const PIECE: u64 = 1024 * 1024;

/// A log as it was before flightcam added to it.
#[derive(Debug)]
pub struct Original {
    /// The original.
    pub log: Log,
    /// The earlier run that is undone in it; or why none is, so that the log is the file as it is.
    pub undone: Result<EarlierRun, Lost>,
}

/// Why the original log cannot be recovered from a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum Lost {
    #[error("it has nothing from flightcam")]
    NotEnriched,
    #[error("it was written in the interleaved layout, which cannot be undone")]
    Interleaved,
    #[error("it came through a pipe, which cannot be undone")]
    PassedOn,
    #[error("another program has rewritten it since, or it is damaged")]
    Rewritten,
}

impl Original {
    /// Of a log, enriched or not. Nothing is written: the end of an enriched log is only read from elsewhere.
    ///
    /// # Errors
    /// The log cannot be read, or what it contains of its original is not a log.
    pub fn of(log: Log) -> Result<Self, ReadError> {
        let (message, tail) = match find(&log)? {
            Ok(found) => found,
            Err(lost) => {
                return Ok(Self {
                    log,
                    undone: Err(lost),
                });
            }
        };
        let undone = Ok(provenance::earlier_run(&log)?);
        let start = message.data_end;
        let log = Log::read(
            log.file
                .with_tail(start, Box::new(tail), message.tail_length),
        )?;
        // Its data section is read from the file itself, so the tail must not contain a part of that.
        if log.data_end != start {
            return Err(log.file.damaged(start, Damage::MisplacedEnd));
        }
        Ok(Self { log, undone })
    }

    /// Checks that the log has none of the topics that are to be added, neither from an earlier run that cannot be
    /// undone nor from another program.
    ///
    /// # Errors
    /// It has one; the error says from where.
    pub fn check_topics_are_free(&self) -> Result<(), WriteError> {
        let lost = self.undone.as_ref().err().copied();
        provenance::check_topics_are_free(&self.log, lost.unwrap_or(Lost::Rewritten))
    }
}

/// The content of the attachment: what the log has after its data section, and what identifies the data section.
pub(super) fn encode(log: &Log) -> Result<Vec<u8>, ReadError> {
    let data_end = log.data_end;
    let prefix = Fingerprint::of(log.file.own_bytes(), data_end)
        .map_err(|source| ReadError::io("cannot read", log.file.path(), source))?;
    let (tail_zstd, tail_sha256) = compress(log, data_end)?;
    let message = OriginalTail {
        data_end,
        tail_length: log.file.length() - data_end,
        data_section_crc: log.data_crc,
        head_sha256: prefix.head_sha256.to_vec(),
        foot_sha256: prefix.foot_sha256.to_vec(),
        tail_sha256,
        tail_zstd,
    };
    Ok(message.encode_to_vec())
}

/// The log from `start` on as a zstd frame, and the hash of its uncompressed bytes. Piece by piece, because a recorder
/// that crashed can leave gigabytes of zeros.
fn compress(log: &Log, start: u64) -> Result<(Vec<u8>, Vec<u8>), ReadError> {
    let failed = |source| ReadError::io("cannot compress the end of", log.file.path(), source);
    let mut sha256 = Sha256::new();
    let mut zstd =
        zstd::Encoder::new(Vec::new(), zstd::DEFAULT_COMPRESSION_LEVEL).map_err(failed)?;
    let mut piece = Vec::new();
    let mut position = start;
    while position < log.file.length() {
        let length = PIECE.min(log.file.length() - position);
        log.file.read_into(&mut piece, position, length)?;
        sha256.update(&piece);
        zstd.write_all(&piece).map_err(failed)?;
        position += length;
    }
    Ok((zstd.finish().map_err(failed)?, sha256.finalize().to_vec()))
}

/// What a log contains of its original, with the uncompressed tail, or why there is nothing that can be trusted.
fn find(log: &Log) -> Result<Result<(OriginalTail, File), Lost>, ReadError> {
    let attachments = &log.contents.attachments;
    let mut indexes = attachments.iter().map(|index| &index.record);
    let Some(index) = indexes.rfind(|index| index.name == NAME) else {
        return Ok(Err(provenance::why_no_way_back(log)?));
    };
    let rewritten = Ok(Err(Lost::Rewritten));
    let Some(message) = decode(log, index)? else {
        return rewritten;
    };
    let prefix = Fingerprint {
        length: message.data_end,
        head_sha256: match message.head_sha256.as_slice().try_into() {
            Ok(hash) => hash,
            Err(_) => return rewritten,
        },
        foot_sha256: match message.foot_sha256.as_slice().try_into() {
            Ok(hash) => hash,
            Err(_) => return rewritten,
        },
    };
    let is_intact = prefix.length <= index.offset
        && index.offset.checked_add(index.length) == Some(log.data_end)
        && is_all_ours(log, prefix.length)
        && Fingerprint::of(log.file.own_bytes(), prefix.length)
            .map_err(|source| ReadError::io("cannot read", log.file.path(), source))?
            == prefix;
    if !is_intact {
        return rewritten;
    }
    let file = message.decompress().map_err(|source| {
        let action = "cannot uncompress the original's end into a temporary file";
        ReadError::io(action, log.file.path(), source)
    })?;
    Ok(file.map(|file| (message, file)).ok_or(Lost::Rewritten))
}

fn decode(log: &Log, index: &AttachmentIndex) -> Result<Option<OriginalTail>, ReadError> {
    let record = log.file.read(index.offset, index.length)?;
    let attachment = (Records::new(&record).next())
        .and_then(Result::ok)
        .filter(|record| record.opcode == op::ATTACHMENT)
        .and_then(|record| mcap::parse_record(op::ATTACHMENT, record.body).ok());
    Ok(match attachment {
        Some(Record::Attachment { data, .. }) => OriginalTail::decode(&*data).ok(),
        _ => None,
    })
}

/// Whether flightcam wrote everything from `start` on.
fn is_all_ours(log: &Log, start: u64) -> bool {
    let contents = &log.contents;
    let is_derived = |id: &u16| {
        let channel = contents.definitions.channels.get(id);
        channel.is_some_and(|channel| {
            Quantity::ALL
                .iter()
                .any(|quantity| quantity.topic() == channel.record.topic)
        })
    };
    let segments = (contents.segments.iter()).filter(|segment| segment.offset >= start);
    let attachments = (contents.attachments.iter()).filter(|index| index.record.offset >= start);
    let metadata = (contents.metadata.iter()).filter(|index| index.record.offset >= start);
    segments
        .flat_map(|segment| segment.message_counts.keys())
        .all(is_derived)
        && attachments.map(|index| &index.record.name).eq([NAME])
        && metadata
            .map(|index| &index.record.name)
            .eq([provenance::NAME])
}

impl OriginalTail {
    /// The tail in a temporary file; `None` if it is not the one that was compressed.
    fn decompress(&self) -> io::Result<Option<File>> {
        let mut file = tempfile::tempfile()?;
        let mut sha256 = Sha256::new();
        // Reading one byte more than there should be detects a longer tail.
        let mut zstd =
            zstd::Decoder::new(self.tail_zstd.as_slice())?.take(self.tail_length.saturating_add(1));
        let mut piece = vec![0; PIECE as usize];
        let mut length = 0;
        loop {
            // A damaged frame is not an error of the disk.
            let read = match zstd.read(&mut piece) {
                Ok(0) => break,
                Ok(read) => read,
                Err(_) => return Ok(None),
            };
            sha256.update(&piece[..read]);
            file.write_all(&piece[..read])?;
            length += read as u64;
        }
        file.rewind()?;
        let is_right = length == self.tail_length
            && sha256.finalize().as_slice() == self.tail_sha256.as_slice();
        Ok(is_right.then_some(file))
    }
}
