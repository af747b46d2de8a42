//! When the messages of a channel were logged, without reading the messages where the log has indexes of them.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{MessageIndex, op};

use super::{
    Log, SegmentReader,
    contents::{Segment, SegmentKind},
    record::{FRAME_LENGTH, parse, split_frame},
    summary::{MESSAGE_INDEX_ENTRY, MESSAGE_INDEX_PREFIX},
};
use crate::error::Error;

impl Log {
    /// The log times of the messages of some channels, by channel id, each channel's in order. A chunk is opened
    /// only if one of these channels has no message index there that says as much as it should.
    ///
    /// # Errors
    /// The log cannot be read or is damaged there.
    pub fn message_times(
        &self,
        channel_ids: &BTreeSet<u16>,
    ) -> Result<BTreeMap<u16, Vec<u64>>, Error> {
        let mut times: BTreeMap<u16, Vec<u64>> = BTreeMap::new();
        let mut segments = SegmentReader::new(self);
        for segment in &self.contents.segments {
            let mut unindexed = BTreeSet::new();
            for (&id, &count) in &segment.message_counts {
                if !channel_ids.contains(&id) {
                    continue;
                }
                match self.indexed_times(segment, id, count)? {
                    Some(indexed) => times.entry(id).or_default().extend(indexed),
                    None => _ = unindexed.insert(id),
                }
            }
            if unindexed.is_empty() {
                continue;
            }
            for message in segments.read(segment)? {
                let (_, message) = message?;
                if unindexed.contains(&message.channel_id) {
                    let of_channel = times.entry(message.channel_id).or_default();
                    of_channel.push(message.log_time);
                }
            }
        }
        times.values_mut().for_each(|times| times.sort_unstable());
        Ok(times)
    }

    /// The times that a segment's message index tells of a channel that has so many messages there; `None` where
    /// there is no such index, or one of something else.
    fn indexed_times(
        &self,
        segment: &Segment,
        channel_id: u16,
        count: u64,
    ) -> Result<Option<impl Iterator<Item = u64> + use<>>, Error> {
        let SegmentKind::Chunk { index, .. } = &segment.kind else {
            return Ok(None);
        };
        let offsets = &index.record.message_index_offsets;
        let Some(&offset) = offsets.get(&channel_id) else {
            return Ok(None);
        };
        // So long as the count demands, whatever length the record itself claims.
        let length = MESSAGE_INDEX_PREFIX + count * MESSAGE_INDEX_ENTRY;
        if offset.saturating_add(length) > self.file.len() {
            return Ok(None);
        }
        let record = self.file.read(offset, length)?;
        let (frame, body) = record.split_at(FRAME_LENGTH);
        let index = split_frame(frame)
            .filter(|(opcode, _)| *opcode == op::MESSAGE_INDEX)
            .and_then(|_| parse::<MessageIndex>(body).ok())
            .filter(|index| index.channel_id == channel_id && index.records.len() as u64 == count);
        Ok(index.map(|index| index.records.into_iter().map(|entry| entry.log_time)))
    }
}
