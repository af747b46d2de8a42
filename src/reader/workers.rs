//! Segments → runs of samples, on several threads.

use std::{
    collections::{BTreeMap, BTreeSet},
    panic,
    sync::mpsc,
    thread::{self, available_parallelism},
};

use super::{Part, merge::Run};
use crate::{
    clock::LogEpochs,
    log::{Damage, Log, ReadError, SegmentReader},
    sample::{Sample, Tallies},
    source::Source,
};

/// More threads than this would only wait for the disk, or for the one that takes the samples.
const MOST_WORKERS: usize = 3;

/// Reading fewer bytes than this takes about as long as starting threads.
const WORTH_THREADS: u64 = 4 * 1024 * 1024;

/// Reads the samples of one part after the other, reusing its buffers.
struct Worker<'a> {
    log: &'a Log,
    segments: SegmentReader<'a>,
    wanted: BTreeSet<u16>,
    source: Source,
    /// The epochs of the messages, if the times of samples are log times.
    epochs: Option<&'a LogEpochs>,
    dropped: Tallies,
}

impl<'a> Worker<'a> {
    fn new(log: &'a Log, source: Source, epochs: Option<&'a LogEpochs>) -> Self {
        Self {
            log,
            segments: SegmentReader::new(log),
            wanted: source.channel_ids(),
            source,
            epochs,
            dropped: Tallies::default(),
        }
    }

    /// Reads the samples of a part: one run for each epoch, sorted, or all in the order of the file if the epochs are not
    /// known.
    fn read(&mut self, part: &Part) -> Result<Vec<Run>, ReadError> {
        let &Part { start, segment, .. } = part;
        let mut epochs = self.epochs.map(|epochs| epochs.in_segment(part.number));
        let mut samples: BTreeMap<u32, Vec<Sample>> = BTreeMap::new();
        for (number, message) in self.segments.read(segment, &self.wanted)?.enumerate() {
            let message = message?;
            if message.log_time < start {
                let damage = Damage::EarlierThanIndexed {
                    message: message.log_time,
                    index: start,
                };
                return Err(self.log.file.damaged(segment.offset, damage));
            }
            let epoch = (epochs.as_mut()).map(|epochs| epochs.epoch(number, message.channel_id));
            let of_epoch = samples.entry(epoch.unwrap_or(0)).or_default();
            self.source.read(&message, |kind, sample| match sample {
                Ok(sample) => of_epoch.push(sample),
                Err(reason) => self.dropped[kind].count_dropped(reason, 1),
            });
        }
        let runs = samples.into_iter().map(|(epoch, samples)| {
            let mut run = Run { epoch, samples };
            if self.epochs.is_some() {
                run.sort();
            }
            run
        });
        Ok(runs.collect())
    }
}

/// The number of workers worth starting for these parts.
fn worthwhile_workers(parts: &[Part]) -> usize {
    let bytes: u64 = parts.iter().map(|part| part.segment.length).sum();
    if bytes < WORTH_THREADS {
        return 1;
    }
    let cores = available_parallelism().map_or(1, |cores| cores.get());
    cores.min(MOST_WORKERS).min(parts.len())
}

/// The samples of each part in turn.
pub type Runs<'r> = &'r mut dyn Iterator<Item = Result<Vec<Run>, ReadError>>;

/// Reads the samples of all parts, passes them to `take`, and returns the source and what was dropped.
///
/// The workers read the parts in turn, and hand over the samples of one part at a time, through a zero-capacity
/// channel: each continues only when its samples have been taken. So each holds those of one part at most, and an error
/// is that of the first part that has one, whichever worker is faster.
pub fn read<E: From<ReadError>>(
    log: &Log,
    mut source: Source,
    parts: &[Part],
    epochs: Option<&LogEpochs>,
    take: impl FnOnce(Runs) -> Result<(), E>,
) -> Result<(Source, Tallies), E> {
    let count = worthwhile_workers(parts);
    if count == 1 {
        let mut worker = Worker::new(log, source, epochs);
        take(&mut parts.iter().map(|part| worker.read(part)))?;
        return Ok((worker.source, worker.dropped));
    }
    thread::scope(|scope| {
        let (workers, results): (Vec<_>, Vec<_>) = (0..count)
            .map(|first| {
                let (done, result) = mpsc::sync_channel(0);
                let mut worker = Worker::new(log, source.clone(), epochs);
                let work = move || {
                    for part in parts.iter().skip(first).step_by(count) {
                        // After an error, or if `take` has failed, the receiver is gone.
                        if done.send(worker.read(part)).is_err() {
                            break;
                        }
                    }
                    worker
                };
                (scope.spawn(work), result)
            })
            .unzip();
        // A worker that ends before it has read its parts has panicked. The panic is resumed when it is joined.
        let mut runs = results
            .iter()
            .cycle()
            .map_while(|result| result.recv().ok());
        let taken = take(&mut runs);
        drop(results);
        let mut dropped = Tallies::default();
        for worker in workers {
            let worker = worker
                .join()
                .unwrap_or_else(|panicked| panic::resume_unwind(panicked));
            source.merge(&worker.source);
            dropped.merge(&worker.dropped);
        }
        taken.map(|()| (source, dropped))
    })
}
