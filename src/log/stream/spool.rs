//! Those bytes of a passed-on log that may be needed again.

use std::{
    fs::File,
    io::{self, Seek, SeekFrom, Write},
    path::Path,
};

use crate::log::{error::ReadError, file::LogFile};

/// How much is kept of each end of what was passed on.
const ENDS: usize = 64 * 1024;

/// Some of a log's bytes, at their offsets in a temporary file that has holes in place of the others.
pub struct Spool {
    file: File,
    /// The first bytes that were passed on.
    head: Vec<u8>,
    /// The last bytes that were passed on, and some before them.
    foot: Vec<u8>,
}

impl Spool {
    pub fn new() -> Result<Self, ReadError> {
        Ok(Self {
            file: tempfile::tempfile().map_err(temporary)?,
            head: Vec::new(),
            foot: Vec::new(),
        })
    }

    /// Keeps the bytes at `offset`.
    pub fn write(&mut self, offset: u64, bytes: &[u8]) -> Result<(), ReadError> {
        let sought = self.file.seek(SeekFrom::Start(offset));
        sought
            .and_then(|_| self.file.write_all(bytes))
            .map_err(temporary)
    }

    /// Discards everything that was written from an offset on.
    pub fn forget(&mut self, from: u64) -> Result<(), ReadError> {
        self.file.set_len(from).map_err(temporary)
    }

    /// Notes the next bytes that were passed on.
    pub fn pass(&mut self, bytes: &[u8]) {
        let room = ENDS - self.head.len();
        self.head.extend_from_slice(&bytes[..bytes.len().min(room)]);
        let last = &bytes[bytes.len().saturating_sub(ENDS)..];
        if last.len() == ENDS {
            self.foot.clear();
        }
        self.foot.extend_from_slice(last);
        // Not every time, because moving the rest to the front takes longer than passing on most records.
        if self.foot.len() > 2 * ENDS {
            self.foot.drain(..self.foot.len() - ENDS);
        }
    }

    /// What has been kept so far, for reading.
    pub fn open(&self, name: &Path) -> Result<LogFile, ReadError> {
        LogFile::from_file(name, self.file.try_clone().map_err(temporary)?)
    }

    /// The end of what has been kept.
    pub fn end(&self) -> Result<u64, ReadError> {
        Ok(self.file.metadata().map_err(temporary)?.len())
    }

    /// Everything that was kept of a log whose data section ends at `data_end`.
    pub fn finish(mut self, name: &Path, data_end: u64) -> Result<LogFile, ReadError> {
        let (head, foot) = (
            std::mem::take(&mut self.head),
            std::mem::take(&mut self.foot),
        );
        self.write(0, &head)?;
        self.write(data_end - foot.len() as u64, &foot)?;
        LogFile::from_file(name, self.file)
    }
}

/// The error for a temporary file that cannot be written.
pub fn temporary(source: io::Error) -> ReadError {
    ReadError::io(
        "cannot write a temporary file there",
        &std::env::temp_dir(),
        source,
    )
}
