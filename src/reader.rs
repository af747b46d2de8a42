//! Log + source → samples in time order, whatever their order in the file.
//!
//! Segments are read in the order of their earliest message. A sample is handed on as soon as no unread
//! segment can hold an earlier one, so where segments do not overlap no more than one segment's samples are
//! held. Where they overlap, which logs that were written topic after topic do completely, samples are held
//! (about a hundred bytes each), never segments.

use std::{cmp::Reverse, collections::VecDeque};

use crate::{
    error::Error,
    log::{Log, SegmentReader, contents::Segment},
    sample::{Kind, Sample, Tally},
    source::Source,
};

/// Reads a log's samples in time order; at equal times attitude before velocity, then in the order of the
/// file.
pub struct Reader<'a> {
    source: Source,
    messages: SegmentReader<'a>,
    log: &'a Log,
    /// The segments that have telemetry, the one that starts last first.
    unread: Vec<(u64, &'a Segment)>,
    /// Samples that were read but not handed on, sorted.
    held: VecDeque<Held>,
    /// Samples that were read since `held` was sorted; none between two calls of `next`.
    fresh: Vec<Held>,
    dropped: Dropped,
    bytes_read: u64,
}

/// The messages that gave no sample.
#[derive(Debug, Clone, Default)]
pub struct Dropped {
    pub attitude: Tally,
    pub velocity: Tally,
}

/// A sample that waits for its turn, and its place in the file.
struct Held {
    sample: Sample,
    segment: u64,
    position: usize,
}

impl Held {
    fn time(&self) -> u64 {
        self.sample.stamp().log_time
    }

    fn key(&self) -> (u64, Kind, u64, usize) {
        (self.time(), self.sample.kind(), self.segment, self.position)
    }
}

impl<'a> Reader<'a> {
    pub fn new(log: &'a Log, source: Source) -> Self {
        let wanted = source.channel_ids();
        let has_telemetry =
            |segment: &Segment| segment.message_counts.keys().any(|id| wanted.contains(id));
        let mut unread: Vec<(u64, &Segment)> = log
            .contents
            .segments
            .iter()
            .filter(|segment| has_telemetry(segment))
            .filter_map(|segment| Some((segment.times?.0, segment)))
            .collect();
        unread.sort_by_key(|&(start, segment)| Reverse((start, segment.offset)));
        Self {
            source,
            messages: SegmentReader::new(log),
            log,
            unread,
            held: VecDeque::new(),
            fresh: Vec::new(),
            dropped: Dropped::default(),
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
    pub fn finish(self) -> (Source, Dropped) {
        (self.source, self.dropped)
    }

    fn read_segment(&mut self, start: u64, segment: &Segment) -> Result<(), Error> {
        for (position, message) in self.messages.read(segment)?.enumerate() {
            let message = message?;
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
                Ok(sample) => self.fresh.push(Held {
                    sample,
                    segment: segment.offset,
                    position,
                }),
                Err(reason) => {
                    let tally = match kind {
                        Kind::Attitude => &mut self.dropped.attitude,
                        Kind::Velocity => &mut self.dropped.velocity,
                    };
                    tally.count_dropped(reason, 1);
                }
            });
        }
        self.bytes_read += segment.length;
        Ok(())
    }
}

impl Iterator for Reader<'_> {
    type Item = Result<Sample, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut earliest = self.held.front().map(Held::time);
        // At equal times the unread segment may lie earlier in the file.
        while let Some(&(start, segment)) = self.unread.last()
            && earliest.is_none_or(|time| time >= start)
        {
            self.unread.pop();
            let before = self.fresh.len();
            if let Err(error) = self.read_segment(start, segment) {
                self.unread.clear();
                self.held.clear();
                self.fresh.clear();
                return Some(Err(error));
            }
            let fresh = self.fresh[before..].iter().map(Held::time);
            earliest = fresh.chain(earliest).min();
        }
        if !self.fresh.is_empty() {
            self.held.extend(self.fresh.drain(..));
            // What is held is in order already, and so, mostly, is a segment: little is left to do.
            self.held.make_contiguous().sort_by_key(Held::key);
        }
        self.held.pop_front().map(|held| Ok(held.sample))
    }
}
