//! Changing the end of a log's file in place, so that the file can be recovered whatever happens.
//!
//! The new end is complete before the log is touched. It is written to a *journal*, followed by the old end. Until the
//! journal is complete it has no name; then it is a file beside the log. The order is
//!
//! 1. the log is locked,
//! 2. the journal is written and synced, gets its name, and its folder is synced,
//! 3. the log is written, cut to its new length, and synced,
//! 4. the journal is removed, and its folder synced.
//!
//! If this is interrupted, the next run that opens the log finds the journal and restores the old end. A journal is
//! believed only if it is whole and flightcam can have left the log and the journal as they are: after the part that
//! does not change, each byte of the log must be that of the old end or that of the new end; and the log before the
//! change and the log after it must have the same original, so that they differ only in what flightcam has added. So
//! nothing can be lost, whoever made the journal and whatever has happened to the log since. If not, both files are
//! left as they are.

mod recovery;

use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write},
    ops::Range,
    path::{Path, PathBuf},
};

use binrw::{BinWrite, binrw};

use crate::{
    fs::{NewFile, ReadAt, WriteAt, folder_of, sync_folder},
    log::{ReadError, file::LogFile, fingerprint::Fingerprint},
    text::{self, Foreign},
};
pub use recovery::{Interrupted, open};

/// A journal's name is the log's name and this.
const SUFFIX: &str = ".flightcam-journal";

/// The first bytes of a journal; the new end follows.
const MAGIC: &[u8] = b"flightcam journal 2\n";

/// The first bytes of a journal of any version.
const ANY_VERSION: &[u8] = b"flightcam journal ";

/// How much of a file is held in memory while it is copied or compared.
const PIECE: usize = 1024 * 1024;

/// The last bytes of a journal: the length of the trailer before them, and the checksum of everything before.
const ENDING: u64 = 4 + CRC;

/// Bytes of a checksum.
const CRC: u64 = 4;

/// The steps of a change. A process that is killed after one of them leaves something different than after another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JournalStep {
    /// The journal is written, but perhaps not on the disk yet.
    JournalWritten,
    /// The journal has its name, but perhaps not on the disk yet.
    JournalNamed,
    /// The journal and its name are on the disk.
    JournalDurable,
    /// The log's new end is written; the old one may reach beyond it.
    LogWritten,
    /// The log has its new length.
    LogCut,
    /// The log is on the disk.
    LogDurable,
    /// The journal is removed, but perhaps not from the disk yet.
    JournalRemoved,
}

impl JournalStep {
    /// All steps, in their order.
    pub const ALL: [Self; 7] = [
        Self::JournalWritten,
        Self::JournalNamed,
        Self::JournalDurable,
        Self::LogWritten,
        Self::LogCut,
        Self::LogDurable,
        Self::JournalRemoved,
    ];
}

/// Why a log cannot be changed in place, or an interrupted change of it not be undone.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// What each variant and field is, its message says.
#[allow(missing_docs)]
pub enum JournalError {
    #[error(transparent)]
    Read(#[from] ReadError),

    #[error("{}: {action}: {source}", text::path(path))]
    Io {
        action: &'static str,
        path: PathBuf,
        source: io::Error,
    },

    #[error(
        "{}: another program has written to it since it was opened, so it was left as it is",
        text::path(path)
    )]
    Changed { path: PathBuf },

    #[error(
        "{}: {} beside it is left from an interrupted change of another log ({of})",
        text::path(path),
        text::path(journal)
    )]
    Foreign {
        path: PathBuf,
        journal: PathBuf,
        /// Where that log was.
        of: Foreign,
    },

    #[error(
        "{}: {} beside it looks like that of an interrupted change, but {fault}. Both are left as they are",
        text::path(path),
        text::path(journal)
    )]
    Distrusted {
        path: PathBuf,
        journal: PathBuf,
        fault: JournalFault,
    },

    #[error(
        "{cause}\nand the log {} could not be restored ({rollback}); {} has its old end",
        text::path(path),
        text::path(journal)
    )]
    NotRolledBack {
        path: PathBuf,
        journal: PathBuf,
        cause: Box<JournalError>,
        rollback: io::Error,
    },
}

/// Why a journal is not believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum JournalFault {
    #[error("it is empty")]
    Empty,
    #[error("it is not a journal")]
    NotAJournal,
    #[error("it was written by another version of flightcam")]
    OtherVersion,
    #[error("it is incomplete or damaged")]
    Damaged,
    #[error("the lengths in it contradict each other")]
    Lengths,
    #[error("the log has {length} bytes, more than it had before that change and after it")]
    LogIsLonger { length: u64 },
    #[error(
        "the log's byte {offset} is neither what it was before that change nor what it was to become"
    )]
    LogIsDifferent { offset: u64 },
    #[error("undoing the change would remove what flightcam did not write")]
    NotOurs,
}

impl JournalError {
    fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io {
            action,
            path: path.into(),
            source,
        }
    }
}

// ---- Changing a log ----

/// The new end of a log's file while it is being written. If it is dropped, the log stays as it is.
#[derive(Debug)]
pub struct NewEnd<'a> {
    log: &'a LogFile,
    file: &'a File,
    start: u64,
    journal: NewFile,
    path: PathBuf,
}

impl<'a> NewEnd<'a> {
    /// Begins the new end of a log from `start` on. The log must have been opened to be changed.
    ///
    /// # Errors
    /// No file can be created beside the log, or the log is not in a file.
    pub fn begin(log: &'a LogFile, start: u64) -> Result<Self, JournalError> {
        let unsupported = || {
            let source = ErrorKind::Unsupported.into();
            JournalError::io("cannot be changed in place", log.path(), source)
        };
        let file = log.as_file().ok_or_else(unsupported)?;
        let path = beside(log.path())?;
        let create = || {
            // A journal has what its log has, so the same users may read it.
            let permissions = file.metadata()?.permissions();
            let name = path.file_name().unwrap_or_default();
            let journal = NewFile::create(folder_of(&path), name, Some(permissions))?;
            WriteAt::new(journal.file(), 0)?.write_all(MAGIC)?;
            Ok(journal)
        };
        let journal = create().map_err(|source| not_saved(&path, source))?;
        Ok(Self {
            log,
            file,
            start,
            journal,
            path,
        })
    }

    /// Where the new end is written to.
    ///
    /// # Errors
    /// The system has no handle left.
    pub fn out(&self) -> Result<WriteAt, JournalError> {
        let out = WriteAt::new(self.journal.file(), MAGIC.len() as u64);
        out.map_err(|source| not_saved(&self.path, source))
    }

    /// Makes the new end, which has been written completely, that of the log.
    ///
    /// # Errors
    /// The disk fails. Then the log is as it was, or, if that fails too, the journal stays and the next run tries again.
    pub fn commit(self, reached: &dyn Fn(JournalStep)) -> Result<(), JournalError> {
        let Self {
            log,
            file,
            start,
            journal,
            path,
        } = self;
        let saved = |source| not_saved(&path, source);
        let changed = || JournalError::Changed {
            path: log.path().into(),
        };
        if !log.is_untouched().map_err(saved)? {
            return Err(changed());
        }
        let trailer = complete(file, log.path(), start, &journal).map_err(saved)?;
        reached(JournalStep::JournalWritten);
        journal.file().sync_all().map_err(saved)?;
        let content = journal.file().try_clone().map_err(saved)?;
        journal.give_name(&path, false).map_err(saved)?;
        let change = Change {
            log: file,
            log_path: log.path(),
            journal: content,
            path: &path,
            trailer,
        };
        reached(JournalStep::JournalNamed);
        if let Err(source) = sync_folder(&path) {
            // The log was not touched. If the journal cannot be removed now, the next run does that.
            let _ = fs::remove_file(&path);
            return Err(saved(source));
        }
        reached(JournalStep::JournalDurable);
        // Once more, because what another program has written since is about to be overwritten.
        if !log.is_untouched().map_err(saved)? {
            let _ = fs::remove_file(&path);
            return Err(changed());
        }
        let made = change.make(reached);
        made.map_err(|source| JournalError::io("cannot write the log", log.path(), source))
            .and_then(|()| remove(&path, reached))
            .map_err(|cause| change.roll_back(cause))
    }
}

fn not_saved(journal: &Path, source: io::Error) -> JournalError {
    JournalError::io("cannot save the log's end", journal, source)
}

/// The end of a journal, before its length and the checksum of everything.
#[binrw]
#[brw(little)]
#[derive(Debug)]
struct Trailer {
    /// Identifies the part of the log that does not change.
    prefix: Fingerprint,
    /// The log's length before the change.
    old_length: u64,
    /// The log's length after the change.
    new_length: u64,
    /// Bytes of the old end in the journal, where it is a zstd frame.
    saved: u64,
    /// The log's path, for error messages.
    #[br(parse_with = binrw::helpers::until_eof)]
    path: Vec<u8>,
}

impl Trailer {
    fn start(&self) -> u64 {
        self.prefix.length
    }

    /// The length of the journal before the trailer; `None` if the lengths contradict each other.
    fn offset(&self) -> Option<u64> {
        self.old_length.checked_sub(self.start())?;
        self.saved_offset()?.checked_add(self.saved)
    }

    /// Where the old end is in the journal.
    fn saved_offset(&self) -> Option<u64> {
        let new_end = self.new_length.checked_sub(self.start())?;
        new_end.checked_add(MAGIC.len() as u64)
    }
}

/// Adds the old end to a journal that has the new one, and everything else.
fn complete(log: &File, log_path: &Path, start: u64, journal: &NewFile) -> io::Result<Trailer> {
    let journal = journal.file();
    let new_end = journal.length()? - MAGIC.len() as u64;
    let mut out = WriteAt::new(journal, journal.length()?)?;

    // The fastest level, because a log's end is mostly repeated schemas, or compressed already.
    let mut zstd = zstd::Encoder::new(BufWriter::with_capacity(PIECE, &mut out), 1)?;
    let old_length = log.length()?;
    let length = old_length.checked_sub(start);
    let length = length.ok_or(ErrorKind::UnexpectedEof)?;
    let mut end = log;
    end.seek(SeekFrom::Start(start))?;
    io::copy(
        &mut BufReader::with_capacity(PIECE, end.take(length)),
        &mut zstd,
    )?;
    zstd.finish()?.flush()?;

    let mut trailer = Trailer {
        prefix: Fingerprint::of(log, start)?,
        old_length,
        new_length: start + new_end,
        saved: 0,
        path: log_path
            .canonicalize()?
            .into_os_string()
            .into_encoded_bytes(),
    };
    let offset = journal.length()?;
    trailer.saved = offset - MAGIC.len() as u64 - new_end;
    let mut bytes = io::Cursor::new(Vec::new());
    trailer.write(&mut bytes).map_err(io::Error::other)?;
    let mut bytes = bytes.into_inner();
    bytes.extend((bytes.len() as u32).to_le_bytes());
    out.write_all(&bytes)?;
    let crc = checksum(journal, journal.length()?)?;
    out.write_all(&crc.to_le_bytes())?;
    Ok(trailer)
}

/// The checksum of the first bytes of a file.
fn checksum(file: &File, length: u64) -> io::Result<u32> {
    let mut crc = crc32fast::Hasher::new();
    for_each_piece(0..length, |offset, piece| {
        file.read_exact_at(piece, offset)?;
        crc.update(piece);
        Ok(true)
    })?;
    Ok(crc.finalize())
}

/// Calls `take` with the offset and a buffer for each piece of a range, until it returns `false`.
fn for_each_piece(
    range: Range<u64>,
    mut take: impl FnMut(u64, &mut [u8]) -> io::Result<bool>,
) -> io::Result<()> {
    let mut piece = vec![0; PIECE];
    let mut offset = range.start;
    while offset < range.end {
        let length = (PIECE as u64).min(range.end - offset);
        if !take(offset, &mut piece[..length as usize])? {
            break;
        }
        offset += length;
    }
    Ok(())
}

/// A journal that is whole, and the log that it belongs to.
struct Change<'a> {
    log: &'a File,
    log_path: &'a Path,
    journal: File,
    path: &'a Path,
    trailer: Trailer,
}

impl Change<'_> {
    /// Gives the log its new end.
    fn make(&self, reached: &dyn Fn(JournalStep)) -> io::Result<()> {
        let Trailer { new_length, .. } = self.trailer;
        let mut new_end = self.journal.try_clone()?;
        new_end.seek(SeekFrom::Start(MAGIC.len() as u64))?;
        let mut new_end = new_end.take(new_length - self.trailer.start());
        let mut log = WriteAt::new(self.log, self.trailer.start())?;
        let mut piece = vec![0; PIECE];
        loop {
            let read = new_end.read(&mut piece)?;
            if read == 0 {
                break;
            }
            log.write_all(&piece[..read])?;
        }
        reached(JournalStep::LogWritten);
        self.log.set_len(new_length)?;
        reached(JournalStep::LogCut);
        self.log.sync_all()?;
        reached(JournalStep::LogDurable);
        Ok(())
    }

    /// Undoes a change that has failed. Returns the reason, with the error of that if there is one.
    fn roll_back(&self, cause: JournalError) -> JournalError {
        let undone = self.undo().and_then(|()| fs::remove_file(self.path));
        match undone {
            Ok(()) => cause,
            Err(rollback) => JournalError::NotRolledBack {
                path: self.log_path.into(),
                journal: self.path.into(),
                cause: Box::new(cause),
                rollback,
            },
        }
    }

    /// Gives the log its old end again.
    fn undo(&self) -> io::Result<()> {
        let mut out = WriteAt::new(self.log, self.trailer.start())?;
        io::copy(
            &mut self.old_end()?,
            &mut BufWriter::with_capacity(PIECE, &mut out),
        )?;
        self.log.set_len(self.trailer.old_length)?;
        self.log.sync_all()
    }

    fn old_end(&self) -> io::Result<impl Read> {
        let mut journal = self.journal.try_clone()?;
        journal.seek(SeekFrom::Start(self.trailer.saved_offset().unwrap_or(0)))?;
        Ok(zstd::Decoder::new(journal.take(self.trailer.saved))?.single_frame())
    }
}

/// The path of a log's journal. It is beside the file itself, whichever links lead there.
fn beside(log: &Path) -> Result<PathBuf, JournalError> {
    let file = log.canonicalize();
    let file = file.map_err(|source| JournalError::io("cannot find the log", log, source))?;
    Ok(journal_of(&file))
}

/// Whether a file has the name of a journal.
pub fn is_journal(path: &Path) -> bool {
    path.as_os_str()
        .as_encoded_bytes()
        .ends_with(SUFFIX.as_bytes())
}

/// The path of the journal of a log whose path is not a link.
pub fn journal_of(log: &Path) -> PathBuf {
    let mut name = OsString::from(log);
    name.push(SUFFIX);
    name.into()
}

fn remove(journal: &Path, reached: &dyn Fn(JournalStep)) -> Result<(), JournalError> {
    fs::remove_file(journal)
        .map_err(|source| JournalError::io("cannot remove", journal, source))?;
    reached(JournalStep::JournalRemoved);
    // Too late to fail, because the change is complete. At worst a power cut undoes it.
    let _ = sync_folder(journal);
    Ok(())
}
