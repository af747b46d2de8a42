//! Runs of samples, each in order → all samples in order.

use std::{
    cmp::Ordering,
    collections::{BinaryHeap, binary_heap::PeekMut},
    mem, vec,
};

use super::{Arrival, Part};
use crate::{
    log::ReadError,
    sample::{Kind, Sample},
};

/// The samples that one segment has of one epoch.
pub struct Run {
    pub epoch: u32,
    pub samples: Vec<Sample>,
}

impl Run {
    /// Sorts the samples by time and kind; those that agree stay in the order of the file.
    pub fn sort(&mut self) {
        (self.samples).sort_by_key(|sample| (sample.stamp().log_time, sample.kind()));
    }
}

/// Those of a run that were not taken yet, at least one.
struct HeldRun {
    epoch: u32,
    next: Sample,
    others: vec::IntoIter<Sample>,
    /// The number of the segment.
    segment: usize,
}

impl HeldRun {
    fn new(segment: usize, run: Run) -> Option<Self> {
        let mut others = run.samples.into_iter();
        Some(Self {
            epoch: run.epoch,
            next: others.next()?,
            others,
            segment,
        })
    }

    fn place(&self) -> (u32, u64, Kind, usize) {
        let time = self.next.stamp().log_time;
        (self.epoch, time, self.next.kind(), self.segment)
    }
}

/// Reversed: `BinaryHeap` pops the greatest first.
impl Ord for HeldRun {
    fn cmp(&self, other: &Self) -> Ordering {
        other.place().cmp(&self.place())
    }
}

impl PartialOrd for HeldRun {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for HeldRun {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for HeldRun {}

/// Samples that wait until no earlier one can come.
#[derive(Default)]
pub struct Held(BinaryHeap<HeldRun>);

impl Held {
    /// Adds the sorted runs of a segment.
    pub fn extend(&mut self, segment: usize, runs: impl IntoIterator<Item = Run>) {
        let runs = runs.into_iter();
        self.0
            .extend(runs.filter_map(|run| HeldRun::new(segment, run)));
    }

    /// Takes the first sample and its epoch, if it is earlier than all that have not been read yet, which are of an
    /// epoch and from a time on.
    pub fn take_first(&mut self, unread_from: Option<(u32, u64)>) -> Option<(u32, Sample)> {
        let mut first = self.0.peek_mut()?;
        let (epoch, time, ..) = first.place();
        // At equal times, one that has not been read yet may be earlier in the file.
        if unread_from.is_some_and(|start| (epoch, time) >= start) {
            return None;
        }
        let sample = match first.others.next() {
            Some(next) => mem::replace(&mut first.next, next),
            None => PeekMut::pop(first).next,
        };
        Some((epoch, sample))
    }
}

/// Passes all samples to `take` in order. The n-th of `runs` are those of the n-th part, each sorted; they are requested
/// when all samples before its part's start have been taken.
pub fn merge<E: From<ReadError>>(
    parts: &[Part],
    runs: impl Iterator<Item = Result<Vec<Run>, ReadError>>,
    mut take: impl FnMut(Arrival) -> Result<(), E>,
) -> Result<(), E> {
    let mut held = Held::default();
    let mut bytes_read = 0;
    let starts = parts
        .iter()
        .skip(1)
        .map(|part| Some((part.epoch, part.start)))
        .chain([None]);
    for ((part, runs), unread_from) in parts.iter().zip(runs).zip(starts) {
        held.extend(part.number, runs?);
        bytes_read += part.segment.length;
        while let Some((epoch, sample)) = held.take_first(unread_from) {
            take(Arrival {
                sample,
                epoch,
                bytes_read,
            })?;
        }
    }
    Ok(())
}
