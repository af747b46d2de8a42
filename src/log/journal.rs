//! Changing the end of a log's file in place, so that the file can be recovered whatever happens.
//!
//! Before the first byte is overwritten, everything that is about to be replaced is saved in a *journal*, a file
//! beside the log. The order is
//!
//! 1. the log is locked,
//! 2. the journal is written, and it and its folder are synced,
//! 3. the log is written, cut to its new length, and synced,
//! 4. the journal is removed, and its folder synced.
//!
//! If this is interrupted, the next run that opens the log finds the journal and restores the old end. If the journal
//! is incomplete, writing it was interrupted, so the log had not been touched yet.

use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

use binrw::{BinRead, BinWrite, binrw};

use super::{error::JournalError, prefix::Prefix};
use crate::fs::{WriteAt, grant, sync_folder};

/// A journal's name is the log's name and this.
const SUFFIX: &str = ".flightcam-journal";

/// How much of a file is held in memory while it is copied.
const PIECE: usize = 1024 * 1024;

/// Bytes of the checksum at the end of a journal.
const CRC_LENGTH: u64 = size_of::<u32>() as u64;

/// The steps of a change. A process that is killed after one of them leaves something different than after another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JournalStep {
    /// The journal exists and is empty.
    JournalCreated,
    /// The journal is written, but perhaps not on the disk yet.
    JournalWritten,
    /// The journal is on the disk.
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
        Self::JournalCreated,
        Self::JournalWritten,
        Self::JournalDurable,
        Self::LogWritten,
        Self::LogCut,
        Self::LogDurable,
        Self::JournalRemoved,
    ];
}

/// The start of a journal. It is followed by the log's old end, as a zstd frame, and a CRC-32 of everything before.
#[binrw]
#[brw(little, magic = b"flightcam journal 1\n")]
struct Header {
    /// Identifies the part of the log that is not changed.
    prefix: Prefix,
    /// The log's length.
    length: u64,
    /// The log's path, for error messages.
    #[bw(calc = path.len() as u32)]
    path_length: u32,
    #[br(count = path_length)]
    path: Vec<u8>,
}

/// A log's file while its end is being replaced.
///
/// If neither [`commit`](Self::commit) nor [`roll_back`](Self::roll_back) is called, the next run restores the old end.
#[derive(Debug)]
pub struct Journal<'a> {
    log: &'a File,
    log_path: &'a Path,
    path: PathBuf,
}

impl<'a> Journal<'a> {
    /// See [`LogFile::change_from`](super::file::LogFile::change_from).
    pub(super) fn begin(
        log: &'a File,
        log_path: &'a Path,
        start: u64,
        reached: &dyn Fn(JournalStep),
    ) -> Result<Self, JournalError> {
        let path = beside(log_path)?;
        let failed = |source| JournalError::io("cannot save the log's end", &path, source);
        let journal = File::create_new(&path).map_err(failed)?;
        let written =
            write(log, log_path, start, journal, reached).and_then(|()| sync_folder(&path));
        if let Err(error) = written {
            // The log was not touched. If the incomplete journal cannot be removed now, the next run removes it.
            let _ = fs::remove_file(&path);
            return Err(failed(error));
        }
        reached(JournalStep::JournalDurable);
        Ok(Self {
            log,
            log_path,
            path,
        })
    }

    /// The log's file.
    pub fn log(&self) -> &File {
        self.log
    }

    /// The path of the log.
    pub fn log_path(&self) -> &Path {
        self.log_path
    }

    /// Makes the change permanent, with a file of `length` bytes.
    ///
    /// # Errors
    /// The file cannot be truncated or synced, or the journal cannot be removed.
    pub fn commit(&self, length: u64, reached: &dyn Fn(JournalStep)) -> Result<(), JournalError> {
        let failed = |source| JournalError::io("cannot write the log", self.log_path, source);
        let file = self.log;
        reached(JournalStep::LogWritten);
        file.set_len(length).map_err(failed)?;
        reached(JournalStep::LogCut);
        file.sync_all().map_err(failed)?;
        reached(JournalStep::LogDurable);
        remove(&self.path, reached)
    }

    /// Restores the old end.
    ///
    /// # Errors
    /// That is not possible now. The journal stays, and the next run tries again.
    pub fn roll_back(self) -> Result<(), JournalError> {
        recover(self.log, self.log_path).map(drop)
    }
}

/// Whether there is a journal beside a log, because the log is being changed or a change was interrupted.
pub(super) fn exists(log: &Path) -> bool {
    beside(log).is_ok_and(|journal| journal.exists())
}

/// Whether there is no file of that name, or cannot be because the name is too long.
fn cannot_be_there(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::NotFound | ErrorKind::InvalidFilename
    )
}

/// The error for a log whose old end cannot be restored.
pub(super) fn not_recovered(log: &Path, source: io::Error) -> JournalError {
    let action = "cannot bring the log back to what it was before an interrupted run";
    JournalError::io(action, log, source)
}

/// Undoes an interrupted change of a file, if there was one; returns whether there was. The file must be locked, so
/// that no change is under way.
pub(super) fn recover(log: &File, log_path: &Path) -> Result<bool, JournalError> {
    let path = beside(log_path)?;
    let journal = match File::open(&path) {
        Err(error) if cannot_be_there(&error) => return Ok(false),
        opened => opened,
    };
    let failed = |source| not_recovered(log_path, source);
    let mut journal = journal.map_err(failed)?;
    if let Some(header) = read_whole(&mut journal).map_err(failed)? {
        let prefix = Prefix::of(log, header.prefix.length).ok();
        if prefix.as_ref() != Some(&header.prefix) {
            return Err(JournalError::Foreign {
                path: log_path.into(),
                journal: path,
                of: String::from_utf8_lossy(&header.path).into_owned(),
            });
        }
        bring_back(log, &header, journal).map_err(failed)?;
    }
    remove(&path, &|_| {})?;
    Ok(true)
}

fn write(
    log: &File,
    log_path: &Path,
    start: u64,
    journal: File,
    reached: &dyn Fn(JournalStep),
) -> io::Result<()> {
    reached(JournalStep::JournalCreated);
    let metadata = log.metadata()?;
    grant(&journal, metadata.permissions())?;
    let path = log_path.canonicalize()?;
    let header = Header {
        prefix: Prefix::of(log, start)?,
        length: metadata.len(),
        path: path.into_os_string().into_encoded_bytes(),
    };
    let mut start_of_journal = io::Cursor::new(Vec::new());
    header
        .write(&mut start_of_journal)
        .map_err(io::Error::other)?;
    let mut out = Checksummed {
        out: BufWriter::with_capacity(PIECE, journal),
        crc: crc32fast::Hasher::new(),
    };
    out.write_all(start_of_journal.get_ref())?;
    // The fastest level, because a log's end is mostly repeated schemas, or compressed already.
    let mut zstd = zstd::Encoder::new(&mut out, 1)?;
    let mut end = log;
    end.seek(SeekFrom::Start(start))?;
    let mut end = BufReader::with_capacity(PIECE, end.take(header.length - start));
    io::copy(&mut end, &mut zstd)?;
    zstd.finish()?;
    let Checksummed { mut out, crc } = out;
    out.write_all(&crc.finalize().to_le_bytes())?;
    let journal = out.into_inner()?;
    reached(JournalStep::JournalWritten);
    journal.sync_all()
}

/// Reads the header of a journal, and leaves the file's position after it; `None` if the journal is incomplete.
fn read_whole(journal: &mut File) -> io::Result<Option<Header>> {
    let length = journal.metadata()?.len();
    // A power cut can leave zeros, which would be the checksum of an empty journal.
    let Some(checked) = length
        .checked_sub(CRC_LENGTH)
        .filter(|&checked| checked > 0)
    else {
        return Ok(None);
    };
    let mut crc = Checksummed {
        out: io::sink(),
        crc: crc32fast::Hasher::new(),
    };
    let mut reader = BufReader::with_capacity(PIECE, &mut *journal);
    io::copy(&mut (&mut reader).take(checked), &mut crc)?;
    let mut expected = [0; CRC_LENGTH as usize];
    reader.read_exact(&mut expected)?;
    if crc.crc.finalize() != u32::from_le_bytes(expected) {
        return Ok(None);
    }
    journal.rewind()?;
    match Header::read(journal) {
        Ok(header) => Ok(Some(header)),
        Err(binrw::Error::Io(error)) => Err(error),
        Err(error) => Err(io::Error::new(ErrorKind::InvalidData, error.to_string())),
    }
}

/// Writes the log's old end from a journal that has been read up to the end of its header.
fn bring_back(log: &File, header: &Header, journal: File) -> io::Result<()> {
    let start = header.prefix.length;
    let mut end = zstd::Decoder::new(journal)?.single_frame();
    let mut out = BufWriter::with_capacity(PIECE, WriteAt::new(log, start)?);
    let written = io::copy(&mut end, &mut out)?;
    out.flush()?;
    if Some(written) != header.length.checked_sub(start) {
        return Err(io::Error::new(
            ErrorKind::InvalidData,
            "the journal does not have the length that it should have",
        ));
    }
    log.set_len(header.length)?;
    log.sync_all()
}

fn remove(journal: &Path, reached: &dyn Fn(JournalStep)) -> Result<(), JournalError> {
    fs::remove_file(journal)
        .map_err(|source| JournalError::io("cannot remove", journal, source))?;
    reached(JournalStep::JournalRemoved);
    // Too late to fail, because the change is complete. At worst a power cut undoes it.
    let _ = sync_folder(journal);
    Ok(())
}

/// The path of a log's journal. It is beside the file itself, whichever links lead there.
fn beside(log: &Path) -> Result<PathBuf, JournalError> {
    let file = log.canonicalize();
    let file = file.map_err(|source| JournalError::io("cannot find the log", log, source))?;
    Ok(journal_of(&file))
}

/// The path of the journal of a log whose path is not a link.
pub fn journal_of(log: &Path) -> PathBuf {
    let mut name = OsString::from(log);
    name.push(SUFFIX);
    name.into()
}

/// Passes on what is written and computes its checksum.
struct Checksummed<W> {
    out: W,
    crc: crc32fast::Hasher,
}

impl<W: Write> Write for Checksummed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.crc.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
