//! Undoing a change that was interrupted, after checking that this can lose nothing.

use std::{
    fs::{self, File},
    io::{self, ErrorKind, Read},
    path::{Path, PathBuf},
};

use binrw::BinRead;

use super::{
    ANY_VERSION, CRC, Change, ENDING, JournalError, JournalFault, MAGIC, Trailer, beside, checksum,
    for_each_piece, remove,
};
use crate::{
    fs::{Access, LockedFile, ReadAt, Slice, to_temporary_file},
    log::{Log, ReadError, file::LogFile, fingerprint::Fingerprint},
    writer::original::Original,
};

/// A change of a log in place that was interrupted and is about to be undone.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Interrupted {
    /// The log.
    pub log: PathBuf,
    /// The file beside it that has its old end.
    pub journal: PathBuf,
    /// Bytes of the log as it was found.
    pub found_length: u64,
    /// Bytes of the log before the change, and again in a moment.
    pub old_length: u64,
}

/// Opens and locks a log's file. If a change of it was interrupted, that is undone first, which `announce` is given
/// before anything is written.
///
/// # Errors
/// The log cannot be opened, or an interrupted change cannot be undone, perhaps because that could lose something.
pub fn open(
    path: &Path,
    access: Access,
    announce: &dyn Fn(&Interrupted),
) -> Result<LogFile, JournalError> {
    let mut file = LogFile::lock(path, access)?;
    let mut recovered = false;
    // Checked while the lock is held, so that the journal is not that of a change under way.
    while access == Access::Read && exists(path) {
        drop(file);
        recovered |= recover(&lock_to_recover(path)?, path, announce)?;
        file = LogFile::lock(path, access)?;
    }
    if access == Access::Change {
        recovered = recover(&file, path, announce)?;
    }
    Ok(LogFile::of_locked(path, file)?.recovered(recovered))
}

/// Whether there is a journal beside a log, because the log is being changed or a change was interrupted.
fn exists(log: &Path) -> bool {
    beside(log).is_ok_and(|journal| fs::symlink_metadata(journal).is_ok())
}

fn lock_to_recover(path: &Path) -> Result<LockedFile, JournalError> {
    LogFile::lock(path, Access::Change).map_err(|error| match error {
        ReadError::Io { source, .. } => not_recovered(path, source),
        other => other.into(),
    })
}

/// The error for a log whose old end cannot be restored.
fn not_recovered(log: &Path, source: io::Error) -> JournalError {
    let action = "cannot bring the log back to what it was before an interrupted run";
    JournalError::io(action, log, source)
}

/// Undoes an interrupted change of a file, if there was one; returns whether there was. The file must be locked, so
/// that no change is under way.
fn recover(
    log: &LockedFile,
    log_path: &Path,
    announce: &dyn Fn(&Interrupted),
) -> Result<bool, JournalError> {
    let log: &File = log;
    let path = beside(log_path)?;
    let failed = |source| not_recovered(log_path, source);
    let distrust = |fault| JournalError::Distrusted {
        path: log_path.into(),
        journal: path.clone(),
        fault,
    };
    // Checked before opening, because opening a pipe waits for a writer.
    match fs::symlink_metadata(&path) {
        Err(error) if cannot_be_there(&error) => return Ok(false),
        Err(error) => return Err(failed(error)),
        Ok(metadata) if !metadata.is_file() => return Err(distrust(JournalFault::NotAJournal)),
        Ok(_) => {}
    }
    let journal = File::open(&path).map_err(failed)?;
    let trailer = Trailer::read_from(&journal)
        .map_err(failed)?
        .map_err(distrust)?;
    if Fingerprint::of(log, trailer.start()).ok().as_ref() != Some(&trailer.prefix) {
        return Err(JournalError::Foreign {
            path: log_path.into(),
            journal: path,
            of: String::from_utf8_lossy(&trailer.path).into_owned().into(),
        });
    }
    let change = Change {
        log,
        log_path,
        journal,
        path: &path,
        trailer,
    };
    change.check().map_err(failed)?.map_err(distrust)?;
    announce(&Interrupted {
        log: log_path.into(),
        journal: path.clone(),
        found_length: log.length().map_err(failed)?,
        old_length: change.trailer.old_length,
    });
    change.undo().map_err(failed)?;
    remove(&path, &|_| {})?;
    Ok(true)
}

/// Whether there is no file of that name, or cannot be because the name is too long.
fn cannot_be_there(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::NotFound | ErrorKind::InvalidFilename
    )
}

impl Trailer {
    /// Reads that of a journal, if the journal is whole.
    fn read_from(journal: &File) -> io::Result<Result<Self, JournalFault>> {
        let length = journal.length()?;
        if length == 0 {
            return Ok(Err(JournalFault::Empty));
        }
        let mut start = vec![0; MAGIC.len().min(length as usize)];
        journal.read_exact_at(&mut start, 0)?;
        if start != MAGIC {
            return Ok(Err(match start.starts_with(ANY_VERSION) {
                true => JournalFault::OtherVersion,
                false if MAGIC.starts_with(&start) => JournalFault::Damaged,
                false => JournalFault::NotAJournal,
            }));
        }
        let Some(ending) = length.checked_sub(ENDING) else {
            return Ok(Err(JournalFault::Damaged));
        };
        let [mut trailer_length, mut crc] = [[0; 4]; 2];
        journal.read_exact_at(&mut trailer_length, ending)?;
        journal.read_exact_at(&mut crc, length - CRC)?;
        if checksum(journal, length - CRC)? != u32::from_le_bytes(crc) {
            return Ok(Err(JournalFault::Damaged));
        }
        let trailer_length = u32::from_le_bytes(trailer_length);
        let Some(offset) = ending.checked_sub(trailer_length.into()) else {
            return Ok(Err(JournalFault::Lengths));
        };
        let mut bytes = vec![0; trailer_length as usize];
        journal.read_exact_at(&mut bytes, offset)?;
        let trailer = Self::read(&mut io::Cursor::new(bytes));
        let trailer = trailer.ok().filter(|it| it.offset() == Some(offset));
        Ok(trailer.ok_or(JournalFault::Lengths))
    }
}

impl Change<'_> {
    /// Checks that undoing the change loses nothing.
    fn check(&self) -> io::Result<Result<(), JournalFault>> {
        let Trailer {
            old_length,
            new_length,
            ..
        } = self.trailer;
        let length = self.log.length()?;
        if length > old_length.max(new_length) {
            return Ok(Err(JournalFault::LogIsLonger { length }));
        }
        let old_end = match self.uncompress_old_end()? {
            Ok(old_end) => old_end,
            Err(fault) => return Ok(Err(fault)),
        };
        if let Some(offset) = self.find_difference(&old_end)? {
            return Ok(Err(JournalFault::LogIsDifferent { offset }));
        }
        Ok(match self.has_same_original(old_end) {
            Ok(true) => Ok(()),
            Err(ReadError::Io { source, .. }) => return Err(source),
            Ok(false) | Err(_) => Err(JournalFault::NotOurs),
        })
    }

    /// The old end in a temporary file, if it has the length that it should have.
    fn uncompress_old_end(&self) -> io::Result<Result<File, JournalFault>> {
        let expected = self.trailer.old_length - self.trailer.start();
        // Reading one byte more than there should be detects a longer end.
        let end = self.old_end()?.take(expected.saturating_add(1));
        Ok(match to_temporary_file(end, |_| {})? {
            None => Err(JournalFault::Damaged),
            Some((file, length)) if length == expected => Ok(file),
            Some(_) => Err(JournalFault::Lengths),
        })
    }

    fn new_end(&self) -> io::Result<Slice> {
        let new_end = self.journal.try_clone()?;
        let length = self.trailer.new_length - self.trailer.start();
        Ok(Slice::new(new_end, MAGIC.len() as u64, length))
    }

    /// The first place where the log is neither what it was before the change nor what it was to become.
    fn find_difference(&self, old_end: &File) -> io::Result<Option<u64>> {
        let start = self.trailer.start();
        let new_end = self.new_end()?;
        let (mut old, mut new) = (Vec::new(), Vec::new());
        let mut different = None;
        for_each_piece(start..self.log.length()?, |offset, piece| {
            self.log.read_exact_at(piece, offset)?;
            read_at_most(old_end, offset - start, piece.len(), &mut old)?;
            read_at_most(&new_end, offset - start, piece.len(), &mut new)?;
            let is_different = |(place, byte): (usize, &u8)| {
                let is_known = old.get(place) == Some(byte) || new.get(place) == Some(byte);
                // A power cut can leave zeros where something was to be written.
                !is_known && *byte != 0
            };
            let place = piece.iter().enumerate().position(is_different);
            different = place.map(|place| offset + place as u64);
            Ok(different.is_none())
        })?;
        Ok(different)
    }

    /// Whether the log before the change and the log after it have the same original, whose data ends where the change
    /// begins. Then undoing the change removes nothing but what flightcam has added.
    fn has_same_original(&self, old_end: File) -> Result<bool, ReadError> {
        let failed = |source| ReadError::io("cannot read", self.log_path, source);
        let start = self.trailer.start();
        let with_end = |end: Box<dyn ReadAt>, length| {
            let log = self.log.try_clone().map_err(failed)?;
            let file = LogFile::from_file(self.log_path, log)?.with_tail(start, end, length);
            Original::of(Log::read(file)?)
        };
        let old = with_end(Box::new(old_end), self.trailer.old_length - start)?;
        let new_end = self.new_end().map_err(failed)?;
        let new = with_end(Box::new(new_end), self.trailer.new_length - start)?;
        Ok(old.log.data_end == start && old.log.file.has_same_end(&new.log.file, start)?)
    }
}

/// Reads as much as there is, but no more than `most`.
fn read_at_most(
    bytes: &dyn ReadAt,
    offset: u64,
    most: usize,
    buffer: &mut Vec<u8>,
) -> io::Result<()> {
    let there = bytes.length()?.saturating_sub(offset);
    buffer.resize(there.min(most as u64) as usize, 0);
    match buffer.is_empty() {
        true => Ok(()),
        false => bytes.read_exact_at(buffer, offset),
    }
}
