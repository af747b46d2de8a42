//! Which of several places a role is read from, by what their messages hold.

use flightcam::{
    Input, Note, PassedOver,
    enrich::{derive, enrich},
    inspect::inspect,
    log::Log,
    run::Output,
    sample::Kind,
    source::{Source, request::Request},
};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::{io::Cursor, ops::ControlFlow};

use crate::support::{folder::*, logbook::Logbook, options, selecting::*, topics::*};

mod alternatives;
mod between_profiles;

fn times(count: usize, topic: Topic) -> Topic {
    let messages = topic.messages.iter().cycle().take(count);
    Topic {
        messages: messages.cloned().collect(),
        ..topic
    }
}

#[track_caller]
fn source(topics: &[Topic], request: &Request) -> Source {
    select_with(topics, request).unwrap_or_else(|error| panic!("{error}"))
}

/// Of what was passed over: the topic, how many messages it has, how many of those that were looked at are usable, and how
/// many are not, for which reason.
type Passed<'a> = (&'a str, u64, u64, Vec<(&'a str, u64)>);

/// The topic of a role, and what was passed over for it.
fn choice(source: &Source, kind: Kind) -> (&str, Vec<Passed<'_>>) {
    let topic = source.role(kind).expect("a role").topic.as_str();
    let passed_over = source.passed_over.iter().filter(|one| one.role == kind);
    let passed_over = passed_over.map(|PassedOver { place, instead, .. }| {
        assert_eq!(instead.origin.topic, topic);
        let dropped = place.looked_at.dropped.iter();
        let dropped = dropped.map(|(reason, count)| (reason.name(), *count));
        let (messages, used) = (place.messages, place.looked_at.used);
        (
            place.origin.topic.as_str(),
            messages,
            used,
            dropped.collect(),
        )
    });
    (topic, passed_over.collect())
}

const POSE: &str = "/mavros/local_position/pose";
const IMU: &str = "/mavros/imu/data";
const ODOM: &str = "/mavros/local_position/odom";

fn imu(covariance: f64) -> Topic {
    let covariance: Vec<f64> = [covariance].into_iter().chain([0.0; 8]).collect();
    let message = json!({ "orientation": quaternion(), "orientation_covariance": covariance });
    twice(IMU, message).of_type("sensor_msgs/Imu")
}

fn invalid(topic: Topic) -> Topic {
    let messages = topic.messages.iter().map(|message| {
        let mut message: Value = serde_json::from_slice(message).expect("JSON");
        message["v_xy_valid"] = json!(false);
        message.to_string().into_bytes()
    });
    Topic {
        messages: messages.collect(),
        ..topic
    }
}

fn px4_odometry() -> Topic {
    let message =
        json!({ "pose_frame": 1, "q": [1, 0, 0, 0], "velocity_frame": 1, "velocity": [1, 0, 0] });
    twice("/fmu/out/vehicle_odometry", message)
}

fn unusable(topic: Topic) -> Topic {
    let messages = topic.messages.iter();
    let messages = messages.map(|message| {
        let message = String::from_utf8_lossy(message);
        message.replace(r#""w":1"#, r#""w":0"#).into_bytes()
    });
    Topic {
        messages: messages.collect(),
        ..topic
    }
}

fn px4(valid: bool) -> [Topic; 2] {
    let position = local_position("/fmu/out/vehicle_local_position");
    let position = if valid { position } else { invalid(position) };
    [attitude("/fmu/out/vehicle_attitude"), position]
}

fn mavros(valid: bool) -> [Topic; 2] {
    let name = "/mavros/local_position/velocity_local";
    let x = if valid { json!(1) } else { json!("NaN") };
    let linear = json!({ "x": x, "y": 0, "z": 0 });
    let velocity = twice(name, json!({ "twist": { "linear": linear } }));
    [
        pose(POSE),
        velocity.of_type("geometry_msgs/msg/TwistStamped"),
    ]
}

// ---- Too few messages ----

#[test]
fn a_stray_message_does_not_beat_a_series() {
    let topics = [pose(POSE), times(1000, imu(0.0))];
    let stray = [times(1, pose(POSE)), times(1000, imu(0.0))];
    for topics in [topics, stray] {
        let count = topics[0].messages.len() as u64;
        let found = source(&topics, &Request::default());
        let expected = vec![(POSE, count, count, vec![])];
        assert_eq!(choice(&found, Kind::Attitude), (IMU, expected));
    }
}

/// The first place has `first` messages, the second `second`.
fn is_first_used(first: usize, second: usize) -> bool {
    let topics = [times(first, pose(POSE)), times(second, imu(0.0))];
    let source = source(&topics, &Request::default());
    let (topic, passed_over) = choice(&source, Kind::Attitude);
    assert_eq!(passed_over.len(), usize::from(topic == IMU));
    topic == POSE
}

#[test]
fn the_order_counts_where_the_first_has_a_hundred_messages_or_one_in_fifty_of_the_others() {
    for (first, second) in [
        (1, 1),
        (1, 50),
        (2, 100),
        (20, 1000),
        (99, 4950),
        (100, 6000),
    ] {
        assert!(is_first_used(first, second), "{first} and {second}");
    }
    for (first, second) in [(1, 51), (2, 101), (19, 1000), (99, 4951)] {
        assert!(!is_first_used(first, second), "{first} and {second}");
    }
}

#[test]
fn of_several_places_the_first_is_used_that_is_not_a_stray() {
    let topics = [
        times(1, pose(POSE)),
        times(300, imu(0.0)),
        times(9000, odometry(ODOM)),
    ];
    let source = source(&topics, &Request::default());
    let expected = vec![(POSE, 1, 1, vec![])];
    assert_eq!(choice(&source, Kind::Attitude), (IMU, expected));
}

// ---- No usable messages ----

#[test]
fn an_attitude_that_is_never_valid_does_not_beat_one_that_is() {
    let topics = [times(30, imu(-1.0)), times(20, odometry(ODOM))];
    let source = source(&topics, &Request::default());
    let expected = vec![(IMU, 30, 0, vec![("no_orientation", 30)])];
    assert_eq!(choice(&source, Kind::Attitude), (ODOM, expected));
}

#[test]
fn a_velocity_that_is_never_valid_does_not_beat_one_that_is() {
    let position = "/fmu/out/vehicle_local_position";
    let topics = [
        attitude("/fmu/out/vehicle_attitude"),
        times(400, invalid(local_position(position))),
        px4_odometry(),
    ];
    let found = source(&topics, &Request::default());
    let expected = vec![(position, 400, 0, vec![("marked_invalid", 100)])];
    assert_eq!(
        choice(&found, Kind::Velocity),
        ("/fmu/out/vehicle_odometry", expected)
    );
    // Valid once in a while is enough, as it is if nothing better is there.
    let mut now_and_then = topics.clone();
    for message in now_and_then[1].messages.iter_mut().step_by(5) {
        *message = local_position(position).messages[0].clone();
    }
    for topics in [&now_and_then[..], &topics[..2]] {
        let source = source(topics, &Request::default());
        assert_eq!(choice(&source, Kind::Velocity), (position, vec![]));
    }
}

#[test]
fn numbers_that_are_none_throughout_are_not_usable() {
    let profile = own(r#"
        name = "own"
        attitude = { topics = ["/a"], orientation.quaternion = "q", convention = "frd-ned" }
        velocity = { topics = ["/v", "/w"], vector = "v", frame = "ned" }
        gimbal = [
            { topics = ["/g"], orientation.pitch = { field = "p", unit = "degrees" }, reference = "heading" },
            { topics = ["/h"], orientation.pitch = { field = "p", unit = "degrees" }, reference = "heading" },
        ]"#);
    let topics = [
        attitude("/a"),
        twice("/v", json!({ "v": ["NaN", "NaN", "NaN"] })),
        twice("/w", json!({ "v": [1, 2, 3] })),
        twice("/g", json!({ "p": "NaN" })),
        twice("/h", json!({ "p": -30 })),
    ];
    let source = source(&topics, &profile);
    let none = |topic| vec![(topic, 2, 0, vec![("non_finite", 2)])];
    assert_eq!(choice(&source, Kind::Velocity), ("/w", none("/v")));
    assert_eq!(choice(&source, Kind::Gimbal), ("/h", none("/g")));
}

#[test]
fn if_nothing_is_usable_the_first_place_is_used() {
    let topics = [times(5, imu(-1.0)), unusable(odometry(ODOM))];
    let source = source(&topics, &Request::default());
    assert_eq!(choice(&source, Kind::Attitude), (IMU, vec![]));
}

/// The first place is valid only in a small part of the log, wherever that is.
#[test]
fn a_place_that_is_usable_for_a_tenth_of_the_flight_is_found_usable() {
    for part in 0..10 {
        let mut book = Logbook::with_chunks_of(2000);
        let [first, second] = [POSE, ODOM].map(|name| book.channel(0, name, "json"));
        for time in 0..3000 {
            let is_valid = time / 300 == part;
            let w = if is_valid { 1.0 } else { 0.0 };
            let orientation = json!({ "w": w, "x": 0, "y": 0, "z": 0 });
            let pose = json!({ "pose": { "orientation": orientation } });
            book.put(first, time, pose.to_string().as_bytes());
            book.put(second, time, &odometry(ODOM).messages[0]);
        }
        let (_folder, path) = book.finish();
        let log = Log::open(&path).expect("a log");
        let source = Source::select(&log, &Request::default()).expect("a source");
        assert_eq!(source.attitude().topic, POSE, "in part {part}");
    }
}

// ---- The same everywhere ----

fn enriched(topics: &[Topic]) -> flightcam::Report {
    let folder = Folder::with(LOG, log(topics));
    enrich(folder.path(LOG), folder.path(RESULT), &options()).expect("a result")
}

fn on_passing_over(notes: &[Note]) -> Vec<&Note> {
    let is_meant = |note: &&Note| matches!(note, Note::PassedOver(_));
    notes.iter().filter(is_meant).collect()
}

#[test]
fn all_ways_of_reading_a_log_choose_the_same_and_say_so() {
    let topics = [
        times(1, pose(POSE)),
        times(700, imu(0.0)),
        times(200, mavros(false)[1].clone()),
        times(300, odometry(ODOM)),
    ];
    let bytes = log(&topics);
    let folder = Folder::with(LOG, &bytes);
    let report = enrich(folder.path(LOG), folder.path(RESULT), &options()).expect("a result");
    assert_eq!(report.samples[&Kind::Attitude].topic.as_deref(), Some(IMU));
    assert_eq!(report.samples[&Kind::Velocity].topic.as_deref(), Some(ODOM));
    let notes = on_passing_over(&report.notes);
    assert_eq!(notes.len(), 2, "{:?}", report.notes);

    // What is only shown was chosen in the same way.
    let inspection = inspect(folder.path(LOG), &options()).expect("an inspection");
    let inspected = on_passing_over(&inspection.notes).into_iter();
    let is_of_position =
        |note: &&Note| matches!(note, Note::PassedOver(one) if one.role == Kind::Position);
    let (of_position, others): (Vec<&Note>, Vec<&Note>) = inspected.partition(is_of_position);
    assert_eq!((of_position.len(), &others), (1, &notes));

    let mut result = Vec::new();
    let streamed = enrich(
        Input::stream("log", Cursor::new(bytes.clone())),
        Output::stream("result", &mut result),
        &options(),
    );
    let streamed = streamed.expect("a result");
    assert_eq!(on_passing_over(&streamed.notes), notes);
    assert_eq!(streamed.samples, report.samples);

    let mut count = 0;
    let derived = derive(folder.path(LOG), &options(), |values| {
        count += values.len() as u64;
        ControlFlow::Continue(())
    });
    let derived = derived.expect("a readable log").expect("to its end");
    assert_eq!(on_passing_over(&derived.notes), notes);
    assert_eq!(
        count,
        report
            .written
            .iter()
            .map(|topic| topic.messages)
            .sum::<u64>()
    );
}

#[test]
fn the_command_line_says_what_was_passed_over_and_why() {
    let topics = [
        times(1, pose(POSE)),
        times(700, imu(0.0)),
        times(200, mavros(false)[1].clone()),
        times(300, odometry(ODOM)),
    ];
    let folder = Folder::with(LOG, log(&topics));
    let arguments = format!("enrich {LOG} -o {RESULT} --depression 30");
    let words = "the attitude is read from /mavros/imu/data, not from /mavros/local_position/pose: \
                 that has 1 message, and the other 700 … \
                 the velocity is read from /mavros/local_position/odom, \
                 not from /mavros/local_position/velocity_local: \
                 none of 100 of its 200 messages that were looked at is usable (100 with a number that is not finite)";
    assert_reads(&folder.run(&arguments, 0).0, words);
    assert_reads(&folder.run(&format!("inspect {LOG}"), 0).0, words);
    let topics = [px4(false), mavros(true)].concat();
    let folder = Folder::with(LOG, log(&topics));
    let words = "the velocity is read from /mavros/local_position/velocity_local, not from \
                 /fmu/out/vehicle_local_position, which the profile px4-ros2 reads: \
                 none of its 2 messages is usable (2 marked invalid by the log)";
    assert_reads(&folder.run(&arguments, 0).0, words);
}

/// Spoils the content of a log's chunks.
fn spoilt(log: &[u8]) -> Vec<u8> {
    let mut log = log.to_vec();
    let chunks = crate::support::numbered::chunk_indexes(&log);
    for chunk in chunks {
        let end = (chunk.chunk_start_offset + chunk.chunk_length) as usize;
        log[end - 20..end].fill(0xc5);
    }
    log
}

#[test]
fn messages_are_looked_at_only_where_there_is_a_choice() {
    let with = |topics: &[&str]| {
        let mut book = Logbook::with_chunks_of(1_000_000);
        let fields = "message Message { repeated double q = 1; double lat = 2; double lon = 3; double alt = 4; }";
        let attitude = "/fmu/out/vehicle_attitude";
        for topic in [attitude].iter().chain(topics) {
            let (channel, _) = book.protobuf(topic, fields);
            book.put(channel, 1, &[]);
        }
        let (_folder, path) = book.finish();
        let log = std::fs::read(path).expect("the log");
        let folder = Folder::with(LOG, spoilt(&log));
        let log = Log::open(&folder.path(LOG)).expect("a summary");
        let request = Request::default();
        [
            Source::select(&log, &request),
            Source::compare(&log, &request),
        ]
        .map(|source| source.map_err(|error| error.to_string()))
    };
    let is_damaged = |source: &Result<Source, String>| {
        source
            .as_ref()
            .is_err_and(|error| error.contains("damaged"))
    };
    assert!(with(&[]).iter().all(Result::is_ok));
    assert!(
        with(&["/fmu/out/vehicle_attitude_v1"])
            .iter()
            .all(is_damaged)
    );
    // Nothing is derived from positions. They are only shown, where all is compared.
    let positions = [
        "/fmu/out/vehicle_global_position",
        "/fmu/out/vehicle_gps_position",
    ];
    let [selected, compared] = with(&positions);
    assert!(selected.is_ok() && is_damaged(&compared));
}

proptest! {
    #![proptest_config(crate::support::cases(30))]

    /// The rule, for any numbers of messages, of which any share is usable.
    #[test]
    fn the_first_place_is_used_that_has_enough_usable_messages(
        counts in prop::collection::vec((1..400usize, 0..=10u32), 3),
    ) {
        let places = [POSE, IMU, ODOM];
        let topics: Vec<Topic> = places.into_iter().zip(&counts).map(|(name, &(count, tenths))| {
            let usual = [pose(POSE), imu(0.0), odometry(ODOM)].into_iter().find(|one| one.name == name);
            let usual = usual.expect("one of them");
            let not_usable = unusable(usual.clone());
            let messages = (0..count).map(|n| match (n * 7 % 10) < tenths as usize {
                true => usual.messages[0].clone(),
                false => not_usable.messages[0].clone(),
            });
            Topic { messages: messages.collect(), ..usual }
        }).collect();
        let source = source(&topics, &Request::default());
        let (topic, passed_over) = choice(&source, Kind::Attitude);
        let chosen = places.iter().position(|place| *place == topic).expect("a place");
        prop_assert_eq!(passed_over.len(), chosen);
        let usable = |place: usize| counts[place].0 as f64 * f64::from(counts[place].1) / 10.0;
        let most = (0..3).map(usable).fold(0.0, f64::max);
        // Of some only an estimate is known, which may be off by a few messages.
        for place in 0..chosen {
            prop_assert!(usable(place) < 115.0 && usable(place) <= most / 50.0 + 12.0, "{counts:?}: {topic}");
        }
        prop_assert!(most == 0.0 || usable(chosen) > 0.0, "{counts:?}: {topic}");
    }
}
