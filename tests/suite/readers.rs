//! The ecosystem's own readers as judges of results: the official Python library with its decoders, rosbags,
//! and the TypeScript library that Foxglove uses. `tests/readers/install` installs them; without them these
//! tests are skipped with a message, or fail if `FLIGHTCAM_REQUIRE_READERS` is set.

// What viewers are shown.
mod shown;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use flightcam::{
    Options, Output,
    enrich::enrich,
    messages::{Encoding, EncodingChoice},
    writer::Layout,
};
use mcap::{Compression, records::op};
use serde_json::Value;

use crate::support::{layout::interleaved, message::DerivedMessage, *};

/// The two readers as command lines.
fn readers() -> Option<[Vec<PathBuf>; 2]> {
    let folder = repository("tests/readers");
    let python = folder.join(".venv/bin/python");
    if python.exists() && folder.join("node_modules").is_dir() {
        return Some([
            vec![python, folder.join("read.py")],
            vec!["node".into(), folder.join("read.mjs")],
        ]);
    }
    let required = std::env::var_os("FLIGHTCAM_REQUIRE_READERS").is_some();
    assert!(
        !required,
        "the readers are not installed: run tests/readers/install"
    );
    eprintln!("skipped: the readers are not installed; tests/readers/install does that");
    None
}

/// The lines that a reader prints for a file.
fn run(reader: &[PathBuf], log: &Path, mode: &[&str]) -> Vec<String> {
    let output = Command::new(&reader[0])
        .arg(&reader[1])
        .arg(log)
        .args(mode)
        .output()
        .expect("the reader runs");
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "{reader:?} {mode:?} refuses {}: {complaint}",
        log.display()
    );
    let text = String::from_utf8(output.stdout).expect("the reader writes UTF-8");
    text.lines().map(str::to_owned).collect()
}

/// What a reader finds in a file: a line for each message, and its summary.
fn read(reader: &[PathBuf], log: &Path, mode: &[&str]) -> (Vec<String>, Value) {
    let mut lines = run(reader, log, mode);
    let last = lines.pop().expect("a line");
    let summary = last
        .strip_prefix("summary ")
        .expect("the last line is the summary");
    (
        lines,
        serde_json::from_str(summary).expect("the summary is JSON"),
    )
}

/// Enriches a log in every layout and has every reader judge the results.
fn have_judged(readers: &[Vec<PathBuf>; 2], input: &Path) {
    for options in [options(), interleaved()] {
        have_result_judged(readers, input, &options);
    }
}

/// Has every reader judge a result, through its index and as a stream from the start.
fn have_result_judged(readers: &[Vec<PathBuf>; 2], input: &Path, options: &Options) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("result.mcap");
    let report = enrich(input, &output, options).expect("the log is enriched");
    let mut expected: BTreeMap<String, u64> = BTreeMap::new();
    for topic in &report.written {
        expected.insert(topic.topic.to_owned(), topic.messages);
    }

    for reader in readers {
        let torn: &[&str] = match report.complete {
            true => &["stream"],
            false => &["stream", "--torn"],
        };
        let (original, _) = read(reader, input, torn);
        let (mut streamed, summary) = read(reader, &output, &["stream"]);
        assert_eq!(
            summary["statistics"],
            summary["recount"],
            "{}",
            input.display()
        );

        let topic = |line: &String| line.split(' ').next().expect("a topic").to_owned();
        let (derived, kept): (Vec<String>, Vec<String>) = streamed
            .iter()
            .cloned()
            .partition(|line| DERIVED.contains(&topic(line).as_str()));
        assert!(kept == original, "every original message, in its order");
        let mut counts: BTreeMap<String, u64> = BTreeMap::new();
        for line in &derived {
            *counts.entry(topic(line)).or_default() += 1;
        }
        assert_eq!(counts, expected);

        // This mode fails by itself unless messages come in time order.
        let (mut indexed, summary) = read(reader, &output, &["index"]);
        let log = fs::read(&output).expect("the result");
        let loose = Parts::of(&log)
            .data
            .iter()
            .any(|(opcode, _)| *opcode == op::MESSAGE);
        assert_eq!(
            summary["fallback"],
            loose,
            "{} is read by its index",
            input.display()
        );
        assert!(!loose || report.layout == Layout::Append);
        assert_eq!(
            summary["statistics"],
            summary["recount"],
            "{}",
            input.display()
        );
        let names = &summary["attachments"];
        assert_eq!(
            names.to_string().contains("flightcam/original_tail"),
            report.layout == Layout::Append,
            "{names}"
        );
        assert!(summary["metadata"].to_string().contains("flightcam"));
        streamed.sort();
        indexed.sort();
        assert!(
            indexed == streamed,
            "the index leads to every message of {}",
            input.display()
        );
    }
}

#[test]
fn both_readers_find_every_message_of_the_demonstration_log() {
    let Some(readers) = readers() else { return };
    have_judged(&readers, &repository("fixtures/survey_flight.mcap"));
}

#[test]
fn both_readers_find_every_message_of_the_real_logs() {
    let (Some(readers), Some(folder)) = (readers(), real_logs()) else {
        return;
    };
    for log in [
        "test_ulog.mcap",
        "test_ulog.ros2.mcap",
        "sample_px4_events.mcap",
        "sample_log_small.mcap",
    ] {
        have_judged(&readers, &folder.join(log));
    }
}

#[test]
fn both_readers_find_every_message_whatever_the_shape_of_the_log() {
    let Some(readers) = readers() else { return };
    let whole = Shape::default().write();
    let mut everything = Shape::with(|options| options.compression(Some(Compression::Lz4)));
    everything.attachment_and_metadata = true;
    everything.topic_after_topic = true;
    let logs: [(&str, Vec<u8>); 8] = [
        (
            "lz4, overlapping chunks, attachment, metadata",
            everything.write(),
        ),
        (
            "no compression",
            Shape::with(|options| options.compression(None)).write(),
        ),
        (
            "no chunks",
            Shape::with(|options| options.use_chunks(false)).write(),
        ),
        (
            "no message indexes",
            Shape::with(|options| options.emit_message_indexes(false)).write(),
        ),
        (
            "no summary",
            Shape::with(|options| options.emit_summary_records(false)).write(),
        ),
        (
            "no chunk indexes",
            Shape::with(|options| options.emit_chunk_indexes(false)).write(),
        ),
        ("messages outside chunks too", mixed_log()),
        ("breaks off", whole[..whole.len() / 3].to_vec()),
    ];
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (shape, log) in logs {
        eprintln!("{shape}");
        let input = folder.path().join("log.mcap");
        fs::write(&input, log).expect("the log is written");
        have_judged(&readers, &input);
    }
}

/// What the Python decoders find in a derived message, read with `decode.py`.
#[derive(Debug, PartialEq)]
struct Decoded {
    topic: String,
    log_time: u64,
    stamp: u64,
    frame_id: String,
    /// To the last bit.
    numbers: Vec<u64>,
}

fn decode(python: &Path, log: &Path, library: &str) -> Vec<Decoded> {
    let decoder = [python.to_owned(), repository("tests/readers/decode.py")];
    let lines = run(&decoder, log, &[library]);
    let decoded = lines.iter().map(|line| {
        let words: Vec<&str> = line.split(' ').collect();
        let [topic, log_time, stamp, frame_id, numbers @ ..] = &words[..] else {
            panic!("{line}")
        };
        let bits = |number: &&str| number.parse::<f64>().expect("a number").to_bits();
        Decoded {
            topic: (*topic).to_owned(),
            log_time: log_time.parse().expect("a time"),
            stamp: stamp.parse().expect("a time"),
            frame_id: (*frame_id).to_owned(),
            numbers: numbers.iter().map(bits).collect(),
        }
    });
    decoded.collect()
}

/// Enriches a log in an encoding and has a library decode what was derived. That must equal what the same log
/// enriched in protobuf has.
fn have_decoded(python: &Path, input: &Path, encoding: Encoding, library: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("result.mcap");
    let enriched = |encoding| {
        let options = options().encoding(EncodingChoice::Given(encoding));
        let replaced = Output::File {
            path: output.clone(),
            overwrite: true,
        };
        enrich(input, replaced, &options).expect("a result");
        fs::read(&output).expect("the result")
    };
    let protobuf = stream(&enriched(Encoding::Protobuf), false).into_iter();
    let derived = protobuf.filter(|message| DERIVED.contains(&message.topic.as_str()));
    let mut expected: Vec<Decoded> = derived
        .map(|message| DerivedMessage::decode(&message))
        .map(|mut message| {
            if encoding == Encoding::Ros2 && message.topic == "/camera/orientation" {
                // Without the angles.
                message.numbers.truncate(4);
            }
            Decoded {
                topic: message.topic,
                log_time: message.log_time,
                stamp: message.log_time,
                frame_id: message.frame_id,
                numbers: message.numbers.into_iter().map(f64::to_bits).collect(),
            }
        })
        .collect();
    for topic in DERIVED {
        assert!(expected.iter().any(|message| message.topic == topic));
    }

    enriched(encoding);
    let mut decoded = decode(python, &output, library);
    assert!(decoded.is_sorted_by_key(|message| message.log_time));
    // The order of messages at equal times is up to the reader.
    let order = |message: &Decoded| (message.log_time, message.topic.clone());
    expected.sort_by_key(order);
    decoded.sort_by_key(order);
    assert!(decoded == expected, "{encoding:?} of {}", input.display());
}

#[test]
fn the_ecosystems_decoders_find_the_same_numbers_in_every_encoding() {
    let Some([python, _]) = readers() else { return };
    for encoding in Encoding::ALL {
        let input = repository("fixtures/survey_flight.mcap");
        have_decoded(&python[0], &input, encoding, "mcap");
    }
}

#[test]
fn rosbags_reads_ros2_messages_from_a_ros2_file() {
    let Some([python, _]) = readers() else { return };
    let mut shape = Shape::with(|options| options.profile("ros2"));
    // A schema that is not ROS 2 would make it refuse the file.
    shape.schema_id = 0;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let input = folder.path().join("log.mcap");
    fs::write(&input, shape.write()).expect("the log is written");
    have_decoded(&python[0], &input, Encoding::Ros2, "rosbags");
    if let Some(real) = real_logs() {
        let input = real.join("test_ulog.ros2.mcap");
        for library in ["rosbags", "mcap"] {
            have_decoded(&python[0], &input, Encoding::Ros2, library);
        }
    }
}
