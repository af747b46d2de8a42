//! Enriching a log: its telemetry is read, what follows from that for the camera is derived, and the log is written
//! with it, all at the same time.
//!
//! ```text
//! reading workers ──samples──▶ job ──derived values──▶ the caller's thread: a sink
//!                              (merges, transforms)    (encodes, compresses, writes)
//!                                                      beside it: the log is copied to a new file by the system
//! ```
//!
//! Each arrow is a channel that holds little, so that whoever is faster waits, and memory is bounded. The job knows
//! nothing of what becomes of the values: what takes them is a [`Sink`].

mod background;
mod job;
mod log_sink;
mod plan;
mod stream;
mod target;

use std::{ops::ControlFlow, thread};

use crate::{
    derived::{Derived, Quantity},
    error::Error,
    log::{Access, Log, file::LogFile, stream::Named},
    options::Options,
    report::{Findings, MissingTopic, Report},
    run::{Input, Left, Output, Run, RunError, Stopped},
    transform::Outcome,
    writer::original::Original,
};
use job::{Derivation, Job};
use plan::Plan;
use target::Target;

/// What follows the derivation: it takes all derived values, in the order of their times.
pub(crate) trait Sink {
    /// Takes the next values.
    ///
    /// # Errors
    /// It cannot, or wants no more of them.
    fn take(&mut self, values: &[Derived]) -> Result<(), Stopped>;
}

impl<F: FnMut(&[Derived]) -> ControlFlow<()>> Sink for F {
    fn take(&mut self, values: &[Derived]) -> Result<(), Stopped> {
        match self(values) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Stopped::Cancelled),
        }
    }
}

/// Writes a log with the camera's channels. Of a log that is enriched already the earlier result is replaced.
///
/// # Errors
/// What is wrong with the log, the options or the output. No new file is left then, and a log in place is as it was. A
/// stream may have got a part of the result, or, if the log comes from a stream too, the log as it is.
pub fn enrich<'a>(
    input: impl Into<Input<'a>>,
    output: impl Into<Output<'a>>,
    options: &Options,
) -> Result<Report, Error> {
    let (input, output) = (input.into(), output.into());
    let run = Run::new(&options.watch, output.name(input.name()), output.left());
    run.attend(|| match input {
        Input::File(path) => {
            // Looked at first, because opening a log that has no summary reads all of it.
            let target = Target::new(Some(&path), output, options.layout)?;
            let file = LogFile::open(&path, target.access())?;
            enrich_log(file, target, options, &run)
        }
        Input::Bytes { name, bytes } => {
            let target = Target::new(None, output, options.layout)?;
            enrich_log(LogFile::from_bytes(&name, bytes)?, target, options, &run)
        }
        Input::Stream { name, stream } => stream::enrich(
            Named {
                name: &name,
                stream,
            },
            output,
            options,
            &run,
        ),
    })
}

/// Enriches a log of which any part can be read at any time.
fn enrich_log(
    file: LogFile,
    target: Target,
    options: &Options,
    run: &Run,
) -> Result<Report, Stopped> {
    let original = Original::of(Log::read(file)?)?;
    original.check_topics_are_free()?;
    let plan = Plan::new(&original.log, options)?;
    write(&original, &original.log, plan, target, options, run)
}

/// Writes a log to where it is to go, with what follows from its telemetry. That is read from the log `telemetry`,
/// which is the original unless that came through a pipe.
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
        let mut job = Job::start(scope, telemetry, source, camera, options, run);
        let find = |derivation: Derivation| {
            let Derivation {
                source,
                dropped,
                outcome,
            } = derivation;
            Findings::new(
                original, options, source, camera, encoding, &dropped, outcome,
            )
        };
        // Nothing is created where nothing can be derived.
        let Some(first) = job.next() else {
            return Err(nothing_derived(&find(job.finish()?), &original.log).into());
        };

        let mut sink = target.begin(scope, &original.log, format, run)?;
        let derivation = sink.take(&first).and_then(|()| job.feed(&mut sink));
        match derivation {
            Ok(derivation) => {
                let findings = find(derivation);
                let written = sink.finish(findings.facts())?;
                Ok(findings.report(output, written))
            }
            Err(stopped) => Err(sink.abandon(stopped)),
        }
    })
}

/// Derives the camera's motion from a log's telemetry without writing a log: `take` gets all values, in the order of
/// their times. Gives what became of the samples; `None` where `take` ended it.
///
/// # Errors
/// What is wrong with the log or the options.
pub fn derive<'a>(
    input: impl Into<Input<'a>>,
    options: &Options,
    mut take: impl FnMut(&[Derived]) -> ControlFlow<()>,
) -> Result<Option<Outcome>, Error> {
    let input = input.into();
    let run = Run::new(&options.watch, input.name().into(), Left::Nothing);
    run.attend(|| {
        let log = match input {
            Input::File(path) => Log::read(LogFile::open(&path, Access::Read)?)?,
            Input::Bytes { name, bytes } => Log::read(LogFile::from_bytes(&name, bytes)?)?,
            Input::Stream { name, stream } => stream::telemetry(
                Named {
                    name: &name,
                    stream,
                },
                options,
                &run,
            )?,
        };
        let Plan { source, camera, .. } = Plan::new(&log, options)?;
        thread::scope(|scope| {
            let _at_end = run.cancel_at_end();
            let job = Job::start(scope, &log, source, camera, options, &run);
            match job.feed(&mut take) {
                Ok(derivation) => Ok(Some(derivation.outcome())),
                Err(Stopped::Cancelled) if run.go_on().is_ok() => Ok(None),
                Err(stopped) => Err(stopped),
            }
        })
    })
}

fn nothing_derived(findings: &Findings, log: &Log) -> Error {
    let missing = Quantity::ALL.map(|quantity| MissingTopic {
        topic: quantity.topic(),
        reason: findings.why_missing(quantity),
    });
    RunError::NothingDerived {
        path: log.file.path().into(),
        missing: missing.into(),
    }
    .into()
}
