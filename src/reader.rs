//! Log + source → samples in time order, whatever their order in the file.
//!
//! Where the [clock](crate::clock) was set back, a new epoch begins: all samples of an epoch come before those of the
//! next.
//!
//! Segments are read in the order of their epoch and their earliest message, those of a long log by a few threads that
//! hold one segment each. A sample is passed on as soon as no unread segment can have an earlier one, so if segments do
//! not overlap, only the samples of that many segments are held. If they overlap, completely so in a log that was
//! written topic after topic, samples are held (less than a hundred bytes each), never segments. If the samples' times
//! are not log times, it is not known which segment has the earliest, so all samples are held until all segments are
//! read.

mod hold;
mod merge;
mod workers;

use crate::{
    clock::{ClockStep, LogEpochs, SampleTimes},
    log::{Log, ReadError, contents::Segment},
    sample::{Kind, Sample, Tallies},
    source::Source,
};

/// Reads a log's samples epoch by epoch, and in time order in each; at equal times in the order of their kinds, then of
/// the file.
pub struct Reader<'a> {
    log: &'a Log,
    source: Source,
    /// The segments that have telemetry, in the order of their starts.
    parts: Vec<Part<'a>>,
    /// The epochs of the messages, if the times of samples are log times.
    epochs: Option<LogEpochs>,
}

/// A segment that has telemetry.
#[derive(Debug, Clone, Copy)]
struct Part<'a> {
    /// No sample in it is of an earlier epoch,
    epoch: u32,
    /// and none is earlier.
    start: u64,
    /// The segment's number in the log.
    number: usize,
    segment: &'a Segment,
}

/// A sample, and how far reading has got.
#[derive(Debug, Clone, Copy)]
pub struct Arrival {
    /// The sample.
    pub sample: Sample,
    /// Its epoch.
    pub epoch: u32,
    /// How many of the [bytes](Reader::bytes_total) have been read.
    pub bytes_read: u64,
}

/// What is known when all samples have been read.
#[derive(Debug)]
pub struct ReadOut {
    /// Where the telemetry is, and what was noticed in its messages.
    pub source: Source,
    /// The samples that were dropped.
    pub dropped: Tallies,
    /// Where times go back.
    pub clock_steps: Vec<ClockStep>,
}

impl<'a> Reader<'a> {
    /// Reads the samples that `source` finds in `log`.
    ///
    /// # Errors
    /// The log cannot be read or is damaged.
    pub fn new(log: &'a Log, source: Source) -> Result<Self, ReadError> {
        let wanted = source.channel_ids();
        // Unless samples are in log time, nothing is known about their times before a segment is read.
        let epochs = match source.is_in_log_time() {
            true => Some(LogEpochs::of(log, &wanted)?),
            false => None,
        };
        let segments = log.contents.segments.iter().enumerate();
        let parts = segments.filter_map(|(number, segment)| {
            let channels = segment.channels_among(&wanted);
            let (start, _) = segment.times.filter(|_| !channels.is_empty())?;
            let place = epochs.as_ref().map(|epochs| {
                let epochs = epochs.in_segment(number);
                let first = channels.iter().map(|&id| epochs.epoch_here(id)).min();
                (first.unwrap_or(0), start)
            });
            let (epoch, start) = place.unwrap_or_default();
            Some(Part {
                epoch,
                start,
                number,
                segment,
            })
        });
        let mut parts: Vec<Part> = parts.collect();
        parts.sort_by_key(|part| (part.epoch, part.start, part.number));
        Ok(Self {
            log,
            source,
            parts,
            epochs,
        })
    }

    /// Bytes of the segments that have telemetry.
    pub fn bytes_total(&self) -> u64 {
        let segments = self.parts.iter().map(|part| part.segment);
        segments.map(|segment| segment.length).sum()
    }

    /// The numbers of the segments in which epochs begin, from the second one on; empty if that is not known, or if not
    /// all topics begin them together.
    pub fn epoch_starts(&self) -> Vec<usize> {
        let epochs = self.epochs.as_ref();
        epochs.map_or_else(Vec::new, |epochs| epochs.epochs.starts())
    }

    /// Reads all samples. `take` gets them one after the other.
    ///
    /// # Errors
    /// The log cannot be read or is damaged, or `take` fails, after which it is not called again.
    pub fn for_each<E: From<ReadError>>(
        self,
        take: impl FnMut(Arrival) -> Result<(), E>,
    ) -> Result<ReadOut, E> {
        let Self {
            log,
            source,
            parts,
            epochs,
        } = self;
        let mut clock_steps = Vec::new();
        let steps = &mut clock_steps;
        let times = SampleTimes::new(&source);
        let (source, mut dropped) = workers::read(log, source, &parts, epochs.as_ref(), |runs| {
            let Some(epochs) = &epochs else {
                *steps = hold::hold(&parts, times, runs, take)?;
                return Ok(());
            };
            merge::merge(&parts, runs, take)?;
            *steps = epochs.epochs.steps().to_vec();
            Ok::<_, E>(())
        })?;
        for kind in Kind::ALL {
            dropped[kind].unselected = source.unselected(kind);
        }
        Ok(ReadOut {
            source,
            dropped,
            clock_steps,
        })
    }
}
