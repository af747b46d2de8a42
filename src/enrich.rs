//! Enriching a log: reading its telemetry, deriving the camera's motion, and writing the log with it, all at the same
//! time.
//!
//! ```text
//! reading workers ──samples──▶ job ──derived values──▶ the caller's thread: a sink
//!                              (merges, transforms)    (encodes, compresses, writes)
//!                                                      beside it: the kernel copies the log to a new file
//! ```
//!
//! Each arrow is a channel with little room, so the faster side waits and memory is bounded. The job does not know what
//! becomes of the values; they go to a sink.

mod background;
pub(crate) mod claims;
mod held_back;
mod job;
mod judge;
mod log_sink;
mod plan;
mod showing;
pub(crate) mod stream;
mod target;

use std::{ops::ControlFlow, thread};

use crate::{
    derived::{Derived, Quantity},
    error::Error,
    log::{Log, file::LogFile, stream::Named},
    options::Options,
    report::{Derivation, DeriveReport, Findings, Report},
    run::{Input, Left, Output, Run, RunError, Stopped},
    source::stream_filter::StreamFilter,
    writer::{Layout, original::Original},
};
use job::{Batch, Job};
use judge::judge;
use plan::Plan;
use showing::{Showing, Staging};
use target::Target;

/// Receives the derived values epoch by epoch, each in the order of their times, for example a log writer.
pub(crate) trait Sink {
    /// Takes the next values.
    ///
    /// # Errors
    /// It cannot take them, or has stopped early.
    fn take(&mut self, batch: &Batch) -> Result<(), Stopped>;
}

/// Writes a log with the camera's channels. If the log is already enriched, the earlier result is replaced.
///
/// # Errors
/// Something is wrong with the log, the options or the output. Then there is no new file, and a log that was to be
/// changed in place is unchanged. A stream may have received a part of the result or, if the log comes from a stream
/// too, the log as it is.
pub fn enrich<'a>(
    input: impl Into<Input<'a>>,
    output: impl Into<Output<'a>>,
    options: &Options,
) -> Result<Report, Error> {
    let input = input.into();
    let output = output.into().open_special(input.path())?;
    let run = Run::new(&options.watch, output.name(input.name()), output.left());
    run.run_watched(|| match input {
        Input::Stream { name, stream } => {
            stream::enrich(Named::new(&name, stream), output, options, &run)
        }
        input => {
            // Checked first, because opening a log without a summary reads all of it.
            let target = Target::new(input.path(), output, options.layout)?;
            enrich_log(
                input.open(target.access(), &options.watch)?,
                target,
                options,
                &run,
            )
        }
    })
}

/// Enriches a log that can be read by position.
fn enrich_log(
    file: LogFile,
    target: Target,
    options: &Options,
    run: &Run,
) -> Result<Report, Stopped> {
    let original = Original::of(Log::read(file)?)?;
    original.check_are_free(options.topics())?;
    let plan = Plan::new(&original.log, options)?;
    write(&original, &original.log, plan, target, options, run)
}

/// Reads the telemetry, derives the camera's motion and writes the log with it, all at the same time. The telemetry is
/// read from the log `telemetry`, which is the original unless that comes through a pipe.
fn write(
    original: &Original,
    telemetry: &Log,
    plan: Plan,
    target: Target,
    options: &Options,
    run: &Run,
) -> Result<Report, Stopped> {
    let Plan {
        source,
        camera,
        encoding,
        format,
    } = plan;
    let output = target.name().to_owned();
    run.expect(target.bytes_to_copy(&original.log));
    thread::scope(|scope| {
        let _at_end = run.cancel_at_end();
        let start =
            |source, flight| Job::start(scope, telemetry, source, camera, options, flight, run);
        let findings = |derivation: Derivation| {
            let format = format.clone();
            Findings::new(original, options, camera, encoding, format, derivation)
        };
        let staging = Staging::new(telemetry, options, &source.profile)?;
        let mut staged = match &staging {
            // What is shown goes among the log's chunks, so it has to be known first.
            Some(staging) if options.layout == Layout::Interleaved => {
                let job = start(source.clone(), Some(staging.recorder()))?;
                let flight = job.run_to_end()?.flight;
                flight.map(|flight| staging.stage(flight)).transpose()?
            }
            _ => None,
        };
        let recorder = staging.as_ref().filter(|_| staged.is_none());
        let mut job = start(source, recorder.map(Staging::recorder))?;
        // If nothing can be derived, nothing is created.
        let Some(first) = job.next() else {
            let derivation = job.finish()?;
            judge(&derivation, &original.log, options)?;
            let findings = findings(derivation).with_positions(telemetry);
            return Err(nothing_derived(&findings, &original.log).into());
        };

        let mut sink = target.begin(scope, &original.log, format.clone(), run)?;
        sink.writer.divide(&job.epoch_starts);
        sink.showing = (staged.as_ref()).map(|flight| Showing::start(scope, flight));
        let derivation = sink.take(&first).and_then(|()| job.feed(&mut sink));
        match derivation {
            Ok(mut derivation) => {
                let oddities = match judge(&derivation, &original.log, options) {
                    Ok(oddities) => oddities,
                    Err(error) => return Err(sink.give_up(error)),
                };
                if let (Some(staging), Some(flight)) = (&staging, derivation.flight.take()) {
                    let flight = match staging.stage(flight) {
                        Ok(flight) => flight,
                        Err(error) => return Err(sink.give_up(error.into())),
                    };
                    sink.showing = Some(Showing::start(scope, &flight));
                    staged = Some(flight);
                }
                sink.show_rest()?;
                let findings = findings(derivation)
                    .with(oddities)
                    .with_positions(telemetry)
                    .showing(staged, staging.and_then(|staging| staging.calibration));
                let (written, grown_by) = sink.finish(findings.facts())?;
                Ok(findings.report(output, written, grown_by))
            }
            // What was written is dropped with the sink.
            Err(stopped) => Err(stopped),
        }
    })
}

/// Derives the camera's motion from a log's telemetry without writing a log. `take` gets all values in batches, in the
/// order of their times; where the log's clock was set back, so are they. Returns what became of the samples; `None` if
/// `take` ended the derivation.
///
/// # Errors
/// Something is wrong with the log or the options.
pub fn derive<'a>(
    input: impl Into<Input<'a>>,
    options: &Options,
    mut take: impl FnMut(&[Derived]) -> ControlFlow<()>,
) -> Result<Option<DeriveReport>, Error> {
    let input = input.into();
    let run = Run::new(&options.watch, input.name().into(), Left::Nothing);
    run.run_watched(|| {
        let log = stream::telemetry(input, StreamFilter::new, options, &run)?;
        let Plan { source, camera, .. } = Plan::new(&log, options)?;
        thread::scope(|scope| {
            let _at_end = run.cancel_at_end();
            let mut job = Job::start(scope, &log, source, camera, options, None, &run)?;
            for batch in &mut job {
                if take(&batch.values).is_break() {
                    return Ok(None);
                }
            }
            let derivation = job.finish()?;
            judge(&derivation, &log, options)?;
            let grown_by = log.file.grown_by()?;
            Ok(Some(DeriveReport::new(&log, derivation, grown_by)))
        })
    })
}

fn nothing_derived(findings: &Findings, log: &Log) -> Error {
    let missing = Quantity::ALL.map(|quantity| findings.missing(quantity));
    RunError::NothingDerived {
        path: log.file.path().into(),
        missing: missing.into(),
    }
    .into()
}
