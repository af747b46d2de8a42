//! What viewers have trouble with in a log, as `flightcam inspect` says it.

use std::fs;

use mcap::WriteOptions;
use serde_json::{Value, json};

use crate::support::{folder::*, logbook::Logbook, topics::*};

/// The start of a flight in spring 2024, milliseconds.
const START: u64 = 1_710_773_350_000;
const DAY: u64 = 24 * 60 * 60 * 1000;

fn in_folder(logbook: Logbook) -> Folder {
    let (_folder, path) = logbook.finish();
    Folder::with(LOG, fs::read(path).unwrap())
}

/// Without message indexes, with messages at time 0 and a fast topic.
fn awkward_to_view() -> Folder {
    let options = WriteOptions::new().emit_message_indexes(false);
    let mut logbook = Logbook::with_options(options);
    let [state, unset, imu] =
        ["/state", "/a\u{1b}b", "/imu"].map(|topic| logbook.channel(0, topic, "json"));
    for topic in [unset, unset, imu] {
        logbook.put(topic, 0, b"{}");
    }
    for n in 0..=250 {
        logbook.put(imu, START + 10 * n, b"{}");
    }
    for n in 0..50 {
        logbook.put_flat(state, START + 50 * n, "0.5", "1");
    }
    in_folder(logbook)
}

#[test]
fn each_is_said_in_a_line() {
    let (printed, _) = awkward_to_view().run(&format!("inspect {LOG}"), 0);
    let of_viewers = printed.lines().filter(|line| line.starts_with("Viewers "));
    assert_eq!(
        of_viewers.collect::<Vec<_>>(),
        [
            "Viewers     3 messages on 2 topics, at 0.000 s in log time, are 54 years before all others, so a \
             viewer's time axis begins there and the rest is squeezed into its end: /a\\u{1b}b (2), /imu (1)",
            "Viewers     1 topic has more than the 60 messages per second that viewers draw: /imu (100 Hz)",
            "Viewers     1 of 1 chunk lacks message indexes, without which readers such as Foxglove's refuse a \
             chunk; enrich writes the missing ones",
        ]
    );
}

#[test]
fn nothing_is_said_of_a_log_that_has_none() {
    let flight = log(&[flat("/state")]);
    let (printed, _) = Folder::with(LOG, flight).run(&format!("inspect {LOG}"), 0);
    assert!(!printed.contains("Viewers"), "{printed}");
}

#[test]
fn the_json_has_the_numbers() {
    let (json, _) = awkward_to_view().run(&format!("inspect {LOG} --json"), 0);
    let report: Value = serde_json::from_str(&json).expect("one JSON document");
    let start = START * 1_000_000;
    let far = json!({
        "kind": "early_messages",
        "messages": 3,
        "topics": { "/a\u{1b}b": 2, "/imu": 1 },
        "times": [0, 0],
        "rest": [start, start + 2_500_000_000],
    });
    let fast = json!({ "kind": "fast_topics", "topics": [{ "topic": "/imu", "rate_hz": 100.0 }] });
    let unindexed = json!({ "kind": "unindexed_chunks", "unindexed": 1, "chunks": 1 });
    assert_eq!(report["viewer_warnings"], json!([far, fast, unindexed]));
}

#[test]
fn distances_are_in_days_or_years() {
    for (time, words) in [
        (
            DAY + 5,
            "1 message on 1 topic, at 86400.005 s in log time, is 1 day after all others, so a viewer's time axis \
             ends there and the rest is squeezed into its start: /state (1)",
        ),
        (20 * DAY, "is 20 days after"),
        (400 * DAY, "is 1 year after"),
    ] {
        let mut logbook = Logbook::new();
        let state = logbook.json("/state");
        for time in [0, 1, 2, 3, 4, time] {
            logbook.put_flat(state, time, "0.5", "1");
        }
        let (printed, _) = in_folder(logbook).run(&format!("inspect {LOG}"), 0);
        assert_reads(&printed, words);
    }
}
