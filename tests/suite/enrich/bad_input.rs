//! Logs that are not as they should be: what is counted, what is refused and with which error, and that a refusal
//! leaves no trace. [`Folder::refuses`] and [`Folder::writes`] check the latter.

use std::fs;

use serde_json::{Value, json};

use crate::support::{
    self,
    folder::*,
    logbook::{Logbook, protobuf_message},
    ros::{Types, Wire},
    topics::*,
};

const COUNT: u32 = 50;

/// The arguments for a profile that reads `/pose`: a quaternion `q`, and a velocity `v` to the north.
const POSE: &str = "--depression 30 --attitude /pose.q:frd-ned --velocity /pose.v:ned";

fn enrich(arguments: &str) -> String {
    format!("enrich {LOG} {arguments}")
}

/// The log in a folder.
fn written(book: Logbook) -> Folder {
    let (_folder, path) = book.finish();
    Folder::with(LOG, fs::read(path).expect("the log"))
}

fn poses(change: impl Fn(u32, &mut Value)) -> Topic {
    let messages = (0..COUNT).map(|n| {
        let half = 0.01 * f64::from(n);
        let mut message =
            json!({ "q": [half.cos(), 0.0, 0.0, half.sin()], "v": [3.0, 0.0, 0.0], "name": "ap" });
        change(n, &mut message);
        message
    });
    topic("/pose", messages)
}

fn folder(topics: &[Topic]) -> Folder {
    Folder::with(LOG, log(topics))
}

mod truncated_messages {
    use super::*;

    const LOST: [u32; 3] = [3, 4, 30];

    /// Checks that the run goes on without three of fifty messages and reports that.
    fn are_counted(folder: &Folder, arguments: &str) {
        let report = folder.writes(RESULT, &enrich(arguments), 3);
        assert_reads(
            &report,
            "Attitude … 47 of 50 samples used … 3 dropped: not decodable … \
             Velocity … 47 of 50 samples used … 3 dropped: not decodable … \
             Written … /camera/relative_rpy: 46 messages … /camera/velocity: 47 messages … \
             Note … 6 samples could not be decoded as the log's schemas say",
        );
        let report = folder.reports(&enrich(&format!("{arguments} --force")), 3);
        assert_eq!(report["complete"], false);
        assert_eq!(report["attitude"]["dropped"], json!({ "undecodable": 3 }));
        assert_eq!(report["velocity"]["dropped"], json!({ "undecodable": 3 }));
    }

    fn cut(n: u32, mut message: Vec<u8>) -> Vec<u8> {
        if LOST.contains(&n) {
            message.truncate(message.len() / 2 - 1);
        }
        message
    }

    #[test]
    fn truncated_json_messages_are_counted() {
        let mut state = topic("/drone/state", states(COUNT as i32, 1.0));
        let messages = (0..).zip(state.messages);
        state.messages = messages.map(|(n, message)| cut(n, message)).collect();
        are_counted(&folder(&[state]), "--depression 30");
    }

    #[test]
    fn truncated_protobuf_messages_are_counted() {
        let mut book = Logbook::new();
        let definition = "message Message { repeated float q = 1; repeated float v = 2; }";
        let (channel, descriptor) = book.protobuf("/pose", definition);
        let message = protobuf_message(&descriptor, r#"{"q":[1,0,0,0],"v":[1,2,3]}"#);
        for n in 0..COUNT {
            book.put(channel, n.into(), &cut(n, message.clone()));
        }
        are_counted(&written(book), POSE);
    }

    #[test]
    fn truncated_ros_messages_are_counted() {
        let types = Types::from([("test/Pose", "string name\nfloat64[4] q\nfloat32[3] v")]);
        let message = json!({ "name": "drone", "q": [1, 0, 0, 0], "v": [1, 2, 3] });
        for wire in Wire::ALL {
            let mut book = Logbook::new();
            let channel = book.ros(wire, "/pose", "test/Pose", &types.text("test/Pose"));
            let message = types.serialize(wire, "test/Pose", &message);
            for n in 0..COUNT {
                book.put(channel, n.into(), &cut(n, message.clone()));
            }
            are_counted(&written(book), POSE);
        }
    }

    #[test]
    fn a_log_of_truncated_messages_alone_yields_nothing() {
        let mut state = topic("/drone/state", states(2, 1.0));
        // It has the fields, but no usable attitude.
        state.messages[0] = br#"{"roll":0,"pitch":0,"yaw":NaN}"#.to_vec();
        state.messages[1].truncate(9);
        let message = "nothing can be derived … /camera/relative_rpy: … 0 of 2 usable, 1 not decodable … \
                       /camera/orientation: … 0 of 2 usable, 1 not decodable";
        let mut torn = state.clone();
        torn.messages[0] = b"{}".to_vec();
        folder(&[torn]).refuses(&enrich("--depression 30"), 1, "no usable telemetry");
        let arguments = "--depression 30 --attitude /drone/state.roll,/drone/state.pitch,/drone/state.yaw:radians";
        folder(&[state]).refuses(&enrich(arguments), 1, message);
    }
}

mod fields {
    use super::*;

    /// Definitions of the type test/Pose, each with a path that is tried in it and the error.
    #[test]
    fn a_missing_field_is_reported_with_the_reason() {
        let types = Types::from([(
            "test/Pose",
            "string name\nfloat64[4] q\nfloat64[] any\nfloat32[3] v",
        )]);
        let message = json!({ "name": "drone", "q": [1, 0, 0, 0], "any": [1, 0], "v": [1, 2, 3] });
        let mut book = Logbook::new();
        let text = types.text("test/Pose");
        let channel = book.ros(Wire::LittleEndian, "/pose", "test/Pose", &text);
        let message = types.serialize(Wire::LittleEndian, "test/Pose", &message);
        for n in 0..COUNT {
            book.put(channel, n.into(), &message);
        }
        let ros2 = written(book);
        let json = folder(&[poses(|_, _| {})]);
        for (log, field, problem) in [
            (
                &ros2,
                "q[4]",
                "field `q[4]` does not exist, because the list has 4 elements, counted from 0",
            ),
            (
                &ros2,
                "name.w",
                "field `name.w` does not exist, because `name` is text",
            ),
            (
                &ros2,
                "name[0]",
                "field `name[0]` does not exist, because `name` is text",
            ),
            (&ros2, "name", "field `name` is not a number but text"),
            (&ros2, "q", "field `q` is not a number but a list"),
            (
                &ros2,
                "quat[0]",
                "no field `quat[0]`; test/Pose has name, q, any, v",
            ),
            (
                &json,
                "q[4]",
                "no field `q[4]`; … with the most fields has name, q, v",
            ),
            (&json, "name.w", "no field `name.w`"),
            (&json, "name", "field `name` is not a number but text"),
            (
                &json,
                "quat[0]",
                "no field `quat[0]`; … with the most fields has name, q, v",
            ),
        ] {
            let attitude = format!("--attitude /pose.{field},/pose.v[0],/pose.v[1]:degrees");
            let message =
                format!("attitude does not fit: /pose: its … {problem} … /pose … --attitude");
            let message = message
                .replace("its … no field", "it has no field")
                .replace("its … field", "its field");
            log.refuses(&enrich(&format!("--depression 30 {attitude}")), 1, &message);
        }
        // A list without a fixed length has a length in each message.
        let attitude = "--attitude /pose.any[2],/pose.v[0],/pose.v[1]:degrees";
        let message = "nothing can be derived … 0 of 50 usable, 50 without a field that is needed";
        ros2.refuses(&enrich(&format!("--depression 30 {attitude}")), 1, message);
    }

    #[test]
    fn a_json_number_may_be_in_quotes() {
        let arguments = "--depression 30 --attitude /pose.q[0],/pose.q[1],/pose.q[2],/pose.q[3]:frd-ned --velocity /pose.v[0],/pose.v[1],/pose.v[2]:ned";
        let plain = folder(&[poses(|_, _| {})]);
        plain.reports(&enrich(arguments), 0);
        let quoted = folder(&[poses(|_, message| {
            for list in ["q", "v"] {
                for number in message[list].as_array_mut().unwrap() {
                    *number = json!(number.to_string());
                }
            }
        })]);
        quoted.reports(&enrich(arguments), 0);
        let derived = |folder: &Folder| {
            let messages = support::stream(&folder.read(RESULT), false).into_iter();
            let derived =
                messages.filter(|message| support::DERIVED.contains(&message.topic.as_str()));
            derived.collect::<Vec<_>>()
        };
        assert!(derived(&quoted) == derived(&plain), "to the last digit");
        let whole = folder(&[poses(|_, message| {
            message["q"] = json!(["1", "0", "0", "0"])
        })]);
        assert_eq!(whole.reports(&enrich(POSE), 0)["attitude"]["used"], COUNT);

        let worded = folder(&[poses(|n, message| {
            if n >= 40 {
                message["q"][0] = json!("unknown");
            }
        })]);
        let report = worded.reports(&enrich(arguments), 3);
        assert_eq!(report["attitude"]["dropped"], json!({ "undecodable": 10 }));
        assert_eq!(report["attitude"]["used"], 40);
    }
}

#[test]
fn an_invalid_schema_is_reported_with_its_topic() {
    let message = vec![0, 1, 0, 0];
    for (encoding, schema_encoding, data, problem) in [
        (
            "protobuf",
            "protobuf",
            "not descriptors",
            "its protobuf schema cannot be read",
        ),
        (
            "protobuf",
            "protobuf",
            "",
            "its protobuf schema does not define `test/Pose`",
        ),
        (
            "json",
            "jsonschema",
            "{ \"type\": ",
            "its JSON schema cannot be read: EOF",
        ),
        (
            "cdr",
            "ros2msg",
            "float64[4] q\nfloat64[",
            "its ROS message definition cannot be used: line 2",
        ),
        (
            "cdr",
            "ros2msg",
            "other/Type q",
            "its ROS message definition … does not define `other/Type`",
        ),
        (
            "cdr",
            "ros2msg",
            "test/Pose q",
            "its ROS message definition … `test/Pose` contains itself",
        ),
        (
            "ros1",
            "ros1msg",
            "3 fields",
            "its ROS message definition cannot be used",
        ),
        (
            "flatbuffer",
            "flatbuffer",
            "",
            "its messages are encoded as `flatbuffer` … reads protobuf, JSON, ROS 2 … ROS 1",
        ),
        (
            "cdr",
            "ros2idl",
            "struct Pose {};",
            "its messages are encoded as `cdr` with a schema in `ros2idl` … (cdr with ros2msg)",
        ),
        (
            "cdr",
            "",
            "",
            "its messages are encoded as `cdr` without a schema … (cdr with ros2msg)",
        ),
    ] {
        let opaque = Topic {
            name: "/pose",
            encoding,
            schema: None,
            messages: vec![message.clone(); 3],
        };
        let opaque = match schema_encoding {
            "" => opaque,
            _ => opaque.with_schema("test/Pose", schema_encoding, data),
        };
        let log = folder(&[opaque]);
        let message = format!(
            "attitude does not fit: /pose: {problem} … topics of the log: … /pose ({encoding} … --attitude"
        );
        log.refuses(&enrich(POSE), 1, &message);
        let searched =
            format!("no usable telemetry … flat: … what /pose has is not known: {problem}");
        log.refuses(&enrich("--depression 30"), 1, &searched);
    }
}

#[test]
fn an_invalid_schema_of_another_topic_does_not_matter() {
    let broken = topic("/broken", [json!({})]).with_schema("B", "jsonschema", "{");
    let foreign = Topic {
        encoding: "flatbuffer",
        ..topic("/foreign", [json!({})])
    };
    let state = topic("/drone/state", states(COUNT as i32, 1.0));
    folder(&[broken, foreign, state]).writes(RESULT, &enrich("--depression 30"), 0);
}

#[test]
fn profiles_that_fit_equally_well_are_named_with_how_to_choose() {
    let both = [
        pose("/mavros/local_position/pose"),
        twist("/mavros/local_position/velocity_local"),
        attitude("/fmu/out/vehicle_attitude"),
        local_position("/fmu/out/vehicle_local_position"),
    ];
    let message = "flight.mcap: several profiles fit equally well … \
                   px4-ros2: /fmu/out/vehicle_attitude … mavros: /mavros/local_position/pose … \
                   choose one … --profile px4-ros2";
    let folder = folder(&both);
    folder.refuses(&enrich("--depression 30"), 1, message);
    for profile in ["mavros", "px4-ros2"] {
        let report = folder.reports(
            &enrich(&format!("--depression 30 --force --profile {profile}")),
            0,
        );
        assert_eq!(report["profile"]["name"], profile);
    }
}

#[test]
fn a_quaternion_far_from_unit_length_is_dropped_and_one_near_it_normalised() {
    let plain = folder(&[poses(|_, _| {})]);
    plain.writes(RESULT, &enrich(POSE), 0);
    let scaled = |lengths: &'static [f64]| {
        folder(&[poses(move |n, message| {
            let length = lengths[n as usize % lengths.len()];
            for number in message["q"].as_array_mut().unwrap() {
                *number = json!(number.as_f64().unwrap() * length);
            }
        })])
    };
    let near = scaled(&[0.51, 0.9, 1.0, 1.999, -1.0]);
    let report = near.reports(&enrich(POSE), 0);
    assert_eq!(
        report["attitude"],
        json!({
            "topic": "/pose",
            "used": COUNT,
            "dropped": {},
            "read_as": [{ "kind": "quaternion", "axes": "frd-ned", "because": "given" }],
        })
    );
    let numbers = |folder: &Folder| {
        let messages = support::stream(&folder.read(RESULT), false).into_iter();
        let derived = messages.filter(|message| support::DERIVED.contains(&message.topic.as_str()));
        derived
            .flat_map(|message| support::message::DerivedMessage::decode(&message).numbers)
            .collect::<Vec<_>>()
    };
    let pairs = numbers(&near).into_iter().zip(numbers(&plain));
    assert!(pairs.clone().count() > 200);
    assert!(
        pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12),
        "normalised first"
    );

    let far = scaled(&[1.0, 0.49, 2.01, 0.0, 1e9]);
    let report = far.writes(RESULT, &enrich(POSE), 0);
    assert_reads(
        &report,
        "/pose: 10 of 50 samples used … 40 dropped: with a quaternion that is not a rotation",
    );
    let report = far.reports(&enrich(&format!("{POSE} --force")), 0);
    assert_eq!(
        report["attitude"]["dropped"],
        json!({ "not_a_rotation": 40 })
    );
}
