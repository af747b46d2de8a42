//! Samples from messages: schemas of all kinds, fields in messages, and which samples are used.

use std::collections::BTreeSet;

use flightcam::{sample::Kind, source::profile::Profile};
use prost::Message;
use prost_reflect::DynamicMessage;

use crate::support::{logbook::*, message::DerivedMessage, small_logs::*};

#[test]
fn samples_come_in_time_order_whatever_their_order_in_the_file() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    for time in [40, 10, 30, 20, 0, 50] {
        log.put_flat(channel, time, &format!("{}", time as f64 / 100.0), "1");
    }
    let (derived, _) = log.enrich(None).expect("a result");
    assert_eq!(
        yaws(&derived),
        [(10, 0.1), (20, 0.1), (30, 0.1), (40, 0.1), (50, 0.1)]
    );
    assert!(derived.is_sorted_by_key(|message| message.log_time));
}

#[test]
fn the_first_in_the_file_of_simultaneous_samples_is_used() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    log.put_flat(channel, 0, "0", "1");
    for yaw in ["0.1", "0.2", "0.3"] {
        // Far apart in the file, so that they are in different chunks.
        log.put_flat(channel, 20, yaw, "1");
        for time in 100..120 {
            log.put_flat(channel, time, yaw, "1");
        }
    }
    let (derived, report) = log.enrich(None).expect("a result");
    assert_eq!(yaws(&derived)[0], (20, 0.1));
    assert_eq!(
        dropped(&report.samples[&Kind::Attitude].tally),
        [("duplicate_time", 42)]
    );
    assert_eq!(
        dropped(&report.samples[&Kind::Velocity].tally),
        [("duplicate_time", 42)]
    );
}

#[test]
fn the_first_in_the_file_of_simultaneous_samples_is_used_though_its_chunk_starts_later() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    log.put_flat(channel, 20, "0.1", "1");
    log.writer.flush().expect("the chunk ends");
    log.put_flat(channel, 0, "0", "1");
    log.put_flat(channel, 20, "0.9", "1");
    let (derived, _) = log.enrich(None).expect("a result");
    assert_eq!(yaws(&derived), [(20, 0.1)]);
}

#[test]
fn derived_messages_have_the_times_of_their_samples() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    log.put_flat(channel, 0, "0", "1");
    log.put_flat(channel, 20, "0", "1");
    let (derived, _) = log.enrich(None).expect("a result");
    for message in &derived {
        assert_eq!(message.publish_time, message.log_time + 7);
    }
    let rotation = derived
        .iter()
        .find(|message| message.topic == "/camera/relative_rpy");
    let interval = DerivedMessage::decode(rotation.expect("a rotation")).interval;
    assert_eq!(interval, Some(20_000_000));
}

const FLAT: &str = "message Message { double roll = 1; float pitch = 20; double yaw = 3;
    string note = 4; sint32 vx = 5; int64 vy = 6; fixed32 vz = 7; }";

#[test]
fn a_protobuf_number_may_be_of_any_type_and_an_absent_one_is_its_default() {
    let mut log = Logbook::new();
    let (channel, message) = log.protobuf("/state", FLAT);
    for (time, yaw) in [(0, 0.0), (20, 0.25)] {
        let mut state = DynamicMessage::new(message.clone());
        state.set_field_by_name("yaw", prost_reflect::Value::F64(yaw));
        state.set_field_by_name("note", prost_reflect::Value::String("skipped".into()));
        state.set_field_by_name("vx", prost_reflect::Value::I32(-3));
        log.put(channel, time, &state.encode_to_vec());
    }
    let (derived, report) = log.enrich(None).expect("a result");
    assert_eq!(yaws(&derived), [(20, 0.25)]);
    let north_of_heading = |yaw: f64| (-3.0 * yaw.cos() * 1e9).round() / 1e9;
    assert_eq!(
        forwards(&derived),
        [(0, -3.0), (20, north_of_heading(0.25))]
    );
    assert_eq!(report.profile.name, "flat");
}

#[test]
fn a_protobuf_field_with_presence_that_is_absent_is_missing() {
    let mut log = Logbook::new();
    let (channel, message) = log.protobuf(
        "/state",
        "message Message { double roll = 1; double pitch = 2; optional double yaw = 3;
         double vx = 4; double vy = 5; double vz = 6; }",
    );
    for (time, yaw) in [(0, Some(0.0)), (20, None), (40, Some(0.5))] {
        let mut state = DynamicMessage::new(message.clone());
        if let Some(yaw) = yaw {
            state.set_field_by_name("yaw", prost_reflect::Value::F64(yaw));
        }
        log.put(channel, time, &state.encode_to_vec());
    }
    let (derived, report) = log.enrich(None).expect("a result");
    assert_eq!(yaws(&derived), [(40, 0.5)]);
    assert_eq!(
        dropped(&report.samples[&Kind::Attitude].tally),
        [("missing_field", 1)]
    );
    assert_eq!(
        forwards(&derived).len(),
        3,
        "the velocity is there, and the attitude by interpolation"
    );
}

const NESTED: &str =
    "message Message { Pose pose = 2; repeated Pose others = 3; string frame = 4; }
    message Pose { repeated float q = 9; Vector speed = 1; bool ok = 2; }
    message Vector { double x = 1; double y = 2; double z = 3; }";

const NESTED_PROFILE: &str = r#"
    name = "nested"
    [attitude]
    topics = ["/none", "/pose"]
    orientation.quaternion = "pose.q"
    convention = "frd-ned"
    reset_counter = { field = "pose.resets", optional = true }
    [velocity]
    vector = ["pose.speed.x", "pose.speed.y", "pose.speed.z"]
    frame = "ned"
    valid = ["pose.ok"]
"#;

#[test]
fn each_reading_is_dropped_for_the_first_reason_that_applies() {
    let mut log = Logbook::new();
    let (channel, message) = log.protobuf("/pose", NESTED);
    let still = r#""speed":{"x":1},"ok":true"#;
    for (time, text) in [
        (0, format!(r#"{{"pose":{{"q":[1,0,0,0],{still}}}}}"#)),
        (1, format!(r#"{{"pose":{{"q":[1,0,0],{still}}}}}"#)),
        (2, format!(r#"{{"pose":{{"q":[1,0,0,0,0],{still}}}}}"#)),
        (3, format!(r#"{{"pose":{{"q":["NaN",0,0,0],{still}}}}}"#)),
        (4, format!(r#"{{"pose":{{"q":[0.1,0,0,0],{still}}}}}"#)),
        (5, format!(r#"{{"pose":{{"q":[0,0,3,0],{still}}}}}"#)),
        (6, r#"{"frame":"no pose"}"#.to_owned()),
        (
            7,
            r#"{"pose":{"q":[1,0,0,0],"speed":{"x":"Infinity"},"ok":false}}"#.to_owned(),
        ),
        (
            8,
            r#"{"pose":{"q":[1,0,0,0],"speed":{"x":1},"ok":false}}"#.to_owned(),
        ),
        (9, r#"{"pose":{"q":[1.9,0,0,0],"ok":true}}"#.to_owned()),
    ] {
        let payload = protobuf_message(&message, &text);
        log.put(channel, time, &payload);
    }
    log.put(channel, 10, &[0x12, 0x7f, 0x00]);
    let (derived, report) = log.enrich(Some(NESTED_PROFILE)).expect("a result");
    assert_eq!(
        dropped(&report.samples[&Kind::Attitude].tally),
        [
            ("undecodable", 1),
            ("missing_field", 1),
            ("non_finite", 1),
            ("not_a_rotation", 4)
        ]
    );
    assert_eq!(
        dropped(&report.samples[&Kind::Velocity].tally),
        [
            ("undecodable", 1),
            ("missing_field", 2),
            ("non_finite", 1),
            ("marked_invalid", 1)
        ]
    );
    assert_eq!(yaws(&derived), [(7, 0.0), (8, 0.0), (9, 0.0)]);
    assert!(!report.complete, "a message could not be read");
    assert_eq!(
        report.samples[&Kind::Attitude].topic.as_deref(),
        Some("/pose")
    );
}

#[test]
fn lists_may_be_packed_or_not_and_messages_may_come_in_parts() {
    let mut log = Logbook::new();
    let (channel, message) = log.protobuf("/pose", NESTED);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let packed = protobuf_message(
        &message,
        r#"{"pose":{"q":[1,0,0,0],"speed":{"x":2},"ok":true}}"#,
    );
    log.put(channel, 0, &packed);
    // A quarter turn: the quaternion unpacked, each number in a part of its own, ok in the last.
    let mut parts = Vec::new();
    for number in [half, 0.0, 0.0, half] {
        parts.extend([0x12, 5, (9 << 3) | 5]);
        parts.extend(number.to_le_bytes());
    }
    parts.extend([0x12, 4, 0x0a, 0, 0x10, 1]);
    log.put(channel, 20, &parts);
    let (derived, report) = log.enrich(Some(NESTED_PROFILE)).expect("a result");
    assert_eq!(
        yaws(&derived),
        [(20, (std::f64::consts::FRAC_PI_2 * 1e9).round() / 1e9)]
    );
    assert_eq!(report.samples[&Kind::Velocity].tally.used, 2);
}

#[test]
fn a_field_that_the_schema_lacks_is_an_error_that_names_it_and_what_there_is() {
    for (wrong, essential) in [
        (("pose.q", "pose.quat"), ["pose.quat", "speed, ok, q"]),
        (
            ("pose.speed.x", "pose.speed.x.y"),
            ["pose.speed.x.y", "`pose.speed.x` is a single number"],
        ),
        (("pose.speed.x", "frame"), ["`frame`", "text"]),
        (
            ("pose.q", "others.q"),
            ["others.q", "`others` is a list of messages"],
        ),
        (
            ("pose.q", "pose.ok"),
            ["`pose.ok` is not a list of numbers", "single number"],
        ),
        (("pose.ok", "pose.q"), ["`pose.q` is not", "list"]),
    ] {
        let mut log = Logbook::new();
        let (channel, message) = log.protobuf("/pose", NESTED);
        let payload = protobuf_message(&message, r#"{"pose":{"q":[1,0,0,0]}}"#);
        log.put(channel, 0, &payload);
        let profile =
            NESTED_PROFILE.replace(&format!("\"{}\"", wrong.0), &format!("\"{}\"", wrong.1));
        let error = log
            .enrich(Some(&profile))
            .expect_err("the schema lacks it")
            .to_string();
        assert!(error.contains("/pose"), "{error}");
        for word in essential {
            assert!(error.contains(word), "{error}");
        }
    }
}

#[test]
fn json_may_be_nested_and_null_is_missing() {
    let profile = r#"
        name = "nested"
        [attitude]
        topics = ["/json"]
        orientation.euler = { roll = "att.r", pitch = "att.p", yaw = "att.y", unit = "degrees" }
        [velocity]
        vector = ["v.n", "v.e", "v.d"]
        frame = "ned"
        valid = ["fix"]
    "#;
    let mut log = Logbook::new();
    let channel = log.json("/json");
    for (time, text) in [
        (
            0,
            r#"{"x":[1,{"att":5}],"att":{"r":0,"p":0,"y":0},"v":{"n":4,"e":0,"d":0},"fix":true}"#,
        ),
        (
            1,
            r#"{"att":{"r":0,"p":0,"y":null},"v":{"n":4,"e":0,"d":0},"fix":false}"#,
        ),
        (2, r#"{"att":{"r":0,"p":0},"v":{"n":4,"e":0},"fix":1}"#),
        (
            3,
            r#"{"fix":true,"v":{"d":0,"e":0,"n":4e0},"att":{"y":90,"p":0,"r":0}}"#,
        ),
        (4, r#"{"att":{"r":0,"p":0,"y":"ninety"}}"#),
        (5, r#"{"att":"#),
    ] {
        log.put(channel, time, text.as_bytes());
    }
    let (derived, report) = log.enrich(Some(profile)).expect("a result");
    assert_eq!(
        yaws(&derived),
        [(3, (std::f64::consts::FRAC_PI_2 * 1e9).round() / 1e9)]
    );
    assert_eq!(
        dropped(&report.samples[&Kind::Attitude].tally),
        [("undecodable", 2), ("missing_field", 2)]
    );
    assert_eq!(
        dropped(&report.samples[&Kind::Velocity].tally),
        [
            ("undecodable", 2),
            ("missing_field", 1),
            ("marked_invalid", 1)
        ]
    );
    assert_eq!(forwards(&derived), [(0, 4.0), (3, 0.0)]);
}

#[test]
fn a_json_field_may_be_one_that_the_schema_leaves_open_or_the_first_message_lacks() {
    let profile = r#"
        name = "open"
        [attitude]
        topics = ["/json"]
        orientation.euler = { roll = "att.r", pitch = "att.p", yaw = "att.y", unit = "radians" }
    "#;
    let mut log = Logbook::new();
    let schema = br#"{"type":"object","properties":{"att":{"type":"object"},"status":{}}}"#;
    let schema = log.writer.add_schema("State", "jsonschema", schema);
    let channel = log.channel(schema.expect("a schema"), "/json", "json");
    for (time, text) in [
        (0, r#"{"status":"boot"}"#),
        (1, r#"{"att":null}"#),
        (2, r#"{"att":{"r":0,"p":0,"y":0}}"#),
        (3, r#"{"att":{"r":0,"p":0,"y":0.5}}"#),
    ] {
        log.put(channel, time, text.as_bytes());
    }
    let (derived, report) = log.enrich(Some(profile)).expect("a result");
    assert_eq!(yaws(&derived), [(3, 0.5)]);
    assert_eq!(
        dropped(&report.samples[&Kind::Attitude].tally),
        [("missing_field", 2)]
    );
    assert!(report.complete);
}

#[test]
fn a_json_list_within_a_list_is_not_a_list_of_numbers() {
    let profile = r#"
        name = "lists"
        [attitude]
        orientation.quaternion = "/json.q"
        convention = "frd-ned"
    "#;
    let mut log = Logbook::new();
    let channel = log.json("/json");
    for (time, q) in ["[1,0,0,0]", "[[1],0,0,0]", "[0,0,0,[1]]", "[0,0,0,1]"]
        .into_iter()
        .enumerate()
    {
        log.put(channel, time as u64, format!(r#"{{"q":{q}}}"#).as_bytes());
    }
    let (derived, report) = log.enrich(Some(profile)).expect("a result");
    assert_eq!(derived.len(), 1 + 2, "a rotation and two orientations");
    assert_eq!(
        dropped(&report.samples[&Kind::Attitude].tally),
        [("undecodable", 2)]
    );
}

#[test]
fn neither_of_two_topics_that_fit_equally_well_is_guessed() {
    let mut log = Logbook::new();
    for topic in ["/drone1/state", "/drone2/state"] {
        let channel = log.json(topic);
        log.put_flat(channel, 0, "0", "1");
        log.put_flat(channel, 20, "0", "1");
    }
    let error = log.enrich(None).expect_err("either would do").to_string();
    assert!(
        error.contains("/drone1/state and /drone2/state fit equally well"),
        "{error}"
    );
}

#[test]
fn one_topic_may_be_named_for_both_roles() {
    let profile = r#"
        name = "one"
        [attitude]
        topics = ["/state"]
        orientation.euler = { roll = "roll", pitch = "pitch", yaw = "yaw", unit = "radians" }
        [velocity]
        topics = ["/state"]
        vector = ["vx", "vy", "vz"]
        frame = "ned"
    "#;
    let mut log = Logbook::new();
    let channel = log.json("/state");
    log.put_flat(channel, 0, "0", "1");
    log.put_flat(channel, 20, "0.5", "1");
    let (derived, report) = log.enrich(Some(profile)).expect("a result");
    assert_eq!(yaws(&derived), [(20, 0.5)]);
    assert_eq!(report.samples[&Kind::Velocity].tally.used, 2);
}

#[test]
fn samples_of_many_overlapping_chunks_are_put_in_order() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    let count = 2000;
    for i in 0..count {
        log.put_flat(channel, i, "0", "1");
        log.put_flat(channel, 2 * count - i, "0", "1");
        log.writer.flush().expect("the chunk ends");
    }
    let (derived, report) = log.enrich(None).expect("a result");
    assert!(derived.is_sorted_by_key(|message| message.log_time));
    assert_eq!(report.samples[&Kind::Attitude].tally.used, 2 * count);
}

#[test]
fn old_px4_logs_have_no_reset_counter() {
    let attitude = "message Message { repeated float q = 1; }";
    let mut log = Logbook::new();
    let (channel, message) = log.protobuf("/vehicle_attitude", attitude);
    for time in [0, 20] {
        let payload = protobuf_message(&message, r#"{"q":[1,0,0,0]}"#);
        log.put(channel, time, &payload);
    }
    let (derived, report) = log.enrich(None).expect("a result");
    assert_eq!(report.profile.name, "px4-ulog");
    assert_eq!(derived.len(), 1 + 2, "a rotation and two orientations");
    let reason = report.not_written[0].reason.to_string();
    assert!(reason.contains("/vehicle_local_position"), "{reason}");
}

#[test]
fn every_built_in_profile_is_well_formed_and_says_what_it_is_for() {
    let names: Vec<String> = Profile::built_in()
        .into_iter()
        .map(|profile| {
            assert!(!profile.description.is_empty());
            assert_eq!(
                Profile::load(&profile.name).expect("found by its name"),
                profile
            );
            profile.name
        })
        .collect();
    let is_plain = |name: &String| {
        name.bytes()
            .all(|byte| byte.is_ascii_lowercase() || b"0123456789.-".contains(&byte))
    };
    assert!(names.iter().all(is_plain), "{names:?}");
    let different: BTreeSet<&String> = names.iter().collect();
    assert_eq!(different.len(), names.len());
}
