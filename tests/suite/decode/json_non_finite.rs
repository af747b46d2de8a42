//! JSON as loggers write it, with bare `NaN` and `Infinity`: not finite where they are needed, and no matter elsewhere.

use std::fmt::Write;

use flightcam::source::{Source, request::Request};
use proptest::{collection::vec, prelude::*};

use crate::support::{logbook::Logbook, small_logs::Found, telemetry::InMemory};

const PROFILE: &str = r#"
    name = "own"
    [attitude]
    topics = ["/t"]
    when = { field = "mode", says = "NaN-free" }
    orientation.quaternion = "q"
    convention = "frd-ned"
    [velocity]
    topics = ["/t"]
    vector = ["x", "y", "z"]
    frame = "ned"
"#;

fn log_of(messages: &[String]) -> Logbook {
    let mut log = Logbook::new();
    let channel = log.json("/t");
    for (message, time) in messages.iter().zip(0..) {
        log.put(channel, time, message.as_bytes());
    }
    log
}

fn velocities(messages: &[String]) -> Found {
    log_of(messages).velocities(PROFILE)
}

/// A message with this x, and with something else that nobody wants.
fn message(x: &str, other: &str) -> String {
    format!(r#"{{"mode":"NaN-free","other":{other},"q":[1,0,0,0],"x":{x},"y":2,"z":-3}}"#)
}

#[test]
fn a_number_that_is_not_finite_does_not_matter_where_it_is_not_needed() {
    let others = [
        "NaN",
        "-Infinity",
        "Infinity ",
        "nan",
        "-inf",
        "[NaN]",
        "[1, [Infinity,NaN], {}]",
        r#"{"a": NaN, "b": {"c": [-Infinity]}}"#,
        r#"["NaN", NaN, "\"NaN", "\\", NaN, "a\\\"", NaN]"#,
        r#""NaN""#,
        r#""\u004eaN""#,
        "1.5e-3",
        "null",
    ];
    let messages: Vec<String> = others.iter().map(|other| message("1", other)).collect();
    let (found, dropped) = velocities(&messages).expect("velocities");
    assert_eq!(found, vec![[1.0, 2.0, -3.0]; others.len()]);
    assert_eq!(dropped, []);
}

#[test]
fn a_sample_that_needs_a_number_that_is_not_finite_is_dropped() {
    let numbers = [
        "1",
        "NaN",
        "Infinity",
        "-Infinity",
        "+inf",
        "-nan",
        "INF",
        "NAN",
        "4",
        "nano",
        "Na",
        "N\u{e4}N",
    ];
    let messages = numbers.map(|x| message(x, "0"));
    let (found, dropped) = velocities(&messages).expect("velocities");
    assert_eq!(found, [[1.0, 2.0, -3.0], [4.0, 2.0, -3.0]]);
    assert_eq!(dropped, [("undecodable", 3), ("non_finite", 7)]);
}

#[test]
fn a_list_may_have_numbers_that_are_not_finite() {
    let profile = r#"
        name = "list"
        [attitude]
        topics = ["/t"]
        orientation.quaternion = { fields = ["q[0]", "q[1]", "q[2]", "q[3]"], order = "wxyz" }
        convention = "frd-ned"
        [velocity]
        topics = ["/t"]
        vector = "v"
        frame = "ned"
    "#;
    let messages = [
        r#"{"q":[1,0,0,0,NaN],"v":[1,2,3]}"#,
        r#"{"q":[1,0,0,0,NaN],"v":[1,NaN,3]}"#,
        r#"{"q":[1,0,0,0,NaN],"v":[1,2,3,Infinity]}"#,
    ];
    let (found, dropped) = log_of(&messages.map(str::to_owned))
        .velocities(profile)
        .expect("velocities");
    assert_eq!(found, [[1.0, 2.0, 3.0]]);
    assert_eq!(dropped, [("missing_field", 1), ("non_finite", 1)]);
}

/// What the fields are is known from the messages here.
#[test]
fn fields_are_found_in_messages_with_such_numbers() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    for time in 0..20 {
        let state = format!(
            r#"{{"battery": {{"temperature": NaN}}, "roll": 0.0, "pitch": 0, "yaw": 0.{time:02}, "vx": 1, "vy": 0, "vz": 0}}"#
        );
        log.put(channel, time, state.as_bytes());
    }
    let (derived, report) = log.enrich(None).expect("a result");
    assert_eq!(report.profile.name, "flat");
    assert_eq!(derived.len(), 19 + 20 + 20);
    assert!(report.complete);
}

#[test]
fn a_schema_may_have_such_numbers_too() {
    let mut log = Logbook::new();
    let fields = ["roll", "pitch", "yaw", "vx", "vy", "vz"]
        .map(|name| format!(r#""{name}": {{"type": "number", "default": NaN}}"#));
    let schema = format!(
        r#"{{"type": "object", "properties": {{{}}}}}"#,
        fields.join(", ")
    );
    let schema = (log.writer)
        .add_schema("State", "jsonschema", schema.as_bytes())
        .expect("a schema");
    let channel = log.channel(schema, "/state", "json");
    log.put_flat(channel, 0, "0", "1");
    let (_folder, path) = log.finish();
    let log = flightcam::log::Log::open(&path).expect("a log");
    let source = Source::select(&log, &Request::default()).expect("a source");
    assert_eq!(source.profile.name, "flat");
}

#[test]
fn reading_such_messages_allocates_only_a_buffer() {
    let messages: Vec<String> = (0..50).map(|_| message("1", "[NaN, NaN]")).collect();
    let mut telemetry = InMemory::read(log_of(&messages), PROFILE);
    let (source, messages) = telemetry.parts();
    let mut samples = 0;
    let mut read = |messages: &[_]| {
        for message in messages {
            source.read(message, |_, sample| samples += u32::from(sample.is_ok()));
        }
    };
    read(&messages[..1]);
    let allocations = allocation_counter::measure(|| read(&messages[1..]));
    assert_eq!(allocations.count_total, 0);
    assert_eq!(samples, 100);
}

/// What nobody wants: any value that JSON has, and numbers that are not finite.
#[derive(Debug, Clone)]
enum Unwanted {
    Word(&'static str),
    Number(f64),
    Text(String),
    List(Vec<Self>),
    Object(Vec<(String, Self)>),
}

fn unwanted() -> impl Strategy<Value = Unwanted> {
    let text = || r#"[a\\" NI,:\[{}]{0,4}(NaN|-Infinity|inf)?["\\]{0,3}"#;
    let words = ["NaN", "Infinity", "-Infinity", "nan", "null", "true"];
    let leaf = prop_oneof![
        prop::sample::select(words.to_vec()).prop_map(Unwanted::Word),
        any::<f64>().prop_filter_map("finite", |number| {
            number.is_finite().then_some(Unwanted::Number(number))
        }),
        text().prop_map(Unwanted::Text),
    ];
    leaf.prop_recursive(4, 24, 4, move |inner| {
        prop_oneof![
            vec(inner.clone(), 0..4).prop_map(Unwanted::List),
            vec((text(), inner), 0..4).prop_map(Unwanted::Object),
        ]
    })
}

impl Unwanted {
    fn write(&self, json: &mut String) {
        let quoted = |text: &str| serde_json::to_string(text).expect("JSON");
        let separated =
            |json: &mut String, place| json.push_str(if place == 0 { "" } else { ", " });
        match self {
            Self::Word(word) => json.push_str(word),
            Self::Number(number) => write!(json, "{number:e}").expect("written"),
            Self::Text(text) => json.push_str(&quoted(text)),
            Self::List(list) => {
                json.push('[');
                for (place, element) in list.iter().enumerate() {
                    separated(json, place);
                    element.write(json);
                }
                json.push(']');
            }
            Self::Object(fields) => {
                json.push('{');
                for (place, (name, value)) in fields.iter().enumerate() {
                    separated(json, place);
                    // So that it is not the name of a wanted field.
                    json.push_str(&quoted(&format!("_{name}")));
                    json.push_str(": ");
                    value.write(json);
                }
                json.push('}');
            }
        }
    }
}

proptest! {
    #![proptest_config(crate::support::cases(128))]

    #[test]
    fn whatever_else_there_is_in_a_message_its_wanted_fields_are_read(
        others in vec((unwanted(), any::<i32>()), 1..6)
    ) {
        let mut messages = Vec::new();
        for (other, x) in &others {
            let mut json = String::new();
            other.write(&mut json);
            messages.push(message(&x.to_string(), &json));
        }
        let expected: Vec<_> = others.iter().map(|(_, x)| [f64::from(*x), 2.0, -3.0]).collect();
        prop_assert_eq!(velocities(&messages), Ok((expected, Vec::new())));
    }
}
