//! The part of the output behind the copied data section, as a stream that the official writer can write to.

use std::{
    io::{self, Seek, SeekFrom, Write},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

/// A stream that continues a file at a given position.
///
/// The official MCAP writer believes that it writes a file of its own. What would start that file (magic
/// bytes and header) is swallowed, and so is what would end it, once [`Seal::close`] was called: the writer
/// tells its chunk indexes only when it also writes a DataEnd, a summary and a footer.
pub struct Region<W> {
    out: W,
    position: u64,
    /// Of the data section so far, where the log has a checksum to go on with.
    crc: Option<crc32fast::Hasher>,
    /// What the official writer is still expected to start with.
    preamble: Vec<u8>,
    seal: Seal,
}

/// Closes a region while the official writer owns it.
#[derive(Debug, Clone, Default)]
pub struct Seal(Arc<AtomicBool>);

impl Seal {
    /// From now on everything that is written to the region is swallowed.
    pub fn close(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_closed(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl<W: Write> Region<W> {
    /// Continues `out` at `position`, and the checksum of what lies before.
    pub fn new(out: W, position: u64, crc: Option<u32>) -> Self {
        Self {
            out,
            position,
            crc: crc.map(crc32fast::Hasher::new_with_initial),
            preamble: Vec::new(),
            seal: Seal::default(),
        }
    }

    /// The region that swallows these bytes before all others, and the means to close it.
    pub fn sealable(mut self, preamble: Vec<u8>) -> (Self, Seal) {
        self.preamble = preamble;
        let seal = self.seal.clone();
        (self, seal)
    }

    /// Where the next byte goes.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// The checksum so far and the stream itself.
    pub fn into_parts(self) -> (Option<u32>, W) {
        (self.crc.map(crc32fast::Hasher::finalize), self.out)
    }
}

impl<W: Write> Write for Region<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.seal.is_closed() {
            return Ok(bytes.len());
        }
        let (swallowed, kept) = bytes.split_at(self.preamble.len().min(bytes.len()));
        if !self.preamble.starts_with(swallowed) {
            return Err(io::Error::other(
                "the MCAP writer does not start as expected",
            ));
        }
        self.preamble.drain(..swallowed.len());
        self.out.write_all(kept)?;
        if let Some(crc) = &mut self.crc {
            crc.update(kept);
        }
        self.position += kept.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Only tells the position; a region is written from front to back.
impl<W: Write> Seek for Region<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) => Ok(self.position),
            _ => Err(io::Error::from(io::ErrorKind::Unsupported)),
        }
    }
}
