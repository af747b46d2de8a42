//! Undoing: an enriched log → the log that it was made from, byte for byte.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::{
    enrich::conclude,
    error::Error,
    log::{
        Log,
        file::LogFile,
        locked::{Access, WriteAt},
    },
    progress::{Watch, Watcher},
    report::lossy,
    run::{Left, RunError},
    writer::{
        WriteError,
        copy::{copy_data, copy_end},
        destination::Destination,
        original::Original,
    },
};

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
        let watcher = Watcher::new(watch, log.into(), Left::Unchanged);
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
    let watcher = Watcher::new(watch, output.into(), Left::Nothing);
    let failed = |source| destination.write_error(source);
    let metadata = original.file.handle().metadata().map_err(failed)?;
    let pending = destination.create(Some(metadata.permissions()))?;
    let mut file = pending.file();
    let copied = |done| watcher.go_on(done, original.file.length());
    copy_data(&original, &mut file, failed, copied)
        .and_then(|()| copy_end(&original, &mut file, failed, copied))
        .map_err(|error| watcher.explain(error))?;
    pending.commit()?;
    Ok(restored)
}

fn describe(original: &Original, output: &Path) -> Result<Restored, Error> {
    let file = &original.log.file;
    let undone = match &original.undone {
        Ok(earlier) => Some(earlier.to_string()),
        Err(_) if file.was_recovered() => None,
        Err(reason) => {
            return Err(RunError::NotRestorable {
                path: file.path().into(),
                reason: *reason,
            }
            .into());
        }
    };
    Ok(Restored {
        input: file.path().into(),
        output: output.into(),
        bytes: file.length(),
        undone,
        recovered: file.was_recovered(),
    })
}

fn in_place(original: &Log, watcher: &Watcher) -> Result<(), Error> {
    let (file, start) = (&original.file, original.data_end);
    let failed = |source| WriteError::io("cannot write the log", file.path(), source);
    let mut end = WriteAt::new(file.handle(), start).map_err(failed)?;
    let mut step = |step| watcher.step(step);
    let journal = file.change_from(start, &mut step)?;
    let written = |done| watcher.go_on(done, file.length());
    let changed = copy_end(original, &mut end, failed, written)
        .map_err(|error| watcher.explain(error))
        .and_then(|()| Ok(journal.commit(file.length(), &mut step)?));
    conclude(journal, file.path(), changed)
}
