//! Samples whose times are not log times: all are held, because only they themselves show their order and their epochs.

use std::collections::BTreeMap;

use super::{
    Arrival, Part,
    merge::{Held, Run},
};
use crate::{
    clock::{ClockStep, Place, SampleTimes, series_of},
    log::ReadError,
    sample::Sample,
};

/// Passes all samples to `take` in order. The n-th of `runs` has those of the n-th part, in the order of the file, as
/// the parts are; `times` has no sample yet. Returns where times go back.
pub fn hold<E: From<ReadError>>(
    parts: &[Part],
    mut times: SampleTimes,
    runs: impl Iterator<Item = Result<Vec<Run>, ReadError>>,
    mut take: impl FnMut(Arrival) -> Result<(), E>,
) -> Result<Vec<ClockStep>, E> {
    let mut read = Vec::new();
    for (part, runs) in parts.iter().zip(runs) {
        let samples: Vec<Sample> = runs?.into_iter().flat_map(|run| run.samples).collect();
        for (place, sample) in places(part, &samples) {
            times.push(place, sample);
        }
        read.push(samples);
    }
    let epochs = times.epochs();
    let mut now = epochs.at(Place::new(0, 0));
    let mut held = Held::default();
    for (part, samples) in parts.iter().zip(read) {
        let mut by_epoch: BTreeMap<u32, Vec<Sample>> = BTreeMap::new();
        for (place, sample) in places(part, &samples) {
            now.go_to(place);
            let of_epoch = by_epoch.entry(now.epoch(series_of(sample)));
            of_epoch.or_default().push(*sample);
        }
        let runs = by_epoch.into_iter().map(|(epoch, samples)| {
            let mut run = Run { epoch, samples };
            run.sort();
            run
        });
        held.extend(part.number, runs);
    }
    let bytes_read = parts.iter().map(|part| part.segment.length).sum();
    while let Some((epoch, sample)) = held.take_first(None) {
        take(Arrival {
            sample,
            epoch,
            bytes_read,
        })?;
    }
    Ok(epochs.steps().to_vec())
}

fn places<'s>(part: &Part, samples: &'s [Sample]) -> impl Iterator<Item = (Place, &'s Sample)> {
    let segment = part.number;
    let samples = samples.iter().enumerate();
    samples.map(move |(message, sample)| (Place::new(segment, message), sample))
}
