//! The same derived values in each encoding: the same numbers, true schemas, and the right choice.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};

use flightcam::{
    Options, Report,
    derived::{Derived, Quantity, Value},
    enrich::enrich,
    geometry::RollPitchYaw,
    messages::{Encoding, EncodingChoice, Format},
    report::Note,
    sample::Stamp,
};
use mcap::{
    Summary, WriteOptions,
    records::{Channel, MessageHeader},
};
use nalgebra::{Matrix3, Rotation3, Vector3};
use prost_reflect::DescriptorPool;

use crate::support::{message::DerivedMessage, orientations::assert_well_formed, *};

fn asking_for(encoding: Encoding) -> Options {
    options().encoding(EncodingChoice::Given(encoding))
}

fn survey_flight() -> Vec<u8> {
    fs::read(repository("fixtures/survey_flight.mcap")).expect("the demonstration flight")
}

fn enriched(log: &[u8], encoding: Encoding) -> (Vec<u8>, Report) {
    enrich_bytes_with(log, &asking_for(encoding)).expect("a result")
}

/// The derived messages of a result.
fn derived_messages(log: &[u8], result: &[u8]) -> Vec<DerivedMessage> {
    judge(log, result, false)
        .iter()
        .map(DerivedMessage::decode)
        .collect()
}

fn summary(log: &[u8]) -> Summary {
    let summary = Summary::read(log).expect("a readable summary");
    summary.expect("a summary")
}

/// The channels that enriching added, in the order of their topics.
fn derived_channels(log: &[u8]) -> Vec<std::sync::Arc<mcap::Channel<'static>>> {
    let channels = summary(log).channels;
    DERIVED
        .map(|topic| channels.values().find(|channel| channel.topic == topic))
        .into_iter()
        .map(|channel| channel.expect("the channel").clone())
        .collect()
}

/// The result's own record of how it was made.
fn facts(log: &[u8]) -> BTreeMap<String, String> {
    let summary = summary(log);
    let mut indexes = summary.metadata_indexes.iter();
    let index = indexes.rfind(|index| index.name == "flightcam");
    let record = mcap::read::metadata(log, index.expect("the record"));
    record.expect("a readable record").metadata
}

#[test]
fn every_encoding_has_the_same_numbers_and_times() {
    let log = survey_flight();
    let [protobuf, json, ros2] = Encoding::ALL.map(|encoding| {
        let (result, report) = enriched(&log, encoding);
        assert_eq!(report.encoding.name, encoding);
        derived_messages(&log, &result)
    });
    assert_eq!(protobuf.len(), 3309 + 3310 + 3310);
    for message in &protobuf {
        let frame_id = match message.topic.as_str() {
            "/camera/relative_rpy" => "previous_camera",
            "/camera/orientation" => "ned",
            _ => "camera",
        };
        assert_eq!(message.stamp, message.log_time);
        assert_eq!(message.frame_id, frame_id);
        let has_interval = message.topic == "/camera/relative_rpy";
        assert_eq!(message.interval.is_some(), has_interval);
        if message.topic == "/camera/orientation" {
            assert_well_formed(message);
        }
    }
    let bits = |message: &DerivedMessage| -> Vec<u64> {
        let numbers = message.numbers.iter();
        numbers.map(|number| number.to_bits()).collect()
    };
    for (others, has_all) in [(json, true), (ros2, false)] {
        assert_eq!(others.len(), protobuf.len());
        for (other, message) in others.iter().zip(&protobuf) {
            let mut expected = message.clone();
            if !has_all {
                expected.interval = None;
                if message.topic == "/camera/orientation" {
                    expected.numbers.truncate(4);
                }
            }
            assert_eq!(*other, expected);
            assert_eq!(bits(other), bits(&expected), "{other:?}, not {message:?}");
        }
    }
}

#[test]
fn the_encoding_is_the_telemetrys_by_default() {
    let telemetry = |encoding: &str| Channel {
        id: 1,
        schema_id: 0,
        topic: TELEMETRY.to_owned(),
        message_encoding: encoding.into(),
        metadata: BTreeMap::new(),
    };
    for (found, expected) in [
        ("protobuf", Encoding::Protobuf),
        ("json", Encoding::Json),
        ("cdr", Encoding::Ros2),
        ("ros1", Encoding::Protobuf),
        ("flatbuffer", Encoding::Protobuf),
    ] {
        let chosen = Format::choose(EncodingChoice::Automatic, &telemetry(found));
        assert_eq!(chosen.encoding, expected, "{found}");
        for given in Encoding::ALL {
            let chosen = Format::choose(EncodingChoice::Given(given), &telemetry(found));
            assert_eq!(chosen.encoding, given);
        }
    }

    let schemas = [
        "flightcam.v1.RelativeRpy",
        "flightcam.v1.CameraOrientation",
        "flightcam.v1.CameraVelocity",
    ];
    for (log, name) in [
        (survey_flight(), "protobuf"),
        (Shape::default().write(), "json"),
    ] {
        let (result, report) = enrich_bytes(&log).expect("a result");
        let facts = facts(&result);
        assert_eq!(facts["encoding"], name);
        assert_eq!(
            facts["encoding_reason"],
            format!("chosen because /drone/state is {name}")
        );
        assert_eq!(report.encoding.name.name(), name);
        let telemetry = (
            report.encoding.telemetry_topic,
            report.encoding.telemetry_encoding,
        );
        assert_eq!(telemetry, (TELEMETRY.into(), name.into()));
        for (channel, schema) in derived_channels(&result).iter().zip(schemas) {
            assert_eq!(channel.message_encoding, name);
            assert_eq!(channel.schema.as_ref().expect("a schema").name, schema);
        }
    }
    let (result, _) = enriched(&survey_flight(), Encoding::Json);
    assert_eq!(facts(&result)["encoding"], "json");
    let reason = "as asked for; /drone/state is protobuf";
    assert_eq!(facts(&result)["encoding_reason"], reason);
}

#[test]
fn the_report_names_the_schemas_that_the_log_has() {
    for encoding in Encoding::ALL {
        let (result, report) = enriched(&survey_flight(), encoding);
        for (channel, written) in derived_channels(&result).iter().zip(&report.written) {
            let schema = channel.schema.as_ref().expect("a schema");
            assert_eq!(
                (written.topic, written.schema),
                (&*channel.topic, &*schema.name)
            );
        }
    }
}

#[test]
fn json_schemas_explain_every_field_of_the_protobuf_messages() {
    for quantity in Quantity::ALL {
        let protobuf = Encoding::Protobuf.schema(quantity);
        let pool = DescriptorPool::decode(protobuf.data).expect("descriptors");
        let message = pool.get_message_by_name(protobuf.name).expect("the type");
        let fields: Vec<String> = message.fields().map(|f| f.name().to_owned()).collect();

        let json = Encoding::Json.schema(quantity);
        assert_eq!((json.name, json.encoding), (protobuf.name, "jsonschema"));
        let schema: serde_json::Value = serde_json::from_slice(json.data).expect("JSON");
        assert_eq!(schema["title"], json.name);
        assert_eq!(schema["required"], serde_json::json!(fields));
        let properties = schema["properties"].as_object().expect("properties");
        let fields: BTreeSet<&str> = fields.iter().map(String::as_str).collect();
        assert_eq!(fields, properties.keys().map(String::as_str).collect());
        for (name, property) in properties {
            assert!(property["description"].is_string(), "{name}");
            let (kind, parts) = match name.as_str() {
                "timestamp" | "interval" => ("object", &["sec", "nsec"][..]),
                "quaternion" => ("object", &["x", "y", "z", "w"][..]),
                "frame_id" => ("string", &[][..]),
                _ => ("number", &[][..]),
            };
            assert_eq!(property["type"], kind, "{name}");
            if kind == "object" {
                assert_eq!(property["required"], serde_json::json!(parts));
                let properties = property["properties"].as_object().expect("an object");
                assert!(properties.keys().all(|name| parts.contains(&name.as_str())));
                assert_eq!(properties.len(), parts.len());
            }
        }
    }
}

// ---- ROS 2 ----

fn derived(log_time: u64, value: Value) -> Derived {
    let stamp = Stamp {
        log_time,
        publish_time: 0,
    };
    Derived { stamp, value }
}

fn in_ros2(derived: &Derived) -> Vec<u8> {
    // Alignment counts from the message's own start.
    let mut out = b"before".to_vec();
    Encoding::Ros2.encode(derived, &mut out);
    out.split_off(b"before".len())
}

#[test]
fn a_ros2_message_is_laid_out_as_cdr() {
    let velocity = Value::CameraVelocity(Vector3::new(1.0, -2.0, 0.5));
    let mut expected = vec![0, 1, 0, 0]; // CDR, little-endian
    expected.extend([2, 0, 0, 0, 3, 0, 0, 0]); // 2 s and 3 ns
    expected.extend([7, 0, 0, 0]);
    expected.extend(b"camera\0");
    expected.extend([0; 5]); // 19 bytes so far; numbers of 8 bytes start at multiples of 8
    expected.extend([0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
    expected.extend([0, 0, 0, 0, 0, 0, 0, 0xc0]);
    expected.extend([0, 0, 0, 0, 0, 0, 0xe0, 0x3f]);
    assert_eq!(in_ros2(&derived(2_000_000_003, velocity)), expected);

    let rotation = Value::RelativeRpy {
        interval: 20_000_000,
        rpy: RollPitchYaw {
            roll: 1.0,
            pitch: -2.0,
            yaw: 0.5,
        },
    };
    let mut other = expected[..12].to_vec();
    other.extend([16, 0, 0, 0]);
    other.extend(b"previous_camera\0");
    other.extend([0; 4]);
    other.extend(&expected[28..]);
    assert_eq!(in_ros2(&derived(2_000_000_003, rotation)), other);

    // A half turn about the vertical: x, y, z, w are 0, 0, 1, 0.
    let orientation =
        Rotation3::from_matrix_unchecked(Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0)));
    let mut other = expected[..12].to_vec();
    other.extend([4, 0, 0, 0]);
    other.extend(b"ned\0"); // 16 bytes so far
    other.extend([0; 16]);
    other.extend([0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
    other.extend([0; 8]);
    let orientation = Value::Orientation(orientation);
    assert_eq!(in_ros2(&derived(2_000_000_003, orientation)), other);
}

#[test]
fn a_ros2_stamp_is_clamped_to_the_last_possible_one() {
    let velocity = Value::CameraVelocity(Vector3::zeros());
    let last = 2_147_483_647_999_999_999;
    for (log_time, seconds, nanoseconds) in [
        (last - 1, i32::MAX, 999_999_998),
        (last, i32::MAX, 999_999_999),
        (last + 1, i32::MAX, 999_999_999),
        (u64::MAX, i32::MAX, 999_999_999),
    ] {
        let message = in_ros2(&derived(log_time, velocity));
        assert_eq!(message[4..8], i32::to_le_bytes(seconds));
        assert_eq!(message[8..12], u32::to_le_bytes(nanoseconds));
    }
    for (encoding, start, expected) in [
        (Encoding::Ros2, last - 10_000_000, true),
        (Encoding::Ros2, last - 30_000_000, false),
        (Encoding::Json, last - 10_000_000, false),
    ] {
        let (_, report) = enriched(&flat_log(start), encoding);
        let noted = report.notes.contains(&Note::Ros2StampOverflow);
        assert_eq!(noted, expected, "{:?}", report.notes);
    }
}

/// Two samples of JSON telemetry 20 ms apart.
fn flat_log(start: u64) -> Vec<u8> {
    log_with(WriteOptions::new(), start, |_| BTreeMap::new())
}

/// The same, with channel metadata, after `write` has written into the log.
fn log_with(
    options: WriteOptions,
    start: u64,
    before: impl FnOnce(&mut mcap::Writer<std::io::Cursor<Vec<u8>>>) -> BTreeMap<String, String>,
) -> Vec<u8> {
    let mut writer = options
        .create(std::io::Cursor::new(Vec::new()))
        .expect("a writer");
    let metadata = before(&mut writer);
    let channel_id = writer
        .add_channel(0, TELEMETRY, "json", &metadata)
        .expect("a channel");
    for log_time in [start, start + 20_000_000] {
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time: log_time,
        };
        let state = br#"{"roll":0,"pitch":0,"yaw":0.5,"vx":1,"vy":2,"vz":3}"#;
        writer
            .write_to_known_channel(&header, state)
            .expect("a message");
    }
    writer.finish().expect("the log is finished");
    writer.into_inner().into_inner()
}

#[test]
fn ros2_channels_of_a_type_share_its_schema_and_have_the_telemetrys_quality_of_service() {
    const QOS: &str = "offered_qos_profiles";
    let version = ("flightcam".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
    for qos in ["- history: 1\n  depth: 10", ""] {
        let log = log_with(WriteOptions::new(), 0, |_| match qos {
            "" => BTreeMap::new(),
            qos => BTreeMap::from([
                (QOS.to_owned(), qos.to_owned()),
                ("topic_type_hash".to_owned(), "RIHS01_of_another".to_owned()),
            ]),
        });
        let (result, _) = enriched(&log, Encoding::Ros2);
        judge(&log, &result, false);
        let channels = derived_channels(&result);
        let types = ["Vector3Stamped", "QuaternionStamped", "Vector3Stamped"];
        for (channel, name) in channels.iter().zip(types) {
            assert_eq!(channel.message_encoding, "cdr");
            let expected = [version.clone(), (QOS.to_owned(), qos.to_owned())];
            assert_eq!(channel.metadata, expected.into());
            let schema = channel.schema.as_ref().expect("a schema");
            assert_eq!(schema.name, format!("geometry_msgs/msg/{name}"));
            assert_eq!(schema.encoding, "ros2msg");
        }
        assert_eq!(summary(&result).schemas.len(), 2);

        let (result, _) = enriched(&log, Encoding::Json);
        let channels = derived_channels(&result);
        let expected = BTreeMap::from([version.clone()]);
        assert!(channels.iter().all(|channel| channel.metadata == expected));
    }
}

#[test]
fn a_ros2_definition_has_every_type_that_it_refers_to() {
    let vector = "geometry_msgs/Vector3 / float64 x / float64 y / float64 z";
    let quaternion =
        "geometry_msgs/Quaternion / float64 x 0 / float64 y 0 / float64 z 0 / float64 w 1";
    for (quantity, own, part) in [
        (Quantity::RelativeRpy, "Vector3 vector", vector),
        (Quantity::Orientation, "Quaternion quaternion", quaternion),
        (Quantity::CameraVelocity, "Vector3 vector", vector),
    ] {
        let schema = Encoding::Ros2.schema(quantity);
        let text = std::str::from_utf8(schema.data).expect("UTF-8");
        assert!(!text.contains('\r'));
        let separator = format!("\n{}\nMSG: ", "=".repeat(80));
        let fields = |part: &str| -> String {
            let lines = part.lines().filter(|line| !line.starts_with('#'));
            let lines: Vec<&str> = lines.filter(|line| !line.is_empty()).collect();
            lines.join(" / ")
        };
        let parts: Vec<String> = text.split(&separator).map(fields).collect();
        let own = format!("std_msgs/Header header / {own}");
        let header = "std_msgs/Header / builtin_interfaces/Time stamp / string frame_id";
        let time = "builtin_interfaces/Time / int32 sec / uint32 nanosec";
        assert_eq!(parts, [&own, part, header, time]);
    }
}

#[test]
fn a_schema_that_the_log_has_is_not_written_again() {
    let same = Encoding::Ros2.schema(Quantity::CameraVelocity);
    for (encoding, data, schemas) in [
        ("ros2msg", same.data, 2),
        ("ros2msg", b"another".as_slice(), 3),
        ("ros2idl", same.data, 3),
    ] {
        let log = log_with(WriteOptions::new(), 0, |writer| {
            let id = writer.add_schema_with_id(7, same.name, encoding, data);
            let metadata = BTreeMap::new();
            writer
                .add_channel(id.expect("a schema"), "/wind", "cdr", &metadata)
                .expect("a channel");
            metadata
        });
        let (result, _) = enriched(&log, Encoding::Ros2);
        assert_eq!(derived_messages(&log, &result).len(), 1 + 2 + 2);
        let summary = summary(&result);
        assert_eq!(summary.schemas.len(), schemas);
        assert_eq!(
            summary.stats.expect("statistics").schema_count,
            schemas as u16
        );
    }
}

#[test]
fn a_requested_encoding_that_ros2_tools_refuse_is_noted() {
    let log = flat_log(0);
    for (encoding, expected) in [
        (Encoding::Protobuf, None),
        (Encoding::Json, None),
        (Encoding::Ros2, Some(("/drone/state", "json"))),
    ] {
        let (_, report) = enriched(&log, encoding);
        let expected = expected.map(|(topic, encoding): (&str, &str)| Note::ChannelNotRos2 {
            topic: topic.into(),
            message_encoding: encoding.into(),
        });
        assert_eq!(report.notes, Vec::from_iter(expected));
    }
}

#[test]
fn a_real_ros2_log_stays_readable_by_ros2_tools_by_default() {
    let Some(folder) = real_logs() else { return };
    let log = fs::read(folder.join("test_ulog.ros2.mcap")).expect("the log");
    let (_, report) = enrich_bytes(&log).expect("a result");
    assert_eq!(report.encoding.name, Encoding::Ros2);
    assert!(report.notes.is_empty(), "{:?}", report.notes);
    for encoding in [Encoding::Protobuf, Encoding::Json] {
        let (_, report) = enriched(&log, encoding);
        assert_eq!(report.notes, [Note::NewChannelsNotRos2]);
    }
}

#[test]
fn a_result_in_or_from_the_folder_of_a_ros2_bag_says_how_to_list_it() {
    let bag = "# a comment\nrosbag2_bagfile_information:\n  version: 9\n";
    let other = "name: rosbag2_bagfile_information\n";
    for (at_input, at_output, expected) in [
        (Some(bag), None, Some("bag/metadata.yaml")),
        (None, Some(bag), Some("elsewhere/metadata.yaml")),
        (Some(other), Some(other), None),
        (None, None, None),
    ] {
        let root = tempfile::tempdir().expect("a temporary folder");
        let [from, to] = [("bag", at_input), ("elsewhere", at_output)].map(|(name, metadata)| {
            let folder = root.path().join(name);
            fs::create_dir(&folder).expect("a folder");
            if let Some(text) = metadata {
                fs::write(folder.join("metadata.yaml"), text).expect("written");
            }
            folder
        });
        let input = from.join("flight_0.mcap");
        fs::write(&input, flat_log(0)).expect("the log is written");
        let report = enrich(&input, to.join("result.mcap"), &options());
        match (&report.expect("a result").notes[..], expected) {
            ([], None) => {}
            ([Note::BagMetadataOutdated { path }], Some(expected)) => {
                assert!(path.ends_with(expected), "{path:?}");
            }
            (notes, _) => panic!("{notes:?}, expected {expected:?}"),
        }
    }
}

#[test]
fn a_metadata_yaml_that_is_not_a_text_file_is_ignored() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::create_dir(folder.path().join("metadata.yaml")).expect("a folder of that name");
    let input = folder.path().join("log.mcap");
    fs::write(&input, flat_log(0)).expect("the log is written");
    let report = enrich(&input, folder.path().join("result.mcap"), &options());
    assert!(report.expect("a result").notes.is_empty());
}

#[test]
fn an_enriched_log_says_in_which_axes_it_was_read() {
    let (result, _) = enriched(&survey_flight(), Encoding::Json);
    let read_as: serde_json::Value =
        serde_json::from_str(&facts(&result)["velocity_read_as"]).expect("JSON");
    let expected = serde_json::json!([{ "kind": "velocity", "axes": "ned", "unit": "m/s", "because": "profile" }]);
    assert_eq!(read_as, expected);
}
