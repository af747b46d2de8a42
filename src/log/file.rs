//! A log's bytes, read by position.

use std::{
    fs::File,
    path::{Path, PathBuf},
};

use super::{
    error::{Damage, JournalError, ReadError},
    journal::{self, Journal, Step},
    locked::{Access, LockedFile, read_exact_at},
};

/// An open log file. Reading is by position, so that several readers can share it.
///
/// As long as it is open nobody changes it in place: it holds a shared lock, or the exclusive one of whoever
/// is about to change it.
#[derive(Debug)]
pub struct LogFile {
    path: PathBuf,
    file: LockedFile,
    /// What stands in place of the file's own bytes from some position on.
    tail: Option<Tail>,
    len: u64,
    /// Whether a change that was cut short was undone first.
    recovered: bool,
}

#[derive(Debug)]
struct Tail {
    start: u64,
    file: File,
}

impl LogFile {
    /// Opens and locks a file. If a change of it was cut short, that is undone first.
    ///
    /// # Errors
    /// The file does not exist, is not a regular file, cannot be opened, or is locked by another run.
    pub fn open(path: &Path, access: Access) -> Result<Self, ReadError> {
        let io = |source| ReadError::io("cannot open the log", path, source);
        // Asked before opening, because opening a pipe waits for somebody to write to it.
        let metadata = std::fs::metadata(path).map_err(io)?;
        if !metadata.is_file() {
            return Err(ReadError::NotAFile { path: path.into() });
        }
        let mut recovered = false;
        let mut file = LockedFile::open(path, access)?;
        // Asked when the lock is held, so that a journal is not one of a change that is under way.
        while access == Access::Read && journal::exists(path) {
            drop(file);
            recovered |= recover(path)?;
            file = LockedFile::open(path, access)?;
        }
        if access == Access::Change {
            recovered = journal::recover(&file, path)?;
        }
        Ok(Self {
            recovered,
            ..Self::of(path, file)?
        })
    }

    /// A file that nobody else has, so that it needs no lock, and what errors call it.
    ///
    /// # Errors
    /// It cannot be said how long it is.
    pub fn from_file(path: &Path, file: File) -> Result<Self, ReadError> {
        Self::of(path, file.into())
    }

    fn of(path: &Path, file: LockedFile) -> Result<Self, ReadError> {
        let metadata = file.metadata();
        let metadata =
            metadata.map_err(|source| ReadError::io("cannot open the log", path, source))?;
        Ok(Self {
            path: path.into(),
            len: metadata.len(),
            file,
            tail: None,
            recovered: false,
        })
    }

    /// The same file with the bytes from `start` on replaced by those of `tail`, which is `length` bytes long.
    /// Nothing is written.
    pub fn with_tail(self, start: u64, tail: File, length: u64) -> Self {
        Self {
            len: start + length,
            tail: Some(Tail { start, file: tail }),
            ..self
        }
    }

    /// Saves what the file has from `start` on, after which that may be overwritten. The file must have been
    /// opened to be changed.
    ///
    /// # Errors
    /// The journal cannot be written; nothing is left of it then.
    pub fn change_from(
        &self,
        start: u64,
        reached: &mut dyn FnMut(Step),
    ) -> Result<Journal<'_>, JournalError> {
        Journal::begin(&self.file, &self.path, start, reached)
    }

    /// What the file is called.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The handle itself, for copying from and, with [`Access::Change`], writing to.
    pub fn handle(&self) -> &File {
        &self.file
    }

    /// Length in bytes when the file was opened.
    pub fn length(&self) -> u64 {
        self.len
    }

    /// Whether an earlier change of the file had been cut short, and was undone when it was opened.
    pub fn was_recovered(&self) -> bool {
        self.recovered
    }

    /// Reads the `length` bytes at `offset` into `buffer`, replacing what it held.
    ///
    /// # Errors
    /// The range does not lie within the file, or reading fails.
    pub fn read_into(
        &self,
        buffer: &mut Vec<u8>,
        offset: u64,
        length: u64,
    ) -> Result<(), ReadError> {
        self.read_behind(buffer, 0, offset, length)
    }

    /// Reads the `length` bytes at `offset` into `buffer` behind its first `kept` bytes, replacing the others.
    ///
    /// # Errors
    /// The range does not lie within the file, or reading fails.
    pub fn read_behind(
        &self,
        buffer: &mut Vec<u8>,
        kept: usize,
        offset: u64,
        length: u64,
    ) -> Result<(), ReadError> {
        if offset.checked_add(length).is_none_or(|end| end > self.len) {
            return Err(self.damaged(offset, Damage::BeyondEnd { length }));
        }
        let too_long = || self.damaged(offset, Damage::OutOfMemory { length });
        let end = usize::try_from(length).ok();
        let end = end.and_then(|length| kept.checked_add(length));
        let end = end.ok_or_else(too_long)?;
        let more = end.saturating_sub(buffer.len());
        buffer.try_reserve_exact(more).map_err(|_| too_long())?;
        // Bytes that are about to be replaced need not be zeroed first.
        buffer.resize(end, 0);
        let (buffer, start) = (&mut buffer[kept..], offset);
        let read = match &self.tail {
            None => read_exact_at(&self.file, buffer, start),
            Some(tail) => {
                let before = tail.start.saturating_sub(start).min(length);
                let (head, rest) = buffer.split_at_mut(before as usize);
                read_exact_at(&self.file, head, start).and_then(|()| match rest {
                    [] => Ok(()),
                    rest => read_exact_at(&tail.file, rest, start + before - tail.start),
                })
            }
        };
        read.map_err(|source| ReadError::io("cannot read", &self.path, source))
    }

    /// As [`read_into`](Self::read_into), into a buffer of its own.
    ///
    /// # Errors
    /// Those of [`read_into`](Self::read_into).
    pub fn read(&self, offset: u64, length: u64) -> Result<Vec<u8>, ReadError> {
        let mut buffer = Vec::new();
        self.read_into(&mut buffer, offset, length)?;
        Ok(buffer)
    }

    /// The error for a place at which the file is not what the format says.
    pub fn damaged(&self, offset: u64, damage: impl Into<Damage>) -> ReadError {
        ReadError::damaged(&self.path, offset, damage)
    }
}

/// Undoes a change that was cut short, if nobody else is doing so. Whether there was one.
fn recover(path: &Path) -> Result<bool, ReadError> {
    let file = LockedFile::open(path, Access::Change).map_err(|error| match error {
        ReadError::Io { source, .. } => journal::not_recovered(path, source).into(),
        other => other,
    })?;
    Ok(journal::recover(&file, path)?)
}
