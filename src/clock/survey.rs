//! The epochs of a log, from the times of its messages or of the samples in them.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    epochs::{Epochs, Now},
    series::{LATE, Place, Series},
};
use crate::{
    log::{Log, ReadError, SegmentReader},
    sample::{Kind, Sample},
    source::Source,
    text::Foreign,
};

/// The epochs of a log's messages by their log times.
#[derive(Debug, Clone, Default)]
pub struct LogEpochs {
    /// The epochs themselves.
    pub epochs: Epochs,
    /// The number of each channel's topic; empty if there is only one epoch.
    topics: BTreeMap<u16, usize>,
}

/// The epochs of the messages of one segment.
pub struct InSegment<'a> {
    segment: usize,
    now: Now<'a>,
    topics: &'a BTreeMap<u16, usize>,
}

impl LogEpochs {
    /// Finds the epochs of the messages on some channels. Unless time goes back on a topic, no message is read: the scan
    /// of a log, or its message indexes, show that.
    ///
    /// # Errors
    /// The log cannot be read or is damaged there.
    pub fn of(log: &Log, wanted: &BTreeSet<u16>) -> Result<Self, ReadError> {
        let mut by_topic: BTreeMap<&str, BTreeSet<u16>> = BTreeMap::new();
        for channel in log.contents.definitions.channels.values() {
            let channel = &channel.record;
            if wanted.contains(&channel.id) {
                let of_topic = by_topic.entry(&channel.topic).or_default();
                of_topic.insert(channel.id);
            }
        }
        let goes_back = |channels| log.goes_back(channels, LATE);
        if !any(by_topic.values().map(goes_back))? {
            return Ok(Self::default());
        }
        let mut series = Vec::new();
        let mut topics = BTreeMap::new();
        for (number, (topic, channels)) in by_topic.into_iter().enumerate() {
            series.push((Foreign::from(topic), Series::default()));
            topics.extend(channels.into_iter().map(|id| (id, number)));
        }
        let mut segments = SegmentReader::new(log);
        for (number, segment) in log.contents.segments.iter().enumerate() {
            if segment.channels_among(wanted).is_empty() {
                continue;
            }
            for (message, read) in segments.read(segment, wanted)?.enumerate() {
                let read = read?;
                if let Some(&topic) = topics.get(&read.channel_id) {
                    let place = Place::new(number, message);
                    series[topic].1.push(place, read.log_time);
                }
            }
        }
        let epochs = Epochs::of(&series);
        Ok(Self { epochs, topics })
    }

    /// The epochs in a segment, from its start on.
    pub fn in_segment(&self, segment: usize) -> InSegment<'_> {
        InSegment {
            segment,
            now: self.epochs.at(Place::new(segment, 0)),
            topics: &self.topics,
        }
    }
}

impl InSegment<'_> {
    /// The epoch of a message, given the number of it among those that are read from the segment.
    pub fn epoch(&mut self, message: usize, channel_id: u16) -> u32 {
        self.now.go_to(Place::new(self.segment, message));
        self.epoch_here(channel_id)
    }

    /// The epoch that a channel is in.
    pub fn epoch_here(&self, channel_id: u16) -> u32 {
        let topic = self.topics.get(&channel_id);
        topic.map_or(0, |&topic| self.now.epoch(topic))
    }
}

/// The times of samples in the order of the file, where they are not log times.
pub struct SampleTimes(Vec<(Foreign, Series)>);

impl SampleTimes {
    /// Starts with the first sample of a source.
    pub fn new(source: &Source) -> Self {
        let topic = |kind| source.role(kind).map(|role| role.topic.clone());
        let series = |kind| (topic(kind).unwrap_or_default(), Series::default());
        Self(Kind::ALL.map(series).into())
    }

    /// Takes the next sample.
    pub fn push(&mut self, place: Place, sample: &Sample) {
        self.0[series_of(sample)]
            .1
            .push(place, sample.stamp().log_time);
    }

    /// The epochs of the samples.
    pub fn epochs(&self) -> Epochs {
        Epochs::of(&self.0)
    }
}

/// The number of the series that a sample belongs to.
pub fn series_of(sample: &Sample) -> usize {
    sample.kind() as usize
}

fn any(mut results: impl Iterator<Item = Result<bool, ReadError>>) -> Result<bool, ReadError> {
    results
        .find(|result| !matches!(result, Ok(false)))
        .unwrap_or(Ok(false))
}
