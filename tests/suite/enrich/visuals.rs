//! `--visuals` from a log to a log: what is written, what is reported, and that nothing of the log is lost.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    fs,
    io::Cursor,
    sync::Arc,
};

use flightcam::{
    DropReason, Encoding, EncodingChoice, Kind, Layout, Note, Options, PassedOver, Report,
    camera::FieldOfView,
    report::{GroundBecause, Lack, MissingReason},
    restore,
    visuals::{Ground, VisualOptions, VisualRate},
};
use foxglove::{
    Encode,
    messages::{CameraCalibration, FrameTransform, FrameTransforms, Odometry, SceneUpdate},
};
use mcap::{Message, MessageStream, WriteOptions};
use serde_json::json;

use crate::support::{
    ReadMessage, check_index_leads_to, enrich_bytes_with,
    flights::{recording_for, recordings_for},
    layout::summary_of,
    options, real_logs, recount, repository, stream,
    topics::{log as log_of, topic},
};

fn survey_flight() -> Vec<u8> {
    fs::read(repository("fixtures/survey_flight.mcap")).expect("the demonstration flight")
}

fn seen() -> FieldOfView {
    FieldOfView::from_degrees(70.0, 50.0).expect("it is in range")
}

fn showing(visuals: VisualOptions) -> Options {
    options().visuals(visuals)
}

fn everything() -> Options {
    showing(VisualOptions::new().field_of_view(seen()))
}

fn enriched(log: &[u8], options: &Options) -> (Vec<u8>, Report) {
    enrich_bytes_with(log, options).expect("a result")
}

/// How many messages the report says that each topic has.
fn written(report: &Report) -> BTreeMap<&'static str, u64> {
    let topics = report.written.iter();
    topics.map(|topic| (topic.topic, topic.messages)).collect()
}

fn lacks(report: &Report) -> BTreeMap<&'static str, Lack> {
    let missing = report.not_written.iter();
    missing
        .filter_map(|missing| match missing.reason {
            MissingReason::NotShown { lack } => Some((missing.topic, lack)),
            _ => None,
        })
        .collect()
}

/// The messages of a result that the log does not have, in the order of the file.
fn new(report: &Report, result: &[u8]) -> Vec<ReadMessage> {
    let topics: BTreeSet<&str> = report.written.iter().map(|topic| topic.topic).collect();
    let mut messages = stream(result, false);
    messages.retain(|message| topics.contains(message.topic.as_str()));
    messages
}

fn of_topic<T: prost::Message + Default>(messages: &[ReadMessage], topic: &str) -> Vec<(u64, T)> {
    let messages = messages.iter().filter(|message| message.topic == topic);
    messages
        .map(|message| {
            let decoded = T::decode(&message.payload[..]).expect("a message of the type");
            (message.log_time, decoded)
        })
        .collect()
}

#[test]
fn the_demonstration_flight_has_all_that_can_be_shown() {
    let log = survey_flight();
    let (result, report) = enriched(&log, &everything());
    let ticks = written(&report)["/camera/transforms"];
    assert_eq!(
        written(&report),
        BTreeMap::from([
            ("/camera/relative_rpy", 3309),
            ("/camera/orientation", 3310),
            ("/camera/velocity", 3310),
            ("/camera/transforms_static", 1),
            ("/camera/transforms", 1986),
            ("/camera/odometry", ticks),
            ("/camera/pose", ticks),
            ("/camera/display", ticks),
            ("/camera/scene", ticks / 3),
            ("/camera/location", ticks / 6),
            ("/camera/model", 1),
            ("/camera/path", 1),
            ("/camera/calibration", 1),
            ("/camera/footprint", 1),
            ("/camera/state", 2),
        ])
    );
    assert_eq!(
        lacks(&report),
        BTreeMap::from([
            ("/camera/events", Lack::Incident),
            ("/camera/log", Lack::Incident)
        ])
    );
    let visuals = report.visuals.as_ref().expect("a report on them");
    assert_eq!((visuals.transforms_hz, visuals.scenes_hz), (30.0, 10.0));
    let ground = visuals.ground.as_ref().expect("positions are known");
    assert_eq!(ground.because, GroundBecause::Assumed);
    let field_of_view = visuals.field_of_view.as_ref().expect("it is given");
    assert!((field_of_view.degrees[0] - 70.0).abs() < 1e-9);
    assert_eq!(field_of_view.calibration, None);

    // The log's own data is as it was, and the result is consistent.
    let kept = report.bytes_kept as usize;
    assert!(result[..kept] == log[..kept]);
    assert_eq!(summary_of(&result).stats, Some(recount(&result)));
    check_index_leads_to(stream(&result, false), &result);
}

#[test]
fn what_is_shown_once_is_there_from_the_first_moment_on() {
    let (result, report) = enriched(&survey_flight(), &everything());
    let messages = new(&report, &result);
    let first = messages.iter().map(|message| message.log_time).min();
    for topic in [
        "/camera/transforms_static",
        "/camera/model",
        "/camera/path",
        "/camera/calibration",
        "/camera/footprint",
        "/camera/state",
    ] {
        let message = messages.iter().find(|message| message.topic == topic);
        assert_eq!(message.map(|message| message.log_time), first, "{topic}");
    }
}

#[test]
fn chunks_for_viewers_are_short_in_time() {
    let (result, report) = enriched(&survey_flight(), &everything());
    let new: BTreeSet<u16> = (summary_of(&result).channels.values())
        .filter(|channel| {
            report
                .written
                .iter()
                .any(|topic| topic.topic == channel.topic)
        })
        .map(|channel| channel.id)
        .collect();
    let summary = summary_of(&result);
    let chunks = (summary.chunk_indexes.iter()).filter(|chunk| {
        chunk
            .message_index_offsets
            .keys()
            .any(|id| new.contains(id))
    });
    for chunk in chunks {
        // No chunk of one megabyte holds both ends of what is shown and nothing in between.
        assert!(chunk.uncompressed_size < 1_300_000);
    }
}

#[test]
fn transforms_and_odometry_say_where_the_camera_is() {
    let (result, report) = enriched(&survey_flight(), &everything());
    let messages = new(&report, &result);
    let transforms: Vec<(u64, FrameTransforms)> = of_topic(&messages, "/camera/transforms");
    let odometries: Vec<(u64, Odometry)> = of_topic(&messages, "/camera/odometry");
    assert_eq!(transforms.len(), odometries.len());
    for ((time, transforms), (same_time, odometry)) in transforms.iter().zip(&odometries) {
        assert_eq!(time, same_time);
        let names = |transform: &FrameTransform| {
            (
                transform.parent_frame_id.clone(),
                transform.child_frame_id.clone(),
            )
        };
        let chain: Vec<(String, String)> = transforms.transforms.iter().map(names).collect();
        assert_eq!(chain[0], ("ned".to_owned(), "drone".to_owned()));
        assert_eq!(chain[1], ("drone".to_owned(), "camera".to_owned()));
        assert_eq!(odometry.frame_id, "map");
        assert_eq!(odometry.body_frame_id, "camera");
        let ned = transforms.transforms[0].translation.expect("a translation");
        let map = odometry.pose.as_ref().and_then(|pose| pose.position);
        let map = map.expect("a position");
        assert_eq!([map.x, map.y, map.z], [ned.y, ned.x, -ned.z]);
        assert!(odometry.pose_covariance.is_empty() && odometry.velocity_covariance.is_empty());
    }
}

#[test]
fn rates_and_ground_are_those_that_are_asked_for() {
    let rate = VisualRate::from_hertz(5.0).expect("it is in range");
    let visuals = VisualOptions::new()
        .rate(rate)
        .ground(Ground::Altitude(500.0));
    let (_, report) = enriched(&survey_flight(), &showing(visuals));
    let counts = written(&report);
    assert_eq!(counts["/camera/transforms"], 331);
    assert_eq!(counts["/camera/scene"], 331);
    assert_eq!(counts["/camera/location"], 331);
    let visuals = report.visuals.as_ref().expect("a report on them");
    let ground = visuals.ground.as_ref().expect("positions are known");
    assert_eq!(
        (ground.altitude_m, &ground.because),
        (500.0, &GroundBecause::Given)
    );
    assert_eq!(visuals.field_of_view, None);
    let lacks = lacks(&report);
    assert_eq!(lacks["/camera/calibration"], Lack::FieldOfView);
    assert_eq!(lacks["/camera/footprint"], Lack::FieldOfView);
}

#[test]
fn in_every_encoding_the_same_is_shown() {
    let log = survey_flight();
    let counts = Encoding::ALL.map(|encoding| {
        let options = everything().encoding(EncodingChoice::Given(encoding));
        let (result, report) = enriched(&log, &options);
        check_index_leads_to(stream(&result, false), &result);
        let mut counts = written(&report);
        if encoding == Encoding::Ros2 {
            // A log without transforms gets them where ROS 2 expects them.
            for (theirs, ours) in [
                ("/tf", "/camera/transforms"),
                ("/tf_static", "/camera/transforms_static"),
            ] {
                let count = counts.remove(theirs).expect("transforms");
                counts.insert(ours, count);
            }
        }
        counts
    });
    assert_eq!(counts[0], counts[1]);
    assert_eq!(counts[0], counts[2]);
}

#[test]
fn interleaved_everything_is_in_the_order_of_its_times() {
    let log = survey_flight();
    let options = everything().layout(Layout::Interleaved);
    let (result, report) = enriched(&log, &options);
    let interleaved = new(&report, &result);
    assert!(interleaved.is_sorted_by_key(|message| message.log_time));
    let (appended, of_appended) = enriched(&log, &everything());
    assert_eq!(written(&report), written(&of_appended));
    let sorted = |mut messages: Vec<ReadMessage>| {
        messages.sort();
        messages
    };
    assert!(sorted(interleaved) == sorted(new(&of_appended, &appended)));
    check_index_leads_to(stream(&result, false), &result);
}

/// A log of PX4 in JSON, whose receiver never had a fix.
fn without_a_fix() -> Vec<u8> {
    let attitude = |_| json!({"q": [1, 0, 0, 0], "quat_reset_counter": 0});
    let fix = |_| json!({"latitude_deg": 0, "longitude_deg": 0, "altitude_msl_m": 0});
    let local = |number: u32| {
        let north = f64::from(number) * 0.1;
        json!({
            "x": north, "y": 0, "z": -10, "vx": 5, "vy": 0, "vz": 0,
            "xy_valid": true, "z_valid": true, "v_xy_valid": true, "v_z_valid": true,
        })
    };
    log_of(&[
        topic("/vehicle_attitude", (0..200).map(attitude)),
        topic("/vehicle_gps_position", (0..200).map(fix)),
        topic("/vehicle_local_position", (0..200).map(local)),
    ])
}

#[test]
fn positions_are_chosen_by_what_their_messages_hold_where_they_are_shown() {
    let log = without_a_fix();
    let (_, report) = enriched(&log, &everything());
    let positions = &report.samples[&Kind::Position];
    assert_eq!(
        positions.topic.as_ref().expect("a topic").as_str(),
        "/vehicle_local_position"
    );
    assert_eq!(positions.tally.used, 200);
    let passed_over = report.notes.iter().find_map(|note| match note {
        Note::PassedOver(passed_over) => Some(passed_over),
        _ => None,
    });
    let PassedOver { role, place, .. } = passed_over.expect("a note");
    assert_eq!(*role, Kind::Position);
    assert_eq!(place.origin.topic.as_str(), "/vehicle_gps_position");
    assert!(place.looked_at.dropped.contains_key(&DropReason::NotAPlace));
}

#[test]
fn what_is_read_is_counted_in_every_layout() {
    let log = survey_flight();
    let (_, appended) = enriched(&log, &everything());
    let (_, interleaved) = enriched(&log, &everything().layout(Layout::Interleaved));
    assert_eq!(appended.samples[&Kind::Position].tally.total(), 3310);
    assert_eq!(appended.samples, interleaved.samples);
}

#[test]
fn the_log_can_be_given_back_and_enriched_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("log.mcap");
    let log = survey_flight();
    fs::write(&path, &log).expect("written");
    let in_place = || flightcam::Output::InPlace;
    let first = flightcam::enrich(&path, in_place(), &everything()).expect("a result");
    // Without them the second time: they are gone.
    let second = flightcam::enrich(&path, in_place(), &options()).expect("a result");
    assert_eq!(written(&second).len(), 3);
    let topics: BTreeSet<String> = (summary_of(&fs::read(&path).expect("read"))
        .channels
        .values())
    .map(|channel| channel.topic.clone())
    .collect();
    assert!(topics.iter().all(|topic| topic != "/camera/scene"));
    // And again with them: each once.
    let third = flightcam::enrich(&path, in_place(), &everything()).expect("a result");
    assert_eq!(written(&third), written(&first));
    restore(&path, in_place(), &flightcam::watch::Watch::default()).expect("restored");
    assert!(fs::read(&path).expect("read") == log);
}

/// A log with one more channel and one message on it.
fn beside<T: Encode>(log: &[u8], topic: &str, message: &T) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression_threads(0);
    let mut writer = options.create(&mut file).expect("a writer");
    let mut payload = Vec::new();
    assert!(message.encode(&mut payload).is_ok(), "a vector grows");
    let schema = T::get_schema().expect("a schema");
    let channel = Arc::new(mcap::Channel {
        id: 900,
        topic: topic.to_owned(),
        schema: Some(Arc::new(mcap::Schema {
            id: 900,
            name: schema.name.to_string(),
            encoding: schema.encoding.to_string(),
            data: Cow::Owned(schema.data.to_vec()),
        })),
        message_encoding: T::get_message_encoding(),
        metadata: BTreeMap::new(),
    });
    for (number, read) in MessageStream::new(log).expect("a readable log").enumerate() {
        let read = read.expect("a message");
        if number == 0 {
            let one = Message {
                channel: Arc::clone(&channel),
                sequence: 0,
                log_time: read.log_time,
                publish_time: read.log_time,
                data: Cow::Owned(payload.clone()),
            };
            writer.write(&one).expect("it is written");
        }
        writer.write(&read).expect("it is written");
    }
    writer.finish().expect("the log is finished");
    drop(writer);
    file.into_inner()
}

fn transform_of_another() -> FrameTransforms {
    FrameTransforms {
        transforms: vec![FrameTransform {
            parent_frame_id: "map".to_owned(),
            child_frame_id: "base_link".to_owned(),
            ..FrameTransform::default()
        }],
    }
}

#[test]
fn frames_have_a_prefix_where_the_log_has_transforms_of_its_own() {
    // MAVROS has a frame `map`, too.
    for recording in recordings_for("mavros").take(2) {
        let log = beside(&recording.log(), "/tf", &transform_of_another());
        let options = everything().encoding(EncodingChoice::Given(Encoding::Protobuf));
        let (result, report) = enriched(&log, &options);
        let messages = new(&report, &result);
        let scenes: Vec<(u64, SceneUpdate)> = of_topic(&messages, "/camera/scene");
        for (_, scene) in scenes {
            for entity in scene.entities {
                assert!(
                    entity.frame_id.starts_with("flightcam/"),
                    "{}",
                    entity.frame_id
                );
            }
        }
        for topic in ["/camera/transforms", "/camera/transforms_static"] {
            let transforms: Vec<(u64, FrameTransforms)> = of_topic(&messages, topic);
            assert!(!transforms.is_empty());
            for transform in transforms.into_iter().flat_map(|(_, all)| all.transforms) {
                assert!(transform.parent_frame_id.starts_with("flightcam/"));
                assert!(transform.child_frame_id.starts_with("flightcam/"));
            }
        }
    }
}

#[test]
fn in_a_ros2_log_with_transforms_they_are_left_alone() {
    let recording = recording_for("px4-ros2");
    let (_, without) = enriched(&recording.log(), &everything());
    assert!(written(&without).contains_key("/tf"));
    let log = beside(&recording.log(), "/tf", &transform_of_another());
    let (_, with) = enriched(&log, &everything());
    assert!(!written(&with).contains_key("/tf"));
    assert!(written(&with).contains_key("/camera/transforms"));
    assert!(written(&with).contains_key("/camera/transforms_static"));
}

#[test]
fn a_calibration_in_the_log_says_what_the_camera_sees() {
    let calibration = CameraCalibration {
        width: 640,
        height: 480,
        frame_id: "lens".to_owned(),
        k: vec![500.0, 0.0, 310.0, 0.0, 510.0, 250.0, 0.0, 0.0, 1.0],
        ..CameraCalibration::default()
    };
    let log = beside(&survey_flight(), "/lens/calibration", &calibration);
    let (result, report) = enriched(&log, &showing(VisualOptions::new()));
    let visuals = report.visuals.as_ref().expect("a report on them");
    let field_of_view = visuals.field_of_view.as_ref().expect("the log says it");
    let topic = field_of_view
        .calibration
        .as_ref()
        .map(|topic| topic.as_str());
    assert_eq!(
        (topic, field_of_view.others),
        (Some("/lens/calibration"), 0)
    );
    let wide = (310.0f64 / 500.0).atan() + (330.0f64 / 500.0).atan();
    assert!((field_of_view.degrees[0] - wide.to_degrees()).abs() < 1e-9);
    let messages = new(&report, &result);
    let written: Vec<(u64, CameraCalibration)> = of_topic(&messages, "/camera/calibration");
    let [(_, written)] = &written[..] else {
        panic!("{written:?}")
    };
    assert_eq!(written.frame_id, "camera_optical");
    assert_eq!((written.width, written.height), (640, 480));
    assert_eq!(written.k, calibration.k);
    // What is asked for takes precedence.
    let (_, report) = enriched(&log, &everything());
    let visuals = report.visuals.as_ref().expect("a report on them");
    let field_of_view = visuals.field_of_view.as_ref().expect("it is given");
    assert_eq!(field_of_view.calibration, None);
    // One of a camera that was never calibrated says nothing.
    let uncalibrated = CameraCalibration {
        k: vec![0.0; 9],
        ..calibration
    };
    let log = beside(&survey_flight(), "/lens/calibration", &uncalibrated);
    let (_, report) = enriched(&log, &showing(VisualOptions::new()));
    assert_eq!(
        report.visuals.expect("a report on them").field_of_view,
        None
    );
}

#[test]
fn a_topic_of_another_program_is_refused_only_with_visuals() {
    let calibration = CameraCalibration::default();
    let log = beside(&survey_flight(), "/camera/calibration", &calibration);
    enrich_bytes_with(&log, &options()).expect("the topic is not needed");
    let refused = enrich_bytes_with(&log, &everything()).expect_err("the topic is taken");
    let message = refused.to_string();
    assert!(
        message.contains("already has a topic /camera/calibration"),
        "{message}"
    );
}

#[test]
fn recordings_of_all_publishers_are_shown() {
    for profile in [
        "px4-ulog",
        "px4-ros2",
        "mavros",
        "ardupilot-ros2",
        "dji-osdk",
        "nav-msgs",
    ] {
        let recording = recording_for(profile);
        let (result, report) = enriched(&recording.log(), &everything());
        let counts = written(&report);
        let transforms = counts.get("/tf").or(counts.get("/camera/transforms"));
        assert!(
            *transforms.expect("transforms") > 60,
            "{}: {counts:?}",
            recording.name
        );
        assert!(counts["/camera/scene"] > 20 && counts["/camera/display"] > 60);
        check_index_leads_to(stream(&result, false), &result);
    }
}

#[test]
fn real_logs_are_shown() {
    let Some(folder) = real_logs() else { return };
    for log in [
        "test_ulog.mcap",
        "test_ulog.ros2.mcap",
        "sample_log_small.mcap",
    ] {
        let log = fs::read(folder.join(log)).expect("a log");
        let (result, report) = enriched(&log, &everything());
        let counts = written(&report);
        let transforms = counts.get("/tf").or(counts.get("/camera/transforms"));
        assert!(*transforms.expect("transforms") > 100, "{counts:?}");
        assert_eq!(counts["/camera/path"], 1);
        // Odometry needs a velocity, and one of the logs has none that is valid.
        let has_velocity = counts.contains_key("/camera/velocity");
        assert_eq!(counts.contains_key("/camera/odometry"), has_velocity);
        check_index_leads_to(stream(&result, false), &result);
    }
}
