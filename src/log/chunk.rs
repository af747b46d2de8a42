//! The content of a chunk.

use std::{borrow::Cow, io::Read};

use mcap::records::{ChunkHeader, Record, op};

use super::{
    file::LogFile,
    record::{RawRecord, Records},
};
use crate::error::Error;

/// More than any recorder puts into a chunk. A chunk that claims more is refused before it fills the memory.
const MAX_CONTENT: u64 = 1 << 30;

/// Reads chunks, reusing its buffers from one to the next.
#[derive(Default)]
pub struct ChunkReader {
    raw: Vec<u8>,
    decoder: Decoder,
}

#[derive(Default)]
struct Decoder {
    zstd: Option<zstd::bulk::Decompressor<'static>>,
    content: Vec<u8>,
}

/// Why a chunk has no readable content.
#[derive(Debug, thiserror::Error)]
enum ChunkFault {
    #[error("it is no whole chunk record")]
    Malformed,
    #[error("its compression `{0}` is not supported (zstd, lz4 and none are)")]
    UnknownCompression(String),
    #[error("its content cannot be decompressed: {0}")]
    Decompression(#[from] std::io::Error),
    #[error("its content is {found} bytes long and should be {expected}")]
    Length { expected: u64, found: usize },
    #[error(
        "its content does not have the checksum that was recorded ({expected:08x}, not {found:08x})"
    )]
    Checksum { expected: u32, found: u32 },
    #[error("it is said to hold {0} bytes; at most 1 GiB is read")]
    TooLarge(u64),
}

impl ChunkReader {
    /// The header of the chunk whose record lies at `offset`, and the records that it holds, checked against
    /// its length and, where it has one, its checksum.
    ///
    /// # Errors
    /// There is no such chunk, or its content is damaged.
    pub fn read(
        &mut self,
        file: &LogFile,
        offset: u64,
        length: u64,
    ) -> Result<(ChunkHeader, Records<'_>), Error> {
        let damaged = |fault: ChunkFault| {
            file.corrupt(offset, format!("the chunk there is unreadable: {fault}"))
        };
        file.read_into(&mut self.raw, offset, length)?;
        let (header, compressed) =
            split(&self.raw).ok_or_else(|| damaged(ChunkFault::Malformed))?;
        let content = self.decoder.decode(&header, compressed).map_err(damaged)?;
        Ok((header, Records::new(content)))
    }
}

/// The header of a chunk's record, and what is compressed in it.
fn split(record: &[u8]) -> Option<(ChunkHeader, &[u8])> {
    match Records::new(record).next()?.ok()? {
        RawRecord {
            opcode: op::CHUNK,
            body,
            ..
        } => match mcap::parse_record(op::CHUNK, body).ok()? {
            Record::Chunk {
                header,
                data: Cow::Borrowed(data),
            } => Some((header, data)),
            _ => None,
        },
        _ => None,
    }
}

impl Decoder {
    fn decode<'a>(
        &'a mut self,
        header: &ChunkHeader,
        compressed: &'a [u8],
    ) -> Result<&'a [u8], ChunkFault> {
        let content = match header.compression.as_str() {
            "" => compressed,
            "zstd" => {
                self.reserve(header.uncompressed_size)?;
                let zstd = match &mut self.zstd {
                    Some(zstd) => zstd,
                    empty => empty.insert(zstd::bulk::Decompressor::new()?),
                };
                zstd.decompress_to_buffer(compressed, &mut self.content)?;
                &self.content
            }
            "lz4" => {
                self.reserve(header.uncompressed_size)?;
                // One byte more than there should be tells a longer content from a right one.
                lz4::Decoder::new(compressed)?
                    .take(header.uncompressed_size.saturating_add(1))
                    .read_to_end(&mut self.content)?;
                &self.content
            }
            other => return Err(ChunkFault::UnknownCompression(other.to_owned())),
        };
        if content.len() as u64 != header.uncompressed_size {
            return Err(ChunkFault::Length {
                expected: header.uncompressed_size,
                found: content.len(),
            });
        }
        if header.uncompressed_crc != 0 {
            let found = crc32fast::hash(content);
            if found != header.uncompressed_crc {
                return Err(ChunkFault::Checksum {
                    expected: header.uncompressed_crc,
                    found,
                });
            }
        }
        Ok(content)
    }

    fn reserve(&mut self, size: u64) -> Result<(), ChunkFault> {
        self.content.clear();
        usize::try_from(size)
            .ok()
            .filter(|_| size <= MAX_CONTENT)
            .and_then(|size| self.content.try_reserve_exact(size).ok())
            .ok_or(ChunkFault::TooLarge(size))
    }
}
