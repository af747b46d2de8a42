//! What viewers have trouble with: messages far from the rest of a log, fast topics, chunks without message indexes.

use std::collections::BTreeMap;

use flightcam::{
    Options,
    inspect::{FarMessages, ViewerWarning, inspect},
};
use mcap::{WriteOptions, records::op};

use crate::support::{inspection::*, logbook::Logbook, *};

const SECOND: u64 = 1000;
const HOUR: u64 = 3600 * SECOND;
const DAY: u64 = 24 * HOUR;

/// A flight in spring 2024, milliseconds.
const FLIGHT: u64 = 1_710_773_350 * SECOND;

/// A message: its topic, and its log time in milliseconds. A topic followed by a mark is the same on another channel.
type Written = (&'static str, u64);

/// Messages at even distances.
fn series(topic: &'static str, start: u64, hertz: u64, seconds: u64) -> Vec<Written> {
    let count = hertz * seconds;
    (0..=count)
        .map(|n| (topic, start + n * SECOND / hertz))
        .collect()
}

/// A minute of a slow topic.
fn flight() -> Vec<Written> {
    series("/state", FLIGHT, 10, 60)
}

fn warnings_with(options: WriteOptions, messages: &[Written]) -> Vec<ViewerWarning> {
    let mut logbook = Logbook::with_options(options);
    let mut channels = BTreeMap::new();
    for &(topic, time) in messages {
        let next = channels.len() as u16 + 1;
        let channel = *channels.entry(topic).or_insert(next);
        if channel == next {
            let writer = &mut logbook.writer;
            let schema = match topic {
                "/tf" => writer.add_schema("tf2_msgs/msg/TFMessage", "jsonschema", b"{}"),
                _ => Ok(0),
            };
            let schema = schema.expect("a schema");
            let topic = topic.trim_end_matches('\'');
            let added = writer.add_channel_with_id(next, schema, topic, "json", &BTreeMap::new());
            added.expect("a channel");
        }
        logbook.put(channel, time, b"{}");
    }
    let (_folder, log) = logbook.finish();
    let inspection = inspect(log, &Options::default()).expect("a readable log");
    inspection.viewer_warnings
}

/// What is found in a log of small chunks with these messages, in the order of the file.
fn warnings(messages: &[Written]) -> Vec<ViewerWarning> {
    warnings_with(WriteOptions::new().chunk_size(Some(512)), messages)
}

/// What is said of messages far from the rest: how many on which topics, and when, in milliseconds.
type Far<'a> = (Vec<(&'a str, u64)>, [u64; 2]);

fn far(messages: &FarMessages) -> Far<'_> {
    let topics = messages.topics.iter();
    let topics: Vec<(&str, u64)> = topics
        .map(|(topic, count)| (topic.as_str(), *count))
        .collect();
    let counts = topics.iter().map(|(_, count)| count);
    assert_eq!(messages.messages, counts.sum::<u64>());
    (topics, messages.times.map(|time| time / 1_000_000))
}

fn rest(messages: &FarMessages) -> [u64; 2] {
    messages.rest.map(|time| time / 1_000_000)
}

#[test]
fn messages_at_time_zero_are_named_with_their_topics() {
    let never_published = [
        ("/parameters", 0),
        ("/state", 0),
        ("/state", 1),
        ("/rtl", 7),
    ];
    let found = warnings(&[&never_published[..], &flight()].concat());
    let [ViewerWarning::EarlyMessages(early)] = &found[..] else {
        panic!("{found:?}");
    };
    let topics = vec![("/parameters", 1), ("/rtl", 1), ("/state", 2)];
    assert_eq!(far(early), (topics, [0, 7]));
    assert_eq!(rest(early), [FLIGHT, FLIGHT + 60 * SECOND]);
    assert_eq!(warnings(&flight()), []);
}

#[test]
fn what_is_found_does_not_depend_on_the_container() {
    let stray = [("/parameters", 0), ("/state", 0), ("/imu", 3)];
    let imu = series("/imu", FLIGHT, 100, 10);
    // Topic after topic, and message after message.
    let by_topic = [&stray[..], &flight(), &imu].concat();
    let mut by_time = by_topic.clone();
    by_time.sort_by_key(|(_, time)| *time);
    let expected = warnings(&by_topic);
    assert!(
        matches!(
            expected[..],
            [
                ViewerWarning::EarlyMessages(_),
                ViewerWarning::FastTopics { .. }
            ]
        ),
        "{expected:?}"
    );
    for messages in [by_topic, by_time] {
        for options in [
            WriteOptions::new(),
            WriteOptions::new().chunk_size(Some(2048)),
            WriteOptions::new().use_chunks(false),
            WriteOptions::new().emit_summary_records(false),
            WriteOptions::new()
                .emit_message_indexes(false)
                .chunk_size(Some(512)),
        ] {
            let mut found = warnings_with(options, &messages);
            found.retain(|found| !matches!(found, ViewerWarning::UnindexedChunks { .. }));
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn a_day_without_a_message_is_not_far() {
    let after = |time: u64| [("/early", FLIGHT - time), ("/late", FLIGHT + 60 * SECOND)];
    let with = |time| warnings(&[&after(time)[..], &flight()].concat());
    assert_eq!(with(DAY), []);
    let found = with(DAY + 1);
    let [ViewerWarning::EarlyMessages(early)] = &found[..] else {
        panic!("{found:?}");
    };
    let time = FLIGHT - DAY - 1;
    assert_eq!(far(early), (vec![("/early", 1)], [time, time]));
    // Each is less than a day from another one, which comes later in the file, in a chunk of its own.
    let bridged = [FLIGHT - 60 * HOUR, FLIGHT - 20 * HOUR, FLIGHT - 40 * HOUR];
    let bridged = bridged.map(|time| ("/status", time));
    let bridged = [&bridged[..], &flight()].concat();
    let each_in_a_chunk = WriteOptions::new().chunk_size(Some(1));
    assert_eq!(warnings_with(each_in_a_chunk, &bridged), []);
    assert_eq!(warnings(&bridged), []);
}

#[test]
fn the_rest_is_where_most_messages_are() {
    let synchronized = [("/gps", FLIGHT), ("/state", FLIGHT + SECOND)];
    let since_boot = series("/state", 20 * SECOND, 10, 60);
    let found = warnings(&[&since_boot[..], &synchronized].concat());
    let [ViewerWarning::LateMessages(late)] = &found[..] else {
        panic!("{found:?}");
    };
    let topics = vec![("/gps", 1), ("/state", 1)];
    assert_eq!(far(late), (topics, [FLIGHT, FLIGHT + SECOND]));
    assert_eq!(rest(late), [20 * SECOND, 80 * SECOND]);

    let astray = [
        ("/a", 0),
        ("/a", 9 * DAY),
        ("/b", 9 * DAY),
        ("/c", FLIGHT + 2 * DAY),
    ];
    let found = warnings(&[&flight()[..], &astray].concat());
    let [
        ViewerWarning::EarlyMessages(early),
        ViewerWarning::LateMessages(late),
    ] = &found[..]
    else {
        panic!("{found:?}");
    };
    assert_eq!(far(early), (vec![("/a", 2), ("/b", 1)], [0, 9 * DAY]));
    let time = FLIGHT + 2 * DAY;
    assert_eq!(far(late), (vec![("/c", 1)], [time, time]));
}

/// The topics that are said to be fast, with their rates.
fn fast(messages: &[Written]) -> Vec<(String, f64)> {
    let fast = warnings(messages)
        .into_iter()
        .find_map(|found| match found {
            ViewerWarning::FastTopics { topics } => Some(topics),
            _ => None,
        });
    let fast = fast.into_iter().flatten();
    fast.map(|fast| (fast.topic.to_string(), fast.rate_hz))
        .collect()
}

#[test]
fn topics_over_60_hz_are_named_with_their_rates() {
    assert_eq!(fast(&series("/state", FLIGHT, 60, 30)), []);
    // As a camera of 60 frames per second may have.
    let camera = (0..=302).map(|n| ("/camera", FLIGHT + n * 5 * SECOND / 302));
    assert_eq!(fast(&camera.collect::<Vec<_>>()), []);
    assert_eq!(
        fast(&series("/state", FLIGHT, 61, 30)),
        [("/state".to_owned(), 61.0)]
    );
    let both = [
        series("/state", FLIGHT, 40, 10),
        series("/state'", FLIGHT, 40, 10),
    ];
    assert_eq!(fast(&both.concat()), [("/state".to_owned(), 80.1)]);
}

#[test]
fn a_burst_is_not_a_rate() {
    let burst = (0..500).map(|n| ("/parameters", FLIGHT + n));
    let burst: Vec<Written> = burst.collect();
    assert_eq!(fast(&[&burst[..], &flight()].concat()), []);
    let second = series("/imu", FLIGHT, 100, 1);
    assert_eq!(fast(&second), [("/imu".to_owned(), 100.0)]);
}

#[test]
fn a_message_far_away_does_not_change_a_rate() {
    let imu = series("/imu", FLIGHT, 200, 10);
    for time in [0, FLIGHT + 3 * DAY] {
        let messages = [&[("/imu", time)][..], &imu, &flight()].concat();
        assert_eq!(fast(&messages), [("/imu".to_owned(), 200.0)]);
    }
}

#[test]
fn of_fast_topics_those_that_are_drawn_come_first() {
    let messages = [
        series("/gyro", FLIGHT, 100, 5),
        series("/imu", FLIGHT, 250, 5),
        series("/tf", FLIGHT, 100, 5),
    ];
    let fast = fast(&messages.concat());
    let names: Vec<&str> = fast.iter().map(|(topic, _)| topic.as_str()).collect();
    assert_eq!(names, ["/tf", "/imu", "/gyro"]);
}

fn unindexed(log: &[u8]) -> Option<(u64, u64)> {
    let found = inspected(log).viewer_warnings;
    found.into_iter().find_map(|found| match found {
        ViewerWarning::UnindexedChunks { unindexed, chunks } => Some((unindexed, chunks)),
        _ => None,
    })
}

#[test]
fn chunks_without_message_indexes_are_counted() {
    let chunks = |log: &[u8]| {
        let summary = mcap::Summary::read(log).expect("readable");
        summary.expect("a summary").chunk_indexes.len() as u64
    };
    let usual = Shape::default().write();
    assert!(chunks(&usual) > 2);
    assert_eq!(unindexed(&usual), None);

    let none = Shape::with(|options| options.emit_message_indexes(false)).write();
    assert_eq!(unindexed(&none), Some((chunks(&none), chunks(&none))));

    // The first index after the first chunk is a record of an unknown kind.
    let mut parts = Parts::of(&usual);
    let index = (parts.data.iter_mut()).find(|(opcode, _)| *opcode == op::MESSAGE_INDEX);
    index.expect("a message index").0 = 0x90;
    parts.data_section_crc = 0;
    assert_eq!(unindexed(&parts.join()), Some((1, chunks(&usual))));
}

/// Readers that seek need both, and do not seek without the former.
#[test]
fn message_indexes_are_not_missed_where_there_is_no_index_of_the_chunks() {
    let without = |options: WriteOptions| options.emit_message_indexes(false);
    for log in [
        Shape::with(|options| without(options).emit_summary_records(false)),
        Shape::with(|options| without(options).emit_chunk_indexes(false)),
        Shape::with(|options| without(options).use_chunks(false)),
    ] {
        assert_eq!(unindexed(&log.write()), None);
    }
}

#[test]
fn chunks_with_message_indexes_are_not_opened() {
    let mut logbook = Logbook::with_options(WriteOptions::new().compression(None));
    let [parameters, imu] = ["/parameters", "/imu"].map(|topic| logbook.channel(0, topic, "x"));
    logbook.put(parameters, 0, b"{}");
    for n in 0..1000 {
        logbook.put(imu, FLIGHT + n * 10, b"{}");
    }
    let (_folder, path) = logbook.finish();
    let mut log = std::fs::read(path).expect("the log");
    let expected = inspected(&log).viewer_warnings;
    assert_eq!(expected.len(), 2, "{expected:?}");
    let summary = mcap::Summary::read(&log).expect("readable");
    for index in summary.expect("a summary").chunk_indexes {
        // After the chunk's opcode, length and times, which its index has too.
        let chunk = index.chunk_start_offset as usize;
        log[chunk + 9 + 16..][..60].fill(0xc5);
    }
    assert_eq!(inspected(&log).viewer_warnings, expected);
}

#[test]
fn real_logs_have_messages_at_time_zero_and_fast_topics() {
    let Some(folder) = real_logs() else { return };
    let found = |name: &str| {
        let log = std::fs::read(folder.join(name)).expect("the log");
        inspected(&log).viewer_warnings
    };
    let with_times_since_1970 = found("sample_px4_events.mcap");
    let [
        ViewerWarning::EarlyMessages(early),
        ViewerWarning::FastTopics { topics },
    ] = &with_times_since_1970[..]
    else {
        panic!("{with_times_since_1970:?}");
    };
    let expected = vec![
        ("/manual_control_setpoint", 1),
        ("/parameter_update", 1),
        ("/rtl_time_estimate", 9),
        ("/transponder_report", 1),
    ];
    assert_eq!(far(early), (expected, [0, 0]));
    let rates = topics
        .iter()
        .map(|fast| (fast.topic.as_str(), fast.rate_hz));
    assert!(rates.eq([("/ekf2_timestamps", 250.0), ("/sensor_combined", 250.0)]));
    // Its times are since the autopilot started, and 0 is one of them.
    let with_times_since_boot = found("test_ulog.mcap");
    let [ViewerWarning::FastTopics { topics }] = &with_times_since_boot[..] else {
        panic!("{with_times_since_boot:?}");
    };
    assert_eq!(topics.len(), 1);
    assert_eq!(found("test_ulog.ros2.mcap"), []);
}
