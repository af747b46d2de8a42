//! Files that are locked while they are open, and reading and writing them by position.

use std::{
    fs::{File, OpenOptions, Permissions, TryLockError},
    io::{self, Write},
    ops::Deref,
    path::Path,
};

use super::error::ReadError;

/// What is going to happen to a file, and so which lock it needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// It is read, as others may do at the same time.
    Read,
    /// It is read and changed in place, while nobody else has it open.
    Change,
}

/// A file that is locked for as long as this lives.
#[derive(Debug)]
pub struct LockedFile(File);

impl LockedFile {
    /// Opens and locks a file.
    ///
    /// # Errors
    /// It cannot be opened, or another run has locked it, or, if it is to be changed, it cannot be locked.
    pub fn open(path: &Path, access: Access) -> Result<Self, ReadError> {
        let mut options = OpenOptions::new();
        options.read(true).write(access == Access::Change);
        let file = options.open(path);
        let file = file.map_err(|source| ReadError::io("cannot open the log", path, source))?;
        let locked = match access {
            Access::Read => file.try_lock_shared(),
            Access::Change => file.try_lock(),
        };
        match (locked, access) {
            (Err(TryLockError::WouldBlock), _) => Err(ReadError::Locked { path: path.into() }),
            (Err(TryLockError::Error(source)), Access::Change) => Err(ReadError::NoLocks {
                path: path.into(),
                source,
            }),
            // Where the file system knows no locks, nobody can be changing the file in place.
            (Err(TryLockError::Error(_)), Access::Read) | (Ok(()), _) => Ok(Self(file)),
        }
    }
}

impl From<File> for LockedFile {
    /// Of a file that nobody else has, so that it needs no lock.
    fn from(file: File) -> Self {
        Self(file)
    }
}

impl Deref for LockedFile {
    type Target = File;

    fn deref(&self) -> &File {
        &self.0
    }
}

impl Drop for LockedFile {
    /// Closing is not enough: a process that another thread is just starting has the file open too for a moment.
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

/// Lets whoever may read a log read also what is made of it, as far as the user can grant that.
pub fn grant(file: &File, permissions: Permissions) -> io::Result<()> {
    match file.set_permissions(permissions) {
        Err(error) if cannot_be_granted(&error) => Ok(()),
        granted => granted,
    }
}

fn cannot_be_granted(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::PermissionDenied | io::ErrorKind::Unsupported
    )
}

/// Writes to a file from some position on, whatever else is done with its handle.
#[derive(Debug)]
pub struct WriteAt {
    file: File,
    position: u64,
}

impl WriteAt {
    /// Begins at `position`.
    ///
    /// # Errors
    /// The system has no handle left.
    pub fn new(file: &File, position: u64) -> io::Result<Self> {
        Ok(Self {
            file: file.try_clone()?,
            position,
        })
    }
}

impl Write for WriteAt {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = write_at(&self.file, bytes, self.position)?;
        self.position += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(unix)]
fn write_at(file: &File, bytes: &[u8], offset: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::write_at(file, bytes, offset)
}

#[cfg(windows)]
fn write_at(file: &File, bytes: &[u8], offset: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_write(file, bytes, offset)
}

/// Reads the bytes at `offset`, whatever else is done with the file's handle.
///
/// # Errors
/// The file ends before, or cannot be read.
#[cfg(unix)]
pub fn read_exact_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, buffer, offset)
}

/// Reads the bytes at `offset`, whatever else is done with the file's handle.
///
/// # Errors
/// The file ends before, or cannot be read.
#[cfg(windows)]
pub fn read_exact_at(file: &File, mut buffer: &mut [u8], mut offset: u64) -> io::Result<()> {
    while !buffer.is_empty() {
        let read = std::os::windows::fs::FileExt::seek_read(file, buffer, offset)?;
        if read == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        buffer = &mut buffer[read..];
        offset += read as u64;
    }
    Ok(())
}
