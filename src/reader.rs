//! Log + source → samples in time order, whatever their order in the file.
//!
//! Segments are read in the order of their earliest message, those of a long log by a few threads that hold one
//! segment each. A sample is passed on as soon as no unread segment can have an earlier one, so if segments do not
//! overlap, only the samples of that many segments are held. If they overlap, completely so in a log that was written
//! topic after topic, samples are held (less than a hundred bytes each), never segments. If the samples' times are not
//! log times, it is not known which segment has the earliest, so all samples are held until all segments are read.

mod merge;
mod workers;

use crate::{
    log::{Log, ReadError, contents::Segment},
    sample::{Kind, Sample, Tallies},
    source::Source,
};

/// Reads a log's samples in time order; at equal times in the order of their kinds, then of the file.
pub struct Reader<'a> {
    log: &'a Log,
    source: Source,
    /// The segments that have telemetry, in the order of their starts.
    parts: Vec<Part<'a>>,
}

/// A segment that has telemetry.
#[derive(Debug, Clone, Copy)]
struct Part<'a> {
    /// No sample in it is earlier.
    start: u64,
    segment: &'a Segment,
}

impl<'a> Reader<'a> {
    /// Reads the samples that `source` finds in `log`.
    pub fn new(log: &'a Log, source: Source) -> Self {
        let wanted = source.channel_ids();
        // Unless samples are in log time, nothing is known about their times before a segment is read.
        let is_in_log_time = source.is_in_log_time();
        let start_of = |(start, _): (u64, u64)| if is_in_log_time { start } else { 0 };
        let mut parts: Vec<Part> = (log.contents.segments.iter())
            .filter(|segment| !segment.channels_among(&wanted).is_empty())
            .filter_map(|segment| {
                let start = start_of(segment.times?);
                Some(Part { start, segment })
            })
            .collect();
        parts.sort_by_key(|part| (part.start, part.segment.offset));
        Self { log, source, parts }
    }

    /// Bytes of the segments that have telemetry.
    pub fn bytes_total(&self) -> u64 {
        let segments = self.parts.iter().map(|part| part.segment);
        segments.map(|segment| segment.length).sum()
    }

    /// Reads all samples. `take` gets them one after the other, each with how many of the [bytes](Self::bytes_total)
    /// had been read by then. Returns the source, and what was dropped.
    ///
    /// # Errors
    /// The log cannot be read or is damaged, or `take` fails, after which it is not called again.
    pub fn for_each<E: From<ReadError>>(
        self,
        take: impl FnMut(Sample, u64) -> Result<(), E>,
    ) -> Result<(Source, Tallies), E> {
        let (source, mut dropped) = workers::read(self.log, self.source, &self.parts, take)?;
        for kind in Kind::ALL {
            dropped[kind].unselected = source.unselected(kind);
        }
        Ok((source, dropped))
    }
}
