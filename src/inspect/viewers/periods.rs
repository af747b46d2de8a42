//! The periods of a log: its messages, divided where there is none for more than a day.

use std::collections::BTreeMap;

use crate::log::{Log, ReadError, SegmentReader};

/// The longest time between two messages of one period, nanoseconds. Drones do not fly for a day without a message.
const DAY: u64 = 24 * 60 * 60 * 1_000_000_000;

/// Messages of which each is at most a day after the one before it.
pub struct Period {
    /// Log times of the first and the last, nanoseconds.
    pub times: [u64; 2],
    /// How many there are, by channel id.
    pub messages: BTreeMap<u16, u64>,
}

impl Period {
    /// How many messages there are.
    pub fn count(&self) -> u64 {
        self.messages.values().sum()
    }

    fn join(&mut self, other: &Self) {
        let [start, end] = self.times;
        self.times = [start.min(other.times[0]), end.max(other.times[1])];
        for (id, count) in &other.messages {
            *self.messages.entry(*id).or_default() += count;
        }
    }
}

/// The periods of a log, in the order of time. The times of single messages are read only in segments that last longer
/// than a day.
///
/// # Errors
/// The log cannot be read or is damaged there.
pub fn periods(log: &Log) -> Result<Vec<Period>, ReadError> {
    let mut periods = Periods::default();
    let mut reader = SegmentReader::new(log);
    for segment in &log.contents.segments {
        let Some((start, end)) = segment.times else {
            continue;
        };
        if start.abs_diff(end) <= DAY {
            periods.add(Period {
                times: [start.min(end), start.max(end)],
                messages: segment.message_counts.clone(),
            });
            continue;
        }
        let ids = segment.message_counts.keys().copied().collect();
        let mut messages = Vec::new();
        reader.for_each_time(segment, ids, |id, time| messages.push((time, id)))?;
        messages.sort_unstable();
        for together in messages.chunk_by(|(time, _), (next, _)| next - time <= DAY) {
            let mut counts = BTreeMap::new();
            for (_, id) in together {
                *counts.entry(*id).or_default() += 1;
            }
            if let (Some((start, _)), Some((end, _))) = (together.first(), together.last()) {
                periods.add(Period {
                    times: [*start, *end],
                    messages: counts,
                });
            }
        }
    }
    Ok(periods.0.into_values().collect())
}

/// Periods by their starts.
#[derive(Default)]
struct Periods(BTreeMap<u64, Period>);

impl Periods {
    /// Adds messages. Periods that they lie between, or are in, become one.
    fn add(&mut self, mut period: Period) {
        while let Some(start) = self.near(&period)
            && let Some(mut near) = self.0.remove(&start)
        {
            near.join(&period);
            period = near;
        }
        self.0.insert(period.times[0], period);
    }

    /// The start of the last one that is at most a day from these messages.
    fn near(&self, period: &Period) -> Option<u64> {
        let [start, end] = period.times;
        let (&of_last, last) = self.0.range(..=end.saturating_add(DAY)).next_back()?;
        (last.times[1].saturating_add(DAY) >= start).then_some(of_last)
    }
}
