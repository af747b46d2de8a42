//! Which topics take a step of a clock together.
//!
//! Topics that were recorded together, so that their messages alternate in the file, are stamped by one clock: where one
//! of them steps back, all begin a new epoch, even one with too few messages to show it. A topic that visibly runs on
//! there was stamped by another clock, and stays in its epoch; then the times of the two no longer belong together, and
//! nothing is computed from both until they step together again. Topics that a converter wrote one after the other do not
//! show what happened at the same time; their steps are matched by their number.

use std::collections::BTreeSet;

use serde::Serialize;

use super::series::{Place, Series, Step};
use crate::text::Foreign;

/// Where the times on a topic go back, although the file goes on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ClockStep {
    /// The topic.
    pub topic: Foreign,
    /// The number of the first message after the step, among the topic's in the order of the file, counted from 1; if
    /// the time of a sample is not its log time, only messages with a usable one are counted.
    pub message: u64,
    /// The latest time before the step, nanoseconds.
    pub before: u64,
    /// The time of that message, nanoseconds.
    pub after: u64,
}

impl ClockStep {
    /// By how much the time goes back, seconds.
    pub fn seconds(&self) -> f64 {
        (self.before - self.after) as f64 / 1e9
    }
}

/// The epochs of a log.
#[derive(Debug, Clone, Default)]
pub struct Epochs {
    /// Where epochs begin, in the order of the file.
    changes: Vec<Change>,
    steps: Vec<ClockStep>,
    /// Whether all topics that have messages were recorded together.
    is_one_recording: bool,
}

/// Where some series begin an epoch.
#[derive(Debug, Clone)]
struct Change {
    from: Place,
    epoch: u32,
    /// Their numbers.
    series: Vec<usize>,
}

/// The steps that some series take together.
struct CommonStep {
    from: Place,
    /// Nanoseconds.
    length: u64,
    series: BTreeSet<usize>,
}

impl Epochs {
    /// Finds the epochs of the messages on some topics.
    pub fn of(series: &[(Foreign, Series)]) -> Self {
        let mut found = Vec::new();
        for (number, (topic, series)) in series.iter().enumerate() {
            found.extend(series.steps().into_iter().map(|step| (number, topic, step)));
        }
        if found.is_empty() {
            return Self::default();
        }
        found.sort_by_key(|(_, _, step)| step.first);
        let recordings = recordings(series);
        let mut changes = Vec::new();
        for recording in &recordings {
            let of_recording = found
                .iter()
                .filter(|(number, ..)| recording.contains(number));
            let steps = common_steps(of_recording.map(|(number, _, step)| (*number, step)));
            changes.extend((1..).zip(steps).map(|(epoch, step)| {
                let takes_it = |number: &usize| {
                    step.series.contains(number)
                        || !series[*number].1.runs_on_through(step.from, step.length)
                };
                Change {
                    from: step.from,
                    epoch,
                    series: recording.iter().copied().filter(takes_it).collect(),
                }
            }));
        }
        changes.sort_by_key(|change| change.from);
        let step = |(_, topic, step): (usize, &Foreign, Step)| ClockStep {
            topic: topic.clone(),
            message: step.message,
            before: step.before,
            after: step.after,
        };
        let mut steps: Vec<ClockStep> = found.into_iter().map(step).collect();
        // Several kinds of sample may come from one message.
        steps.dedup();
        Self {
            changes,
            steps,
            is_one_recording: recordings.len() == 1,
        }
    }

    /// Where times go back, in the order of the file.
    pub fn steps(&self) -> &[ClockStep] {
        &self.steps
    }

    /// The numbers of the segments in which the epochs after the first one begin; empty unless they begin for all topics
    /// at the same place.
    pub fn starts(&self) -> Vec<usize> {
        let starts = self
            .changes
            .iter()
            .map(|change| change.from.segment as usize);
        starts.filter(|_| self.is_one_recording).collect()
    }

    /// The epochs at a place.
    pub fn at(&self, place: Place) -> Now<'_> {
        let mut now = Now {
            changes: &self.changes,
            epochs: Vec::new(),
        };
        now.go_to(place);
        now
    }
}

/// In which epoch each series is at some place.
#[derive(Debug, Clone)]
pub struct Now<'a> {
    /// The changes that come after it.
    changes: &'a [Change],
    /// As far as they are not 0.
    epochs: Vec<u32>,
}

impl Now<'_> {
    /// Goes on to a later place in the file.
    pub fn go_to(&mut self, place: Place) {
        while let [change, later @ ..] = self.changes
            && change.from <= place
        {
            for &number in &change.series {
                if self.epochs.len() <= number {
                    self.epochs.resize(number + 1, 0);
                }
                self.epochs[number] = change.epoch;
            }
            self.changes = later;
        }
    }

    /// The epoch in which a series is.
    pub fn epoch(&self, series: usize) -> u32 {
        self.epochs.get(series).copied().unwrap_or(0)
    }
}

/// Groups series whose places in the file overlap.
fn recordings(series: &[(Foreign, Series)]) -> Vec<Vec<usize>> {
    let ranges = series.iter().enumerate();
    let ranges = ranges.filter_map(|(number, (_, series))| Some((series.range()?, number)));
    let mut ranges: Vec<((Place, Place), usize)> = ranges.collect();
    ranges.sort_unstable();
    let mut recordings: Vec<Vec<usize>> = Vec::new();
    let mut end = None;
    for ((first, last), number) in ranges {
        match recordings.last_mut() {
            Some(recording) if Some(first) <= end => recording.push(number),
            _ => recordings.push(vec![number]),
        }
        end = end.max(Some(last));
    }
    recordings
}

/// Joins the steps of several series, given in the order of the file, that may be at the same place.
fn common_steps<'a>(steps: impl Iterator<Item = (usize, &'a Step)>) -> Vec<CommonStep> {
    let mut common: Vec<CommonStep> = Vec::new();
    for (number, step) in steps {
        let length = step.before - step.after;
        match common.last_mut() {
            Some(last) if step.last < last.from && !last.series.contains(&number) => {
                last.series.insert(number);
                last.length = last.length.max(length);
            }
            _ => common.push(CommonStep {
                from: step.first,
                length,
                series: BTreeSet::from([number]),
            }),
        }
    }
    common
}
