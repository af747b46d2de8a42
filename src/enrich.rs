//! The pipeline: reader → transform → writer → report.

mod copying;
mod derivation;
mod output;
mod passing;
mod task;

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use crate::{
    error::Error,
    log::{Log, file::LogFile, locked::Access, stream::Named},
    options::Options,
    progress::{Watch, Watcher},
    report::Report,
    run::{Left, RunError},
    writer::{Layout, destination::Destination, original::Original},
};
use derivation::Derivation;
pub(crate) use output::conclude;
pub use passing::{enrich_stream, enrich_stream_to_file};

/// `NAME.enriched.mcap` beside the input.
pub fn default_output(input: &Path) -> PathBuf {
    let mut name = input.file_stem().unwrap_or_default().to_owned();
    name.push(".enriched.mcap");
    input.with_file_name(name)
}

/// Writes the log `input` with the camera's channels to a new file, `output`. Of a log that is enriched already
/// the earlier result is replaced.
///
/// # Errors
/// Nothing is left at `output` then. The error says what was wrong and what to do about it.
pub fn enrich(
    input: &Path,
    output: &Path,
    options: &Options,
    watch: Watch,
) -> Result<Report, Error> {
    // Asked first, because opening a log that has no summary reads all of it.
    let destination = Destination::new(input, output, options.overwrite)?;
    let original = Original::of(Log::open(input)?)?;
    let derivation = Derivation::new(&original, &original.log, options)?;
    let watcher = Watcher::new(watch, output.into(), Left::Nothing);
    output::to_new_file(&original.log, &destination, derivation, &watcher)
}

/// Adds the camera's channels to the log in its own file, in which an earlier result is replaced.
///
/// # Errors
/// The log is as it was then. The error says what was wrong and what to do about it. The interleaved layout is
/// refused, because it leaves nothing in its place.
pub fn enrich_in_place(log: &Path, options: &Options, watch: Watch) -> Result<Report, Error> {
    if options.layout == Layout::Interleaved {
        return Err(RunError::InterleavedInPlace.into());
    }
    let file = LogFile::open(log, Access::Change)?;
    let original = Original::of(Log::read(file)?)?;
    let derivation = Derivation::new(&original, &original.log, options)?;
    let watcher = Watcher::new(watch, log.into(), Left::Unchanged);
    output::in_place(&original.log, derivation, &watcher)
}

/// Writes the log `input` with the camera's channels to a stream.
///
/// # Errors
/// What the stream has got by then is not whole. The error says what was wrong and what to do about it.
pub fn enrich_to(
    input: &Path,
    output: Named<impl Write + Send>,
    options: &Options,
    watch: Watch,
) -> Result<Report, Error> {
    let original = Original::of(Log::open(input)?)?;
    let derivation = Derivation::new(&original, &original.log, options)?;
    let watcher = Watcher::new(watch, output.name.into(), Left::Incomplete);
    output::to_stream(&original.log, output, derivation, &watcher)
}
