//! A log's bytes, read by position.

use std::{
    fs::{File, Permissions},
    io,
    ops::Range,
    path::{Path, PathBuf},
    time::SystemTime,
};

use super::error::{Damage, ReadError};
use crate::fs::{Access, LockedFile, OpenError, ReadAt, is_at};

/// How much is held in memory of bytes that are read piece by piece.
const PIECE: u64 = 1024 * 1024;

/// A log's bytes: those of a file, or of anything else that can be read by position. Several readers can share them.
///
/// While a file is open, no other run changes it in place: it is locked, exclusively if this run is about to change
/// it.
#[derive(Debug)]
pub struct LogFile {
    path: PathBuf,
    bytes: Bytes,
    /// How many there are.
    own_length: u64,
    /// What replaces the bytes from some position on; each replaces the end of what is before it.
    tails: Vec<Tail>,
    /// The state of the file when it was opened, if other programs may write to it.
    opened: Option<State>,
    /// Whether an interrupted change was undone first.
    recovered: bool,
}

/// What shows that a file was written to.
#[derive(Debug, Clone, Copy)]
struct State {
    length: u64,
    /// Not all file systems have it.
    modified: Option<SystemTime>,
}

impl State {
    fn of(file: &File) -> io::Result<Self> {
        let metadata = file.metadata()?;
        Ok(Self {
            length: metadata.len(),
            modified: metadata.modified().ok(),
        })
    }

    /// Whether this is the state of a file that was not written to since `before`.
    fn is_still(&self, before: &Self) -> bool {
        let modified = self.modified.zip(before.modified);
        self.length == before.length && modified.is_none_or(|(now, then)| now == then)
    }
}

#[derive(Debug)]
enum Bytes {
    /// A file, from which the kernel can copy, and which can be changed in place.
    File(LockedFile),
    /// Anything else, which can only be read.
    Other(Box<dyn ReadAt>),
}

#[derive(Debug)]
struct Tail {
    start: u64,
    length: u64,
    bytes: Box<dyn ReadAt>,
}

impl LogFile {
    /// Opens and locks a file. An interrupted change of it is not noticed; see
    /// [`journal::open`](crate::writer::journal::open).
    ///
    /// # Errors
    /// The file does not exist, is not a regular file, cannot be opened, or is locked by another run.
    pub fn open(path: &Path, access: Access) -> Result<Self, ReadError> {
        Self::of_locked(path, Self::lock(path, access)?)
    }

    /// Opens and locks a file without looking into it.
    pub(crate) fn lock(path: &Path, access: Access) -> Result<LockedFile, ReadError> {
        // Checked before opening, because opening a pipe waits for a writer.
        let metadata = std::fs::metadata(path).map_err(|source| cannot_open(path, source))?;
        if !metadata.is_file() {
            return Err(ReadError::NotAFile { path: path.into() });
        }
        LockedFile::open(path, access).map_err(|error| match error {
            OpenError::Io(source) => cannot_open(path, source),
            OpenError::Locked => ReadError::Locked { path: path.into() },
            OpenError::NoLocks(source) => ReadError::NoLocks {
                path: path.into(),
                source,
            },
        })
    }

    /// A file that is locked already.
    pub(crate) fn of_locked(path: &Path, file: LockedFile) -> Result<Self, ReadError> {
        let opened = State::of(&file).map_err(|source| cannot_open(path, source))?;
        Ok(Self {
            own_length: opened.length,
            opened: Some(opened),
            ..Self::of(path, Bytes::File(file))?
        })
    }

    /// Notes whether an interrupted change of the file was undone.
    pub(crate) fn recovered(self, recovered: bool) -> Self {
        Self { recovered, ..self }
    }

    /// Wraps a file of this process alone, which needs no lock; errors call it `path`.
    ///
    /// # Errors
    /// Its length cannot be read.
    pub fn from_file(path: &Path, file: File) -> Result<Self, ReadError> {
        Self::of(path, Bytes::File(file.into()))
    }

    /// Wraps bytes that are not in a file; errors call them `name`.
    ///
    /// # Errors
    /// Their number cannot be read.
    pub fn from_bytes(name: &Path, bytes: Box<dyn ReadAt>) -> Result<Self, ReadError> {
        Self::of(name, Bytes::Other(bytes))
    }

    fn of(path: &Path, bytes: Bytes) -> Result<Self, ReadError> {
        let length = bytes.as_read_at().length();
        Ok(Self {
            path: path.into(),
            own_length: length.map_err(|source| cannot_open(path, source))?,
            bytes,
            tails: Vec::new(),
            opened: None,
            recovered: false,
        })
    }

    /// The same log with the bytes from `start` on replaced by those of `tail`, which is `length` bytes long. Nothing
    /// is written.
    pub fn with_tail(mut self, start: u64, bytes: Box<dyn ReadAt>, length: u64) -> Self {
        self.tails.push(Tail {
            start,
            length,
            bytes,
        });
        self
    }

    /// The same log with the end that was replaced last.
    pub fn without_tail(mut self) -> Self {
        self.tails.pop();
        self
    }

    /// How many bytes other programs have added to the file since it was opened. Nothing is known of what is not a file.
    ///
    /// # Errors
    /// The file was written to in another way, so that what was read may not belong together.
    pub fn grown_by(&self) -> Result<u64, ReadError> {
        let (Some(before), Some(file)) = (self.opened, self.as_file()) else {
            return Ok(0);
        };
        let now =
            State::of(file).map_err(|source| ReadError::io("cannot read", &self.path, source))?;
        let path = || self.path.clone();
        match now.length.checked_sub(before.length) {
            None => Err(ReadError::BecameShorter {
                path: path(),
                before: before.length,
                after: now.length,
            }),
            Some(0) if !now.is_still(&before) => Err(ReadError::Changed { path: path() }),
            Some(added) => Ok(added),
        }
    }

    /// The error of a file that has become shorter since it was opened.
    pub(crate) fn became_shorter(&self) -> Option<ReadError> {
        let error = self.grown_by().err()?;
        matches!(error, ReadError::BecameShorter { .. }).then_some(error)
    }

    /// Whether no program has written to the file since it was opened, or put another one in its place.
    pub(crate) fn is_untouched(&self) -> io::Result<bool> {
        let (Some(before), Some(file)) = (self.opened, self.as_file()) else {
            return Ok(true);
        };
        let is_there = match is_at(file, &self.path) {
            Err(error) => error.kind() == io::ErrorKind::Unsupported,
            Ok(is_there) => is_there,
        };
        Ok(is_there && State::of(file)?.is_still(&before))
    }

    /// Passes the bytes from `start` to `end` to `take`, piece by piece, so that memory holds only one of them.
    ///
    /// # Errors
    /// Those of `take`, or the bytes cannot be read.
    pub(crate) fn for_each_piece(
        &self,
        start: u64,
        end: u64,
        mut take: impl FnMut(&[u8]) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        let mut piece = Vec::new();
        let mut offset = start;
        while offset < end {
            let length = PIECE.min(end - offset);
            self.read_into(&mut piece, offset, length)?;
            take(&piece)?;
            offset += length;
        }
        Ok(())
    }

    /// Whether another log has the same bytes from `start` on.
    ///
    /// # Errors
    /// They cannot be read.
    pub(crate) fn has_same_end(&self, other: &Self, start: u64) -> Result<bool, ReadError> {
        if self.length() != other.length() {
            return Ok(false);
        }
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        let mut offset = start;
        while offset < self.length() {
            let length = PIECE.min(self.length() - offset);
            self.read_into(&mut ours, offset, length)?;
            other.read_into(&mut theirs, offset, length)?;
            if ours != theirs {
                return Ok(false);
            }
            offset += length;
        }
        Ok(true)
    }

    /// Its path or name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file, if the bytes are in one; what replaces its end is not in it.
    pub fn as_file(&self) -> Option<&File> {
        match &self.bytes {
            Bytes::File(file) => Some(file),
            Bytes::Other(_) => None,
        }
    }

    /// The file, if these bytes are in it.
    pub(crate) fn file_with(&self, range: &Range<u64>) -> Option<&File> {
        let is_there = self.tails.iter().all(|tail| range.end <= tail.start);
        self.as_file().filter(|_| is_there)
    }

    /// The file's permissions, if the bytes are in one.
    ///
    /// # Errors
    /// They cannot be read.
    pub(crate) fn permissions(&self) -> Result<Option<Permissions>, ReadError> {
        let metadata = self.as_file().map(File::metadata).transpose();
        let metadata = metadata.map_err(|source| cannot_open(&self.path, source))?;
        Ok(metadata.map(|metadata| metadata.permissions()))
    }

    /// The bytes without what replaces their end.
    pub(crate) fn own_bytes(&self) -> &dyn ReadAt {
        self.bytes.as_read_at()
    }

    /// The number of bytes when it was opened.
    pub fn length(&self) -> u64 {
        let last = self.tails.last();
        last.map_or(self.own_length, |tail| tail.start + tail.length)
    }

    /// The number of bytes of the file itself when it was opened, whatever replaces its end.
    pub fn own_length(&self) -> u64 {
        self.own_length
    }

    /// Whether an interrupted change of the file was undone when it was opened.
    pub fn was_recovered(&self) -> bool {
        self.recovered
    }

    /// Reads the `length` bytes at `offset` into `buffer`, replacing what it held.
    ///
    /// # Errors
    /// The range is not within the log, or reading fails.
    pub fn read_into(
        &self,
        buffer: &mut Vec<u8>,
        offset: u64,
        length: u64,
    ) -> Result<(), ReadError> {
        self.read_after(buffer, 0, offset, length)
    }

    /// Reads the `length` bytes at `offset` into `buffer` after its first `kept` bytes, replacing the others.
    ///
    /// # Errors
    /// The range is not within the log, or reading fails.
    pub fn read_after(
        &self,
        buffer: &mut Vec<u8>,
        kept: usize,
        offset: u64,
        length: u64,
    ) -> Result<(), ReadError> {
        if offset
            .checked_add(length)
            .is_none_or(|end| end > self.length())
        {
            return Err(self.damaged(offset, Damage::BeyondEnd { length }));
        }
        let too_long = || self.damaged(offset, Damage::OutOfMemory { length });
        let end = usize::try_from(length).ok();
        let end = end.and_then(|length| kept.checked_add(length));
        let end = end.ok_or_else(too_long)?;
        let more = end.saturating_sub(buffer.len());
        buffer.try_reserve_exact(more).map_err(|_| too_long())?;
        // Bytes that are about to be overwritten need not be zeroed first.
        buffer.resize(end, 0);
        let read = self.read_exact(&mut buffer[kept..], offset);
        read.map_err(|source| {
            let shorter = self.became_shorter();
            shorter.unwrap_or_else(|| ReadError::io("cannot read", &self.path, source))
        })
    }

    fn read_exact(&self, mut buffer: &mut [u8], offset: u64) -> io::Result<()> {
        for tail in self.tails.iter().rev() {
            let before = tail.start.saturating_sub(offset).min(buffer.len() as u64);
            let (head, rest) = buffer.split_at_mut(before as usize);
            if !rest.is_empty() {
                tail.bytes
                    .read_exact_at(rest, offset + before - tail.start)?;
            }
            buffer = head;
        }
        match buffer {
            [] => Ok(()),
            buffer => self.own_bytes().read_exact_at(buffer, offset),
        }
    }

    /// Like [`read_into`](Self::read_into), but into a buffer of its own.
    ///
    /// # Errors
    /// Those of [`read_into`](Self::read_into).
    pub fn read(&self, offset: u64, length: u64) -> Result<Vec<u8>, ReadError> {
        let mut buffer = Vec::new();
        self.read_into(&mut buffer, offset, length)?;
        Ok(buffer)
    }

    /// The first place from `start` on, but before `end`, where there is something other than zeros; `end` if there is
    /// none.
    ///
    /// # Errors
    /// Reading fails.
    pub(crate) fn end_of_zeros(&self, start: u64, end: u64) -> Result<u64, ReadError> {
        let mut length = 64 * 1024;
        let mut piece = Vec::new();
        let mut position = start;
        while position < end {
            self.read_into(&mut piece, position, length.min(end - position))?;
            let zeros = leading_zeros(&piece);
            position += zeros as u64;
            if zeros < piece.len() {
                return Ok(position);
            }
            length = (2 * length).min(1024 * 1024);
        }
        Ok(end)
    }

    /// The error for a place where the log violates the format.
    pub fn damaged(&self, offset: u64, damage: impl Into<Damage>) -> ReadError {
        ReadError::damaged(&self.path, offset, damage)
    }
}

impl Bytes {
    fn as_read_at(&self) -> &dyn ReadAt {
        match self {
            Self::File(file) => &**file,
            Self::Other(bytes) => &**bytes,
        }
    }
}

/// How many zeros there are before anything else.
pub(super) fn leading_zeros(bytes: &[u8]) -> usize {
    // Whole blocks are compared faster than bytes.
    static BLOCK: [u8; 4096] = [0; 4096];
    let blocks = bytes.chunks(BLOCK.len());
    let zeros = blocks.take_while(|block| **block == BLOCK[..block.len()]);
    let start = zeros.map(<[u8]>::len).sum();
    let other = bytes[start..].iter().position(|&byte| byte != 0);
    other.map_or(bytes.len(), |place| start + place)
}

fn cannot_open(path: &Path, source: io::Error) -> ReadError {
    ReadError::io("cannot open the log", path, source)
}
