//! The content of a chunk.

use std::io::Read;

use mcap::records::{ChunkHeader, op};

use super::{
    error::{ChunkFault, Damage, ReadError},
    file::LogFile,
    record::{FRAME_LENGTH, MAX_RECORD, RawRecord, Records, split},
};

/// A byte compressed with zstd becomes at most 32 KiB: 4 bytes are a block of up to 128 KiB.
const ZSTD_RATIO: u64 = 32 * 1024;

/// A byte compressed with lz4 becomes at most 255, because it says by how much a repetition is longer.
const LZ4_RATIO: u64 = 255;

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
        check_length(length).map_err(|damage| file.damaged(offset, damage))?;
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

/// Refuses a record, with its frame, that is too long before it is read.
pub fn check_length(length: u64) -> Result<(), Damage> {
    match length.saturating_sub(FRAME_LENGTH as u64) {
        0..=MAX_RECORD => Ok(()),
        length => Err(Damage::TooLong { length }),
    }
}

/// Splits the body of a chunk's record into its header and its compressed content.
fn split_chunk(body: &[u8]) -> Option<(ChunkHeader, &[u8])> {
    let (header, rest): (ChunkHeader, _) = split(body).ok()?;
    let compressed = rest.get(..usize::try_from(header.compressed_size).ok()?)?;
    Some((header, compressed))
}

impl ChunkDecoder {
    /// Reads the header of a chunk from the body of its record, and the records that it contains, checked against its
    /// length and, if it has one, its checksum.
    pub fn records<'a>(
        &'a mut self,
        body: &'a [u8],
    ) -> Result<(ChunkHeader, Records<'a>), ChunkFault> {
        let (header, compressed) = split_chunk(body).ok_or(ChunkFault::Malformed)?;
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
                self.reserve(header.uncompressed_size, compressed, ZSTD_RATIO)?;
                let zstd = match &mut self.zstd {
                    Some(zstd) => zstd,
                    empty => empty.insert(zstd::bulk::Decompressor::new()?),
                };
                zstd.decompress_to_buffer(compressed, &mut self.content)?;
                &self.content
            }
            "lz4" => {
                self.reserve(header.uncompressed_size, compressed, LZ4_RATIO)?;
                // Reading one byte more than there should be detects longer content.
                lz4::Decoder::new(compressed)?
                    .take(header.uncompressed_size.saturating_add(1))
                    .read_to_end(&mut self.content)?;
                &self.content
            }
            // The name may be as long as the chunk.
            other => {
                let name: String = other.chars().take(64).collect();
                return Err(ChunkFault::UnknownCompression(name.into()));
            }
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

    /// Makes room for the content, unless so few bytes cannot become that many.
    fn reserve(&mut self, size: u64, compressed: &[u8], ratio: u64) -> Result<(), ChunkFault> {
        self.content.clear();
        if size > MAX_RECORD {
            return Err(ChunkFault::TooLarge { size });
        }
        let compressed = compressed.len();
        if size > ratio * compressed as u64 {
            return Err(ChunkFault::Impossible { size, compressed });
        }
        // One more, which is read to see whether the content ends.
        let reserved = self.content.try_reserve_exact(size as usize + 1);
        reserved.map_err(|_| ChunkFault::OutOfMemory { size })
    }
}
