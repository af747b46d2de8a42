//! Log + source → samples in time order, whatever their order in the file.
//!
//! Segments are read in the order of their earliest message. A sample is handed on as soon as no unread
//! segment can hold an earlier one, so where segments do not overlap no more than one segment's samples are
//! held. Where they overlap, which logs that were written topic after topic do completely, samples are held
//! (about a hundred bytes each), never segments. Where the samples' times are not log times, nothing tells which
//! segment holds the earliest, so all samples are held until all segments are read.

use std::{
    cmp::Reverse,
    collections::{BinaryHeap, HashMap},
    vec,
};

use crate::{
    error::Error,
    log::{Log, SegmentReader, contents::Segment},
    sample::{Kind, Sample, Tallies},
    source::Source,
};

/// Reads a log's samples in time order; at equal times in the order of their kinds, then of the file.
pub struct Reader<'a> {
    source: Source,
    messages: SegmentReader<'a>,
    log: &'a Log,
    /// The segments that have telemetry, the one that starts last first.
    unread: Vec<(u64, &'a Segment)>,
    /// The samples of the segments that were read, sorted, by the segments' offsets.
    runs: HashMap<u64, vec::IntoIter<Held>>,
    /// The place in the order of the first sample of each run.
    heads: BinaryHeap<Reverse<Place>>,
    dropped: Tallies,
    bytes_read: u64,
}

/// A sample that waits for its turn, and its message's offset in the segment.
struct Held {
    sample: Sample,
    offset: u64,
}

/// Where a sample stands in the order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    time: u64,
    kind: Kind,
    /// Offset of the segment in the file.
    segment: u64,
    offset: u64,
}

impl Held {
    fn place(&self, segment: u64) -> Place {
        Place {
            time: self.sample.stamp().log_time,
            kind: self.sample.kind(),
            segment,
            offset: self.offset,
        }
    }
}

impl<'a> Reader<'a> {
    /// Over the samples that `source` finds in `log`.
    pub fn new(log: &'a Log, source: Source) -> Self {
        let wanted = source.channel_ids();
        let has_telemetry =
            |segment: &Segment| segment.message_counts.keys().any(|id| wanted.contains(id));
        // Without log times nothing is known of a segment before it is read.
        let is_in_log_time = source.is_in_log_time();
        let start_of = |(start, _): (u64, u64)| if is_in_log_time { start } else { 0 };
        let mut unread: Vec<(u64, &Segment)> = log
            .contents
            .segments
            .iter()
            .filter(|segment| has_telemetry(segment))
            .filter_map(|segment| Some((start_of(segment.times?), segment)))
            .collect();
        unread.sort_by_key(|&(start, segment)| Reverse((start, segment.offset)));
        Self {
            source,
            messages: SegmentReader::new(log),
            log,
            unread,
            runs: HashMap::new(),
            heads: BinaryHeap::new(),
            dropped: Tallies::default(),
            bytes_read: 0,
        }
    }

    /// Bytes of the segments that have telemetry.
    pub fn bytes_total(&self) -> u64 {
        let unread: u64 = self.unread.iter().map(|(_, segment)| segment.length).sum();
        self.bytes_read + unread
    }

    /// Of these, the bytes that were read.
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read
    }

    /// The source, and what was dropped, after the last sample.
    pub fn finish(self) -> (Source, Tallies) {
        (self.source, self.dropped)
    }

    fn read_segment(&mut self, start: u64, segment: &Segment) -> Result<(), Error> {
        let mut run = Vec::new();
        for message in self.messages.read(segment)? {
            let (offset, message) = message?;
            if message.log_time < start {
                return Err(self.log.file.corrupt(
                    segment.offset,
                    format!(
                        "the chunk there has a message at {}, but its index says that it starts at {start}",
                        message.log_time
                    ),
                ));
            }
            self.source.read(&message, |kind, sample| match sample {
                Ok(sample) => run.push(Held { sample, offset }),
                Err(reason) => self.dropped[kind].count_dropped(reason, 1),
            });
        }
        self.bytes_read += segment.length;
        run.sort_by_key(|held| held.place(segment.offset));
        if let Some(first) = run.first() {
            self.heads.push(Reverse(first.place(segment.offset)));
            self.runs.insert(segment.offset, run.into_iter());
        }
        Ok(())
    }

    /// Takes the sample that is first in the order of those that were read.
    fn pop(&mut self) -> Option<Sample> {
        let Reverse(first) = self.heads.pop()?;
        let run = self.runs.get_mut(&first.segment)?;
        let held = run.next()?;
        match run.as_slice().first() {
            Some(next) => self.heads.push(Reverse(next.place(first.segment))),
            None => drop(self.runs.remove(&first.segment)),
        }
        Some(held.sample)
    }
}

impl Iterator for Reader<'_> {
    type Item = Result<Sample, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        // At equal times the unread segment may lie earlier in the file.
        while let Some(&(start, segment)) = self.unread.last()
            && (self.heads.peek()).is_none_or(|Reverse(first)| first.time >= start)
        {
            self.unread.pop();
            if let Err(error) = self.read_segment(start, segment) {
                self.unread.clear();
                self.heads.clear();
                return Some(Err(error));
            }
        }
        self.pop().map(Ok)
    }
}
