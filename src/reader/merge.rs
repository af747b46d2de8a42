//! Runs of samples, each in order → all samples in order.

use std::{
    cmp::Ordering,
    collections::{BinaryHeap, binary_heap::PeekMut},
    mem, vec,
};

use super::Part;
use crate::{
    log::ReadError,
    sample::{Kind, Sample},
};

/// The samples of one segment that were not taken yet, at least one.
struct SampleRun {
    next: Sample,
    others: vec::IntoIter<Sample>,
    /// The segment's offset in the file.
    segment: u64,
}

impl SampleRun {
    fn new(segment: u64, samples: Vec<Sample>) -> Option<Self> {
        let mut others = samples.into_iter();
        Some(Self {
            next: others.next()?,
            others,
            segment,
        })
    }

    fn place(&self) -> (u64, Kind, u64) {
        (self.next.stamp().log_time, self.next.kind(), self.segment)
    }
}

/// Reversed: `BinaryHeap` pops the greatest first.
impl Ord for SampleRun {
    fn cmp(&self, other: &Self) -> Ordering {
        other.place().cmp(&self.place())
    }
}

impl PartialOrd for SampleRun {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for SampleRun {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for SampleRun {}

/// Passes all samples to `take` in order, each with the number of bytes read by then. The n-th of `runs` has those of
/// the n-th part, in the order of their times and kinds; it is requested when all samples before its part's start have
/// been taken.
pub fn merge<E: From<ReadError>>(
    parts: &[Part],
    runs: impl Iterator<Item = Result<Vec<Sample>, ReadError>>,
    mut take: impl FnMut(Sample, u64) -> Result<(), E>,
) -> Result<(), E> {
    let mut held = BinaryHeap::new();
    let mut bytes_read = 0;
    let starts = parts
        .iter()
        .skip(1)
        .map(|part| Some(part.start))
        .chain([None]);
    for ((part, samples), unread_from) in parts.iter().zip(runs).zip(starts) {
        held.extend(SampleRun::new(part.segment.offset, samples?));
        bytes_read += part.segment.length;
        while let Some(sample) = take_first(&mut held, unread_from) {
            take(sample, bytes_read)?;
        }
    }
    Ok(())
}

/// Takes the first sample, if it is earlier than all that have not been read yet.
fn take_first(held: &mut BinaryHeap<SampleRun>, unread_from: Option<u64>) -> Option<Sample> {
    let mut first = held.peek_mut()?;
    // At equal times, one that has not been read yet may be earlier in the file.
    if unread_from.is_some_and(|start| first.next.stamp().log_time >= start) {
        return None;
    }
    Some(match first.others.next() {
        Some(next) => mem::replace(&mut first.next, next),
        None => PeekMut::pop(first).next,
    })
}
