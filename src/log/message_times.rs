//! The log times of a channel's messages, without reading the messages if the log has indexes of them.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet},
};

use super::{
    Log, SegmentReader, contents::Segment, error::ReadError, message_index::message_index,
};

impl Log {
    /// The log times of the messages of some channels, by channel id, those of each channel in order. A chunk is opened
    /// only if one of these channels has no complete message index there.
    ///
    /// # Errors
    /// The log cannot be read or is damaged there.
    pub fn message_times(
        &self,
        channel_ids: &BTreeSet<u16>,
    ) -> Result<BTreeMap<u16, Vec<u64>>, ReadError> {
        let mut times: BTreeMap<u16, Vec<u64>> = BTreeMap::new();
        let mut reader = SegmentReader::new(self);
        for segment in &self.contents.segments {
            let here = segment.channels_among(channel_ids);
            reader.for_each_time(segment, here, |id, time| {
                times.entry(id).or_default().push(time);
            })?;
        }
        times.values_mut().for_each(|times| times.sort_unstable());
        Ok(times)
    }

    /// The log times of the earliest and the latest message of some channels, by channel id, of those from one time to
    /// another. Only those segments are looked into that may have one of them, by their own times.
    ///
    /// # Errors
    /// Those of [`message_times`](Self::message_times).
    pub fn message_time_ends(
        &self,
        channel_ids: &BTreeSet<u16>,
        [from, to]: [u64; 2],
    ) -> Result<BTreeMap<u16, [u64; 2]>, ReadError> {
        let mut ends = Ends {
            reader: SegmentReader::new(self),
            within: [from, to],
            ends: BTreeMap::new(),
            seen: BTreeSet::new(),
        };
        let segments = self.contents.segments.iter();
        let timed = segments.filter_map(|segment| Some((segment.times?, segment)));
        let mut timed: Vec<((u64, u64), &Segment)> = timed
            .filter(|((start, end), _)| *start <= to && *end >= from)
            .collect();
        timed.sort_by_key(|((start, _), _)| *start);
        let mut pending = channel_ids.clone();
        for ((start, _), segment) in &timed {
            pending.retain(|id| ends.of(*id).is_none_or(|[earliest, _]| *start < earliest));
            ends.look_into(segment, &pending)?;
        }
        timed.sort_by_key(|((_, end), _)| Reverse(*end));
        let mut pending = channel_ids.clone();
        for ((_, end), segment) in &timed {
            pending.retain(|id| ends.of(*id).is_none_or(|[_, latest]| *end > latest));
            ends.look_into(segment, &pending)?;
        }
        Ok(ends.ends)
    }
}

/// The search for the earliest and the latest messages of channels.
struct Ends<'a> {
    reader: SegmentReader<'a>,
    /// The first and the last time that counts.
    within: [u64; 2],
    ends: BTreeMap<u16, [u64; 2]>,
    /// The offsets of segments, with the channels that were looked for there.
    seen: BTreeSet<(u64, u16)>,
}

impl Ends<'_> {
    fn of(&self, id: u16) -> Option<[u64; 2]> {
        self.ends.get(&id).copied()
    }

    /// Takes the messages that a segment has on some channels.
    fn look_into(
        &mut self,
        segment: &Segment,
        channel_ids: &BTreeSet<u16>,
    ) -> Result<(), ReadError> {
        let mut here = segment.channels_among(channel_ids);
        here.retain(|id| self.seen.insert((segment.offset, *id)));
        let [from, to] = self.within;
        self.reader.for_each_time(segment, here, |id, time| {
            if (from..=to).contains(&time) {
                let [start, end] = self.ends.entry(id).or_insert([time; 2]);
                (*start, *end) = (time.min(*start), time.max(*end));
            }
        })
    }
}

impl SegmentReader<'_> {
    /// Calls `visit` with the channel id and the log time of each message that a segment has on these channels. The
    /// segment is opened only if it has no complete message index of one of them.
    ///
    /// # Errors
    /// The segment cannot be read or is damaged.
    pub fn for_each_time(
        &mut self,
        segment: &Segment,
        mut channel_ids: BTreeSet<u16>,
        mut visit: impl FnMut(u16, u64),
    ) -> Result<(), ReadError> {
        for id in channel_ids.clone() {
            if let Some(index) = message_index(self.file, segment, id)? {
                index.iter().for_each(|entry| visit(id, entry.log_time));
                channel_ids.remove(&id);
            }
        }
        if channel_ids.is_empty() {
            return Ok(());
        }
        for message in self.read(segment, &channel_ids)? {
            let message = message?;
            visit(message.channel_id, message.log_time);
        }
        Ok(())
    }
}
