//! Reading the telemetry and deriving values from it, on a thread of its own.

use std::{
    mem, panic,
    sync::mpsc::{self, Receiver, SyncSender},
    thread::{Scope, ScopedJoinHandle},
};

use super::Sink;
use crate::{
    camera::Camera,
    check::Recorder,
    derived::Derived,
    log::{Log, ReadError},
    options::Options,
    reader::Reader,
    report::Derivation,
    run::{Cancelled, Run, Stopped},
    sample::{Kind, Sample, VelocityFrom},
    source::Source,
    transform::{Outcome, Transform},
    visuals::{Flight, FlightRecorder},
};

/// How many values are handed over at once, so that handing over costs little for each of them.
const BATCH: usize = 1024;

/// How many batches may wait for the sink, so that the job continues while the sink compresses a chunk, which takes as
/// long as deriving a few batches. More room would only use memory, because in the long run the slower side determines
/// the speed.
const BATCHES: usize = 4;

/// The thread that reads a log's telemetry and derives values from it. As an iterator it yields the values in batches.
/// It ends with the last one, or earlier if something goes wrong; [`finish`](Self::finish) returns which.
pub struct Job<'scope> {
    batches: Receiver<Batch>,
    /// See [`Reader::epoch_starts`].
    pub epoch_starts: Vec<usize>,
    thread: ScopedJoinHandle<'scope, Result<Derivation, Stopped>>,
}

/// Values of one epoch, in the order of their times.
pub struct Batch {
    pub epoch: u32,
    /// At least one.
    pub values: Vec<Derived>,
}

impl<'scope> Job<'scope> {
    /// Starts the thread. If the job is dropped, the thread ends, because it cannot send any more. With `flight`, it
    /// records the flight, too.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn start<'env>(
        scope: &'scope Scope<'scope, 'env>,
        log: &'env Log,
        source: Source,
        camera: Camera,
        options: &Options,
        flight: Option<FlightRecorder>,
        run: &'env Run,
    ) -> Result<Self, ReadError> {
        let reader = Reader::new(log, source)?;
        let transform = Transform::new(camera, options.max_gap)
            .thinned(options.min_interval)
            .with_velocity_from(options.telemetry.velocity_from);
        let deriving = Deriving {
            transform: match &flight {
                Some(_) => transform.with_moments(),
                None => transform,
            },
            flight,
            only_records_positions: options.telemetry.velocity_from != VelocityFrom::Position,
        };
        run.expect(reader.bytes_total());
        let (batches, taken) = mpsc::sync_channel(BATCHES);
        Ok(Self {
            batches: taken,
            epoch_starts: reader.epoch_starts(),
            thread: scope.spawn(move || derive(reader, deriving, &batches, run)),
        })
    }

    /// Passes all remaining batches to a sink.
    ///
    /// # Errors
    /// Those of the sink, and those of [`finish`](Self::finish).
    pub fn feed(self, sink: &mut impl Sink) -> Result<Derivation, Stopped> {
        for batch in &self.batches {
            sink.take(&batch)?;
        }
        self.finish()
    }

    /// Lets all batches pass.
    ///
    /// # Errors
    /// Those of [`finish`](Self::finish).
    pub fn run_to_end(mut self) -> Result<Derivation, Stopped> {
        self.by_ref().for_each(drop);
        self.finish()
    }

    /// Waits for the thread's end.
    ///
    /// # Errors
    /// The log cannot be read, or the run is cancelled.
    pub fn finish(self) -> Result<Derivation, Stopped> {
        // If the thread waits for room in the channel, this wakes it.
        drop(self.batches);
        let result = self.thread.join();
        result.unwrap_or_else(|panic| panic::resume_unwind(panic))
    }
}

impl Iterator for Job<'_> {
    type Item = Batch;

    fn next(&mut self) -> Option<Batch> {
        self.batches.recv().ok()
    }
}

/// The transform and, if it is wanted, what records the flight.
struct Deriving {
    transform: Transform,
    flight: Option<FlightRecorder>,
    /// Whether positions are only recorded, and no velocities are taken from them.
    only_records_positions: bool,
}

impl Deriving {
    /// Whether a sample is only recorded, and nothing is derived from it.
    fn only_records(&self, sample: &Sample) -> bool {
        match sample.kind() {
            Kind::Position => self.only_records_positions,
            kind => kind == Kind::Height,
        }
    }

    fn push(&mut self, sample: Sample, out: &mut Vec<Derived>) {
        let Self {
            transform, flight, ..
        } = self;
        if let Some(flight) = flight {
            flight.go_to(sample.stamp().log_time, |time| transform.ask(time));
            match &sample {
                Sample::Position(sample) => flight.take_position(sample),
                Sample::Height(sample) => flight.take_height(sample),
                _ => {}
            }
        }
        transform.push(sample, out);
        self.record();
    }

    fn begin_epoch(&mut self, out: &mut Vec<Derived>) {
        self.transform.begin_epoch(out);
        self.record();
        if let Some(flight) = &mut self.flight {
            flight.begin_epoch();
        }
    }

    fn finish(mut self, out: &mut Vec<Derived>) -> (Outcome, Option<Flight>) {
        let outcome = self.transform.finish(out);
        self.record();
        (outcome, self.flight.map(FlightRecorder::finish))
    }

    /// Records what the transform has found out.
    fn record(&mut self) {
        if let Some(flight) = &mut self.flight {
            self.transform
                .take_moments()
                .for_each(|moment| flight.take(moment));
        }
    }
}

/// The work of the job's thread.
fn derive(
    reader: Reader,
    mut deriving: Deriving,
    batches: &SyncSender<Batch>,
    run: &Run,
) -> Result<Derivation, Stopped> {
    let total = reader.bytes_total();
    // Sending waits while there is no room. It fails when the receiver is dropped. That is not an error of this thread:
    // the other side has one, or has stopped early.
    let hand_over = |epoch, derived: &mut Vec<Derived>, bytes_read| {
        let values = mem::replace(derived, Vec::with_capacity(BATCH));
        let batch = Batch { epoch, values };
        batches.send(batch).map_err(|_| Cancelled)?;
        run.read(bytes_read);
        run.go_on()
    };
    let mut derived = Vec::with_capacity(BATCH);
    let mut epoch = 0;
    let mut recorder = Box::<Recorder>::default();
    let read = reader.for_each(|arrival| {
        // Checked for each sample, because many of them may yield no value.
        run.go_on()?;
        if arrival.epoch != epoch {
            deriving.begin_epoch(&mut derived);
            if !derived.is_empty() {
                hand_over(epoch, &mut derived, arrival.bytes_read)?;
            }
            epoch = arrival.epoch;
        }
        if !deriving.only_records(&arrival.sample) {
            recorder.push(&arrival.sample);
        }
        deriving.push(arrival.sample, &mut derived);
        match derived.len() < BATCH {
            true => Ok(()),
            false => Ok::<_, Stopped>(hand_over(epoch, &mut derived, arrival.bytes_read)?),
        }
    })?;
    let (outcome, flight) = deriving.finish(&mut derived);
    if !derived.is_empty() {
        hand_over(epoch, &mut derived, total)?;
    }
    run.read(total);
    run.go_on()?;
    Ok(Derivation::new(read, outcome, recorder, flight))
}
