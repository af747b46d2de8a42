//! What `inspect` finds in a log, whatever says it and whatever holds it.
//!
//! The numbers are compared with those that the official reader and the flights themselves give.

mod common;
#[allow(dead_code, unused_imports)] // The writers of flights serve other tests too.
mod flights;

use std::{collections::BTreeMap, fs};

use common::{folder::*, topics::*, *};
use flightcam::{
    Error, Options,
    camera::Mount,
    geometry::DepressionAngle,
    inspect::{FoundRole, Inspection, Planned, Role, Telemetry, inspect},
    messages::{Encoding, EncodingChoice},
    report::CameraReport,
    sample::Kind,
    source::{
        profile::{Profile, ProfileChoice},
        request::Request,
    },
};
use flights::Recording;
use mcap::{MessageStream, WriteOptions};
use serde_json::{Value, json};

fn inspected_with(log: &[u8], options: &Options) -> Result<Inspection, Error> {
    let folder = Folder::with(LOG, log);
    let mut inspection = inspect(&folder.path(LOG), options)?;
    inspection.input = LOG.into();
    Ok(inspection)
}

fn inspected(log: &[u8]) -> Inspection {
    inspected_with(log, &Options::default()).expect("a readable log")
}

#[track_caller]
fn telemetry(inspection: &Inspection) -> &Telemetry {
    let problem = &inspection.problem;
    (inspection.telemetry.as_ref()).unwrap_or_else(|| panic!("no telemetry: {problem:?}"))
}

#[track_caller]
fn found(inspection: &Inspection, kind: Kind) -> &FoundRole {
    match &telemetry(inspection).roles[&kind] {
        Role::Found(found) => found,
        Role::Missing { missing } => panic!("no {}: {missing}", kind.name()),
    }
}

/// What the official reader counts on a topic.
#[derive(Default)]
struct Counted {
    encoding: String,
    schema: String,
    times: Vec<u64>,
}

fn counted(log: &[u8]) -> BTreeMap<String, Counted> {
    let mut topics: BTreeMap<String, Counted> = BTreeMap::new();
    for message in MessageStream::new(log).expect("a log") {
        let message = message.expect("a message");
        let channel = &message.channel;
        let topic = topics.entry(channel.topic.clone()).or_default();
        let schema = channel.schema.as_ref();
        topic.schema = schema.map_or_else(String::new, |schema| schema.name.clone());
        topic.encoding = channel.message_encoding.clone();
        topic.times.push(message.log_time);
    }
    topics.values_mut().for_each(|topic| topic.times.sort());
    topics
}

/// Checks every number that does not depend on what messages mean.
#[track_caller]
fn check_counts(inspection: &Inspection, log: &[u8]) {
    let mut topics = counted(log);
    let times = || topics.values().flat_map(|topic| &topic.times);
    assert_eq!(inspection.bytes, log.len() as u64);
    assert_eq!(inspection.messages, times().count() as u64);
    assert_eq!(inspection.topics, topics.len());
    let span = times().min().zip(times().max());
    assert_eq!(inspection.times, span.map(|(&start, &end)| [start, end]));

    let mut used = Vec::new();
    for role in telemetry(inspection).roles.values() {
        let Role::Found(role) = role else { continue };
        let topic = &topics[&role.topic];
        let (times, seconds) = (&topic.times, |time: u64| time as f64 / 1e9);
        let [start, end] = [times[0], times[times.len() - 1]];
        assert_eq!(role.encoding, topic.encoding);
        assert_eq!(role.schema, topic.schema);
        assert_eq!(role.messages, times.len() as u64);
        assert_eq!(role.times, [start, end]);
        let rate = (times.len() - 1) as f64 / seconds(end - start);
        assert_eq!(role.rate_hz, (end > start).then_some(rate));
        let gaps = times.windows(2).map(|pair| seconds(pair[1] - pair[0]));
        assert_eq!(role.largest_gap_s, gaps.reduce(f64::max));
        assert_eq!(role.read, role.tally.total());
        let invalid = role.tally.dropped.values().sum::<u64>() as f64;
        assert_eq!(role.share_invalid, invalid / role.read as f64);
        used.push(&role.topic);
    }
    topics.retain(|topic, _| !used.contains(&topic));
    let grouped = || inspection.other_topics.iter();
    let names = grouped().flat_map(|group| &group.topics);
    let mut names: Vec<&String> = names.collect();
    names.sort();
    assert!(names.into_iter().eq(topics.keys()));
    for group in grouped() {
        let of_group = group.topics.iter().map(|topic| &topics[topic]);
        assert!(of_group.clone().all(|topic| {
            topic.encoding == group.encoding && topic.schema.starts_with(&group.schemas)
        }));
        let messages: usize = of_group.map(|topic| topic.times.len()).sum();
        assert_eq!(group.messages, messages as u64);
    }
}

/// As the user asks for what is not found by itself.
fn options_for(recording: &Recording) -> Options {
    let text = Profile::built_in_text(recording.profile).expect("built in");
    let profile = Profile::parse(text).expect("a profile");
    let mut options = Options::default();
    if !profile.automatic {
        options.telemetry.profile = ProfileChoice::Given(Box::new(profile));
    }
    options
}

#[test]
fn a_flight_has_the_same_numbers_in_every_convention() {
    for recording in flights::recordings() {
        let log = recording.log();
        let inspection = inspected_with(&log, &options_for(&recording)).expect("a log");
        println!("{}", recording.name);
        check_counts(&inspection, &log);
        let telemetry = telemetry(&inspection);
        assert_eq!(telemetry.profile.name, recording.profile);
        let follows = telemetry.camera == Some(CameraReport::Gimbal);
        assert_eq!(follows, recording.gimbal.is_some());

        let flight = &recording.flight;
        let usable = |is_there: bool, times: &[u64]| is_there.then_some(times.len() as u64);
        for (kind, expected) in [
            (Kind::Attitude, usable(true, &flight.attitude_times)),
            (
                Kind::Velocity,
                usable(!flight.velocity_times.is_empty(), &flight.velocity_times),
            ),
            (
                Kind::Gimbal,
                usable(recording.gimbal.is_some(), &flight.gimbal_times),
            ),
            (
                Kind::Position,
                usable(recording.position.is_some(), &flight.position_times),
            ),
        ] {
            let used = match &telemetry.roles[&kind] {
                Role::Found(found) => {
                    assert_eq!(found.read, found.messages);
                    assert!(found.first.is_some());
                    Some(found.tally.used)
                }
                Role::Missing { .. } => None,
            };
            assert_eq!(used, expected, "{}", kind.name());
        }
        let at_most = telemetry.would_write.iter().map(|planned| planned.at_most);
        let attitudes = flight.attitude_times.len() as u64;
        let velocities = flight.velocity_times.len() as u64;
        assert!(at_most.eq([attitudes - 1, velocities].into_iter().filter(|&n| n > 0)));
        assert_eq!(inspection.problem, None);
        assert!(!inspection.scanned);
    }
}

#[test]
fn real_logs_have_the_numbers_that_are_known_of_them() {
    let Some(folder) = real_logs() else { return };
    for (name, profile, attitudes, velocities, invalid) in [
        ("test_ulog", "px4-ulog", 131, 66, 0),
        ("test_ulog.ros2", "px4-ros2", 131, 66, 0),
        ("sample_px4_events", "px4-ulog", 622, 313, 98),
        ("sample_log_small", "px4-ulog", 1298, 636, 636),
    ] {
        let log = fs::read(folder.join(format!("{name}.mcap"))).expect("the log");
        let inspection = inspected(&log);
        check_counts(&inspection, &log);
        let telemetry = telemetry(&inspection);
        assert_eq!(telemetry.profile.name, profile);
        let [attitude, velocity] =
            [Kind::Attitude, Kind::Velocity].map(|kind| found(&inspection, kind));
        assert_eq!(
            (attitude.messages, attitude.tally.used),
            (attitudes, attitudes)
        );
        assert_eq!(
            (velocity.messages, velocity.tally.used),
            (velocities, velocities - invalid)
        );
        assert_eq!(velocity.share_invalid, invalid as f64 / velocities as f64);
        let at_most = telemetry.would_write.iter().map(|planned| planned.at_most);
        let expected = [attitudes - 1, velocities - invalid];
        assert!(at_most.eq(expected.into_iter().filter(|&count| count > 0)));
        assert_eq!(
            telemetry.would_not_write.len(),
            usize::from(invalid == velocities)
        );
        assert_eq!(inspection.problem, None);
    }
}

/// What an inspection tells of the log and not of its container.
fn told(inspection: Inspection) -> Inspection {
    Inspection {
        bytes: 0,
        scanned: false,
        ..inspection
    }
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
        assert_eq!(told(inspection), told(expected.clone()));
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
        // Behind the chunk's opcode and length.
        log[start as usize + 9..][..60].fill(0xc5);
    }
    assert_eq!(inspected(&log), expected);

    let mut parts = Parts::of(&log);
    parts.summary.clear();
    let error = inspected_with(&parts.join(), &Options::default()).expect_err("it is damaged");
    assert!(matches!(error, Error::Corrupt { .. }), "{error}");
}

fn expected_channel(log: &[u8], topic: &str) -> u16 {
    let mut messages = MessageStream::new(log).expect("a log").map(Result::unwrap);
    let message = messages.find(|message| message.channel.topic == topic);
    message.expect("a message").channel.id
}

#[test]
fn of_a_long_log_an_even_part_is_read_and_the_rest_is_counted() {
    const CHUNKS: u64 = 12;
    const FRAME: usize = 8 << 20;
    let options = WriteOptions::new()
        .compression(None)
        .chunk_size(Some(FRAME as u64))
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false);
    let mut writer = options
        .create(std::io::Cursor::new(Vec::new()))
        .expect("a writer");
    let [state, video] = [("/state", "json"), ("/video", "h264")].map(|(topic, encoding)| {
        let channel = writer.add_channel(0, topic, encoding, &BTreeMap::new());
        channel.expect("a channel")
    });
    let frame = vec![7; FRAME];
    let readings: Vec<Value> = states(10 * CHUNKS as i32, 1.0).collect();
    for (n, mut reading) in (0..).zip(readings) {
        // The first half of the flight is not usable.
        if n < 5 * CHUNKS as u32 {
            reading["yaw"] = Value::Null;
        }
        let reading = reading.to_string().into_bytes();
        let frame = (n % 10 == 9).then_some((video, &frame));
        for (channel_id, payload) in [(state, &reading)].into_iter().chain(frame) {
            let header = mcap::records::MessageHeader {
                channel_id,
                sequence: n,
                log_time: time(n),
                publish_time: time(n),
            };
            let written = writer.write_to_known_channel(&header, payload);
            written.expect("a message");
        }
    }
    writer.finish().expect("the log is finished");
    let inspection = inspected(&writer.into_inner().into_inner());
    for kind in [Kind::Attitude, Kind::Velocity] {
        let role = found(&inspection, kind);
        assert_eq!((role.messages, role.times), (120, [time(0), time(119)]));
        assert_eq!(role.largest_gap_s, Some(0.02));
        // 64 MiB, and at most one chunk more.
        assert!((70..=90).contains(&role.read), "{}", role.read);
        assert_eq!(role.read % 10, 0);
    }
    let attitude = found(&inspection, Kind::Attitude);
    assert!(
        (0.4..=0.6).contains(&attitude.share_invalid),
        "{}",
        attitude.share_invalid
    );
    let invalid = attitude.read - attitude.tally.used;
    let planned = &telemetry(&inspection).would_write;
    assert_eq!(planned[0].at_most, 120 - invalid - 1);
    assert_eq!(planned[1].at_most, 120);
    assert_eq!(found(&inspection, Kind::Velocity).share_invalid, 0.0);
}

#[test]
fn what_would_be_written_is_in_the_encoding_that_enrich_chooses() {
    let encodings = [
        (
            Encoding::Protobuf,
            "protobuf",
            "flightcam.v1.CameraVelocity",
        ),
        (Encoding::Json, "json", "flightcam.v1.CameraVelocity"),
        (Encoding::Ros2, "cdr", "geometry_msgs/msg/Vector3Stamped"),
    ];
    let given = EncodingChoice::Given;
    for (profile, automatic) in [
        ("px4-ulog", Encoding::Protobuf),
        ("px4-ros2", Encoding::Ros2),
        ("dji-osdk", Encoding::Protobuf),
        ("flat", Encoding::Json),
    ] {
        let log = flights::recording_for(profile).log();
        let choices = encodings.map(|(encoding, ..)| (given(encoding), encoding));
        for (choice, expected) in choices
            .into_iter()
            .chain([(EncodingChoice::Automatic, automatic)])
        {
            let options = Options {
                encoding: choice,
                ..common::options()
            };
            let inspection = inspected_with(&log, &options).expect("a log");
            let (_, encoding, schema) = encodings[expected as usize];
            let Planned {
                topic,
                schema: s,
                encoding: e,
                at_most,
            } = telemetry(&inspection).would_write[1];
            assert_eq!((topic, s, e), ("/camera/velocity", schema, encoding));
            let (_, report) = enrich_bytes_with(&log, &options).expect("a result");
            assert_eq!(report.encoding.name, expected);
            assert!(report.written[1].messages <= at_most);
        }
    }
}

#[test]
fn the_camera_is_as_told_or_follows_the_gimbal_or_is_not_known() {
    let [with_gimbal, without] =
        ["px4-ros2", "flat"].map(|profile| flights::recording_for(profile).log());
    let camera = |log: &[u8], depression: Option<f64>, mount: Option<[f64; 3]>| {
        let options = Options {
            depression: depression.map(|angle| DepressionAngle::from_degrees(angle).unwrap()),
            mount: mount.map(|[roll, pitch, yaw]| Mount::from_degrees(roll, pitch, yaw).unwrap()),
            ..Options::default()
        };
        inspected_with(log, &options).map(|inspection| telemetry(&inspection).camera)
    };
    let stabilised = |depression_deg, yaw_offset_deg| {
        Some(CameraReport::Stabilised {
            depression_deg,
            yaw_offset_deg,
        })
    };
    for log in [&with_gimbal, &without] {
        let mount_deg = [10.0, -30.0, 5.0];
        let fixed = Some(CameraReport::Fixed { mount_deg });
        assert_eq!(
            camera(log, Some(30.0), None).unwrap(),
            stabilised(30.0, 0.0)
        );
        assert_eq!(
            camera(log, Some(30.0), Some([0.0, 0.0, 90.0])).unwrap(),
            stabilised(30.0, 90.0)
        );
        assert_eq!(camera(log, None, Some(mount_deg)).unwrap(), fixed);
        let contradiction = camera(log, Some(30.0), Some(mount_deg)).unwrap_err();
        assert!(matches!(contradiction, Error::TiltedMount));
    }
    assert_eq!(
        camera(&with_gimbal, None, None).unwrap(),
        Some(CameraReport::Gimbal)
    );
    assert_eq!(camera(&without, None, None).unwrap(), None);
}

/// Readings of which one lacks a number.
fn states_without(count: i32, field: &'static str, whole: i32) -> impl Iterator<Item = Value> {
    (0..).zip(states(count, 1.0)).map(move |(n, mut state)| {
        if n >= whole {
            state[field] = Value::Null;
        }
        state
    })
}

#[test]
fn what_could_not_be_written_is_told_as_enrich_would() {
    for (states, planned, missing) in [
        (
            states_without(5, "vx", 0),
            &[4][..],
            "a usable velocity sample, and /state has 0 of 5 usable, 5 without a field",
        ),
        (
            states_without(5, "yaw", 1),
            &[5],
            "2 usable attitude samples, and /state has 1 of 5 usable, 4 without",
        ),
    ] {
        let inspection = inspected(&log(&[topic("/state", states)]));
        let telemetry = telemetry(&inspection);
        let at_most = telemetry.would_write.iter().map(|planned| planned.at_most);
        assert!(at_most.eq(planned.iter().copied()));
        assert_reads(&telemetry.would_not_write[0].reason, missing);
        assert_eq!(inspection.problem, None);
    }
    let inspection = inspected(&log(&[topic("/state", states_without(5, "yaw", 0))]));
    assert!(telemetry(&inspection).would_write.is_empty());
    let problem = inspection.problem.expect("there is nothing to write");
    let words = "nothing can be derived … /camera/relative_rpy: it takes 2 usable attitude samples … \
                 /camera/velocity: it takes a usable attitude sample, and /state has 0 of 5 usable";
    assert_reads(&problem, words);
}

#[test]
fn a_gimbal_that_has_no_usable_angle_is_one_that_no_camera_can_follow() {
    let gimbal = topic("/gimbal", [json!({ "pitch": null })]);
    let log = log(&[topic("/state", states(5, 1.0)), gimbal]);
    let mut options = Options {
        telemetry: Request {
            gimbal: Some("/gimbal.pitch:degrees".parse().expect("a gimbal")),
            ..Request::default()
        },
        ..Options::default()
    };
    let problem = inspected_with(&log, &options).expect("a log").problem;
    let words = "/camera/velocity: it takes a usable gimbal sample, and /gimbal has 0 of 1 usable";
    assert_reads(&problem.expect("nothing to follow"), words);
    options.depression = common::options().depression;
    let inspection = inspected_with(&log, &options).expect("a log");
    assert_eq!(inspection.problem, None);
    assert_eq!(telemetry(&inspection).would_write.len(), 2);
}
