//! The log times of messages, read from the log's indexes: the same as from reading all messages, whatever the shape
//! of the log and whatever is wrong with its indexes.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};

use flightcam::log::{
    Damage, Log, ReadError,
    record::{parse, push_record, serialize},
};
use mcap::records::{ChunkIndex, MessageIndex, op};
use proptest::prelude::*;

use crate::support::{shapes::any_shape, *};

type Times = BTreeMap<u16, Vec<u64>>;

/// The times of some channels according to the log.
fn times_of(log: &[u8], channel_ids: &[u16]) -> Result<Times, ReadError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let input = folder.path().join("log.mcap");
    fs::write(&input, log).expect("the log is written");
    Log::open(&input)?.message_times(&BTreeSet::from_iter(channel_ids.iter().copied()))
}

/// The times of all messages on the two topics, each topic's in order.
fn counted(log: &[u8], [telemetry, other]: [u16; 2]) -> Times {
    let mut times = Times::new();
    for message in stream(log, false) {
        let id = match message.topic == TELEMETRY {
            true => telemetry,
            false => other,
        };
        times.entry(id).or_default().push(message.log_time);
    }
    times.values_mut().for_each(|times| times.sort());
    times
}

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn message_times_are_those_of_all_messages_whatever_the_shape(shape in any_shape(), which in 0..4usize) {
        let log = shape.write();
        let wanted: &[&[u16]] = &[&shape.channel_ids, &shape.channel_ids[..1], &shape.channel_ids[1..], &[]];
        let mut expected = counted(&log, shape.channel_ids);
        expected.retain(|id, _| wanted[which].contains(id));
        prop_assert_eq!(times_of(&log, wanted[which]).expect("a readable log"), expected);
    }
}

/// The times of the earliest and the latest message of each channel, of those within a range.
fn ends_of(log: &[u8], channel_ids: &[u16], within: [u64; 2]) -> Result<Ends, ReadError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let input = folder.path().join("log.mcap");
    fs::write(&input, log).expect("the log is written");
    let channel_ids = BTreeSet::from_iter(channel_ids.iter().copied());
    Log::open(&input)?.message_time_ends(&channel_ids, within)
}

type Ends = BTreeMap<u16, [u64; 2]>;

/// The same from the times of all messages.
fn ends(times: &Times, [from, to]: [u64; 2]) -> Ends {
    let ends = times.iter().filter_map(|(id, times)| {
        let within = times.iter().filter(|time| (from..=to).contains(time));
        let (first, last) = (within.clone().min()?, within.max()?);
        Some((*id, [*first, *last]))
    });
    ends.collect()
}

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn the_ends_are_those_of_all_messages_whatever_the_shape(
        shape in any_shape(), from in 0..250u64, count in 0..250u64, whole: bool,
    ) {
        let log = shape.write();
        let within = match whole {
            true => [0, u64::MAX],
            false => [from, from + count].map(|n| 1_000_000_000 + n * 20_000_000 - 7),
        };
        let found = ends_of(&log, &shape.channel_ids, within).expect("a readable log");
        prop_assert_eq!(found, ends(&counted(&log, shape.channel_ids), within));
    }
}

#[test]
fn only_chunks_that_may_have_an_end_are_opened_for_it() {
    let shape = Shape::default();
    let whole = [0, u64::MAX];
    let expected = ends(&counted(&shape.write(), [1, 2]), whole);
    // No index of the telemetry is believed, so the chunks are needed.
    let spoilt = |damaged: fn(usize, usize) -> bool| {
        let mut parts = with_indexes(&shape, |body, _| body[2..6].fill(0xff));
        let chunks = parts
            .data
            .iter_mut()
            .filter(|(opcode, _)| *opcode == op::CHUNK);
        let chunks: Vec<_> = chunks.collect();
        let last = chunks.len() - 1;
        assert!(last > 2);
        for (number, (_, body)) in chunks.into_iter().enumerate() {
            if damaged(number, last) {
                body[8 + 8..].fill(0xc5);
            }
        }
        ends_of(&parts.join(), &[1, 2], whole)
    };
    let between = spoilt(|number, last| 0 < number && number < last);
    assert_eq!(between.expect("the chunks at the ends"), expected);
    for error in [
        spoilt(|number, _| number == 0),
        spoilt(|number, last| number == last),
    ] {
        let error = error.expect_err("a chunk at an end is needed");
        assert!(matches!(error, ReadError::Damaged { .. }), "{error}");
    }
}

#[test]
fn messages_in_and_outside_chunks_count_alike() {
    let log = mixed_log();
    let times = times_of(&log, &[1, 2]).expect("a readable log");
    assert_eq!(times, counted(&log, [1, 2]));
    assert_eq!(times[&2].len() as u64, MESSAGES + 3);
}

#[test]
fn chunks_with_indexes_are_not_opened() {
    let mut parts = Parts::of(&Shape::default().write());
    let expected = counted(&parts.join(), [1, 2]);
    for (opcode, body) in &mut parts.data {
        if *opcode == op::CHUNK {
            // All but its times, which its index has to have too.
            body[8 + 8..].fill(0xc5);
        }
    }
    parts.data_section_crc = 0;
    assert_eq!(times_of(&parts.join(), &[1, 2]).expect("indexes"), expected);
}

/// Changes every message index of the telemetry in a log.
fn with_indexes(shape: &Shape, spoil: impl Fn(&mut Vec<u8>, MessageIndex)) -> Parts {
    let mut parts = Parts::of(&shape.write());
    for (opcode, body) in &mut parts.data {
        if *opcode == op::MESSAGE_INDEX {
            let index: MessageIndex = parse(body).expect("a message index");
            if index.channel_id == 1 {
                spoil(body, index);
            }
        }
    }
    parts.data_section_crc = 0;
    parts
}

/// With times that are those of no message.
fn falsified(mut index: MessageIndex) -> MessageIndex {
    (index.records.iter_mut()).for_each(|entry| entry.log_time += 1);
    index
}

#[test]
fn an_inconsistent_message_index_is_not_believed() {
    let of_another_channel = |body: &mut Vec<u8>, mut index: MessageIndex| {
        index.channel_id = 2;
        *body = serialize(&falsified(index));
    };
    let shorter_than_its_record = |body: &mut Vec<u8>, mut index: MessageIndex| {
        let length = body.len();
        index.records.pop();
        *body = serialize(&falsified(index));
        body.resize(length, 0);
    };
    let endless = |body: &mut Vec<u8>, index| {
        *body = serialize(&falsified(index));
        body[2..6].fill(0xff);
    };
    type Spoiler<'a> = &'a dyn Fn(&mut Vec<u8>, MessageIndex);
    let spoilers: [Spoiler; 3] = [&of_another_channel, &shorter_than_its_record, &endless];
    for spoil in spoilers {
        let shape = Shape::default();
        let log = with_indexes(&shape, spoil).join();
        let expected = counted(&shape.write(), [1, 2]);
        assert_eq!(times_of(&log, &[1, 2]).expect("a readable log"), expected);
    }
}

#[test]
fn a_record_that_is_not_a_message_index_is_not_believed() {
    let expected = counted(&Shape::default().write(), [1, 2]);
    let mut parts = Parts::of(&Shape::default().write());
    for (opcode, body) in &mut parts.data {
        if *opcode == op::MESSAGE_INDEX {
            *opcode = 0x90;
            *body = serialize(&falsified(parse(body).expect("a message index")));
        }
    }
    parts.data_section_crc = 0;
    assert_eq!(times_of(&parts.join(), &[1, 2]).expect("chunks"), expected);
}

/// The record's own length is hostile, so where the records after it are is not known, whatever the summary says.
#[test]
fn a_message_index_longer_than_its_messages_is_damage() {
    let log = Shape::default().write();
    let mut hostile = log.clone();
    let mut first = u64::MAX;
    for (opcode, body) in Parts::of(&log).summary {
        if opcode == op::CHUNK_INDEX {
            let index: ChunkIndex = parse(&body).expect("a chunk index");
            for &offset in index.message_index_offsets.values() {
                let length = offset as usize + 1;
                hostile[length..length + 8].fill(0xff);
                first = first.min(offset);
            }
        }
    }
    let error = times_of(&hostile, &[1, 2]).expect_err("it is damaged");
    assert!(
        matches!(
            error,
            ReadError::Damaged { offset, damage: Damage::NotARecord, .. } if offset == first
        ),
        "{error}"
    );
}

/// A chunk's index names one place for each channel, but its messages may be indexed in two.
#[test]
fn an_index_in_two_parts_is_read_from_the_chunk() {
    let shape = Shape::with(|options| options.emit_summary_records(false));
    let expected = counted(&shape.write(), [1, 2]);
    let parts = Parts::of(&shape.write());
    let mut log = mcap::MAGIC.to_vec();
    for (opcode, body) in &parts.data {
        if *opcode != op::MESSAGE_INDEX {
            push_record(&mut log, *opcode, body);
            continue;
        }
        let whole: MessageIndex = parse(body).expect("a message index");
        let (first, second) = whole.records.split_at(whole.records.len() / 2);
        for records in [first.to_vec(), second.to_vec()] {
            let channel_id = whole.channel_id;
            let part = MessageIndex {
                channel_id,
                records,
            };
            push_record(&mut log, *opcode, &serialize(&part));
        }
    }
    // It breaks off after an index, so that a longer one would reach beyond its end.
    assert_eq!(times_of(&log, &[1, 2]).expect("chunks"), expected);
}

#[test]
fn a_chunk_that_is_needed_and_damaged_is_an_error() {
    let shape = Shape::default();
    let mut parts = with_indexes(&shape, |body, _| body[2..6].fill(0xff));
    for (opcode, body) in &mut parts.data {
        if *opcode == op::CHUNK {
            let middle = body.len() / 2;
            body[middle..].fill(0xc5);
        }
    }
    let error = times_of(&parts.join(), &[1]).expect_err("neither index nor chunk");
    assert!(matches!(error, ReadError::Damaged { .. }), "{error}");
    let others = times_of(&parts.join(), &[2]).expect("indexes");
    assert_eq!(others, counted_of_other(&shape));
}

fn counted_of_other(shape: &Shape) -> Times {
    let mut times = counted(&shape.write(), [1, 2]);
    times.remove(&1);
    times
}
