//! What can go wrong when a log is opened and read.

use std::{
    io,
    path::{Path, PathBuf},
};

use mcap::records::op;

use super::{foreign::ForeignFormat, record::MAX_RECORD};
use crate::text::{self, Foreign};

/// Why a log cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum ReadError {
    #[error("{}: {action}: {source}", text::path(path))]
    Io {
        action: &'static str,
        path: PathBuf,
        source: io::Error,
    },

    #[error("{}: not a regular file", text::path(path))]
    NotAFile { path: PathBuf },

    #[error("{}: the file is empty", text::path(path))]
    Empty { path: PathBuf },

    #[error("{}: not an MCAP file: {}", text::path(path), describe(*format))]
    NotMcap {
        path: PathBuf,
        /// What it seems to be instead, if that is known.
        format: Option<ForeignFormat>,
    },

    #[error(
        "{}: another program made it shorter while it was read: from {before} bytes to {after}",
        text::path(path)
    )]
    BecameShorter {
        path: PathBuf,
        before: u64,
        after: u64,
    },

    #[error(
        "{}: another program changed it while it was read, so what was read may not belong together",
        text::path(path)
    )]
    Changed { path: PathBuf },

    #[error("{}: damaged at byte {offset}: {damage}", text::path(path))]
    Damaged {
        path: PathBuf,
        offset: u64,
        damage: Damage,
    },

    #[error("{}: another run of flightcam is using it", text::path(path))]
    Locked { path: PathBuf },

    #[error(
        "{}: cannot be changed in place, because it cannot be locked against other runs ({source})",
        text::path(path)
    )]
    NoLocks { path: PathBuf, source: io::Error },
}

/// How a log violates the format, at the offset in [`ReadError::Damaged`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum Damage {
    #[error("there should be the header, the log's first record")]
    NoHeader,
    #[error("what is there is not a record")]
    NotARecord,
    #[error("the {0} there cannot be read")]
    Malformed(RecordKind),
    #[error("what starts there holds a record that breaks off")]
    Torn,
    #[error("what starts there is not a run of messages")]
    NotMessages,
    #[error("the chunk there is unreadable: {0}")]
    Chunk(#[from] ChunkFault),
    #[error(
        "the chunk there has a message at {message}, but its index says that it starts at {index}"
    )]
    EarlierThanIndexed {
        /// The message's log time.
        message: u64,
        /// The earliest log time according to the index.
        index: u64,
    },
    #[error("something {length} bytes long is said to be there, but the file is shorter")]
    BeyondEnd { length: u64 },
    #[error("{length} bytes do not fit in memory")]
    OutOfMemory { length: u64 },
    #[error("the record there is {length} bytes long; at most {} MiB is read", MAX_RECORD >> 20)]
    TooLong { length: u64 },
    #[error(
        "with the record there, what would have to be kept of the log in memory is more than {} MiB",
        MAX_RECORD >> 20
    )]
    TooMuch,
    #[error("the {kind} in the chunk there, at byte {position} of its content, cannot be read")]
    MalformedInChunk { kind: RecordKind, position: u64 },
    #[error(
        "there is a {kind} in the chunk there, at byte {position} of its content, and no chunk holds such a record"
    )]
    MisplacedInChunk { kind: RecordKind, position: u64 },
    #[error("the chunk there has a message of channel {channel_id}, which its index leaves out")]
    NotInIndex { channel_id: u16 },
    #[error("the {0} there ends the log's data, but the log goes on after it")]
    EarlyEnd(RecordKind),
    #[error("what is said to be the original's end begins elsewhere")]
    MisplacedEnd,
}

/// A kind of record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum RecordKind {
    #[error("schema or channel")]
    Definition,
    #[error("message")]
    Message,
    #[error("message index")]
    MessageIndex,
    #[error("attachment")]
    Attachment,
    #[error("metadata record")]
    Metadata,
    #[error("header")]
    Header,
    #[error("footer")]
    Footer,
    #[error("chunk")]
    Chunk,
    #[error("chunk index")]
    ChunkIndex,
    #[error("attachment index")]
    AttachmentIndex,
    #[error("statistics record")]
    Statistics,
    #[error("metadata index")]
    MetadataIndex,
    #[error("summary offset")]
    SummaryOffset,
    #[error("DataEnd record")]
    DataEnd,
}

impl RecordKind {
    /// The kind of record that an opcode stands for; `None` if the format does not define it.
    pub(super) fn of(opcode: u8) -> Option<Self> {
        Some(match opcode {
            op::HEADER => Self::Header,
            op::FOOTER => Self::Footer,
            op::SCHEMA | op::CHANNEL => Self::Definition,
            op::MESSAGE => Self::Message,
            op::CHUNK => Self::Chunk,
            op::MESSAGE_INDEX => Self::MessageIndex,
            op::CHUNK_INDEX => Self::ChunkIndex,
            op::ATTACHMENT => Self::Attachment,
            op::ATTACHMENT_INDEX => Self::AttachmentIndex,
            op::STATISTICS => Self::Statistics,
            op::METADATA => Self::Metadata,
            op::METADATA_INDEX => Self::MetadataIndex,
            op::SUMMARY_OFFSET => Self::SummaryOffset,
            op::DATA_END => Self::DataEnd,
            _ => return None,
        })
    }
}

/// Why a chunk has no readable content.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum ChunkFault {
    #[error("it is not a whole chunk record")]
    Malformed,
    #[error("its compression `{0}` is not supported (zstd, lz4 and none are)")]
    UnknownCompression(Foreign),
    #[error("its content cannot be decompressed: {0}")]
    Decompression(#[from] io::Error),
    #[error("its content is {found} bytes long and should be {expected}")]
    Length { expected: u64, found: usize },
    #[error(
        "its content does not have the checksum that was recorded ({expected:08x}, not {found:08x})"
    )]
    Checksum { expected: u32, found: u32 },
    #[error("it is said to hold {size} bytes; at most {} MiB is read", MAX_RECORD >> 20)]
    TooLarge { size: u64 },
    #[error("it is said to hold {size} bytes, which cannot come from {compressed} compressed ones")]
    Impossible { size: u64, compressed: usize },
    #[error("the {size} bytes that it is said to hold do not fit in memory")]
    OutOfMemory { size: u64 },
}

fn describe(format: Option<ForeignFormat>) -> String {
    match format {
        Some(format) => format!("it is {format}"),
        None => "it does not begin with the magic bytes of one".to_owned(),
    }
}

impl ReadError {
    /// Whether the log goes on after the record that ends its data.
    pub(crate) fn is_early_end(&self) -> bool {
        let damage = match self {
            Self::Damaged { damage, .. } => Some(damage),
            _ => None,
        };
        matches!(damage, Some(Damage::EarlyEnd(_)))
    }

    pub(crate) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io {
            action,
            path: path.into(),
            source,
        }
    }

    pub(crate) fn damaged(path: &Path, offset: u64, damage: impl Into<Damage>) -> Self {
        Self::Damaged {
            path: path.into(),
            offset,
            damage: damage.into(),
        }
    }
}
