//! What viewers are shown, as other programs decode it: each message of each topic, all of its fields.

use std::{fs, path::PathBuf};

use flightcam::messages::{Encoding, Format, Message};
use serde_json::Value;

use super::{readers, run};
use crate::support::{repository, shown_log, shown_reading};

fn format(encoding: Encoding) -> Format {
    Format {
        encoding,
        quality_of_service: String::new(),
        has_transforms: false,
    }
}

/// The topics and messages that a program shows of the log in this format.
fn shown_by(program: &[PathBuf], format: &Format, mode: &[&str]) -> Vec<Value> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("shown.mcap");
    fs::write(&path, shown_log::write(format)).expect("written");
    let lines = run(program, &path, mode);
    let parse = |line: &String| serde_json::from_str(line).expect("JSON");
    lines.iter().map(parse).collect()
}

/// The topics and messages of the log in this format that are encoded like that.
fn expected(format: &Format, message_encodings: &[&str]) -> Vec<(String, Value)> {
    let mut expected = Vec::new();
    for shown in shown_log::messages() {
        let topic = format.topic(&Message::from(&shown));
        let definition = format.definition(topic);
        if definition.is_some_and(|found| message_encodings.contains(&found.message_encoding)) {
            let message = shown_reading::read(format, &shown);
            expected.push((topic.name().to_owned(), in_doubles(message)));
        }
    }
    expected
}

/// JavaScript writes 1.0 as 1.
fn in_doubles(value: Value) -> Value {
    match value {
        Value::Number(number) => number.as_f64().expect("a number").into(),
        Value::Array(list) => list.into_iter().map(in_doubles).collect(),
        Value::Object(fields) => fields
            .into_iter()
            .map(|(name, value)| (name, in_doubles(value)))
            .collect(),
        other => other,
    }
}

fn assert_shown(found: &[Value], expected: &[(String, Value)]) {
    assert_eq!(found.len(), expected.len());
    for (found, (topic, message)) in found.iter().zip(expected) {
        assert_eq!(found["topic"], *topic);
        assert_eq!(in_doubles(found["message"].clone()), *message, "{topic}");
    }
}

/// The script for Python, or that for JavaScript, with the programs that run them.
fn scripts() -> Option<[Vec<PathBuf>; 2]> {
    let [python, node] = readers()?;
    let script = |program: &[PathBuf], name| vec![program[0].clone(), repository(name)];
    Some([
        script(&python, "tests/readers/show.py"),
        script(&node, "tests/readers/show.mjs"),
    ])
}

#[test]
fn pythons_decoders_find_all_that_viewers_are_shown() {
    let Some([python, _]) = scripts() else { return };
    for encoding in Encoding::ALL {
        let format = format(encoding);
        let found = shown_by(&python, &format, &["mcap"]);
        assert_shown(&found, &expected(&format, &["protobuf", "json", "cdr"]));
    }
}

#[test]
fn foxgloves_decoder_finds_all_that_viewers_are_shown() {
    let Some([_, node]) = scripts() else { return };
    for encoding in [Encoding::Protobuf, Encoding::Json] {
        let format = format(encoding);
        let found = shown_by(&node, &format, &[]);
        assert_shown(&found, &expected(&format, &["protobuf"]));
    }
}

#[test]
fn rosbags_finds_all_that_viewers_are_shown_and_what_is_kept_for_late_subscribers() {
    let Some([python, _]) = scripts() else { return };
    let format = format(Encoding::Ros2);
    let found = shown_by(&python, &format, &["rosbags"]);
    assert_shown(&found, &expected(&format, &["cdr"]));
    let kept = found
        .iter()
        .filter(|message| message["durability"] == "TRANSIENT_LOCAL");
    let kept: Vec<&str> = kept
        .map(|message| message["topic"].as_str().expect("a topic"))
        .collect();
    let once = [
        "/tf_static",
        "/camera/model",
        "/camera/path",
        "/camera/calibration",
        "/camera/footprint",
    ];
    assert_eq!(kept, once);
    let others = found
        .iter()
        .filter(|message| message["durability"].is_null());
    assert_eq!(others.count(), found.len() - once.len());
}
