//! A log's bytes, read by position.

use std::{
    fs::File,
    path::{Path, PathBuf},
};

use crate::error::Error;

/// An open log file. Reading is by position, so that several readers can share it.
#[derive(Debug)]
pub struct LogFile {
    path: PathBuf,
    file: File,
    len: u64,
}

impl LogFile {
    /// # Errors
    /// The file does not exist, is not a regular file, or cannot be opened.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let io = |source| Error::io("cannot open the log", path, source);
        // Asked before opening, because opening a pipe waits for somebody to write to it.
        let metadata = std::fs::metadata(path).map_err(io)?;
        if !metadata.is_file() {
            return Err(Error::NotAFile { path: path.into() });
        }
        let file = File::open(path).map_err(io)?;
        let metadata = file.metadata().map_err(io)?;
        Ok(Self {
            path: path.into(),
            file,
            len: metadata.len(),
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The handle itself, for copying from.
    pub fn handle(&self) -> &File {
        &self.file
    }

    /// Length in bytes when the file was opened.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Reads the `length` bytes at `offset` into `buffer`, replacing what it held.
    ///
    /// # Errors
    /// The range does not lie within the file, or reading fails.
    pub fn read_into(&self, buffer: &mut Vec<u8>, offset: u64, length: u64) -> Result<(), Error> {
        if offset.checked_add(length).is_none_or(|end| end > self.len) {
            return Err(self.corrupt(
                offset,
                format!(
                    "something {length} bytes long is said to be there, but the file is shorter"
                ),
            ));
        }
        let length = usize::try_from(length)
            .map_err(|_| self.corrupt(offset, format!("{length} bytes do not fit in memory")))?;
        buffer.clear();
        buffer
            .try_reserve_exact(length)
            .map_err(|_| self.corrupt(offset, format!("{length} bytes do not fit in memory")))?;
        buffer.resize(length, 0);
        read_exact_at(&self.file, buffer, offset)
            .map_err(|source| Error::io("cannot read", &self.path, source))
    }

    /// As [`read_into`](Self::read_into), into a buffer of its own.
    pub fn read(&self, offset: u64, length: u64) -> Result<Vec<u8>, Error> {
        let mut buffer = Vec::new();
        self.read_into(&mut buffer, offset, length)?;
        Ok(buffer)
    }

    /// The error for a place at which the file is not what the format says.
    pub fn corrupt(&self, offset: u64, what: impl Into<String>) -> Error {
        Error::Corrupt {
            path: self.path.clone(),
            offset,
            what: what.into(),
        }
    }
}

#[cfg(unix)]
fn read_exact_at(file: &File, buffer: &mut [u8], offset: u64) -> std::io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, buffer, offset)
}

#[cfg(windows)]
fn read_exact_at(file: &File, mut buffer: &mut [u8], mut offset: u64) -> std::io::Result<()> {
    while !buffer.is_empty() {
        let read = std::os::windows::fs::FileExt::seek_read(file, buffer, offset)?;
        if read == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        buffer = &mut buffer[read..];
        offset += read as u64;
    }
    Ok(())
}
