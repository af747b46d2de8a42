//! What the standard library lacks for files: reading and writing by position, locks, copying in the kernel, and names
//! that are as durable as the content.

mod new_file;

pub use new_file::NewFile;

use std::{
    fmt,
    fs::{File, OpenOptions, Permissions, TryLockError},
    io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write},
    ops::Deref,
    path::Path,
};

// ---- Reading and writing by position ----

/// Bytes that can be read by position: those of a file, of an object in a bucket, of memory.
///
/// Several threads read at the same time.
pub trait ReadAt: fmt::Debug + Send + Sync {
    /// How many bytes there are.
    ///
    /// # Errors
    /// The number cannot be read.
    fn length(&self) -> io::Result<u64>;

    /// Fills the buffer with the bytes at `offset`.
    ///
    /// # Errors
    /// There are not enough bytes, or they cannot be read.
    fn read_exact_at(&self, buffer: &mut [u8], offset: u64) -> io::Result<()>;
}

impl ReadAt for File {
    fn length(&self) -> io::Result<u64> {
        Ok(self.metadata()?.len())
    }

    #[cfg(unix)]
    fn read_exact_at(&self, buffer: &mut [u8], offset: u64) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(self, buffer, offset)
    }

    #[cfg(windows)]
    fn read_exact_at(&self, mut buffer: &mut [u8], mut offset: u64) -> io::Result<()> {
        while !buffer.is_empty() {
            let read = std::os::windows::fs::FileExt::seek_read(self, buffer, offset)?;
            if read == 0 {
                return Err(ErrorKind::UnexpectedEof.into());
            }
            buffer = &mut buffer[read..];
            offset += read as u64;
        }
        Ok(())
    }
}

impl ReadAt for Vec<u8> {
    fn length(&self) -> io::Result<u64> {
        Ok(self.len() as u64)
    }

    fn read_exact_at(&self, buffer: &mut [u8], offset: u64) -> io::Result<()> {
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let bytes = self.get(start..).and_then(|rest| rest.get(..buffer.len()));
        buffer.copy_from_slice(bytes.ok_or(ErrorKind::UnexpectedEof)?);
        Ok(())
    }
}

/// A part of a file, as bytes of its own.
#[derive(Debug)]
pub struct Slice {
    file: File,
    offset: u64,
    length: u64,
}

impl Slice {
    /// The `length` bytes of a file at `offset`.
    pub fn new(file: File, offset: u64, length: u64) -> Self {
        Self {
            file,
            offset,
            length,
        }
    }
}

impl ReadAt for Slice {
    fn length(&self) -> io::Result<u64> {
        Ok(self.length)
    }

    fn read_exact_at(&self, buffer: &mut [u8], offset: u64) -> io::Result<()> {
        let end = offset.checked_add(buffer.len() as u64);
        if end.is_none_or(|end| end > self.length) {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        self.file.read_exact_at(buffer, self.offset + offset)
    }
}

/// Writes to a file from some position on, independently of the position of its handle.
#[derive(Debug)]
pub struct WriteAt {
    file: File,
    position: u64,
}

impl WriteAt {
    /// Starts at `position`.
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

/// Copies some bytes of a file, at least one and at most `most`. Returns how many.
///
/// If the output is a file or a pipe, the kernel does so without the bytes passing through this program, and if the
/// file system can share them, without copying them at all. This uses the position of the input's handle, which nothing
/// else may use at the same time.
///
/// # Errors
/// There are no more bytes, or reading or writing fails.
pub fn copy(mut input: &File, offset: u64, most: u64, output: &mut impl Write) -> io::Result<u64> {
    /// How much is held in memory if the kernel cannot copy.
    const BUFFER: u64 = 1024 * 1024;
    input.seek(SeekFrom::Start(offset))?;
    let mut rest = BufReader::with_capacity(BUFFER.min(most) as usize, input.take(most));
    match io::copy(&mut rest, output)? {
        0 => Err(io::Error::new(
            ErrorKind::UnexpectedEof,
            "the file has become shorter while it was copied",
        )),
        copied => Ok(copied),
    }
}

/// Puts everything that a decoder yields into a temporary file, whose position is its start, and gives it to `visit` as
/// well. Returns the file and its length; `None` if the decoder fails, which means that what it decodes is damaged.
///
/// Zeros take no room on most disks, because a recorder that crashed can leave gigabytes of them.
///
/// # Errors
/// The file cannot be created or written.
pub fn to_temporary_file(
    mut decoder: impl Read,
    mut visit: impl FnMut(&[u8]),
) -> io::Result<Option<(File, u64)>> {
    /// How much is held in memory.
    const PIECE: usize = 1024 * 1024;
    let mut file = tempfile::tempfile()?;
    let mut piece = vec![0; PIECE];
    let mut length = 0;
    loop {
        let piece = match decoder.read(&mut piece) {
            Ok(0) => break,
            Ok(read) => &piece[..read],
            Err(_) => return Ok(None),
        };
        visit(piece);
        match piece.iter().all(|&byte| byte == 0) {
            true => drop(file.seek(SeekFrom::Current(piece.len() as i64))?),
            false => file.write_all(piece)?,
        }
        length += piece.len() as u64;
    }
    file.set_len(length)?;
    file.rewind()?;
    Ok(Some((file, length)))
}

// ---- Locks ----

/// How a file will be used, which determines the lock that it needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// The file is read; others may read it at the same time.
    Read,
    /// The file is read and changed in place, while nobody else has it open.
    Change,
}

/// Why a file is not opened.
#[derive(Debug)]
pub enum OpenError {
    /// It cannot be opened.
    Io(io::Error),
    /// Somebody else has locked it.
    Locked,
    /// It is to be changed, and cannot be locked.
    NoLocks(io::Error),
}

/// A file that is locked for as long as this lives.
#[derive(Debug)]
pub struct LockedFile(File);

impl LockedFile {
    /// Opens and locks a file.
    ///
    /// # Errors
    /// It cannot be opened, or another run has locked it, or, if it is to be changed, it cannot be locked.
    pub fn open(path: &Path, access: Access) -> Result<Self, OpenError> {
        let mut options = OpenOptions::new();
        options.read(true).write(access == Access::Change);
        let file = options.open(path).map_err(OpenError::Io)?;
        let locked = match access {
            Access::Read => file.try_lock_shared(),
            Access::Change => file.try_lock(),
        };
        match (locked, access) {
            (Err(TryLockError::WouldBlock), _) => Err(OpenError::Locked),
            (Err(TryLockError::Error(source)), Access::Change) => Err(OpenError::NoLocks(source)),
            // If the file system does not support locks, nobody can be changing the file in place.
            (Err(TryLockError::Error(_)), Access::Read) | (Ok(()), _) => Ok(Self(file)),
        }
    }
}

impl From<File> for LockedFile {
    /// Wraps a file of this process alone, which needs no lock.
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
    /// Unlocks the file. Closing is not enough: a process that another thread is just starting has the file open for a
    /// moment, too.
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

// ---- Names and permissions ----

/// The folder of a file.
pub fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether a path leads to an open file.
#[cfg(unix)]
pub fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let (one, other) = (file.metadata()?, std::fs::metadata(path)?);
    Ok((one.dev(), one.ino()) == (other.dev(), other.ino()))
}

/// Files cannot be told apart here.
///
/// # Errors
/// Always.
#[cfg(not(unix))]
pub fn is_at(_file: &File, _path: &Path) -> io::Result<bool> {
    Err(ErrorKind::Unsupported.into())
}

/// Makes a file's name as durable as its content.
#[cfg(unix)]
pub fn sync_folder(file: &Path) -> io::Result<()> {
    File::open(folder_of(file))?.sync_all()
}

/// Does nothing, because folders cannot be synced here; the file system keeps names in order by itself.
#[cfg(not(unix))]
pub fn sync_folder(_file: &Path) -> io::Result<()> {
    Ok(())
}

/// Gives a file these permissions, as far as the user can grant them.
pub fn grant(file: &File, permissions: Permissions) -> io::Result<()> {
    match file.set_permissions(permissions) {
        Err(error) if cannot_be_granted(&error) => Ok(()),
        granted => granted,
    }
}

fn cannot_be_granted(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::PermissionDenied | ErrorKind::Unsupported
    )
}
