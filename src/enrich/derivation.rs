//! What is derived from a log's telemetry, read on some threads and written on another.

use std::{
    mem,
    sync::mpsc::{self, Receiver, SyncSender},
    thread::{self, Scope, ScopedJoinHandle},
};

use crate::{
    camera::Camera,
    derived::{Derived, Quantity},
    error::Error,
    log::Log,
    messages::Format,
    options::Options,
    reader::Reader,
    report::{EncodingReport, Findings},
    sample::Kind,
    source::Source,
    transform::Transform,
    writer::{LogWriter, original::Original},
};

/// How many values are handed over at once, and how often that may happen before they must have been written.
const BATCH: usize = 1024;
const BATCHES: usize = 4;

/// All that has to be known before the telemetry is read.
pub struct Derivation<'a> {
    original: &'a Original,
    telemetry: &'a Log,
    options: &'a Options,
    source: Source,
    camera: Camera,
    encoding: EncodingReport,
    /// How derived values are to be written.
    pub format: Format,
}

/// A writer on its way to its thread and back.
pub type BoxedWriter<'a> = Box<dyn LogWriter + Send + 'a>;

impl<'a> Derivation<'a> {
    /// Finds the telemetry. It is read from the log `telemetry`, which has that of the original.
    ///
    /// # Errors
    /// There is none, it is ambiguous, or it does not go with the options.
    pub fn new(
        original: &'a Original,
        telemetry: &'a Log,
        options: &'a Options,
    ) -> Result<Self, Error> {
        original.check_topics_are_free()?;
        let source = Source::select(telemetry, &options.telemetry)?;
        let camera = options.camera(&source)?;
        let kinds: &[Kind] = match camera {
            Camera::Gimbal => &[Kind::Attitude, Kind::Velocity, Kind::Gimbal],
            Camera::Stabilised { .. } | Camera::Fixed(_) => &[Kind::Attitude, Kind::Velocity],
        };
        let source = source.keep(telemetry, &options.telemetry, kinds)?;
        let attitude = source.attitude_channel(telemetry);
        let format = Format::choose(options.encoding, attitude);
        Ok(Self {
            encoding: EncodingReport::new(options.encoding, format.encoding, attitude),
            original,
            telemetry,
            options,
            source,
            camera,
            format,
        })
    }

    /// Reads all telemetry and hands what follows from it to the writer that `begin` makes, once there is
    /// something to be written. `read` is told how many bytes of telemetry were read, of how many.
    ///
    /// # Errors
    /// The log cannot be read, the writer fails, `read` does, or nothing can be derived.
    pub fn run<'w>(
        self,
        begin: impl FnOnce() -> Result<BoxedWriter<'w>, Error>,
        mut read: impl FnMut(u64, u64) -> Result<(), Error>,
    ) -> Result<(BoxedWriter<'w>, Findings<'a>, u64), Error> {
        let reader = Reader::new(self.telemetry, self.source);
        let mut transform = Transform::new(self.camera, self.options.max_gap);
        let total = reader.bytes_total();
        let (writer, source, dropped, outcome) = thread::scope(|scope| {
            let mut begin = Some(begin);
            let mut writing: Option<Writing> = None;
            let mut derived = Vec::new();
            let mut hand_over = |derived: &mut Vec<Derived>| {
                if let Some(begin) = begin.take() {
                    writing = Some(Writing::start(scope, begin()?));
                }
                let started = writing.take().expect("it was begun");
                writing = Some(started.send(mem::take(derived))?);
                Ok::<_, Error>(())
            };
            let (source, dropped) = reader.for_each(|sample, bytes_read| {
                transform.push(sample, &mut derived);
                if derived.len() < BATCH {
                    return Ok(());
                }
                hand_over(&mut derived)?;
                read(bytes_read, total)
            })?;
            if !derived.is_empty() {
                hand_over(&mut derived)?;
            }
            let writer = writing.map(Writing::finish).transpose()?;
            Ok::<_, Error>((writer, source, dropped, transform.finish()))
        })?;
        read(total, total)?;
        let findings = Findings::new(
            self.original,
            self.options,
            source,
            self.camera,
            self.encoding,
            &dropped,
            outcome,
        );
        match writer {
            Some(writer) => Ok((writer, findings, total)),
            None => Err(nothing_derived(&findings, &self.original.log)),
        }
    }
}

/// A writer on a thread of its own, where values are encoded and compressed while others are read.
struct Writing<'scope, 'w> {
    batches: SyncSender<Vec<Derived>>,
    thread: ScopedJoinHandle<'scope, Result<BoxedWriter<'w>, Error>>,
}

impl<'scope, 'w> Writing<'scope, 'w> {
    fn start(scope: &'scope Scope<'scope, '_>, writer: BoxedWriter<'w>) -> Self
    where
        'w: 'scope,
    {
        let (batches, received) = mpsc::sync_channel(BATCHES);
        Self {
            batches,
            thread: scope.spawn(move || write_all(writer, received)),
        }
    }

    fn send(self, batch: Vec<Derived>) -> Result<Self, Error> {
        match self.batches.send(batch) {
            Ok(()) => Ok(self),
            Err(_) => match self.finish() {
                Err(error) => Err(error),
                Ok(_) => unreachable!("a writer ends early only with an error"),
            },
        }
    }

    fn finish(self) -> Result<BoxedWriter<'w>, Error> {
        drop(self.batches);
        let written = self.thread.join();
        written.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

fn write_all(
    mut writer: BoxedWriter,
    batches: Receiver<Vec<Derived>>,
) -> Result<BoxedWriter, Error> {
    for batch in batches {
        for derived in &batch {
            writer.write(derived)?;
        }
    }
    Ok(writer)
}

fn nothing_derived(findings: &Findings, log: &Log) -> Error {
    let reasons = Quantity::ALL.map(|quantity| {
        let reason = findings.why_missing(quantity);
        format!("  {}: {reason}", quantity.topic())
    });
    Error::NothingDerived {
        path: log.file.path().into(),
        details: reasons.join("\n"),
    }
}
