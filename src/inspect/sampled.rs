//! What can be learnt from the telemetry's messages without reading all of a long log.

use std::collections::BTreeMap;

use crate::{
    clock::{ClockStep, Epochs, LogEpochs, Place, SampleTimes},
    error::Error,
    log::{Log, SegmentReader, contents::Segment},
    sample::{Kind, Sample, Tallies},
    source::Source,
};

/// The most bytes, approximately, that are read to learn what share of the telemetry is usable.
const MOST_READ: u64 = 64 * 1024 * 1024;

/// What was learnt from some of the telemetry's messages.
pub struct Sampled {
    /// How many samples were usable, and how many not.
    pub tallies: Tallies,
    /// The earliest usable sample of each kind.
    pub first: BTreeMap<Kind, Sample>,
    /// The times of all samples, if all messages were read and these are not log times.
    times: Option<SampleTimes>,
}

impl Sampled {
    /// Reads segments with telemetry: all or, if they are too long, some that are spread evenly among them.
    pub fn read(log: &Log, source: &mut Source) -> Result<Self, Error> {
        let wanted = source.channel_ids();
        let segments: Vec<(usize, &Segment)> = (log.contents.segments.iter().enumerate())
            .filter(|(_, segment)| !segment.channels_among(&wanted).is_empty())
            .collect();
        let length: u64 = segments.iter().map(|(_, segment)| segment.length).sum();
        let share = (MOST_READ as f64 / length as f64).min(1.0);
        let mut reader = SegmentReader::new(log);
        let mut sampled = Self {
            tallies: Tallies::default(),
            first: BTreeMap::new(),
            times: (share == 1.0 && !source.is_in_log_time()).then(|| SampleTimes::new(source)),
        };
        let (mut passed, mut read) = (0, 0);
        for (number, segment) in segments {
            let is_due = read as f64 <= share * passed as f64;
            passed += segment.length;
            if !is_due {
                continue;
            }
            read += segment.length;
            let mut samples = 0;
            for message in reader.read(segment, &wanted)? {
                source.read(&message?, |kind, sample| match sample {
                    Ok(sample) => {
                        sampled.tallies[kind].used += 1;
                        if let Some(times) = &mut sampled.times {
                            times.push(Place::new(number, samples), &sample);
                            samples += 1;
                        }
                        let first = sampled.first.entry(kind).or_insert(sample);
                        if sample.stamp().log_time < first.stamp().log_time {
                            *first = sample;
                        }
                    }
                    Err(reason) => sampled.tallies[kind].count_dropped(reason, 1),
                });
            }
        }
        for kind in Kind::ALL {
            sampled.tallies[kind].unselected = source.unselected(kind);
        }
        Ok(sampled)
    }

    /// Where the time of the telemetry goes back, as far as that is known.
    pub fn clock_steps(&self, log: &Log, source: &Source) -> Result<Vec<ClockStep>, Error> {
        let epochs = match &self.times {
            Some(times) => times.epochs(),
            None if source.is_in_log_time() => LogEpochs::of(log, &source.channel_ids())?.epochs,
            None => Epochs::default(),
        };
        Ok(epochs.steps().to_vec())
    }
}
