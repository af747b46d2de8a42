//! Undoing: an enriched log → the original, byte for byte.

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::{
    error::Error,
    log::{Access, Log},
    report::{Note, lossy},
    run::{Input, Output, Run, RunError, Stopped},
    watch::Watch,
    writer::{
        WriteError, copy::copy_range, destination::Destination, journal::NewEnd,
        original::Original, provenance::EarlierRun,
    },
};

/// What was restored. Scripts read it as JSON, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Restored {
    /// The enriched log.
    #[serde(serialize_with = "lossy")]
    pub input: PathBuf,
    /// The original.
    #[serde(serialize_with = "lossy")]
    pub output: PathBuf,
    /// Bytes of the original.
    pub bytes: u64,
    /// How the enriched log was made; absent if all there was to undo was an interrupted run.
    pub undone: Option<EarlierRun>,
    /// Whether an interrupted run was undone first.
    pub recovered: bool,
    /// What the user should know besides.
    pub notes: Vec<Note>,
}

/// Writes the original of an enriched log: to a new file or a stream, or in place.
///
/// # Errors
/// The log is not enriched, the original cannot be recovered from it, another program changes it meanwhile, or the output
/// cannot be written. Then there is no new file, and a log in place is as it was.
pub fn restore<'a>(
    log: impl Into<Input<'a>>,
    output: impl Into<Output<'a>>,
    watch: &Watch,
) -> Result<Restored, Error> {
    let log = log.into();
    let output = output.into().open_special(log.path())?;
    let run = Run::new(watch, output.name(log.name()), output.left());
    run.run_watched(|| match output {
        Output::InPlace => in_place(log, &run),
        Output::File { path, overwrite } => to_new_file(log, &path, overwrite, &run),
        Output::Handle { name, mut handle } => to_stream(log, &name, &mut handle, &run),
        Output::Stream { name, mut stream } => to_stream(log, &name, &mut stream, &run),
    })
}

fn in_place(log: Input, run: &Run) -> Result<Restored, Stopped> {
    if log.path().is_none() {
        return Err(RunError::NotAFileInPlace.into());
    }
    let original = open(log, Access::Change, run.watch())?;
    let restored = describe(&original, original.log.file.path())?;
    if restored.undone.is_some() {
        replace_end(&original.log, run)?;
    }
    Ok(restored)
}

/// Writes the original's end over that of the enriched log.
fn replace_end(original: &Log, run: &Run) -> Result<(), Stopped> {
    let (file, start, length) = (&original.file, original.data_end, original.file.length());
    let failed = |source| WriteError::io("cannot write the original's end", file.path(), source);
    let new_end = NewEnd::begin(file, start)?;
    run.expect(length);
    copy_range(file, start..length, &mut new_end.out()?, failed, |done| {
        run.copied(done)
    })?;
    Ok(new_end.commit(&|step| run.reached(step))?)
}

fn to_new_file(log: Input, output: &Path, overwrite: bool, run: &Run) -> Result<Restored, Stopped> {
    // Checked first, because opening a log without a summary reads all of it.
    let destination = Destination::new(log.path(), output, overwrite)?;
    let original = open(log, Access::Read, run.watch())?;
    let restored = describe(&original, output)?;
    let pending = destination.create(original.log.file.permissions()?)?;
    let notes = write(&original.log, output, &mut pending.file(), run)?;
    pending.commit()?;
    Ok(Restored { notes, ..restored })
}

fn to_stream(
    log: Input,
    name: &Path,
    output: &mut impl Write,
    run: &Run,
) -> Result<Restored, Stopped> {
    let original = open(log, Access::Read, run.watch())?;
    let restored = describe(&original, name)?;
    let notes = write(&original.log, name, output, run)?;
    Ok(Restored { notes, ..restored })
}

fn open(log: Input, access: Access, watch: &Watch) -> Result<Original, Stopped> {
    Ok(Original::of(Log::read(log.open(access, watch)?)?)?)
}

/// Writes the whole original. Returns what there is to know of the enriched log.
fn write(
    original: &Log,
    name: &Path,
    output: &mut impl Write,
    run: &Run,
) -> Result<Vec<Note>, Stopped> {
    let (file, data_end, length) = (&original.file, original.data_end, original.file.length());
    let failed = |source| WriteError::output(name, source);
    run.expect(length);
    // In two parts, because the kernel can copy the first one.
    for part in [0..data_end, data_end..length] {
        copy_range(file, part, output, failed, |done| run.copied(done))?;
    }
    output.flush().map_err(failed)?;
    Ok(Note::on_growth(file.grown_by()?).into_iter().collect())
}

fn describe(original: &Original, output: &Path) -> Result<Restored, RunError> {
    let file = &original.log.file;
    let undone = match &original.undone {
        Ok(earlier) => Some(earlier.clone()),
        Err(_) if file.was_recovered() => None,
        Err(reason) => {
            return Err(RunError::NotRestorable {
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
        notes: Vec::new(),
    })
}
