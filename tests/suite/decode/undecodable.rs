//! Of the first message that cannot be decoded it is said what is wrong with it, and where.

use flightcam::{
    Note, Options,
    geometry::DepressionAngle,
    log::{Log, ReadError},
    reader::Reader,
    sample::Kind,
    source::{Source, request::Request, undecodable::UndecodableMessage},
};
use serde_json::{Value, json};

use crate::support::{
    folder::{Folder, LOG, assert_reads},
    logbook::{Logbook, protobuf_message, request},
    ros::{Types, Wire},
};

const PROFILE: &str = r#"
    name = "own"
    [attitude]
    topics = ["/t"]
    when = { field = "mode", says = "auto" }
    orientation.euler = { roll = "angles.roll", pitch = "angles.pitch", yaw = "list[1].yaw", unit = "radians" }
    [velocity]
    topics = ["/t"]
    vector = "v"
    frame = "ned"
"#;

const WHOLE: &str = r#"{"mode":"auto","angles":{"roll":0,"pitch":0},"list":[{"yaw":0},{"yaw":0}],"v":[1,2,3],"n":NaN}"#;

/// The first message of the attitude that cannot be decoded.
fn first(log: Logbook, request: &Request) -> Option<UndecodableMessage> {
    let (_folder, path) = log.finish();
    let log = Log::open(&path).expect("a log");
    let source = Source::select(&log, request).expect("a source");
    let reader = Reader::new(&log, source).expect("a readable log");
    let read = reader.for_each(|_| Ok::<_, ReadError>(()));
    let source = read.expect("a readable log").source;
    source.undecodable(Kind::Attitude)
}

/// What is wrong with a JSON message after others that are whole.
fn problem(message: impl AsRef<[u8]>) -> String {
    let mut log = Logbook::new();
    let channel = log.json("/t");
    // The first ten show what the fields are.
    for time in 0..10 {
        log.put(channel, time, WHOLE.as_bytes());
    }
    log.put(channel, 10, message.as_ref());
    let undecodable = first(log, &request(PROFILE)).expect("an undecodable message");
    assert_eq!(undecodable.log_time, 10_000_000);
    assert_eq!(undecodable.topic, "/t");
    undecodable.problem.to_string()
}

#[test]
fn a_json_value_that_is_not_what_is_wanted_is_named_with_its_field() {
    for (part, replacement, expected) in [
        (
            r#""roll":0"#,
            r#""roll":"n/a""#,
            r#"its field `angles.roll` is `"n/a"`, not a number"#,
        ),
        (
            r#""roll":0"#,
            r#""roll":{"a":[1]}"#,
            r#"its field `angles.roll` is `{"a":[1]}`, not a number"#,
        ),
        (
            r#"{"roll":0,"pitch":0}"#,
            "3",
            "its field `angles` is `3`, not an object",
        ),
        (
            r#"{"yaw":0}]"#,
            r#"{"yaw":"x"}]"#,
            r#"its field `list[1].yaw` is `"x"`, not a number"#,
        ),
        (
            r#"[{"yaw":0},{"yaw":0}]"#,
            r#"{"yaw":0}"#,
            r#"its field `list` is `{"yaw":0}`, not a list"#,
        ),
        (
            "[1,2,3]",
            r#"[1,2,"drei"]"#,
            r#"its field `v[2]` is `"drei"`, not a number"#,
        ),
        (r#""auto""#, "[]", "its field `mode` is `[]`, not text"),
        (
            r#""roll":0"#,
            r#""roll":"\u001b[31m\n""#,
            r#"its field `angles.roll` is `"\u001b[31m\n"`, not a number"#,
        ),
        (WHOLE, "[1]", "it is `[1]`, not an object"),
    ] {
        let message = WHOLE.replacen(part, replacement, 1);
        assert_eq!(problem(&message), expected, "{message}");
        // Where the log has no such numbers, too.
        assert_eq!(problem(message.replace("NaN", "1")), expected, "{message}");
    }
    let long = WHOLE.replacen(":0", &format!(r#":"{}""#, "\u{e4}".repeat(3000)), 1);
    let expected = format!(
        r#"its field `angles.roll` is `"{}…`, not a number"#,
        "\u{e4}".repeat(59)
    );
    assert_eq!(problem(long), expected);
}

#[test]
fn what_is_not_json_is_named_with_its_place() {
    for (part, replacement, expected) in [
        (
            r#""roll":0"#,
            r#""roll": .5"#,
            "it is not JSON in its field `angles.roll`: expected value at byte 33, `.5`",
        ),
        (
            r#""n":NaN"#,
            r#""n":NaN,"m":{"k":[0, nix]}"#,
            "it is not JSON in its field `m.k[1]`: expected ident at byte 107, `nix`",
        ),
        (
            r#""roll":0"#,
            r#""roll":1e999"#,
            "it is not JSON in its field `angles.roll`: number out of range at byte 32, `1e999`",
        ),
        (
            r#","v""#,
            r#""v""#,
            "it is not JSON in its field `v`: expected `,` or `}` at byte 73, `\"v\"`",
        ),
        (
            r#":NaN}"#,
            ":NaN}}",
            "it is not JSON: trailing characters at byte 94, `}`",
        ),
    ] {
        let message = WHOLE.replacen(part, replacement, 1);
        assert_eq!(problem(&message), expected, "{message}");
    }
    let cut_off = |length: usize| problem(&WHOLE.as_bytes()[..length]);
    assert_eq!(
        cut_off(32),
        "it is not JSON in its field `angles.roll`: it ends after 32 bytes"
    );
    assert_eq!(cut_off(0), "it is not JSON: it ends after 0 bytes");
    let lines = WHOLE
        .replace(',', ",\n")
        .replacen(r#""pitch":0"#, "\"pitch\":\n  ?", 1);
    assert_eq!(
        problem(lines),
        "it is not JSON in its field `angles.pitch`: expected value at byte 47, `?`"
    );
}

#[test]
fn messages_that_are_compressed_one_by_one_are_recognised() {
    let compressed = |message: &[u8]| zstd::encode_all(message, 3).expect("compressed");
    let expected = "its messages are compressed one by one (zstd), as rosbag2 does with \
                    `compression_mode: message`; flightcam does not read that";
    assert_eq!(problem(compressed(WHOLE.as_bytes())), expected);

    let types = Types::from([("t/T", "string mode\nfloat64[4] q\n")]);
    let message = json!({ "mode": "auto", "q": [1, 0, 0, 0] });
    for wire in Wire::ALL {
        let mut log = Logbook::new();
        let channel = log.ros(wire, "/t", "t/T", &types.text("t/T"));
        for time in 0..3 {
            log.put(
                channel,
                time,
                &compressed(&types.serialize(wire, "t/T", &message)),
            );
        }
        let first = first(log, &request(OF_Q)).expect("an undecodable message");
        assert_eq!(first.problem.to_string(), expected, "{wire:?}");
    }
}

/// Where the messages have to tell which fields there are.
#[test]
fn why_no_field_is_found_in_messages_that_are_not_json_is_said() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    for time in 0..3 {
        let message = zstd::encode_all(WHOLE.as_bytes(), 3).expect("compressed");
        log.put(channel, time, &message);
    }
    let (_folder, path) = log.finish();
    let log = Log::open(&path).expect("a log");
    let problem = Source::select(&log, &Request::default()).expect_err("no fields");
    assert_reads(
        &problem.to_string(),
        "flat: … what /state has is not known: its first messages cannot be read: its messages are compressed one by \
         one (zstd)",
    );
}

const OF_Q: &str = r#"
    name = "own"
    [attitude]
    topics = ["/t"]
    when = { field = "mode", says = "auto" }
    orientation.quaternion = "q"
    convention = "frd-ned"
"#;

#[test]
fn a_ros_message_that_breaks_off_is_explained_by_the_field_where_it_does() {
    let types = Types::from([
        (
            "t/T",
            "uint8[] skipped\nstring mode\nt/Part[] parts\nfloat64[4] q\n",
        ),
        ("t/Part", "float64 a\nstring b\n"),
    ]);
    let message = json!({ "skipped": [1, 2, 3], "mode": "auto", "parts": [{ "a": 1, "b": "c" }], "q": [1, 0, 0, 0] });
    for wire in Wire::ALL {
        let whole = types.serialize(wire, "t/T", &message);
        let explained = |bytes: &[u8]| {
            let mut log = Logbook::new();
            let channel = log.ros(wire, "/t", "t/T", &types.text("t/T"));
            log.put(channel, 0, &whole);
            log.put(channel, 1, bytes);
            let first = first(log, &request(OF_Q)).expect("an undecodable message");
            first.problem.to_string()
        };
        let length = whole.len() - 1;
        assert_eq!(
            explained(&whole[..length]),
            format!("it ends after {length} bytes, before its field `q` does")
        );
        let skipped = if wire == Wire::Ros1 { 5 } else { 9 };
        for length in [skipped, skipped + 6] {
            assert_eq!(
                explained(&whole[..length]),
                format!("it ends after {length} bytes, before its field `mode` does")
            );
        }
        if wire == Wire::Ros1 {
            continue;
        }
        assert_eq!(
            explained(&whole[..3]),
            "it has 3 bytes, too few to name the version of CDR"
        );
        let begins_with = |identifier: [u8; 2]| {
            let mut message = whole.clone();
            message[..2].copy_from_slice(&identifier);
            explained(&message)
        };
        assert_eq!(
            begins_with([0x12, 0xff]),
            "it begins with the bytes 12 ff, which name no version of CDR"
        );
        assert_reads(&begins_with([0, 7]), "it is encoded as XCDR2");
        assert_reads(
            &begins_with([0, 3]),
            "it is encoded as a CDR parameter list",
        );
    }
}

#[test]
fn a_protobuf_message_is_explained_by_the_field_that_cannot_be_read() {
    let definition = "message Message { Pose pose = 1; string mode = 2; Other other = 3; }
        message Pose { repeated double q = 4; } message Other { bytes data = 1; }";
    let profile = OF_Q.replace("\"q\"", "\"pose.q\"");
    let explained = |bytes: &[u8]| {
        let mut log = Logbook::new();
        let (channel, message) = log.protobuf("/t", definition);
        let whole = r#"{"pose":{"q":[1,0,0,0]},"mode":"auto"}"#;
        log.put(channel, 0, &protobuf_message(&message, whole));
        log.put(channel, 1, bytes);
        let first = first(log, &request(&profile)).expect("an undecodable message");
        first.problem.to_string()
    };
    let mode = [0x12, 4, b'a', b'u', b't', b'o'];
    let after_mode = |bytes: &[u8]| explained(&[&mode[..], bytes].concat());
    // Field 4, packed, within field 1.
    let q = [&[0x0a, 34, 0x22, 32][..], &[0; 32]].concat();
    assert_eq!(
        after_mode(&q[..20]),
        "it ends after 26 bytes, before its field `pose` does"
    );
    assert_eq!(
        after_mode(&[0x0a, 3, 0x22, 32, 0]),
        "it ends after 11 bytes, before its field `pose.q` does"
    );
    assert_eq!(
        after_mode(&[0x0a, 2, 0x20, 1]),
        "its field `pose.q`, at byte 8, is not encoded as its type says"
    );
    assert_eq!(
        explained(&[0x10, 1]),
        "its field `mode`, at byte 0, is not encoded as its type says"
    );
    assert_eq!(
        after_mode(&[0x1a, 9, 1]),
        "at byte 6 of 9 there is no field"
    );
    assert_eq!(
        after_mode(&[0xff, 0xff]),
        "at byte 6 of 8 there is no field"
    );
}

/// The segments are read by several threads, if there are that many processors.
#[test]
fn of_all_messages_the_one_with_the_earliest_time_is_explained() {
    let mut log = Logbook::with_chunks_of(100_000);
    let channel = log.json("/t");
    let padding = "x".repeat(10_000);
    let whole = WHOLE.replace("NaN", &format!("\"{padding}\""));
    // The last in the file is the earliest.
    for time in (1..700).rev() {
        let message = match time % 100 {
            50 => whole.replacen(":0", &format!(":\"at {time}\""), 1),
            _ => whole.clone(),
        };
        log.put(channel, time, message.as_bytes());
    }
    let first = first(log, &request(PROFILE)).expect("an undecodable message");
    assert_eq!(first.log_time, 50_000_000);
    assert_eq!(
        first.to_string(),
        "the message on /t at 0.050000000 s in log time: its field `angles.roll` is `\"at 50\"`, not a number"
    );
}

fn flat(yaw: &[&str]) -> Logbook {
    let mut log = Logbook::new();
    let fields = ["roll", "pitch", "yaw", "vx", "vy", "vz"];
    let number = |name: &str| (name.to_owned(), json!({ "type": "number" }));
    let properties: serde_json::Map<_, _> = fields.into_iter().map(number).collect();
    let schema = json!({ "properties": properties }).to_string();
    let schema = log
        .writer
        .add_schema("State", "jsonschema", schema.as_bytes());
    let channel = log.channel(schema.expect("a schema"), "/state", "json");
    for (yaw, time) in yaw.iter().zip(0..) {
        log.put_flat(channel, time, yaw, "1");
    }
    log
}

#[test]
fn the_report_says_what_is_wrong_with_the_first_message() {
    let (_, report) = flat(&["0", "0", "\"east\"", "\"west\"", "0"])
        .enrich(None)
        .expect("a result");
    let undecodable = report.notes.iter().find_map(|note| match note {
        Note::Undecodable { samples, first } => Some((samples, first.clone()?)),
        _ => None,
    });
    let (samples, first) = undecodable.expect("a note");
    assert_eq!(*samples, 4);
    assert_eq!(first.log_time, 2_000_000);
    let json: Value = serde_json::to_value(&first).expect("JSON");
    let expected = json!({
        "topic": "/state",
        "log_time": 2_000_000,
        "problem": r#"its field `yaw` is `"east"`, not a number"#,
    });
    assert_eq!(json, expected);
}

#[test]
fn the_error_that_nothing_is_derived_says_what_is_wrong_with_the_first_message() {
    let problem = flat(&["\"east\"", "\"west\""])
        .enrich(None)
        .expect_err("nothing");
    assert_reads(
        &problem.to_string(),
        "/camera/relative_rpy: … /state has 0 of 2 usable, 2 not decodable; the first that cannot be decoded is the \
         message on /state at 0.000000000 s in log time: its field `yaw` is `\"east\"`, not a number",
    );
}

#[test]
fn the_command_line_says_it_too() {
    let (_folder, path) = flat(&["0", "0", "\"east\"", "0"]).finish();
    let folder = Folder::with(LOG, std::fs::read(path).expect("the log"));
    let wrong = "is the message on /state at 0.002000000 s in log time: its field `yaw` is `\"east\"`, not a number";
    let (inspected, _) = folder.run("inspect flight.mcap --depression 30", 0);
    assert_reads(&inspected.replace("\n             ", " "), wrong);
    let (report, _) = folder.run("enrich flight.mcap --depression 30", 3);
    assert_reads(
        &report,
        "2 samples could not be decoded as the log's schemas say; the first is in the message on /state at",
    );
    let options = Options::new().depression(DepressionAngle::from_degrees(30.0).expect("30°"));
    let inspection = flightcam::inspect(folder.path(LOG), &options).expect("a log");
    let json = serde_json::to_value(&inspection).expect("JSON");
    let first = &json["telemetry"]["roles"]["attitude"]["first_undecodable"];
    assert_eq!(first["log_time"], 2_000_000);
}
