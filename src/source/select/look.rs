//! A look at some of the messages of a place where a role may be: whether they are usable.

use std::collections::{BTreeMap, BTreeSet};

use crate::{
    log::{Log, ReadError, SegmentReader, contents::Segment},
    sample::{DropReason, Sample, Tally},
    source::channel::ChannelReader,
};

/// How many messages are looked at, if the first few leave it open whether they are usable.
const MOST: u64 = 100;

/// From how many parts of the log these are.
const PARTS: usize = 10;

/// How many messages are looked at first.
const FEW: u64 = 10;

/// What a few messages show of all.
#[derive(Debug, Clone, Default)]
pub struct Look {
    /// How many messages there are.
    pub messages: u64,
    /// How many of those that were looked at are usable, how many are not, for which reason, and how many are of another
    /// source.
    pub tally: Tally,
}

impl Look {
    /// Looks at messages of these channels, which have one kind of sample: at a few from the middle of the log and, unless
    /// at least half of these are usable, at more from all over it. These are the same ones in a log that was
    /// [streamed](crate::log::stream).
    ///
    /// # Errors
    /// The log cannot be read or is damaged there.
    pub fn at(log: &Log, mut channels: BTreeMap<u16, ChannelReader>) -> Result<Self, ReadError> {
        let ids: BTreeSet<u16> = channels.keys().copied().collect();
        let parts: Vec<Part> = (log.contents.segments.iter())
            .filter_map(|segment| Part::of(segment, &ids))
            .collect();
        let messages = parts.iter().map(|part| part.messages).sum();
        let mut segments = SegmentReader::new(log);
        let mut look = |parts: &[&Part], most: u64| {
            let (mut read, mut tally) = (0, Tally::default());
            for part in parts {
                let step = part.messages.div_ceil(most / parts.len() as u64).max(1);
                for (place, message) in (0..).zip(segments.read(part.segment, &ids)?) {
                    let message = message?;
                    let channel = channels.get_mut(&message.channel_id);
                    if let Some(channel) = channel.filter(|_| place % step == 0) {
                        read += 1;
                        channel.read(&message, |_, sample| match sample {
                            Ok(Sample::Position(sample)) if !sample.position.is_a_place() => {
                                tally.count_dropped(DropReason::NotAPlace, 1);
                            }
                            Ok(_) => tally.used += 1,
                            Err(reason) => tally.count_dropped(reason, 1),
                        });
                    }
                }
            }
            tally.unselected = read - tally.total();
            Ok::<_, ReadError>(tally)
        };
        let middle: Vec<&Part> = parts.get(parts.len() / 2).into_iter().collect();
        let mut tally = look(&middle, FEW)?;
        if 2 * tally.used < tally.total_with_unselected().max(1) {
            tally = look(&spread(&parts), MOST)?;
        }
        Ok(Self { messages, tally })
    }

    /// How many of the messages are usable, if all are like those that were looked at.
    pub fn usable(&self) -> f64 {
        match self.tally.total_with_unselected() {
            0 => 0.0,
            read => self.messages as f64 * (self.tally.used as f64 / read as f64),
        }
    }
}

/// A segment with messages to look at.
struct Part<'a> {
    segment: &'a Segment,
    messages: u64,
}

impl<'a> Part<'a> {
    fn of(segment: &'a Segment, channel_ids: &BTreeSet<u16>) -> Option<Self> {
        let counts = segment.message_counts.iter();
        let of_channels = counts.filter(|(id, _)| channel_ids.contains(id));
        let messages = of_channels.map(|(_, count)| count).sum();
        (messages > 0).then_some(Self { segment, messages })
    }
}

/// The first part, the last, and some that are evenly spread between them.
fn spread<'p, 'a>(parts: &'p [Part<'a>]) -> Vec<&'p Part<'a>> {
    let count = parts.len().min(PARTS);
    let last = parts.len().saturating_sub(1);
    (0..count)
        .map(|number| &parts[number * last / count.saturating_sub(1).max(1)])
        .collect()
}
