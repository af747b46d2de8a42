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
        let mut segments = SegmentReader::new(self);
        for segment in &self.contents.segments {
            let mut unindexed = segment.channels_among(channel_ids);
            for id in unindexed.clone() {
                if let Some(index) = message_index(&self.file, segment, id)? {
                    let logged = index.iter().map(|entry| entry.log_time);
                    times.entry(id).or_default().extend(logged);
                    unindexed.remove(&id);
                }
            }
            if unindexed.is_empty() {
                continue;
            }
            for message in segments.read(segment, &unindexed)? {
                let message = message?;
                let of_channel = times.entry(message.channel_id).or_default();
                of_channel.push(message.log_time);
            }
        }
        times.values_mut().for_each(|times| times.sort_unstable());
        Ok(times)
    }
}
