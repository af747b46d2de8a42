//! The content of a chunk.

use std::{borrow::Cow, io::Read};

use mcap::records::{ChunkHeader, Record, op};

use super::{
    error::{ChunkFault, ReadError},
    file::LogFile,
    record::{RawRecord, Records},
};

/// More than any recorder puts into a chunk. A chunk that claims more is refused before it fills the memory.
const MAX_CONTENT: u64 = 1 << 30;

/// The most bytes of a chunk's record: content that does not compress becomes a little longer. No other record that is
/// needed as a whole is longer.
pub const MAX_RECORD: u64 = MAX_CONTENT + MAX_CONTENT / 64;

/// Reads chunks, reusing its buffers from one to the next.
#[derive(Default)]
pub struct ChunkReader {
    raw: Vec<u8>,
    decoder: ChunkDecoder,
}

/// Decompresses chunks that are in memory, reusing its buffers from one to the next.
#[derive(Default)]
pub struct ChunkDecoder {
    zstd: Option<zstd::bulk::Decompressor<'static>>,
    content: Vec<u8>,
}

impl ChunkReader {
    /// Reads the header of the chunk whose record is at `offset`, and the records that it contains, checked against its
    /// length and, if it has one, its checksum.
    ///
    /// # Errors
    /// There is no such chunk, or its content is damaged.
    pub fn read(
        &mut self,
        file: &LogFile,
        offset: u64,
        length: u64,
    ) -> Result<(ChunkHeader, Records<'_>), ReadError> {
        check_length(length).map_err(|fault| file.damaged(offset, fault))?;
        file.read_into(&mut self.raw, offset, length)?;
        let body = match Records::new(&self.raw).next() {
            Some(Ok(RawRecord {
                opcode: op::CHUNK,
                body,
                ..
            })) => Ok(body),
            _ => Err(ChunkFault::Malformed),
        };
        body.and_then(|body| self.decoder.records(body))
            .map_err(|fault| file.damaged(offset, fault))
    }
}

/// Refuses a record that is too long for a chunk before it is read.
pub fn check_length(length: u64) -> Result<(), ChunkFault> {
    match length {
        0..=MAX_RECORD => Ok(()),
        _ => Err(ChunkFault::TooLarge(length)),
    }
}

/// Splits the body of a chunk's record into its header and its compressed content.
fn split(body: &[u8]) -> Option<(ChunkHeader, &[u8])> {
    match mcap::parse_record(op::CHUNK, body).ok()? {
        Record::Chunk {
            header,
            data: Cow::Borrowed(data),
        } => Some((header, data)),
        _ => None,
    }
}

impl ChunkDecoder {
    /// Reads the header of a chunk from the body of its record, and the records that it contains, checked against its
    /// length and, if it has one, its checksum.
    pub fn records<'a>(
        &'a mut self,
        body: &'a [u8],
    ) -> Result<(ChunkHeader, Records<'a>), ChunkFault> {
        let (header, compressed) = split(body).ok_or(ChunkFault::Malformed)?;
        let content = self.decode(&header, compressed)?;
        Ok((header, Records::new(content)))
    }

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
                // Reading one byte more than there should be detects longer content.
                lz4::Decoder::new(compressed)?
                    .take(header.uncompressed_size.saturating_add(1))
                    .read_to_end(&mut self.content)?;
                &self.content
            }
            other => return Err(ChunkFault::UnknownCompression(other.into())),
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
