//! The log times of a channel's messages, without reading the messages if the log has indexes of them.

use std::collections::{BTreeMap, BTreeSet};

use super::{Log, SegmentReader, error::ReadError, message_index::message_index};

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
        self.for_each_message_time(channel_ids, |id, time| {
            times.entry(id).or_default().push(time);
        })?;
        times.values_mut().for_each(|times| times.sort_unstable());
        Ok(times)
    }

    /// The log times of the earliest and the latest message of some channels, by channel id.
    ///
    /// # Errors
    /// Those of [`message_times`](Self::message_times).
    pub fn message_time_ends(
        &self,
        channel_ids: &BTreeSet<u16>,
    ) -> Result<BTreeMap<u16, [u64; 2]>, ReadError> {
        let mut ends: BTreeMap<u16, [u64; 2]> = BTreeMap::new();
        self.for_each_message_time(channel_ids, |id, time| {
            let [start, end] = ends.entry(id).or_insert([time; 2]);
            (*start, *end) = (time.min(*start), time.max(*end));
        })?;
        Ok(ends)
    }

    /// Calls `visit` with the channel id and the log time of each message of some channels.
    fn for_each_message_time(
        &self,
        channel_ids: &BTreeSet<u16>,
        mut visit: impl FnMut(u16, u64),
    ) -> Result<(), ReadError> {
        let mut segments = SegmentReader::new(self);
        for segment in &self.contents.segments {
            let mut unindexed = segment.channels_among(channel_ids);
            for id in unindexed.clone() {
                if let Some(index) = message_index(&self.file, segment, id)? {
                    index.iter().for_each(|entry| visit(id, entry.log_time));
                    unindexed.remove(&id);
                }
            }
            if unindexed.is_empty() {
                continue;
            }
            for message in segments.read(segment, &unindexed)? {
                let message = message?;
                visit(message.channel_id, message.log_time);
            }
        }
        Ok(())
    }
}
