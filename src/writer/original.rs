//! The original of an enriched log: how it is kept in the result, and recovered from it.
//!
//! The result starts with the original's bytes up to the end of its data section. The rest of the original is in an
//! attachment of the result, the last record of its data section.

mod added;
mod ending;

use std::{
    fs::File,
    io::{self, Read, Write},
};

use mcap::records::{AttachmentIndex, op};
use prost::Message;
use sha2::{Digest, Sha256};

use super::{
    error::WriteError,
    provenance::{self, EarlierRun},
};
use crate::{
    fs::to_temporary_file,
    log::{
        Damage, Log, ReadError,
        fingerprint::Fingerprint,
        record::{AttachmentStart, Records, split},
    },
    messages::{Topic, v1::OriginalTail},
};
use added::Added;
use ending::Ending;

/// The attachment's name.
pub const NAME: &str = "flightcam/original_tail";

/// Its content is a `flightcam.v1.OriginalTail`.
pub(super) const MEDIA_TYPE: &str = "application/x-protobuf";

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
    /// Finds the original of a log, enriched or not. Nothing is written: the end of an enriched log is only read from
    /// elsewhere.
    ///
    /// # Errors
    /// The log cannot be read, or what it contains of its original is not a log.
    pub fn of(log: Log) -> Result<Self, ReadError> {
        let Found {
            start,
            length,
            tail,
            added,
            ending,
        } = match find(&log)? {
            Ok(found) => found,
            Err(lost) => {
                return Ok(Self {
                    log,
                    undone: Err(lost),
                });
            }
        };
        let undone = provenance::earlier_run(&log)?;
        let original = Log::read(log.file.with_tail(start, Box::new(tail), length))?;
        // Its data section is read from the file itself, so the tail must not contain a part of that.
        if original.data_end != start {
            return Err(original.file.damaged(start, Damage::MisplacedEnd));
        }
        if added.is_of(&original.contents) && ending.is_ours(&original)? {
            return Ok(Self {
                log: original,
                undone: Ok(undone),
            });
        }
        let file = original.file.without_tail();
        Ok(Self {
            log: Log { file, ..log },
            undone: Err(Lost::Rewritten),
        })
    }

    /// Checks that the log has none of the topics that are to be added, neither from an earlier run that cannot be
    /// undone nor from another program, and no attachment that claims to be its end but is not.
    ///
    /// # Errors
    /// It has one; the error says from where.
    pub fn check_are_free(&self, topics: Vec<Topic>) -> Result<(), WriteError> {
        let lost = self.undone.as_ref().err().copied();
        provenance::check_are_free(&self.log, topics, lost.unwrap_or(Lost::Rewritten))?;
        match lost {
            Some(reason @ Lost::Rewritten) if last_tail(&self.log).is_some() => {
                Err(WriteError::UntrustedOriginal {
                    path: self.log.file.path().into(),
                    earlier: Box::new(provenance::earlier_run(&self.log)?),
                    reason,
                })
            }
            _ => Ok(()),
        }
    }
}

/// The attachment with the original's end.
fn last_tail(log: &Log) -> Option<&AttachmentIndex> {
    let attachments = log.contents.attachments.iter();
    let mut indexes = attachments.map(|index| &index.record);
    indexes.rfind(|index| index.name == NAME)
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
    log.file.for_each_piece(start, log.file.length(), |piece| {
        sha256.update(piece);
        zstd.write_all(piece).map_err(failed)
    })?;
    Ok((zstd.finish().map_err(failed)?, sha256.finalize().to_vec()))
}

/// What a log contains of its original, and what was added to that.
struct Found {
    /// Where the original's data section ends.
    start: u64,
    /// What the original has from there on, uncompressed, and the length of that.
    tail: File,
    length: u64,
    added: Added,
    ending: Ending,
}

/// What a log contains of its original, or why there is nothing that can be trusted.
fn find(log: &Log) -> Result<Result<Found, Lost>, ReadError> {
    let Some(index) = last_tail(log) else {
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
        && Fingerprint::of(log.file.own_bytes(), prefix.length)
            .map_err(|source| ReadError::io("cannot read", log.file.path(), source))?
            == prefix;
    if !is_intact {
        return rewritten;
    }
    let Some(added) = Added::read(&log.file, prefix.length, index.offset)? else {
        return rewritten;
    };
    let Some(ending) = Ending::read(&log.file, prefix.length, log.data_end)? else {
        return rewritten;
    };
    let tail = message.decompress().map_err(|source| {
        let action = "cannot uncompress the original's end into a temporary file";
        ReadError::io(action, log.file.path(), source)
    })?;
    let found = tail.map(|tail| Found {
        start: prefix.length,
        tail,
        length: message.tail_length,
        added,
        ending,
    });
    Ok(found.ok_or(Lost::Rewritten))
}

fn decode(log: &Log, index: &AttachmentIndex) -> Result<Option<OriginalTail>, ReadError> {
    let record = log.file.read(index.offset, index.length)?;
    let attachment = (Records::new(&record).next())
        .and_then(Result::ok)
        .filter(|record| record.opcode == op::ATTACHMENT);
    let Some(content) = attachment.and_then(|record| content(record.body)) else {
        return Ok(None);
    };
    // Decoding copies it, and cannot fail for want of memory.
    let mut room: Vec<u8> = Vec::new();
    let length = content.len() as u64;
    room.try_reserve_exact(content.len()).map_err(|_| {
        log.file
            .damaged(index.offset, Damage::OutOfMemory { length })
    })?;
    drop(room);
    Ok(OriginalTail::decode(content).ok())
}

/// The content of an attachment, given the body of its record; `None` if that breaks off, goes on after it, or does not
/// have its checksum.
fn content(body: &[u8]) -> Option<&[u8]> {
    let (start, rest): (AttachmentStart, _) = split(body).ok()?;
    let (content, crc) = rest.split_last_chunk()?;
    let crc = u32::from_le_bytes(*crc);
    let checked = &body[..body.len() - size_of::<u32>()];
    let is_intact =
        start.data_size == content.len() as u64 && (crc == 0 || crc == crc32fast::hash(checked));
    is_intact.then_some(content)
}

impl OriginalTail {
    /// The tail in a temporary file; `None` if it is not the one that was compressed.
    fn decompress(&self) -> io::Result<Option<File>> {
        let mut sha256 = Sha256::new();
        // Reading one byte more than there should be detects a longer tail.
        let zstd =
            zstd::Decoder::new(self.tail_zstd.as_slice())?.take(self.tail_length.saturating_add(1));
        let tail = to_temporary_file(zstd, |piece| sha256.update(piece))?;
        let (length, hash) = (self.tail_length, sha256.finalize());
        Ok(tail
            .filter(|(_, found)| *found == length && hash.as_slice() == self.tail_sha256.as_slice())
            .map(|(file, _)| file))
    }
}
