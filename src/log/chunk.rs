//! The content of a chunk.

use std::io::Read;

use mcap::records::ChunkHeader;

/// Decompresses chunks, reusing its buffer from one to the next.
#[derive(Default)]
pub struct ChunkDecoder {
    zstd: Option<zstd::bulk::Decompressor<'static>>,
    content: Vec<u8>,
}

/// Why a chunk has no readable content.
#[derive(Debug, thiserror::Error)]
pub enum ChunkFault {
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
    #[error("it is said to hold {0} bytes, which do not fit in memory")]
    TooLarge(u64),
}

impl ChunkDecoder {
    /// The records of a chunk, checked against its length and, where it has one, its checksum.
    pub fn decode<'a>(
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
            .and_then(|size| self.content.try_reserve_exact(size).ok())
            .ok_or(ChunkFault::TooLarge(size))
    }
}
