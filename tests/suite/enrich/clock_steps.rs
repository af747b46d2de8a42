//! Logs whose time goes back: each part gives what it gives by itself, and what is merely out of order is sorted.

use std::{io::Cursor, ops::ControlFlow};

use flightcam::{
    ClockStep, Input, Note, Options, Output, Report, derive, enrich, inspect,
    profile::SampleTime,
    sample::{DropReason, Kind},
    source::request::Request,
};
use mcap::{Compression, MessageStream, WriteOptions};
use proptest::prelude::*;

use crate::support::{
    flights::recording_for,
    folder::{Folder, LOG},
    layout::interleave,
    message::DerivedMessage,
    *,
};

type Message = mcap::Message<'static>;

/// What is derived: topic, log time, numbers.
type Row = (String, u64, Vec<f64>);

/// A flight of four seconds as one recorder writes it: the messages of all topics in the order of their times.
fn recorded(profile: &str) -> Vec<Message> {
    let log = recording_for(profile).log();
    let messages = MessageStream::new(&log).expect("a log");
    let messages = messages.map(|message| {
        let message = message.expect("a message");
        mcap::Message {
            data: message.data.into_owned().into(),
            ..message
        }
    });
    let mut messages: Vec<Message> = messages.collect();
    messages.sort_by_key(|message| message.log_time);
    messages
}

/// Sets the clock back at some moments, given in milliseconds since the start, by so many milliseconds. Returns the
/// parts between them.
fn set_back(messages: Vec<Message>, settings: &[(u64, u64)]) -> Vec<Vec<Message>> {
    let start = messages[0].log_time;
    let mut parts = vec![Vec::new(); settings.len() + 1];
    for mut message in messages {
        let at = message.log_time;
        let past = settings
            .iter()
            .filter(|(when, _)| at >= start + when * 1_000_000);
        let past: Vec<&(u64, u64)> = past.collect();
        let back: u64 = past.iter().map(|(_, back)| back * 1_000_000).sum();
        message.log_time -= back;
        message.publish_time = message.log_time;
        parts[past.len()].push(message);
    }
    parts
}

/// Writes a log; each part begins a chunk if `flush` says so.
fn write(options: &WriteOptions, parts: &[Vec<Message>], flush: bool) -> Vec<u8> {
    let options = options.clone().compression_threads(0);
    let mut writer = options.create(Cursor::new(Vec::new())).expect("a writer");
    for part in parts {
        for message in part {
            writer.write(message).expect("a message");
        }
        if flush {
            writer.flush().expect("the chunk ends");
        }
    }
    writer.finish().expect("the log is finished");
    writer.into_inner().into_inner()
}

fn chunked() -> WriteOptions {
    WriteOptions::new().chunk_size(Some(4096))
}

fn rows(messages: Vec<ReadMessage>) -> Vec<Row> {
    let row = |message: ReadMessage| {
        let numbers = DerivedMessage::decode(&message).numbers;
        (message.topic, message.log_time, numbers)
    };
    messages.into_iter().map(row).collect()
}

/// What is derived from a log, in the order of the file.
fn derived(log: &[u8], options: &Options) -> (Vec<Row>, Report) {
    let (result, report) = enrich_bytes_with(log, options).expect("a result");
    let mut messages = stream(&result, false);
    messages.retain(|message| DERIVED.contains(&message.topic.as_str()));
    (rows(messages), report)
}

/// What is derived from each part by itself.
fn by_itself(parts: &[Vec<Message>], options: &Options) -> Vec<Row> {
    let part = |part: &Vec<Message>| {
        let (rows, report) = derived(
            &write(&chunked(), std::slice::from_ref(part), false),
            options,
        );
        assert_eq!(steps(&report.notes), []);
        rows
    };
    parts.iter().flat_map(part).collect()
}

fn steps(notes: &[Note]) -> Vec<ClockStep> {
    let steps = notes.iter().filter_map(|note| match note {
        Note::ClockSteps { steps } => Some(steps.clone()),
        _ => None,
    });
    steps.flatten().collect()
}

#[track_caller]
fn assert_apart(log: &[u8], parts: &[Vec<Message>], options: &Options) -> Report {
    let (result, report) = enrich_bytes_with(log, options).expect("a result");
    assert_eq!(rows(judge(log, &result, false)), by_itself(parts, options));
    assert_eq!(report.breaks.clock_steps as usize, parts.len() - 1);
    report
}

// ---- Steps ----

#[test]
fn a_clock_that_is_set_back_divides_a_ros_2_log() {
    let parts = set_back(recorded("px4-ros2"), &[(2000, 1200)]);
    let log = write(
        &chunked().compression(Some(Compression::Zstd)),
        &parts,
        false,
    );
    // The gimbal's angles, too, are of one part or the other.
    for options in [options(), Options::new()] {
        let report = assert_apart(&log, &parts, &options);
        let steps = steps(&report.notes);
        let step = &steps[0];
        assert!((step.seconds() - 1.2).abs() < 0.05, "{step:?}");
        let of_topic = |message: &&Message| message.channel.topic == step.topic.as_str();
        let first = parts[1].iter().find(of_topic).expect("a message");
        let before = parts[0].iter().filter(of_topic);
        assert_eq!(
            (step.after, step.message),
            (first.log_time, before.count() as u64 + 1)
        );
    }
}

#[test]
fn a_recorder_that_restarts_hours_earlier_divides_a_log_without_chunks() {
    let parts = set_back(recorded("flat"), &[(2000, 7_200_000)]);
    let log = write(&WriteOptions::new().use_chunks(false), &parts, false);
    let report = assert_apart(&log, &parts, &options());
    assert_eq!(steps(&report.notes).len(), 1);
}

#[test]
fn a_clock_may_be_set_back_twice_in_a_ros_1_log() {
    let parts = set_back(recorded("dji-osdk"), &[(1300, 600), (2600, 900)]);
    let log = write(
        &chunked().compression(Some(Compression::Lz4)),
        &parts,
        false,
    );
    assert_apart(&log, &parts, &options());
}

#[test]
fn a_clock_may_be_set_back_between_two_chunks() {
    let parts = set_back(recorded("px4-ulog"), &[(2000, 1500)]);
    assert_apart(&write(&chunked(), &parts, true), &parts, &options());
    assert_apart(&write(&chunked(), &parts, false), &parts, &options());
}

#[test]
fn a_clock_that_is_set_back_is_noticed_without_indexes() {
    let parts = set_back(recorded("mavros"), &[(2000, 1200)]);
    for shape in [
        chunked().emit_message_indexes(false),
        chunked().emit_summary_records(false),
        chunked().emit_chunk_indexes(false),
    ] {
        assert_apart(&write(&shape, &parts, false), &parts, &options());
    }
}

#[test]
fn topics_that_were_written_one_after_the_other_step_back_together() {
    let parts = set_back(recorded("px4-ros2"), &[(2000, 1200)]);
    let mut log: Vec<Message> = parts.concat();
    log.sort_by(|a, b| a.channel.topic.cmp(&b.channel.topic));
    let log = write(&chunked(), &[log], false);
    assert_apart(&log, &parts, &options());
}

/// Of which a step would not be noticed by itself.
#[test]
fn rare_messages_belong_to_the_epoch_of_those_that_were_recorded_with_them() {
    let thinned = recorded("px4-ros2").into_iter().enumerate();
    let is_kept = |n: usize, message: &Message| {
        !message.channel.topic.contains("local_position") || n.is_multiple_of(5)
    };
    let messages = thinned.filter(|(n, message)| is_kept(*n, message));
    let parts = set_back(
        messages.map(|(_, message)| message).collect(),
        &[(2000, 700)],
    );
    let report = assert_apart(&write(&chunked(), &parts, false), &parts, &options());
    let topics: Vec<_> = steps(&report.notes)
        .into_iter()
        .map(|step| step.topic)
        .collect();
    assert_eq!(topics, ["/fmu/out/vehicle_attitude"]);
}

#[test]
fn where_only_one_topic_steps_back_nothing_is_computed_from_both() {
    let messages = recorded("px4-ros2");
    let whole = by_itself(std::slice::from_ref(&messages), &options());
    let parts = set_back(messages, &[(2000, 1200)]);
    let mut log = parts.concat();
    for message in &mut log[parts[0].len()..] {
        if message.channel.topic.contains("local_position") {
            message.log_time += 1_200_000_000;
        }
    }
    let (rows, report) = derived(&write(&chunked(), &[log], false), &options());
    assert_eq!(report.breaks.clock_steps, 1);
    let velocities = |rows: &[Row]| -> Vec<Row> {
        let velocities = rows.iter().filter(|row| row.0 == "/camera/velocity");
        velocities.cloned().collect()
    };
    let (found, whole) = (velocities(&rows), velocities(&whole));
    // Those of the first part.
    assert_eq!(found.len(), 20);
    assert_eq!(found, whole[..found.len()]);
    let dropped = &report.samples[&Kind::Velocity].tally.dropped;
    assert_eq!(
        dropped[&DropReason::OutsideAttitude] as usize,
        38 - found.len()
    );
}

#[test]
fn the_time_of_samples_counts_not_when_they_were_logged() {
    let parts = set_back(recorded("px4-ros2"), &[(2000, 1200)]);
    let mut log = parts.concat();
    // The clock that stamps what is published was not set, and neither was the one that stamps what is logged.
    let whole = recorded("px4-ros2");
    let published = options().telemetry(Request {
        time: Some(SampleTime::PublishTime),
        ..Request::default()
    });
    for (message, original) in log.iter_mut().zip(&whole) {
        message.publish_time = original.log_time;
    }
    let (rows, report) = derived(&write(&chunked(), &[log.clone()], false), &published);
    assert_eq!(rows, by_itself(&[whole], &options()));
    assert_eq!(steps(&report.notes), []);
    for message in &mut log {
        std::mem::swap(&mut message.publish_time, &mut message.log_time);
    }
    let (rows, report) = derived(&write(&chunked(), &[log], false), &published);
    assert_eq!(rows, by_itself(&parts, &options()));
    assert_eq!(report.breaks.clock_steps, 1);
    assert!(!steps(&report.notes).is_empty());
}

// ---- Ways to run ----

#[test]
fn every_way_to_run_divides_a_log_alike() {
    let parts = set_back(recorded("px4-ros2"), &[(1300, 600), (2600, 3_600_000)]);
    let log = write(&chunked(), &parts, false);
    let expected = by_itself(&parts, &options());
    let folder = Folder::with(LOG, &log);
    let path = folder.path(LOG);

    let inspected = inspect(path.clone(), &options()).expect("an inspection");
    let (_, report) = derived(&log, &options());
    // It also looks at what enrich does not use for this camera.
    let mut of_all = steps(&inspected.notes);
    let is_used = |topic: &str| topic.contains("attitude") && !topic.contains("gimbal");
    of_all.retain(|step| {
        let topic = step.topic.as_str();
        is_used(topic) || topic.contains("local_position")
    });
    assert_eq!(of_all, steps(&report.notes));
    assert_eq!(of_all.len(), 4, "two topics, two steps");

    let mut values = Vec::new();
    let outcome = derive(path.clone(), &options(), |derived| {
        let stamps = derived.iter().map(|derived| derived.stamp.log_time);
        values.extend(stamps);
        ControlFlow::Continue(())
    });
    let outcome = outcome.expect("values").expect("all of them");
    let times: Vec<u64> = expected.iter().map(|row| row.1).collect();
    assert_eq!(values, times);
    assert_eq!(outcome.breaks.clock_steps, 2);
    assert_eq!(steps(&outcome.notes), steps(&report.notes));

    let mut streamed = Vec::new();
    let input = Input::stream("-", &log[..]);
    let output = Output::stream("-", &mut streamed);
    let report = enrich(input, output, &options()).expect("a result");
    assert_eq!(report.breaks.clock_steps, 2);
    assert_eq!(rows(judge(&log, &streamed, false)), expected);

    enrich(path.clone(), Output::InPlace, &options()).expect("a result");
    let in_place = std::fs::read(&path).expect("the result");
    assert_eq!(rows(judge(&log, &in_place, false)), expected);
}

#[test]
fn in_the_interleaved_layout_each_part_stays_together() {
    for back in [1200, 7_200_000] {
        let parts = set_back(recorded("px4-ros2"), &[(2000, back)]);
        let log = write(&chunked(), &parts, false);
        let (result, report) = interleave(&log);
        assert_eq!(report.breaks.clock_steps, 1);
        let messages = stream(&result, false);
        let is_derived = |message: &&ReadMessage| DERIVED.contains(&message.topic.as_str());
        let found: Vec<ReadMessage> = messages.iter().filter(is_derived).cloned().collect();
        assert_eq!(rows(found), by_itself(&parts, &options()));
        // Each is soon after its sample: at most a few chunks later.
        for (place, message) in messages.iter().enumerate().filter(|(_, m)| is_derived(m)) {
            let is_sample = |earlier: &ReadMessage| {
                earlier.log_time == message.log_time && !is_derived(&earlier)
            };
            let soon = &messages[place.saturating_sub(400)..place];
            assert!(soon.iter().any(is_sample), "{back}: {message:?} at {place}");
        }
    }
}

// ---- Disorder ----

#[test]
fn what_is_merely_out_of_order_is_sorted() {
    let sorted = recorded("px4-ros2");
    let expected = by_itself(std::slice::from_ref(&sorted), &options());
    let late = |n: usize| if n.is_multiple_of(7) { 200_000_000 } else { 0 };
    let mut numbered: Vec<(usize, Message)> = sorted.iter().cloned().enumerate().collect();
    numbered.sort_by_key(|(n, message)| message.log_time + late(*n));
    let delayed: Vec<Message> = numbered.into_iter().map(|(_, message)| message).collect();
    let mut by_topic = sorted.clone();
    by_topic.sort_by(|a, b| a.channel.topic.cmp(&b.channel.topic));
    let reversed: Vec<Message> = sorted.iter().rev().cloned().collect();
    let halves = [&sorted[200..], &sorted[..200]].concat();
    for (name, messages) in [
        ("late", delayed),
        ("topic after topic", by_topic),
        ("reversed", reversed),
        ("halves", halves),
    ] {
        for shape in [chunked(), WriteOptions::new().use_chunks(false)] {
            let log = write(&shape, std::slice::from_ref(&messages), false);
            let (rows, report) = derived(&log, &options());
            assert!(rows == expected, "{name}");
            assert_eq!(
                (report.breaks.clock_steps, steps(&report.notes)),
                (0, vec![]),
                "{name}"
            );
        }
    }
}

proptest! {
    #![proptest_config(crate::support::cases(16))]

    #[test]
    fn a_shuffled_log_is_sorted(order in Just((0..400).collect::<Vec<usize>>()).prop_shuffle()) {
        let sorted = recorded("flat");
        let shuffled: Vec<Message> = (order.iter())
            .filter_map(|&n| sorted.get(n).cloned())
            .collect();
        let (rows, report) = derived(&write(&chunked(), &[shuffled], false), &options());
        prop_assert_eq!(rows, by_itself(&[sorted], &options()));
        prop_assert_eq!(report.breaks.clock_steps, 0);
    }
}
