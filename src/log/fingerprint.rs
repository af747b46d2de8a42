//! Recognising the start of a log without reading all of it.

use std::io;

use binrw::binrw;
use sha2::{Digest, Sha256};

use crate::fs::ReadAt;

/// How much is hashed at each end.
const HASHED: u64 = 64 * 1024;

/// Identifies the start of a file: by its length, and by hashes of its first and last 64 KiB, or of all of it if it is
/// shorter.
#[binrw]
#[brw(little)]
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fingerprint {
    /// Length in bytes.
    pub length: u64,
    /// SHA-256 of its first 64 KiB.
    pub head_sha256: [u8; 32],
    /// SHA-256 of its last 64 KiB.
    pub foot_sha256: [u8; 32],
}

impl Fingerprint {
    /// Identifies the first `length` bytes.
    ///
    /// # Errors
    /// There are fewer, or they cannot be read.
    pub fn of(bytes: &dyn ReadAt, length: u64) -> io::Result<Self> {
        let hashed = length.min(HASHED);
        let hash = |start: u64| {
            let mut part = vec![0; hashed as usize];
            bytes.read_exact_at(&mut part, start)?;
            io::Result::Ok(Sha256::digest(&part).into())
        };
        Ok(Self {
            length,
            head_sha256: hash(0)?,
            foot_sha256: hash(length - hashed)?,
        })
    }
}
