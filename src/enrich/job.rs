//! Samples → derived values, on a thread of its own.

use std::{
    mem, panic,
    sync::mpsc::{self, Receiver, SyncSender},
    thread::{Scope, ScopedJoinHandle},
};

use super::Sink;
use crate::{
    camera::Camera,
    derived::Derived,
    log::Log,
    options::Options,
    reader::Reader,
    run::{Cancelled, Run, Stopped},
    sample::Tallies,
    source::Source,
    transform::{Outcome, Transform},
};

/// How many values are handed over at once: enough that the threads seldom wait for each other's lock.
const BATCH: usize = 1024;

/// How many batches may wait to be taken. While the sink compresses a chunk, which takes as long as deriving a few
/// batches, the job need not stop; more would only fill memory, because in the long run the slower of the two decides.
const BATCHES: usize = 4;

/// Reading a log's telemetry and deriving what follows from it. As an iterator it gives the derived values in
/// batches, up to the last or until something goes wrong, which [`finish`](Self::finish) tells.
pub struct Job<'scope> {
    batches: Receiver<Vec<Derived>>,
    thread: ScopedJoinHandle<'scope, Result<Derivation, Stopped>>,
}

/// What is known once all telemetry is read.
pub struct Derivation {
    /// Where the telemetry is, and what its messages taught of that.
    pub source: Source,
    /// The samples that the reader dropped.
    pub dropped: Tallies,
    /// What the transform made of the others.
    pub outcome: Outcome,
}

impl Derivation {
    /// What became of all samples.
    pub fn outcome(self) -> Outcome {
        let mut outcome = self.outcome;
        outcome.tallies.merge(&self.dropped);
        outcome
    }
}

impl<'scope> Job<'scope> {
    /// Starts the thread. It ends when the job is dropped, because then nobody takes its batches any more.
    pub fn start<'env>(
        scope: &'scope Scope<'scope, 'env>,
        log: &'env Log,
        source: Source,
        camera: Camera,
        options: &Options,
        run: &'env Run,
    ) -> Self {
        let reader = Reader::new(log, source);
        let transform = Transform::new(camera, options.max_gap);
        run.expect(reader.bytes_total());
        let (batches, taken) = mpsc::sync_channel(BATCHES);
        Self {
            batches: taken,
            thread: scope.spawn(move || derive(reader, transform, &batches, run)),
        }
    }

    /// Hands all batches that are left to a sink.
    ///
    /// # Errors
    /// Those of the sink, and those of [`finish`](Self::finish).
    pub fn feed(self, sink: &mut impl Sink) -> Result<Derivation, Stopped> {
        for batch in &self.batches {
            sink.take(&batch)?;
        }
        self.finish()
    }

    /// What is known once all telemetry is read.
    ///
    /// # Errors
    /// The log cannot be read, or the run is cancelled.
    pub fn finish(self) -> Result<Derivation, Stopped> {
        // A thread that waits for room in the channel is to notice that nobody takes anything any more.
        drop(self.batches);
        let result = self.thread.join();
        result.unwrap_or_else(|panic| panic::resume_unwind(panic))
    }
}

impl Iterator for Job<'_> {
    type Item = Vec<Derived>;

    fn next(&mut self) -> Option<Vec<Derived>> {
        self.batches.recv().ok()
    }
}

/// Reads, derives and hands over.
fn derive(
    reader: Reader,
    mut transform: Transform,
    batches: &SyncSender<Vec<Derived>>,
    run: &Run,
) -> Result<Derivation, Stopped> {
    let total = reader.bytes_total();
    // Waits while there is no room. That there will be none ever again is no error of this thread: whoever took the
    // batches has one, or wants no more.
    let hand_over = |derived: &mut Vec<Derived>, bytes_read| {
        batches.send(mem::take(derived)).map_err(|_| Cancelled)?;
        run.read(bytes_read);
        run.go_on()
    };
    let mut derived = Vec::with_capacity(BATCH);
    let (source, dropped) = reader.for_each(|sample, bytes_read| {
        // Asked for each sample, because many may come of which nothing follows.
        run.go_on()?;
        transform.push(sample, &mut derived);
        match derived.len() < BATCH {
            true => Ok(()),
            false => Ok::<_, Stopped>(hand_over(&mut derived, bytes_read)?),
        }
    })?;
    if !derived.is_empty() {
        hand_over(&mut derived, total)?;
    }
    run.read(total);
    run.go_on()?;
    Ok(Derivation {
        source,
        dropped,
        outcome: transform.finish(),
    })
}
