//! Undoing: an enriched log → the log that it was made from, byte for byte.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::{
    error::Error,
    log::{
        Log,
        file::{Access, LogFile, WriteAt},
        journal::Journal,
    },
    progress::{Watch, Watcher},
    report::lossy,
    writer::{copy::copy_data, destination::Destination, original::Original},
};

/// How much of the original's end is in memory.
const PIECE: u64 = 1024 * 1024;

/// What was restored. As JSON it is what scripts read, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Restored {
    /// The enriched log.
    #[serde(serialize_with = "lossy")]
    pub input: PathBuf,
    /// The original.
    #[serde(serialize_with = "lossy")]
    pub output: PathBuf,
    /// Bytes of the original.
    pub bytes: u64,
    /// How the enriched log had been made; absent if a run that was cut short was all there was to undo.
    pub undone: Option<String>,
    /// Whether a run that was cut short was undone first.
    pub recovered: bool,
}

/// Makes an enriched log in its own file what it was before.
///
/// # Errors
/// The log is as it was then. It is not enriched, the original is not to be had from it, or it cannot be written.
pub fn restore(log: &Path, watch: Watch) -> Result<Restored, Error> {
    let original = Original::of(Log::read(LogFile::open(log, Access::Change)?)?)?;
    let restored = describe(&original, log)?;
    if restored.undone.is_some() {
        let watcher = Watcher::new(watch, log.into(), "the log is as it was");
        in_place(&original.log, &watcher)?;
    }
    Ok(restored)
}

/// Writes what an enriched log was before to a new file, `output`.
///
/// # Errors
/// Nothing is left at `output` then. The log is not enriched, the original is not to be had from it, or the output
/// cannot be written.
pub fn restore_to(
    log: &Path,
    output: &Path,
    overwrite: bool,
    watch: Watch,
) -> Result<Restored, Error> {
    let destination = Destination::new(log, output, overwrite)?;
    let original = Original::of(Log::open(log)?)?;
    let restored = describe(&original, output)?;
    let original = original.log;
    let watcher = Watcher::new(watch, output.into(), "nothing was written");
    let failed = |source| destination.write_error(source);
    let metadata = original.file.handle().metadata().map_err(failed)?;
    let pending = destination.create(metadata.permissions())?;
    let mut file = pending.file();
    let copied = |done| watcher.bytes(done, original.file.len());
    copy_data(&original, &mut file, failed, copied)?;
    write_end(&original, file, failed, &watcher)?;
    pending.commit()?;
    Ok(restored)
}

fn describe(original: &Original, output: &Path) -> Result<Restored, Error> {
    let file = &original.log.file;
    let undone = match &original.undone {
        Ok(earlier) => Some(earlier.clone()),
        Err(_) if file.was_recovered() => None,
        Err(reason) => {
            return Err(Error::NotRestorable {
                path: file.path().into(),
                reason: *reason,
            });
        }
    };
    Ok(Restored {
        input: file.path().into(),
        output: output.into(),
        bytes: file.len(),
        undone,
        recovered: file.was_recovered(),
    })
}

fn in_place(original: &Log, watcher: &Watcher) -> Result<(), Error> {
    let (file, start) = (&original.file, original.data_end);
    let failed = |source| Error::io("cannot write the log", file.path(), source);
    let end = WriteAt::new(file.handle(), start).map_err(failed)?;
    let mut step = |step| watcher.step(step);
    let journal = Journal::begin(file, start, &mut step)?;
    let changed = write_end(original, end, failed, watcher)
        .and_then(|()| journal.commit(file.len(), &mut step));
    journal.conclude(changed)
}

/// Writes what the original has from its data section's end on.
fn write_end(
    original: &Log,
    mut output: impl Write,
    failed: impl Fn(io::Error) -> Error,
    watcher: &Watcher,
) -> Result<(), Error> {
    let length = original.file.len();
    let mut piece = Vec::new();
    let mut position = original.data_end;
    while position < length {
        let step = PIECE.min(length - position);
        original.file.read_into(&mut piece, position, step)?;
        output.write_all(&piece).map_err(&failed)?;
        position += step;
        watcher.bytes(position, length)?;
    }
    Ok(())
}
