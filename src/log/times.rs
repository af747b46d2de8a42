//! When the messages of a channel were logged, without reading the messages where the log has indexes of them.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{MessageIndex, op};

use super::{
    Log, SegmentReader,
    contents::{Segment, SegmentKind},
    record::{FRAME_LENGTH, parse, split_frame},
};
use crate::error::Error;

/// Log times by channel id.
type Times = BTreeMap<u16, Vec<u64>>;

impl Log {
    /// The log times of the messages of some channels, each channel's in order. Chunks that have message indexes
    /// are not opened.
    ///
    /// # Errors
    /// The log cannot be read or is damaged there.
    pub fn message_times(&self, channel_ids: &BTreeSet<u16>) -> Result<Times, Error> {
        let mut times = Times::new();
        let mut segments = SegmentReader::new(self);
        for segment in &self.contents.segments {
            let held = segment.message_counts.keys().copied();
            let wanted: Vec<u16> = held.filter(|id| channel_ids.contains(id)).collect();
            if !wanted.is_empty() && !self.add_indexed_times(segment, &wanted, &mut times)? {
                for message in segments.read(segment)? {
                    let (_, message) = message?;
                    if channel_ids.contains(&message.channel_id) {
                        let of_channel = times.entry(message.channel_id).or_default();
                        of_channel.push(message.log_time);
                    }
                }
            }
        }
        times.values_mut().for_each(|times| times.sort_unstable());
        Ok(times)
    }

    /// Adds the times that a segment's message indexes tell; tells whether it has such indexes.
    fn add_indexed_times(
        &self,
        segment: &Segment,
        wanted: &[u16],
        times: &mut Times,
    ) -> Result<bool, Error> {
        let SegmentKind::Chunk {
            index,
            is_indexed: true,
        } = &segment.kind
        else {
            return Ok(false);
        };
        for id in wanted {
            let Some(&offset) = index.record.message_index_offsets.get(id) else {
                continue;
            };
            let malformed = || self.file.corrupt(offset, "there should be a message index");
            let frame = self.file.read(offset, FRAME_LENGTH as u64)?;
            let length = match split_frame(&frame) {
                Some((op::MESSAGE_INDEX, length)) => length,
                _ => return Err(malformed()),
            };
            let body = self.file.read(offset + FRAME_LENGTH as u64, length)?;
            let index: MessageIndex = parse(&body).map_err(|_| malformed())?;
            let logged = index.records.iter().map(|entry| entry.log_time);
            times.entry(*id).or_default().extend(logged);
        }
        Ok(true)
    }
}
