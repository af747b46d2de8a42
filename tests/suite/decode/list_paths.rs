//! Paths to elements of lists and to times, in protobuf and JSON: the right numbers, to the last digit.

use flightcam::sample::Kind;
use proptest::{collection::vec, prelude::*};
use serde_json::{Value, json};

use crate::support::{
    logbook::{Logbook, protobuf_message},
    ros::{Types, Wire},
    small_logs::{Found, dropped},
};

/// A profile with three fields as the velocity; the attitude is that of a drone that stands still.
fn profile([x, y, z]: [&str; 3]) -> String {
    format!(
        r#"
        name = "own"
        [attitude]
        topics = ["/t"]
        orientation.euler = {{ roll = "still", pitch = "still", yaw = "still", unit = "radians" }}
        [velocity]
        topics = ["/t"]
        vector = ["{x}", "{y}", "{z}"]
        frame = "ned"
        "#
    )
}

fn find(log: Logbook, fields: [&str; 3]) -> Found {
    log.velocities(&profile(fields))
}

fn json_log(messages: &[&str]) -> Logbook {
    let mut log = Logbook::new();
    let channel = log.json("/t");
    for (message, time) in messages.iter().zip(0..) {
        log.put(channel, time, message.as_bytes());
    }
    log
}

fn protobuf_log(definition: &str, messages: &[&str]) -> Logbook {
    let mut log = Logbook::new();
    let (channel, message) = log.protobuf("/t", definition);
    for (text, time) in messages.iter().zip(0..) {
        log.put(channel, time, &protobuf_message(&message, text));
    }
    log
}

// ---- Elements of lists ----

/// What random messages hold: `still`, `q`, `counts`, `esc` with `rpm` and `temperatures`, `body.rates`.
#[derive(Debug, Clone)]
struct Lists {
    q: Vec<f64>,
    counts: Vec<i64>,
    esc: Vec<(i32, Vec<f32>)>,
    rates: Vec<u32>,
}

fn lists() -> impl Strategy<Value = Lists> {
    let real = || prop::num::f64::NORMAL | prop::num::f64::ZERO;
    let single = prop::num::f32::NORMAL | prop::num::f32::ZERO;
    let esc = (any::<i32>(), vec(single, 0..4));
    (
        vec(real(), 0..6),
        vec(any::<i64>(), 0..6),
        vec(esc, 0..4),
        vec(any::<u32>(), 0..6),
    )
        .prop_map(|(q, counts, esc, rates)| Lists {
            q,
            counts,
            esc,
            rates,
        })
}

/// The places in the lists that are asked for: of `q`, `counts`, `esc`, `temperatures` and `rates`.
type Places = [usize; 5];

/// Each path is in one of these, so that all are asked for.
fn path_triples([q, counts, esc, temperature, rate]: Places) -> [[String; 3]; 2] {
    let q = format!("q[{q}]");
    [
        [
            q.clone(),
            format!("esc[{esc}].rpm"),
            format!("esc[{esc}].temperatures[{temperature}]"),
        ],
        [
            format!("counts[{counts}]"),
            format!("body.rates[{rate}]"),
            q,
        ],
    ]
}

impl Lists {
    fn numbers(&self, [q, counts, esc, temperature, rate]: Places) -> [Option<[f64; 3]>; 2] {
        let q = self.q.get(q).copied();
        let (rpm, temperatures) = self.esc.get(esc).cloned().unzip();
        let temperature = temperatures.and_then(|all| all.get(temperature).copied());
        let count = self.counts.get(counts).map(|&count| count as f64);
        let rate = self.rates.get(rate).map(|&rate| f64::from(rate));
        let all = |[a, b, c]: [Option<f64>; 3]| Some([a?, b?, c?]);
        [
            all([q, rpm.map(f64::from), temperature.map(f64::from)]),
            all([count, rate, q]),
        ]
    }

    /// As a JSON message, with whole numbers of 64 bits as strings where `in_text` says so.
    fn json(&self, in_text: bool) -> String {
        let esc = |(rpm, temperatures): &(i32, Vec<f32>)| json!({"rpm": rpm, "x": [[1]], "temperatures": temperatures});
        let counts = self.counts.iter().map(|count| match in_text {
            true => json!(count.to_string()),
            false => json!(count),
        });
        json!({
            "still": 0, "note": "q[0]", "q": self.q, "counts": counts.collect::<Vec<_>>(),
            "esc": self.esc.iter().map(esc).collect::<Vec<Value>>(), "body": {"rates": self.rates},
        })
        .to_string()
    }

    /// As a protobuf message. Of each two bits of `ways`, the first says whether the next number of a list is packed
    /// together with the previous one, the second whether `body` goes on in another part.
    fn protobuf(&self, mut ways: u64) -> Vec<u8> {
        let mut out = Vec::new();
        let mut together = || {
            ways = ways.rotate_right(1);
            ways & 1 == 1
        };
        let mut push = |out: &mut Vec<u8>, number: u64, wire: u64, elements: Vec<Vec<u8>>| {
            let mut packed: Vec<u8> = Vec::new();
            for element in elements {
                if together() {
                    packed.extend(element);
                    continue;
                }
                push_delimited(out, number, &std::mem::take(&mut packed));
                push_varint(out, number << 3 | wire);
                out.extend(element);
            }
            push_delimited(out, number, &packed);
        };
        let doubles = self.q.iter().map(|q| q.to_le_bytes().to_vec()).collect();
        push(&mut out, 1, 1, doubles);
        for (rpm, temperatures) in &self.esc {
            let mut esc = vec![1 << 3];
            push_varint(&mut esc, i64::from(*rpm) as u64);
            let floats = temperatures
                .iter()
                .map(|t| t.to_le_bytes().to_vec())
                .collect();
            push(&mut esc, 2, 5, floats);
            push_delimited(&mut out, 3, &esc);
        }
        let zigzags = self
            .counts
            .iter()
            .map(|&count| varint((count << 1 ^ count >> 63) as u64))
            .collect();
        push(&mut out, 2, 0, zigzags);
        let rates: Vec<Vec<u8>> = self.rates.iter().map(|&rate| varint(rate.into())).collect();
        let (first, second) = rates.split_at(rates.len() / 2);
        for part in [first, second] {
            let mut body = Vec::new();
            push(&mut body, 1, 0, part.to_vec());
            push_delimited(&mut out, 4, &body);
        }
        out
    }
}

fn varint(mut number: u64) -> Vec<u8> {
    let mut out = Vec::new();
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
    out
}

fn push_varint(out: &mut Vec<u8>, number: u64) {
    out.extend(varint(number));
}

fn push_delimited(out: &mut Vec<u8>, number: u64, bytes: &[u8]) {
    push_varint(out, number << 3 | 2);
    push_varint(out, bytes.len() as u64);
    out.extend(bytes);
}

const LISTS: &str =
    "message Message { double still = 9; repeated double q = 1; repeated sint64 counts = 2;
    repeated Esc esc = 3; Body body = 4; }
    message Esc { int32 rpm = 1; repeated float temperatures = 2; }
    message Body { repeated uint32 rates = 1; }";

fn check(
    log: impl Fn() -> Logbook,
    messages: &[Lists],
    places: Places,
) -> Result<(), TestCaseError> {
    for (which, paths) in path_triples(places).iter().enumerate() {
        let expected: Vec<[f64; 3]> = messages
            .iter()
            .filter_map(|lists| lists.numbers(places)[which])
            .collect();
        let missing = (messages.len() - expected.len()) as u64;
        let reasons = if missing > 0 {
            vec![("missing_field", missing)]
        } else {
            vec![]
        };
        prop_assert_eq!(
            find(log(), paths.each_ref().map(String::as_str)),
            Ok((expected, reasons))
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::support::cases(256))]

    #[test]
    fn elements_of_protobuf_lists_are_read_however_they_are_packed(
        messages in vec((lists(), any::<u64>()), 1..5),
        places in prop::array::uniform5(0..4_usize),
    ) {
        let log = || {
            let mut log = Logbook::new();
            let (channel, _) = log.protobuf("/t", LISTS);
            for ((lists, ways), time) in messages.iter().zip(0..) {
                log.put(channel, time, &lists.protobuf(*ways));
            }
            log
        };
        let lists: Vec<Lists> = messages.iter().map(|(lists, _)| lists.clone()).collect();
        check(log, &lists, places)?;
    }

    #[test]
    fn elements_of_json_lists_are_read(
        messages in vec((lists(), any::<bool>()), 1..5),
        places in prop::array::uniform5(0..4_usize),
    ) {
        // What no message has may as well be a misspelling.
        let full = Lists { q: vec![0.5; 4], counts: vec![1; 4], esc: vec![(2, vec![1.5; 4]); 4], rates: vec![3; 4] };
        let messages = [&[(full, false)], &messages[..]].concat();
        let texts: Vec<String> = messages.iter().map(|(lists, in_text)| lists.json(*in_text)).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let lists: Vec<Lists> = messages.iter().map(|(lists, _)| lists.clone()).collect();
        check(|| json_log(&texts), &lists, places)?;
    }
}

#[test]
fn an_element_that_no_list_has_is_missing_and_in_json_an_error() {
    let message = r#"{"still":0,"q":[1,2,3,4]}"#;
    let found = find(protobuf_log(LISTS, &[message; 3]), ["q[4]"; 3]);
    assert_eq!(found, Ok((vec![], vec![("missing_field", 3)])));
    let error = find(json_log(&[message]), ["q[4]"; 3]).expect_err("no message has it");
    assert!(
        error.contains("`q[4]`") && error.contains("has q, still"),
        "{error}"
    );
    // The length of a fixed list is in its definition.
    let types = Types::from([("p/A", "float64 still\nfloat64[4] q")]);
    let mut log = Logbook::new();
    let channel = log.ros(Wire::LittleEndian, "/t", "p/A", &types.text("p/A"));
    let message = serde_json::from_str(message).expect("JSON");
    log.put(
        channel,
        0,
        &types.serialize(Wire::LittleEndian, "p/A", &message),
    );
    let error = find(log, ["q[4]"; 3]).expect_err("no message has it");
    assert!(
        error.contains("`q[4]`") && error.contains("4 elements"),
        "{error}"
    );
}

#[test]
fn json_lists_may_be_nested() {
    let message = r#"{"still":0,"m":[[1,2,3],[4,"5",6],{"a":[7]}]}"#;
    let found = find(json_log(&[message]), ["m[0][2]", "m[1][1]", "m[2].a[0]"]);
    assert_eq!(found, Ok((vec![[3.0, 5.0, 7.0]], vec![])));
}

#[test]
fn a_path_into_a_number_or_string_is_an_error_that_says_so() {
    let definition = "message Message { double still = 1; string note = 2; bytes raw = 3; map<string, double> by = 4;
        repeated Esc esc = 5; } message Esc { double rpm = 1; }";
    for (path, essential) in [
        ("note.x", "`note.x` does not exist, because `note` is text"),
        (
            "note[0]",
            "`note[0]` does not exist, because `note` is text",
        ),
        ("note", "`note` is not a number but text"),
        ("raw[0]", "`raw` is bytes"),
        ("by.a", "`by` is a map"),
        ("esc.rpm", "`esc` is a list of messages"),
        ("esc[0]", "`esc[0]` is not a number but a message"),
        ("esc[0].x", "`esc[0].x`; test.Esc has rpm"),
        ("still[0]", "`still` is a single number"),
    ] {
        let log = protobuf_log(definition, &["{}"]);
        let error = find(log, [path, "still", "still"]).expect_err(path);
        assert!(error.contains(essential) && error.contains("/t"), "{error}");
    }
    for (path, essential) in [
        ("note.x", "no field `note.x`"),
        ("note[0]", "no field `note[0]`"),
        ("note", "`note` is not a number but text"),
        ("esc.rpm", "no field `esc.rpm`"),
        ("esc[0]", "`esc[0]` is not a number but a message"),
    ] {
        let log = json_log(&[r#"{"still":0,"note":"x","esc":[{"rpm":1}]}"#]);
        let error = find(log, [path, "still", "still"]).expect_err(path);
        assert!(error.contains(essential) && error.contains("/t"), "{error}");
    }
}

// ---- Numbers in strings ----

#[test]
fn json_numbers_may_be_strings() {
    let message = |x: &str| format!(r#"{{"still":"0","x":{x},"y":"-1e3","z":" 0.5 "}}"#);
    let texts = [
        r#""12.5""#,
        r#""9007199254740993""#,
        r#""+7""#,
        "true",
        r#""NaN""#,
        r#""-Infinity""#,
        "null",
        r#""""#,
        r#""12,5""#,
        r#""0x10""#,
    ];
    let messages = texts.map(message);
    let log = json_log(&messages.each_ref().map(String::as_str));
    let (numbers, dropped) = find(log, ["x", "y", "z"]).expect("numbers");
    let expected = [12.5, 9007199254740992.0, 7.0, 1.0].map(|x| [x, -1000.0, 0.5]);
    assert_eq!(numbers, expected);
    assert_eq!(
        dropped,
        [("undecodable", 3), ("missing_field", 1), ("non_finite", 2)]
    );
}

#[test]
fn a_json_list_may_hold_numbers_as_strings() {
    let profile = r#"
        name = "list"
        [attitude]
        topics = ["/t"]
        orientation.quaternion = "q"
        convention = "frd-ned"
    "#;
    let log = json_log(&[
        r#"{"q":["1","0.0",0,"-0"]}"#,
        r#"{"q":[1,0,0,"NaN"]}"#,
        r#"{"q":[1,0,0,null]}"#,
        r#"{"q":[1,0,0,"one"]}"#,
        r#"{"q":[1,0,0,{}]}"#,
        r#"{"q":[1,0,0]}"#,
    ]);
    let (samples, tallies) = log.samples(profile).expect("samples");
    assert_eq!(samples.len(), 1);
    let expected = [("undecodable", 2), ("non_finite", 2), ("not_a_rotation", 1)];
    assert_eq!(dropped(&tallies[Kind::Attitude]), expected);
}

// ---- Times ----

/// The times in nanoseconds that a field gives to messages, which need nothing else, and what is dropped.
fn times(log: Logbook, field: &str, unit: &str) -> (Vec<u64>, Vec<(&'static str, u64)>) {
    let time = format!("time = {{ field = {{ path = \"{field}\", unit = \"{unit}\" }} }}\n");
    let (samples, tallies) = log
        .samples(&(time + &profile(["still"; 3])))
        .expect("samples");
    let velocities = samples
        .iter()
        .filter(|sample| sample.kind() == Kind::Velocity);
    let times = velocities.map(|sample| sample.stamp().log_time).collect();
    (times, dropped(&tallies[Kind::Velocity]))
}

#[test]
fn whole_numbers_of_64_bits_are_times_to_the_nanosecond() {
    // None of these is a double.
    let stamps = [
        1_712_345_678_901_234_567,
        1_712_345_678_901_234_568,
        (1 << 63) - 1,
    ];
    for kind in ["uint64", "int64", "fixed64", "sfixed64", "sint64"] {
        let definition = format!("message Message {{ double still = 1; {kind} stamp = 2; }}");
        let messages = stamps.map(|stamp| format!(r#"{{"stamp":"{stamp}"}}"#));
        let log = protobuf_log(&definition, &messages.each_ref().map(String::as_str));
        assert_eq!(
            times(log, "stamp", "ns"),
            (stamps.to_vec(), vec![]),
            "{kind}"
        );
    }
    for quote in ["", "\""] {
        let messages =
            stamps.map(|stamp| format!(r#"{{"still":0,"stamp":{quote}{stamp}{quote}}}"#));
        let log = json_log(&messages.each_ref().map(String::as_str));
        assert_eq!(times(log, "stamp", "ns"), (stamps.to_vec(), vec![]));
    }
    for (wire, kind) in Wire::ALL
        .into_iter()
        .flat_map(|wire| [(wire, "uint64"), (wire, "int64")])
    {
        let definition = format!("float64 still\n{kind} stamp");
        let types = Types::from([("p/A", definition.as_str())]);
        let mut log = Logbook::new();
        let channel = log.ros(wire, "/t", "p/A", &definition);
        for stamp in stamps {
            let message = json!({"still": 0, "stamp": stamp});
            log.put(channel, 0, &types.serialize(wire, "p/A", &message));
        }
        assert_eq!(
            times(log, "stamp", "ns"),
            (stamps.to_vec(), vec![]),
            "{wire:?}"
        );
    }
}

#[test]
fn a_time_may_be_in_any_unit_and_an_impossible_one_is_dropped() {
    for (unit, stamp, expected) in [
        ("s", "1712345678.5", Ok(1_712_345_678_500_000_000)),
        ("s", "1712345678", Ok(1_712_345_678_000_000_000)),
        ("ms", "1712345678901", Ok(1_712_345_678_901_000_000)),
        ("us", "1712345678901234", Ok(1_712_345_678_901_234_000)),
        ("ns", "18446744073709551615", Ok(u64::MAX)),
        ("ns", "18446744073709551616", Err("bad_time")),
        ("us", "18446744073709552", Err("bad_time")),
        ("ns", "-1", Err("bad_time")),
        ("s", "-0.5", Err("bad_time")),
        ("s", "1e300", Err("bad_time")),
        ("s", "\"NaN\"", Err("bad_time")),
        ("s", "null", Err("missing_field")),
    ] {
        let message = format!(r#"{{"still":0,"stamp":{stamp}}}"#);
        let found = times(json_log(&[&message]), "stamp", unit);
        let expected = match expected {
            Ok(time) => (vec![time], vec![]),
            Err(reason) => (vec![], vec![(reason, 1)]),
        };
        assert_eq!(found, expected, "{stamp} {unit}");
    }
}

#[test]
fn a_message_of_seconds_and_nanoseconds_is_a_time() {
    let expected = (vec![1_712_345_678_901_234_567], vec![]);
    for [seconds, nanoseconds] in [
        ["sec", "nanosec"],
        ["sec", "nsec"],
        ["secs", "nsecs"],
        ["seconds", "nanos"],
        ["seconds", "nanoseconds"],
    ] {
        let stamp = format!(r#"{{"{seconds}":1712345678,"{nanoseconds}":901234567}}"#);
        let text = format!(r#"{{"still":0,"header":{{"stamp":{stamp}}}}}"#);
        assert_eq!(times(json_log(&[&text]), "header.stamp", "s"), expected);
        let definition = format!(
            "message Message {{ double still = 1; Header header = 2; }} message Header {{ Stamp stamp = 1; }}
             message Stamp {{ int64 {seconds} = 1; int32 {nanoseconds} = 2; }}"
        );
        let found = times(protobuf_log(&definition, &[&text]), "header.stamp", "s");
        assert_eq!(found, expected);
    }
    let text = r#"{"still":0,"stamp":{"sec":-1,"nsec":5}}"#;
    assert_eq!(
        times(json_log(&[text]), "stamp", "s"),
        (vec![], vec![("bad_time", 1)])
    );
}
