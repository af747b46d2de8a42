//! Undoing: an enriched log → the log that it was made from, byte for byte.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::{
    error::Error,
    log::{
        Log,
        file::LogFile,
        locked::{Access, WriteAt},
    },
    progress::{Watch, Watcher},
    report::lossy,
    writer::{
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
    let pending = destination.create(Some(metadata.permissions()))?;
    let mut file = pending.file();
    let copied = |done| watcher.bytes(done, original.file.length());
    copy_data(&original, &mut file, failed, copied)?;
    copy_end(&original, &mut file, failed, copied)?;
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
        bytes: file.length(),
        undone,
        recovered: file.was_recovered(),
    })
}

fn in_place(original: &Log, watcher: &Watcher) -> Result<(), Error> {
    let (file, start) = (&original.file, original.data_end);
    let failed = |source| Error::io("cannot write the log", file.path(), source);
    let mut end = WriteAt::new(file.handle(), start).map_err(failed)?;
    let mut step = |step| watcher.step(step);
    let journal = file.change_from(start, &mut step)?;
    let written = |done| watcher.bytes(done, file.length());
    let changed = copy_end(original, &mut end, failed, written)
        .and_then(|()| journal.commit(file.length(), &mut step));
    journal.conclude(changed)
}
