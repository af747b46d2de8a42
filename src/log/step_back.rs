//! Whether the log times of a topic go back, in the order of the file.

use std::collections::BTreeSet;

use super::{
    Log, SegmentReader,
    contents::Segment,
    error::ReadError,
    message_index::{IndexEntries, message_index},
};

/// The log times of the messages of one series, one after the other.
#[derive(Debug, Clone, Copy, Default)]
pub struct StepBack {
    latest: u64,
    longest: u64,
}

impl StepBack {
    /// Takes the next message's.
    pub fn push(&mut self, log_time: u64) {
        self.longest = self.longest.max(self.latest.saturating_sub(log_time));
        self.latest = self.latest.max(log_time);
    }
}

impl Log {
    /// Whether a message of these channels, which are those of one topic, is earlier by more than `limit`, in
    /// nanoseconds, than a message before it in the file. A chunk is opened only if one of the channels has no complete
    /// message index there.
    ///
    /// # Errors
    /// The log cannot be read or is damaged there.
    pub fn goes_back(&self, channel_ids: &BTreeSet<u16>, limit: u64) -> Result<bool, ReadError> {
        if let (Some(scanned), [id]) = (&self.contents.steps_back, &Vec::from_iter(channel_ids)[..])
        {
            let step_back = scanned.get(id).copied().unwrap_or_default();
            return Ok(step_back.longest > limit);
        }
        let mut segments = SegmentReader::new(self);
        let mut times = StepBack::default();
        for segment in &self.contents.segments {
            times = match self.indexed_times(segment, channel_ids, times)? {
                Some(times) => times,
                None => {
                    for message in segments.read(segment, channel_ids)? {
                        times.push(message?.log_time);
                    }
                    times
                }
            };
            if times.longest > limit {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Goes on with the messages of a segment, by its indexes; `None` if it does not have all that are needed.
    fn indexed_times(
        &self,
        segment: &Segment,
        channel_ids: &BTreeSet<u16>,
        before: StepBack,
    ) -> Result<Option<StepBack>, ReadError> {
        let mut after = before;
        for id in segment.channels_among(channel_ids) {
            let Some(entries) = message_index(&self.file, segment, id)? else {
                return Ok(None);
            };
            // Messages of two channels of a topic may alternate: each is compared with what is before the segment.
            let mut times = before;
            entries_in_order(&entries, |log_time| times.push(log_time));
            after.latest = after.latest.max(times.latest);
            after.longest = after.longest.max(times.longest);
        }
        Ok(Some(after))
    }
}

/// Passes on the log times in the order of the messages in the chunk. An index may have another order.
fn entries_in_order(entries: &IndexEntries, mut take: impl FnMut(u64)) {
    if entries.iter().is_sorted_by_key(|entry| entry.offset) {
        entries.iter().for_each(|entry| take(entry.log_time));
        return;
    }
    let mut sorted = Vec::from_iter(entries.iter());
    sorted.sort_unstable_by_key(|entry| entry.offset);
    sorted.iter().for_each(|entry| take(entry.log_time));
}
