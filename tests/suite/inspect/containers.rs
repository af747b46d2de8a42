//! An inspection is the same whatever the log's container, and opens no more of it than it must.

use std::{collections::BTreeMap, io::Cursor};

use flightcam::{
    Error, Options,
    inspect::{FirstSample, Inspection, ViewerWarning},
    log::ReadError,
    sample::Kind,
};
use mcap::{MessageStream, WriteOptions, records::MessageHeader};
use serde_json::Value;

use crate::support::{inspection::*, topics::*, *};

/// What an inspection says about the log and not about its container.
fn without_container(mut inspection: Inspection) -> Inspection {
    inspection.bytes = 0;
    inspection.scanned = false;
    let unindexed =
        |warning: &ViewerWarning| matches!(warning, ViewerWarning::UnindexedChunks { .. });
    inspection
        .viewer_warnings
        .retain(|warning| !unindexed(warning));
    inspection
}

#[test]
fn the_numbers_do_not_depend_on_the_container() {
    let usual = Shape::default().write();
    let expected = inspected(&usual);
    check_counts(&expected, &usual);
    assert!(!expected.scanned);
    let vary = |change: fn(WriteOptions) -> WriteOptions| Shape::with(change).write();
    for (log, scanned) in [
        (vary(|options| options.use_chunks(false)), false),
        (vary(|options| options.emit_summary_records(false)), true),
        (vary(|options| options.emit_message_indexes(false)), false),
        (vary(|options| options.emit_chunk_indexes(false)), false),
        (vary(|options| options.emit_statistics(false)), true),
        (vary(|options| options.compression(None)), false),
    ] {
        let inspection = inspected(&log);
        check_counts(&inspection, &log);
        assert_eq!(inspection.scanned, scanned);
        assert_eq!(
            without_container(inspection),
            without_container(expected.clone())
        );
    }
    // Three messages more on another topic.
    let mixed = mixed_log();
    let inspection = inspected(&mixed);
    assert_eq!(inspection.messages, expected.messages + 3);
    assert_eq!(inspection.telemetry, expected.telemetry);
}

/// A topic that no profile knows what to do with.
fn video(frames: impl IntoIterator<Item = Vec<u8>>) -> Topic {
    Topic {
        encoding: "h264",
        messages: frames.into_iter().collect(),
        ..topic("/video", [])
    }
}

#[test]
fn chunks_without_telemetry_are_not_opened_where_there_is_a_summary() {
    let frames = (0..5).map(|_| vec![7; 1 << 20]);
    let mut log = log(&[topic("/state", states(50, 1.0)), video(frames)]);
    let expected = inspected(&log);
    check_counts(&expected, &log);
    let summary = mcap::Summary::read(&log).expect("readable");
    let indexes = summary.expect("a summary").chunk_indexes;
    let telemetry = expected_channel(&log, "/state");
    let others = indexes
        .iter()
        .filter(|index| !index.message_index_offsets.contains_key(&telemetry));
    let others: Vec<u64> = others.map(|index| index.chunk_start_offset).collect();
    assert!(others.len() >= 3);
    for start in others {
        // After the chunk's opcode, length and times, which its index has too.
        log[start as usize + 9 + 16..][..60].fill(0xc5);
    }
    assert_eq!(inspected(&log), expected);

    let mut parts = Parts::of(&log);
    parts.summary.clear();
    let error = inspected_with(&parts.join(), &Options::default()).expect_err("it is damaged");
    assert!(
        matches!(error, Error::Read(ReadError::Damaged { .. })),
        "{error}"
    );
}

fn expected_channel(log: &[u8], topic: &str) -> u16 {
    let mut messages = MessageStream::new(log).expect("a log").map(Result::unwrap);
    let message = messages.find(|message| message.channel.topic == topic);
    message.expect("a message").channel.id
}

/// A log of messages: topic, number for its [`time`], payload. A topic followed by a mark is the same topic on
/// another channel.
fn recorded(
    options: WriteOptions,
    messages: impl IntoIterator<Item = (&'static str, u32, Vec<u8>)>,
) -> Vec<u8> {
    let mut writer = options.create(Cursor::new(Vec::new())).expect("a writer");
    let mut channels = BTreeMap::new();
    for (topic, n, payload) in messages {
        let next = channels.len() as u16 + 1;
        let channel_id = *channels.entry(topic).or_insert(next);
        if channel_id == next {
            let topic = topic.trim_end_matches('\'');
            let encoding = if topic == "/video" { "h264" } else { "json" };
            let added = writer.add_channel_with_id(next, 0, topic, encoding, &BTreeMap::new());
            added.expect("a channel");
        }
        let header = MessageHeader {
            channel_id,
            sequence: n,
            log_time: time(n),
            publish_time: time(n),
        };
        let written = writer.write_to_known_channel(&header, &payload);
        written.expect("a message");
    }
    writer.finish().expect("the log is finished");
    writer.into_inner().into_inner()
}

#[test]
fn a_long_log_is_read_in_even_parts_and_the_rest_counted() {
    const CHUNKS: u32 = 12;
    const FRAME: usize = 8 << 20;
    let options = WriteOptions::new()
        .compression(None)
        .chunk_size(Some(FRAME as u64))
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false);
    let messages = (0..)
        .zip(states(10 * CHUNKS as i32, 1.0))
        .flat_map(|(n, mut reading)| {
            // The first half of the flight is not usable.
            if n < 5 * CHUNKS {
                reading["yaw"] = Value::Null;
            }
            let frame = (n % 10 == 9).then(|| ("/video", n, vec![7; FRAME]));
            [("/state", n, reading.to_string().into_bytes())]
                .into_iter()
                .chain(frame)
        });
    let inspection = inspected(&recorded(options, messages));
    for kind in [Kind::Attitude, Kind::Velocity] {
        let role = found(&inspection, kind);
        assert_eq!((role.messages, role.times), (120, [time(0), time(119)]));
        assert_eq!(role.largest_gap_s, Some(0.02));
        // 64 MiB, and at most one chunk more.
        assert!((70..=90).contains(&role.read), "{}", role.read);
        assert_eq!(role.read % 10, 0);
    }
    let attitude = found(&inspection, Kind::Attitude);
    let share = attitude.share_invalid;
    assert!((0.4..=0.6).contains(&share), "{share}");
    let invalid = attitude.read - attitude.tally.used;
    let planned = &telemetry(&inspection).would_write;
    assert_eq!(planned[0].at_most, 120 - invalid - 1);
    assert_eq!(planned[1].at_most, 120 - invalid);
    assert_eq!(planned[2].at_most, 120);
    assert_eq!(found(&inspection, Kind::Velocity).share_invalid, 0.0);
}

#[test]
fn a_topic_may_have_several_channels_and_its_messages_any_order() {
    let readings: Vec<Vec<u8>> = (states(9, 1.0))
        .map(|reading| reading.to_string().into())
        .collect();
    // Every third is recorded on another channel, and the latest come first.
    let messages = (0..9).rev().map(|n: u32| {
        let topic = if n.is_multiple_of(3) {
            "/state'"
        } else {
            "/state"
        };
        (topic, n, readings[n as usize].clone())
    });
    let log = recorded(WriteOptions::new(), messages);
    assert_eq!(
        mcap::Summary::read(&log).unwrap().unwrap().channels.len(),
        2
    );
    let inspection = inspected(&log);
    check_counts(&inspection, &log);
    let attitude = found(&inspection, Kind::Attitude);
    assert_eq!((attitude.messages, attitude.tally.used), (9, 9));
    assert_eq!(attitude.largest_gap_s, Some(0.02));
    let Some(FirstSample::Attitude { pitch_deg, .. }) = attitude.first else {
        panic!("no first attitude: {:?}", attitude.first);
    };
    assert!((pitch_deg - -0.1f64.to_degrees()).abs() < 1e-9);
}
