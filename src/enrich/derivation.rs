//! What is derived from a log's telemetry, read on some threads and written on another.

use std::{
    mem,
    sync::mpsc::{self, Receiver, SyncSender, TrySendError},
    thread::{self, Scope, Thread},
};

use super::task::{GLANCE, Task};
use crate::{
    camera::Camera,
    derived::{Derived, Quantity},
    error::Error,
    log::Log,
    messages::Format,
    options::Options,
    reader::Reader,
    report::{EncodingReport, Findings, MissingTopic},
    run::RunError,
    sample::Kind,
    source::Source,
    transform::Transform,
    writer::{Layout, LogWriter, original::Original},
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

    /// Where the new messages are to lie.
    pub fn layout(&self) -> Layout {
        self.options.layout
    }

    /// Reads all telemetry and hands what follows from it to the writer that `begin` makes, once there is
    /// something to be written. `read` is told how many bytes of telemetry were read, of how many. If this fails,
    /// `abandon` is called before the writer's thread is waited for.
    ///
    /// # Errors
    /// The log cannot be read, the writer fails, `read` does, or nothing can be derived.
    pub fn run<'w>(
        self,
        begin: impl FnOnce() -> Result<BoxedWriter<'w>, Error>,
        mut read: impl FnMut(u64, u64) -> Result<(), Error>,
        abandon: impl FnOnce(),
    ) -> Result<(BoxedWriter<'w>, Findings<'a>, u64), Error> {
        let reader = Reader::new(self.telemetry, self.source);
        let mut transform = Transform::new(self.camera, self.options.max_gap);
        let total = reader.bytes_total();
        let (writer, source, dropped, outcome) = thread::scope(|scope| {
            let derive = || {
                let mut begin = Some(begin);
                let mut writing: Option<Writing> = None;
                let mut derived = Vec::new();
                let mut hand_over = |derived: &mut Vec<Derived>, bytes_read| {
                    if let Some(begin) = begin.take() {
                        writing = Some(Writing::start(scope, begin()?));
                    }
                    let started = writing.take().expect("it was begun");
                    let waiting = || read(bytes_read, total);
                    writing = Some(started.send(mem::take(derived), waiting)?);
                    read(bytes_read, total)
                };
                let (source, dropped) = reader.for_each(|sample, bytes_read| {
                    transform.push(sample, &mut derived);
                    match derived.len() < BATCH {
                        true => Ok(()),
                        false => hand_over(&mut derived, bytes_read),
                    }
                })?;
                if !derived.is_empty() {
                    hand_over(&mut derived, total)?;
                }
                let waiting = || read(total, total);
                let writer = writing.map(|writing| writing.finish(waiting)).transpose()?;
                Ok::<_, Error>((writer, source, dropped, transform.finish()))
            };
            derive().inspect_err(|_| abandon())
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
    task: Task<'scope, BoxedWriter<'w>>,
}

impl<'scope, 'w> Writing<'scope, 'w> {
    fn start(scope: &'scope Scope<'scope, '_>, writer: BoxedWriter<'w>) -> Self
    where
        'w: 'scope,
    {
        let (batches, received) = mpsc::sync_channel(BATCHES);
        let reading = thread::current();
        Self {
            batches,
            task: Task::start(scope, move || write_all(writer, received, &reading)),
        }
    }

    /// Hands over a batch. `waiting` is called now and then as long as there is no room for it.
    fn send(
        self,
        mut batch: Vec<Derived>,
        mut waiting: impl FnMut() -> Result<(), Error>,
    ) -> Result<Self, Error> {
        loop {
            match self.batches.try_send(batch) {
                Ok(()) => return Ok(self),
                Err(TrySendError::Full(unsent)) => {
                    batch = unsent;
                    thread::park_timeout(GLANCE);
                    waiting()?;
                }
                Err(TrySendError::Disconnected(_)) => match self.finish(waiting) {
                    Err(error) => return Err(error),
                    Ok(_) => unreachable!("a writer ends early only with an error"),
                },
            }
        }
    }

    /// The writer, when it has written everything. `waiting` is called now and then until then.
    fn finish(self, waiting: impl FnMut() -> Result<(), Error>) -> Result<BoxedWriter<'w>, Error> {
        drop(self.batches);
        self.task.join(waiting)
    }
}

/// Writes what comes, and lets the thread that reads know when there is room for more.
fn write_all<'w>(
    mut writer: BoxedWriter<'w>,
    batches: Receiver<Vec<Derived>>,
    reading: &Thread,
) -> Result<BoxedWriter<'w>, Error> {
    for batch in batches {
        reading.unpark();
        for derived in &batch {
            writer.write(derived)?;
        }
    }
    Ok(writer)
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
