//! Whether log times go back, by the scan of a log or by its indexes: the same as by its messages.

use std::collections::BTreeSet;

use flightcam::log::{
    Log,
    record::{parse, serialize},
};
use mcap::records::{MessageIndex, op};
use proptest::prelude::*;

use crate::support::{
    folder::{Folder, LOG},
    numbered::{Content, Message, write},
    shapes::any_shape,
    *,
};

fn goes_back(log: &[u8], channel_ids: &[u16], limit: u64) -> bool {
    let folder = Folder::with(LOG, log);
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let channels = BTreeSet::from_iter(channel_ids.iter().copied());
    log.goes_back(&channels, limit).expect("a readable log")
}

/// The longest time by which a message is earlier than one before it on the same topic.
fn longest(messages: &[Message], channel_id: u16) -> u64 {
    let of_channel = messages
        .iter()
        .filter(|m| m.content.channel_id() == channel_id);
    let (mut latest, mut longest) = (0, 0);
    for message in of_channel {
        latest = message.time.max(latest);
        longest = longest.max(latest - message.time);
    }
    longest
}

proptest! {
    #![proptest_config(crate::support::cases(48))]

    #[test]
    fn a_step_back_is_seen_whatever_the_shape(
        messages in prop::collection::vec((any::<bool>(), 0..60_u64, 0..40usize), 1..200),
        slope in 0..3_u64,
        shape in any_shape(),
    ) {
        let message = |(n, (is_attitude, time, padding))| Message {
            content: if is_attitude { Content::Attitude } else { Content::Velocity },
            time: 1000 + n as u64 * slope + time,
            padding,
        };
        let messages: Vec<Message> = messages.into_iter().enumerate().map(message).collect();
        let log = write(shape.options, &messages);
        for channel_id in [1, 2] {
            let longest = longest(&messages, channel_id);
            prop_assert!(!goes_back(&log, &[channel_id], longest));
            prop_assert!(longest == 0 || goes_back(&log, &[channel_id], longest - 1));
        }
    }
}

#[test]
fn a_step_back_between_the_channels_of_a_topic_is_seen() {
    let message = |content, time| Message {
        content,
        time,
        padding: 0,
    };
    let messages = [(Content::Attitude, 500), (Content::Velocity, 100)];
    let messages = messages.map(|(content, time)| message(content, time));
    for chunks in [true, false] {
        let options = mcap::WriteOptions::new()
            .use_chunks(chunks)
            .chunk_size(Some(1));
        let log = write(options, &messages);
        assert!(goes_back(&log, &[1, 2], 399));
        assert!(!goes_back(&log, &[1, 2], 400));
        assert!(!goes_back(&log, &[1], 0) && !goes_back(&log, &[2], 0));
    }
}

/// Writers may sort an index by time.
#[test]
fn the_order_of_the_messages_counts_and_not_that_of_the_index() {
    let times = [100, 300, 200, 400];
    let messages = times.map(|time| Message {
        content: Content::Attitude,
        time,
        padding: 0,
    });
    let mut parts = Parts::of(&write(mcap::WriteOptions::new(), &messages));
    for (opcode, body) in &mut parts.data {
        if *opcode == op::MESSAGE_INDEX {
            let mut index: MessageIndex = parse(body).expect("a message index");
            index.records.sort_by_key(|entry| entry.log_time);
            *body = serialize(&index);
        }
    }
    parts.data_section_crc = 0;
    let log = parts.join();
    assert!(goes_back(&log, &[1], 99) && !goes_back(&log, &[1], 100));
}

#[test]
fn chunks_with_indexes_are_not_opened_to_see_whether_time_goes_back() {
    let mut parts = Parts::of(&Shape::default().write());
    for (opcode, body) in &mut parts.data {
        if *opcode == op::CHUNK {
            body[8 + 8..].fill(0xc5);
        }
    }
    parts.data_section_crc = 0;
    assert!(!goes_back(&parts.join(), &[1], 0));
}
