//! ROS 2 and ROS 1 messages: what definitions may look like, where fields are, and messages that cannot be read.

use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin_cmd;
use flightcam::sample::Kind;
use serde_json::{Value, json};

use crate::support::{
    logbook::Logbook,
    ros::{Types, Wire},
    small_logs::{Found, dropped},
};

const TOPIC: &str = "/t";

/// A profile with three fields as the velocity, and as the attitude too.
fn profile([x, y, z]: [&str; 3]) -> String {
    format!(
        r#"
        name = "own"
        [attitude]
        topics = ["{TOPIC}"]
        orientation.euler = {{ roll = "{x}", pitch = "{y}", yaw = "{z}", unit = "radians" }}
        [velocity]
        topics = ["{TOPIC}"]
        vector = ["{x}", "{y}", "{z}"]
        frame = "ned"
        "#
    )
}

/// A log of messages of the type `p/A`.
fn log_of(wire: Wire, definition: &str, messages: &[Vec<u8>]) -> Logbook {
    let mut log = Logbook::new();
    let channel = log.ros(wire, TOPIC, "p/A", definition);
    for (message, time) in messages.iter().zip(0..) {
        log.put(channel, time, message);
    }
    log
}

fn find(log: Logbook, fields: [&str; 3]) -> Found {
    log.velocities(&profile(fields))
}

/// What a single field holds in a single message.
fn find_one(wire: Wire, definition: &str, message: &[u8], field: &str) -> Result<f64, String> {
    let log = log_of(wire, definition, &[message.to_vec()]);
    let (numbers, dropped) = find(log, [field; 3])?;
    match numbers[..] {
        [[number, _, _]] => Ok(number),
        _ => Err(format!("{dropped:?}")),
    }
}

fn little_endian(body: &[u8]) -> Vec<u8> {
    [&[0, 1, 0, 0], body].concat()
}

// ---- Where fields are ----

#[test]
fn a_field_is_found_after_fields_of_any_type() {
    let definitions = [
        (
            "p/A",
            "uint8 one\nstring<=20 text\nbool yes\nfloat64[3] three\nuint16[] some\nstring[<=4] texts\n\
             p/Esc first\np/Esc[2] two\np/Esc[<=5] esc\nint64 large\nint8 last",
        ),
        (
            "p/Esc",
            "string name\nuint8 state\nint16[<=3] flags\np/Speed speed",
        ),
        ("p/Speed", "bool is_valid\nfloat32 rpm"),
    ];
    let esc = |name: &str, flags: Value, rpm: f32| json!({"name": name, "state": 7, "flags": flags, "speed": {"is_valid": true, "rpm": rpm}});
    let message = |texts: Value| {
        json!({
            "one": 1, "text": "größer", "yes": true, "three": [0.1, -0.2, 1e300], "some": [1, 2, 65535],
            "texts": texts, "first": esc("", json!([]), 0.5), "two": [esc("a", json!([-1]), 1.5), esc("bb", json!([1, 2, 3]), 2.5)],
            "esc": [esc("x", json!([]), 3.5), esc("yy", json!([5]), 4.5), esc("zzz", json!([6, 7]), 5.5)],
            "large": i64::MIN, "last": -3,
        })
    };
    for wire in Wire::ALL {
        let without_bounds = |text: &str| {
            let unbounded = text.replace("<=20", "").replace("<=4", "");
            unbounded.replace("<=5", "").replace("<=3", "")
        };
        let types = Types::from(definitions.each_ref().map(|(name, text)| (*name, *text)));
        let definition = match wire {
            Wire::Ros1 => without_bounds(&types.text("p/A")),
            _ => types.text("p/A"),
        };
        // Strings of different lengths shift all that follows.
        let messages = [json!([]), json!(["", "abc"]), json!(["a", "b", "cd", ""])]
            .map(|texts| types.serialize(wire, "p/A", &message(texts)));
        for (fields, expected) in [
            (["one", "yes", "three[1]"], [1.0, 1.0, -0.2]),
            (
                ["three[2]", "some[2]", "large"],
                [1e300, 65535.0, i64::MIN as f64],
            ),
            (
                ["first.speed.rpm", "two[1].speed.rpm", "esc[2].speed.rpm"],
                [0.5, 2.5, 5.5],
            ),
            (
                ["esc[2].flags[1]", "esc[0].speed.is_valid", "last"],
                [7.0, 1.0, -3.0],
            ),
            (
                ["last", "esc[1].state", "two[0].flags[0]"],
                [-3.0, 7.0, -1.0],
            ),
        ] {
            let found = find(log_of(wire, &definition, &messages), fields);
            assert_eq!(
                found,
                Ok((vec![expected; 3], vec![])),
                "{wire:?} {fields:?}"
            );
        }
    }
}

#[test]
fn an_element_beyond_the_end_of_a_list_is_missing() {
    let types = Types::from([("p/A", "p/Esc[] esc\nuint8 last"), ("p/Esc", "int32 rpm")]);
    for wire in Wire::ALL {
        let messages = [1, 2, 3].map(|length: usize| {
            let message = json!({"esc": vec![json!({"rpm": 900}); length], "last": length});
            types.serialize(wire, "p/A", &message)
        });
        let fields = ["esc[1].rpm", "last", "last"];
        let found = find(log_of(wire, &types.text("p/A"), &messages), fields);
        let there = vec![[900.0, 2.0, 2.0], [900.0, 3.0, 3.0]];
        assert_eq!(found, Ok((there, vec![("missing_field", 1)])));
    }
}

#[test]
fn an_empty_message_takes_a_byte_in_ros2_and_none_in_ros1() {
    let text = "E first\nE[2] two\nE[] some\nC constants\nint8 last\n===\nMSG: p/E\n===\nMSG: p/C\nint32 X=5";
    let in_ros2 = little_endian(&[9, 9, 9, 0, 2, 0, 0, 0, 9, 9, 9, 251]);
    assert_eq!(
        find_one(Wire::LittleEndian, text, &in_ros2, "last"),
        Ok(-5.0)
    );
    let in_ros1 = [0xff, 0xff, 0xff, 0xff, 251];
    assert_eq!(find_one(Wire::Ros1, text, &in_ros1, "last"), Ok(-5.0));
}

#[test]
fn ros1_has_types_of_its_own() {
    let text = "Header header\ntime t\nduration d\nchar c\nbyte b\nuint8[] some\nuint8 last\n\
                ===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
    let mut message = Vec::new();
    for word in [1, 1_700_000_000, 3, 3] {
        message.extend(u32::to_le_bytes(word));
    }
    message.extend(b"map");
    message.extend([0xff; 16]);
    message.extend([250, 251, 2, 0, 0, 0, 7, 8, 42]);
    for (field, expected) in [
        ("header.seq", 1.0),
        ("header.stamp.sec", 1.7e9),
        ("header.stamp.nsec", 3.0),
        ("t.sec", 4294967295.0),
        ("t.nsec", 4294967295.0),
        ("d.sec", -1.0),
        ("d.nsec", -1.0),
        ("c", 250.0),
        ("b", -5.0),
        ("some[1]", 8.0),
        ("last", 42.0),
    ] {
        assert_eq!(
            find_one(Wire::Ros1, text, &message, field),
            Ok(expected),
            "{field}"
        );
    }
    let profile = format!(
        "time = {{ field = {{ path = \"header.stamp\" }} }}\n{}",
        profile(["last"; 3])
    );
    let log = log_of(Wire::Ros1, text, &[message]);
    let (samples, _) = log.samples(&profile).expect("a sample");
    assert_eq!(samples[0].stamp().log_time, 1_700_000_000_000_000_003);
}

#[test]
fn in_ros2_char_and_byte_are_unsigned_and_times_need_no_definition() {
    let text = "char c\nbyte b\nint8 i\nbool t\nbuiltin_interfaces/Time stamp\nbuiltin_interfaces/msg/Duration d\nuint8 last";
    let mut body = vec![250, 251, 252, 2];
    for word in [-1, 5, -2, -1] {
        body.extend(i32::to_le_bytes(word));
    }
    body.push(7);
    for (field, expected) in [
        ("c", 250.0),
        ("b", 251.0),
        ("i", -4.0),
        ("t", 1.0),
        ("stamp.sec", -1.0),
        ("stamp.nanosec", 5.0),
        ("d.sec", -2.0),
        ("d.nanosec", 4294967295.0),
        ("last", 7.0),
    ] {
        let found = find_one(Wire::LittleEndian, text, &little_endian(&body), field);
        assert_eq!(found, Ok(expected), "{field}");
    }
}

// ---- Definitions ----

#[test]
fn unusual_definitions_are_understood() {
    for text in [
        "uint8 a\nuint8 b",
        "\u{feff}uint8 a\r\nuint8 b\r\n",
        "# only\n\n\tuint8 a # 1\n   uint8\tb#2",
        "uint8 A=0x10\nuint8 a 0x10\nbool B=True\nuint8 b \"\n",
        "string S=it's # x\nuint8 a # \" '\nint32 lower=3\nuint8\tb\t5#",
        "float32 F=1.0f\nbyte N = -1\nuint8 X__Y_=1\nuint8 a\nuint8   b   ",
        "uint8<=3 A=2\nuint8 a\nuint8[<=3] EMPTY=[]\nuint8 b",
    ] {
        awkward(text, ["a", "b"]);
    }
    for text in [
        "q/E e\n===\nMSG: q/msg/E\nuint8 a\nuint8 b",
        "q/msg/E e\n===\nMSG: q/E\nuint8 a\nuint8 b",
        "E e\n================\n\nMSG:p/E\n\n# c\nuint8 a\nuint8 b\n====\nMSG: p/Unused",
        "msg_pkg/msg/E e\r\n===\r\n===\r\nMSG: msg_pkg/E # c\r\nuint8 a\r\nuint8 b\r\n===",
        "E e\n===\nMSG: E\nuint8 a\nuint8 b",
        "E e\n===\nMSG: p/E\nuint8 a\nuint8 b\n===\nMSG: p/E\nstring other",
        "E e\n===\nMSG: q/E\nstring other\n===\nMSG: p/E\nuint8 a\nuint8 b",
    ] {
        awkward(text, ["e.a", "e.b"]);
    }
}

/// Checks a definition of two bytes.
fn awkward(text: &str, [a, b]: [&str; 2]) {
    for name in ["p/msg/A", "p/A"] {
        let mut log = Logbook::new();
        let channel = log.ros(Wire::LittleEndian, TOPIC, name, text);
        log.put(channel, 0, &little_endian(&[7, 9]));
        let found = find(log, [a, b, b]);
        assert_eq!(found, Ok((vec![[7.0, 9.0, 9.0]], vec![])), "{name}: {text}");
    }
}

/// A definition of messages within each other: that many within the outermost.
fn nested(levels: usize) -> String {
    let mut text = "M1 m".to_owned();
    for level in 1..levels {
        text += &format!("\n===\nMSG: p/M{level}\nM{} m", level + 1);
    }
    text + &format!("\n===\nMSG: p/M{levels}\nuint8 a")
}

#[test]
fn messages_may_be_nested_64_deep() {
    let path = (1..64).map(|_| "m.").collect::<String>() + "a";
    let message = little_endian(&[7]);
    let found = find_one(Wire::LittleEndian, &nested(63), &message, &path);
    assert_eq!(found, Ok(7.0));
}

#[test]
fn an_unusable_definition_is_an_error_that_says_why() {
    for (text, essential) in [
        ("uint8", "line 1, `uint8`, names no field"),
        (
            "uint8 a\nuint8 b[3]",
            "line 2, `uint8 b[3]`, names no field",
        ),
        ("string <=10 s", "line 1"),
        ("uint8[-1] a", "array size"),
        ("uint8[][] a", "array size"),
        ("uint8 a\nstring<=x b", "line 2: `string<=x` is not a type"),
        ("/B b", "line 1: `/B` is not a type"),
        ("q/B b", "it does not define `q/B`"),
        ("A a", "`p/A` contains itself"),
        ("B[0] b\n===\nMSG: p/B\nB[] b", "`p/B` contains itself"),
        ("module p { module msg {", "it does not define `p/module`"),
        (
            &nested(64),
            "at `p/M64` messages are nested more than 64 deep",
        ),
    ] {
        let log = log_of(Wire::LittleEndian, text, &[little_endian(&[0; 8])]);
        let error = find(log, ["a"; 3]).expect_err(text);
        let essentials = [
            TOPIC,
            "its ROS message definition cannot be used",
            essential,
        ];
        assert!(
            essentials.iter().all(|word| error.contains(word)),
            "{text}: {error}"
        );
    }
}

#[test]
fn fields_before_a_wstring_can_be_read_and_fields_after_it_cannot() {
    let text = "uint8 a\nE[] es\nE one\nuint8 b\n===\nMSG: p/E\nuint8 x\nwstring<=9 w\nuint8 y";
    let message = little_endian(&[5, 0, 0, 0, 0, 0, 0, 0, 6]);
    assert_eq!(find_one(Wire::LittleEndian, text, &message, "a"), Ok(5.0));
    for (field, barrier) in [("b", "es"), ("one.x", "es"), ("es[0].x", "w")] {
        let error = find_one(Wire::LittleEndian, text, &message, field).expect_err(field);
        let essential = format!("nothing after the field `{barrier}` can be read");
        assert!(
            error.contains(&essential) && error.contains("wstring"),
            "{error}"
        );
    }
}

#[test]
fn a_path_to_an_unknown_field_is_an_error_that_names_where_it_stops() {
    let text = "float32[4] q\nE[] esc\nstring s\nE one\n===\nMSG: p/E\nint32 rpm";
    for (field, essential) in [
        (
            "q[4]",
            "its field `q[4]` does not exist, because the list has 4 elements, counted from 0",
        ),
        ("x", "`x`; p/A has q, esc, s, one"),
        ("esc[1].x", "`esc[1].x`; p/E has rpm"),
        (
            "esc.rpm",
            "`esc.rpm` does not exist, because `esc` is a list of messages",
        ),
        ("q[1].x", "`q[1]` is a single number"),
        ("one[0]", "`one` is a message"),
        ("s.x", "`s.x` does not exist, because `s` is text"),
        ("s[0]", "`s[0]` does not exist, because `s` is text"),
        ("s", "`s` is not a number but text"),
        ("q", "`q` is not a number but a list"),
    ] {
        for wire in Wire::ALL {
            let message = [0, 1, 0, 0].into_iter().chain([0; 64]).collect::<Vec<u8>>();
            let error = find_one(wire, text, &message, field).expect_err(field);
            assert!(
                error.contains(essential) && error.contains(TOPIC),
                "{error}"
            );
        }
    }
}

// ---- Messages that cannot be read ----

const THREE: &str = "float64 a\nfloat64 b\nfloat64 c";

/// A message of [`THREE`] that says how it is encoded.
fn encapsulated(identifier: u16, number: f64) -> Vec<u8> {
    let numbers = [0.1, number, number].map(f64::to_le_bytes);
    [
        &identifier.to_be_bytes()[..],
        &[0, 0],
        numbers.as_flattened(),
    ]
    .concat()
}

#[test]
fn encapsulations_that_are_not_read_are_counted_each_under_its_own_name() {
    let good = [encapsulated(1, 0.2), encapsulated(1, 0.3)];
    for (identifiers, reason, words) in [
        (
            &[6, 7, 8, 9, 10, 11, 0x10, 0x13, 0x15][..],
            "xcdr2",
            "XCDR2",
        ),
        (&[2, 3], "parameter_list", "PL_CDR"),
        (
            &[4, 5, 12, 0x16, 0x100, 0xffff],
            "undecodable",
            "not decodable",
        ),
    ] {
        let bad = identifiers
            .iter()
            .map(|&identifier| encapsulated(identifier, 0.4));
        let bad: Vec<Vec<u8>> = bad.collect();
        let messages = [&good[..], &bad].concat();
        let log = log_of(Wire::LittleEndian, THREE, &messages);
        let (_, report) = log
            .enrich(Some(&profile(["a", "b", "c"])))
            .expect("a result");
        let counted = [(reason, bad.len() as u64)];
        assert_eq!(dropped(&report.samples[&Kind::Attitude].tally), counted);
        assert_eq!(dropped(&report.samples[&Kind::Velocity].tally), counted);
        assert!(!report.complete);

        // The program says so, in words and by its exit code.
        let run = |messages: &[Vec<u8>]| {
            let (folder, log) = log_of(Wire::LittleEndian, THREE, messages).finish();
            let own = folder.path().join("own.toml");
            std::fs::write(&own, profile(["a", "b", "c"])).expect("written");
            let output = cargo_bin_cmd!("flightcam")
                .args(["enrich", "--depression", "30", "--profile"])
                .args([own, log])
                .output();
            output.expect("the program runs")
        };
        let partly = run(&messages);
        let text = String::from_utf8_lossy(&partly.stdout).into_owned();
        assert_eq!(partly.status.code(), Some(3), "{text}");
        assert!(text.contains(words), "{text}");
        let not_at_all = run(&bad);
        let text = String::from_utf8_lossy(&not_at_all.stderr).into_owned();
        assert_eq!(not_at_all.status.code(), Some(1), "{text}");
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn a_message_truncated_before_the_end_of_a_wanted_field_is_counted() {
    let types = Types::from([("p/A", "string name\nfloat64[] some\nfloat32 a\nfloat32 b")]);
    let message = json!({"name": "ab", "some": [1.0, 2.0], "a": 0.5, "b": 0.25});
    for wire in Wire::ALL {
        let whole = types.serialize(wire, "p/A", &message);
        let cut: Vec<Vec<u8>> = (0..=whole.len()).map(|end| whole[..end].to_vec()).collect();
        let found = |field| find(log_of(wire, &types.text("p/A"), &cut), [field; 3]);
        let cut_off = whole.len() as u64;
        assert_eq!(
            found("b"),
            Ok((vec![[0.25; 3]], vec![("undecodable", cut_off)]))
        );
        // Only what comes before it matters.
        assert_eq!(
            found("a"),
            Ok((vec![[0.5; 3]; 5], vec![("undecodable", cut_off - 4)]))
        );
    }
}

#[test]
fn false_lengths_cost_no_more_than_the_bytes_that_are_there() {
    let lists = "uint8[] a\nfloat64[] b\nstring[] c\nE[] e\nfloat64[1000000000] f\nuint8 last\n\
                 ===\nMSG: p/E\nuint8 a\nfloat64[] b\nG[1000000] g\n===\nMSG: p/G\nH[1000000] h\nstring s\n\
                 ===\nMSG: p/H\nfloat64[1000000] x\nuint8 y";
    // In ROS 1 these elements take no bytes at all.
    let nothings = "L[] l\nuint8 last\n===\nMSG: p/L\nN[] n\nZ[] z\n===\nMSG: p/N\nfloat64[0] x\nZ[1000000] z\n===\nMSG: p/Z";
    let started = Instant::now();
    for filling in [0, 1, 0xff] {
        let message = [&[0, 1, 0, 0][..], &vec![filling; 1_000_000]].concat();
        for wire in [Wire::LittleEndian, Wire::Ros1] {
            for (text, field) in [
                (lists, "last"),
                (lists, "b[1]"),
                (lists, "e[1].b[7]"),
                (lists, "e[4294967295].g[999999].h[999999].y"),
                (lists, "f[999999999]"),
                (nothings, "last"),
            ] {
                let log = log_of(wire, text, std::slice::from_ref(&message));
                let found = find(log, [field; 3]).map(|(numbers, _)| numbers.len());
                assert!(found.is_ok(), "{found:?}");
            }
        }
    }
    let taken = started.elapsed();
    assert!(taken < Duration::from_secs(10), "{taken:?}");
}
