//! The end of the original log, kept in the result so that the original can be given back byte for byte.

use std::io::Write;

use prost::Message;
use sha2::{Digest, Sha256};

use crate::{error::Error, log::Log, messages::v1::OriginalTail};

/// The attachment's name.
pub const NAME: &str = "flightcam/original_tail";

/// Its content is a `flightcam.v1.OriginalTail`.
pub const MEDIA_TYPE: &str = "application/x-protobuf";

/// How much is hashed at either end of the original's data section to tell it from another.
const HASHED: u64 = 64 * 1024;

/// How much of the tail is in memory uncompressed.
const PIECE: u64 = 1024 * 1024;

/// What the log has behind its data section, and what identifies the data section, ready to be attached.
pub fn encode(log: &Log) -> Result<Vec<u8>, Error> {
    let data_end = log.data_end;
    let hash = |start: u64, length: u64| -> Result<Vec<u8>, Error> {
        Ok(Sha256::digest(log.file.read(start, length)?).to_vec())
    };
    let hashed = data_end.min(HASHED);
    let (tail_zstd, tail_sha256) = compress(log, data_end)?;
    let message = OriginalTail {
        data_end,
        tail_length: log.file.len() - data_end,
        data_section_crc: log.data_crc,
        head_sha256: hash(0, hashed)?,
        foot_sha256: hash(data_end - hashed, hashed)?,
        tail_sha256,
        tail_zstd,
    };
    Ok(message.encode_to_vec())
}

/// The log from `start` on as a zstd frame, and the hash of what was compressed. Piece by piece, because a
/// recorder that crashed can leave gigabytes of zeros.
fn compress(log: &Log, start: u64) -> Result<(Vec<u8>, Vec<u8>), Error> {
    let failed = |source| Error::io("cannot compress the end of", log.file.path(), source);
    let mut sha256 = Sha256::new();
    let mut zstd =
        zstd::Encoder::new(Vec::new(), zstd::DEFAULT_COMPRESSION_LEVEL).map_err(failed)?;
    let mut piece = Vec::new();
    let mut position = start;
    while position < log.file.len() {
        let length = PIECE.min(log.file.len() - position);
        log.file.read_into(&mut piece, position, length)?;
        sha256.update(&piece);
        zstd.write_all(&piece).map_err(failed)?;
        position += length;
    }
    Ok((zstd.finish().map_err(failed)?, sha256.finalize().to_vec()))
}
