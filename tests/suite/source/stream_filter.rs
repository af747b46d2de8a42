//! Of a streamed log, all messages that may turn out to be its telemetry are kept: what is found and read in them is
//! what is found and read in the whole log. Nothing is kept of what clearly is not telemetry.

use std::{collections::BTreeMap, path::Path};

use flightcam::{
    log::stream::Streamed,
    source::{
        profile::{Profile, ProfileChoice},
        request::Request,
        stream_filter::StreamFilter,
    },
};
use mcap::{WriteOptions, records::op};
use proptest::prelude::*;

use crate::support::{
    Parts,
    flights::{self, flight::Flight, recordings},
    logbook::Logbook,
    piping::*,
    random_topics::{REQUESTS, any_log},
    real_logs,
    ros::Wire,
    selecting::request,
    topics::*,
};

/// A request that names the profile unless it is found automatically.
fn request_for(profile: &str) -> Request {
    let profile = Profile::load(profile).expect("a built-in profile");
    let is_automatic = profile.automatic;
    let given = ProfileChoice::Given(Box::new(profile));
    Request {
        profile: if is_automatic {
            ProfileChoice::Automatic
        } else {
            given
        },
        ..Request::default()
    }
}

#[test]
fn every_profiles_flights_are_found_and_read_whole() {
    let unchunked = || WriteOptions::new().use_chunks(false);
    let many_chunks = || WriteOptions::new().chunk_size(Some(200));
    for recording in recordings() {
        let request = request_for(recording.profile);
        let recording = recording.flying(Flight::beginning);
        let log = recording.log();
        for log in [
            rewritten(&log, unchunked()),
            rewritten(&log, many_chunks()),
            log,
        ] {
            let streamed = check(&log, &request, 4000).expect("a readable log");
            let (selected, _) = telemetry(&streamed.telemetry, &request).expect("telemetry");
            assert!(
                selected.starts_with(&format!("{:?}", recording.profile)),
                "{}: {selected}",
                recording.name
            );
        }
    }
}

#[test]
fn flights_of_several_publishers_in_one_log_are_distinguished_as_in_a_file() {
    let mut log = flights::recorder::Recorder::new();
    for (number, recording) in (0..).zip(recordings()) {
        log.rename(move |topic| match number % 3 {
            0 => topic.to_owned(),
            n => format!("/drone{n}/{}", topic.trim_start_matches('/')),
        });
        recording.flying(Flight::beginning).write(&mut log);
    }
    let log = log.finish();
    for arguments in [
        &[][..],
        &[("--profile", "mavros")],
        &[("--profile", "mavros"), ("--namespace", "/drone1")],
        &[("--namespace", "/drone2")],
        &[("--attitude", "/odom")],
    ] {
        check(&log, &request(arguments), 1_000_000);
    }
}

#[test]
fn real_flights_are_found_and_read_whole() {
    let Some(folder) = real_logs() else { return };
    for name in [
        "test_ulog.mcap",
        "test_ulog.ros2.mcap",
        "sample_px4_events.mcap",
        "sample_log_small.mcap",
    ] {
        let log = std::fs::read(folder.join(name)).expect("the log");
        let streamed = check(&log, &Request::default(), 65_536).expect("a readable log");
        let kept = streamed.telemetry.file.length();
        println!("{name}: {kept} bytes kept of {}", log.len());
    }
}

proptest! {
    #![proptest_config(crate::support::cases(256))]

    #[test]
    fn a_streamed_log_of_any_topics_gives_the_same_as_a_file(
        log in any_log(),
        arguments in prop::sample::select(REQUESTS.to_vec()),
    ) {
        check(&log, &request(arguments), 10_000);
    }
}

// ---- What is not kept ----

/// The messages that are kept of a log, by topic.
fn kept(log: &[u8], request: &Request) -> BTreeMap<String, u64> {
    let mut filter = StreamFilter::new(request);
    let mut kept = BTreeMap::new();
    let (_, streamed) = pipe(Path::new("-"), log, |passing| {
        let is_kept = filter.include(passing);
        *kept.entry(passing.channel.topic.clone()).or_default() += u64::from(is_kept);
        is_kept
    });
    streamed.expect("a readable log");
    kept
}

const COMPRESSED_VIDEO: &str =
    "message Message { string frame_id = 1; bytes data = 2; string format = 3; }";

const IMAGE: &str = "std_msgs/Header header
uint32 height
uint32 width
string encoding
uint8 is_bigendian
uint32 step
uint8[] data
===
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
";

#[test]
fn nothing_is_kept_of_what_clearly_is_not_telemetry() {
    let mut book = Logbook::with_chunks_of(50_000);
    let flat = book.json("/drone/state");
    let (video, _) = book.protobuf("/camera/video", COMPRESSED_VIDEO);
    let rates = "message Message { double roll = 1; double pitch = 2; double yaw = 3; }";
    let (rates, _) = book.protobuf("/rates", rates);
    let image = book.ros(
        Wire::LittleEndian,
        "/camera/image",
        "sensor_msgs/msg/Image",
        IMAGE,
    );
    let battery = book.ros(
        Wire::Ros1,
        "/mavros/battery",
        "sensor_msgs/BatteryState",
        "float32 voltage\nfloat32 percentage",
    );
    let cloud = book.channel(0, "/lidar", "flatbuffer");
    let json_frames = book.json("/camera/frames");
    let json_status = book.json("/status");
    let frame = format!(r#"{{"data":"{}"}}"#, "x".repeat(70_000));
    for time in 0..200 {
        book.put_flat(flat, time, "0.1", "5");
        for channel in [video, rates, image, cloud] {
            book.put(channel, time, &[1; 3000]);
        }
        book.put(battery, time, &[0; 8]);
        book.put(json_frames, time, frame.as_bytes());
        book.put(json_status, time, br#"{"mode":"AUTO"}"#);
    }
    let (_folder, path) = book.finish();
    let log = std::fs::read(path).expect("the log");
    let kept = kept(&log, &Request::default());
    assert_eq!(kept["/drone/state"], 200);
    for topic in [
        "/camera/video",
        "/rates",
        "/camera/image",
        "/mavros/battery",
        "/lidar",
    ] {
        assert_eq!(kept[topic], 0, "{topic}");
    }
    // JSON messages have to be looked at: those of the first segment.
    assert_eq!(kept["/camera/frames"], 1);
    assert!(kept["/status"] <= 10);

    let Streamed { telemetry, .. } = check(&log, &Request::default(), 65_536).expect("readable");
    assert!(
        telemetry.file.length() < 120_000,
        "{}",
        telemetry.file.length()
    );
}

#[test]
fn given_topics_are_kept_and_of_others_only_what_may_be_used_with_them() {
    let mut book = Logbook::new();
    let odd = book.channel(0, "/odd", "json");
    let flat = book.json("/drone/state");
    for time in 0..50 {
        book.put(odd, time, br#"{"a":0.1,"b":0.1,"c":0.2}"#);
        book.put_flat(flat, time, "0.1", "5");
    }
    let (_folder, path) = book.finish();
    let log = std::fs::read(path).expect("the log");
    let kept_of = |arguments: &[(&str, &str)]| {
        check(&log, &request(arguments), 65_536);
        let kept = kept(&log, &request(arguments));
        (kept["/odd"], kept["/drone/state"])
    };
    let given = ("--attitude", "/odd.a,/odd.b,/odd.c:radians");
    // The velocity is that of the profile.
    assert_eq!(kept_of(&[given]), (50, 50));
    let (odd, flat) = kept_of(&[given, ("--velocity", "/odd.a,/odd.b,/odd.c:ned")]);
    assert!(odd == 50, "{odd}");
    assert!(flat <= 50, "{flat}");
    let velocity = (
        "--velocity",
        "/drone/state.vx,/drone/state.vy,/drone/state.vz:ned",
    );
    assert_eq!(kept_of(&[given, velocity]), (50, 50));
    // It is given as the log names it, whatever the namespace of the others.
    let (odd, flat) = kept_of(&[given, velocity, ("--namespace", "/drone")]);
    assert_eq!((odd, flat), (50, 50));
    let (odd, flat) = kept_of(&[]);
    assert!(odd <= 10 && flat == 50, "{odd}");
}

#[test]
fn messages_too_long_for_samples_are_kept_until_others_decide() {
    let mut book = Logbook::with_chunks_of(10_000_000);
    let state = book.json("/drone/state");
    let long = format!(r#"{{"note":"{}"}}"#, "x".repeat(70_000));
    for time in 0..12 {
        book.put(state, time, long.as_bytes());
    }
    for time in 12..50 {
        book.put_flat(state, time, "0.1", "5");
    }
    let (_folder, path) = book.finish();
    let log = std::fs::read(path).expect("the log");
    check(&log, &Request::default(), 65_536);
    assert_eq!(kept(&log, &Request::default())["/drone/state"], 50);
}

#[test]
fn topics_defined_only_in_the_summary_are_kept() {
    let log = log(&[odometry("/odom")]);
    let unchunked = rewritten(&log, WriteOptions::new().use_chunks(false));
    for lacking in [
        &[op::SCHEMA][..],
        &[op::CHANNEL],
        &[op::SCHEMA, op::CHANNEL],
    ] {
        let mut parts = Parts::of(&unchunked);
        parts.data.retain(|(opcode, _)| !lacking.contains(opcode));
        parts.data_section_crc = 0;
        let streamed = check(&parts.join(), &Request::default(), 1000).expect("a readable log");
        let (selected, _) = telemetry(&streamed.telemetry, &Request::default()).expect("telemetry");
        assert!(selected.starts_with("\"nav-msgs\""), "{selected}");
    }
}
