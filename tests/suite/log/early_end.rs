//! A DataEnd record or a footer before the end of the data, or a record where it does not belong, is damage: it would hide
//! messages.

use std::path::Path;

use flightcam::{
    Error, Input, Output, enrich,
    error::RunError,
    log::{Damage, Log, ReadError, RecordKind, record::push_record},
    source::request::Request,
};
use mcap::records::op;
use proptest::prelude::*;

use crate::support::{folder::*, forging::*, piping::*, shapes::any_shape, *};

/// The offsets of the records outside chunks, with their opcodes. Stops where one breaks off.
fn places(log: &[u8]) -> Vec<(usize, u8)> {
    let magic = mcap::MAGIC.len();
    let records = flightcam::log::record::Records::new(log.get(magic..).unwrap_or_default());
    let whole = records.map_while(Result::ok);
    whole
        .map(|record| (magic + record.offset, record.opcode))
        .collect()
}

/// How a log is damaged, whether it is in a file or comes through a pipe, which passes all of it on.
#[track_caller]
fn damage(log: &[u8]) -> (u64, Damage) {
    let folder = Folder::with(LOG, log);
    let path = folder.path(LOG);
    let (output, streamed) = pipe(&path, log, |_| true);
    assert!(output == log, "all of it is passed on");
    let opened = Log::open(&path).expect_err("it is damaged");
    assert_eq!(
        streamed.expect_err("it is damaged").to_string(),
        opened.to_string()
    );
    match opened {
        ReadError::Damaged { offset, damage, .. } => (offset, damage),
        other => panic!("{other}"),
    }
}

#[track_caller]
fn ends_early(log: &[u8], place: usize, expected: RecordKind) {
    let (offset, damage) = damage(log);
    assert_eq!(offset, place as u64);
    assert!(
        matches!(damage, Damage::EarlyEnd(kind) if kind == expected),
        "{damage}"
    );
}

const KINDS: [(u8, RecordKind); 2] = [
    (op::DATA_END, RecordKind::DataEnd),
    (op::FOOTER, RecordKind::Footer),
];

/// The log with the messages of [`Shape`] outside chunks.
fn without_chunks() -> Vec<u8> {
    Shape {
        messages: 20,
        ..Shape::with(|options| options.use_chunks(false))
    }
    .write()
}

#[test]
fn a_message_that_became_the_end_of_the_data_is_reported() {
    for log in [without_chunks(), mixed_log()] {
        for (place, opcode) in places(&log) {
            for (end, kind) in KINDS {
                if opcode == op::MESSAGE {
                    let mut damaged = log.clone();
                    damaged[place] = end;
                    ends_early(&damaged, place, kind);
                }
            }
        }
    }
}

#[test]
fn the_next_program_in_a_pipe_gets_such_a_log_as_it_is_and_the_error_says_so() {
    let mut log = without_chunks();
    let (place, _) = places(&log)
        .into_iter()
        .rfind(|(_, opcode)| *opcode == op::MESSAGE)
        .expect("a message");
    log[place] = op::DATA_END;
    let mut output = Vec::new();
    let input = Input::stream("input", log.as_slice());
    let result = enrich(input, Output::stream("output", &mut output), &options());
    let error = result.expect_err("it is damaged");
    assert!(
        matches!(error, Error::Run(RunError::PassedOn { .. })),
        "{error}"
    );
    assert!(output == log);
}

#[test]
fn an_early_end_after_the_last_chunk_is_reported_where_the_summary_accounts_for_everything() {
    let mut parts = Parts::of(&Shape::default().write());
    assert!(
        Log::open(&folder_with(&parts).path(LOG))
            .expect("readable")
            .scanned
            .is_none()
    );
    for (opcode, kind) in KINDS {
        parts.data.push((opcode, vec![0; 20]));
        let log = parts.join();
        let (place, _) = places(&log)[parts.data.len() - 1];
        ends_early(&log, place, kind);
        parts.data.pop();
    }
}

fn folder_with(parts: &Parts) -> Folder {
    Folder::with(LOG, parts.join())
}

/// With a footer that says that the summary starts right after the early DataEnd.
#[test]
fn data_that_is_said_to_be_the_summary_is_reported() {
    for summary in [true, false] {
        let mut parts = Parts::of(&without_chunks());
        let middle = parts.data.len() / 2;
        parts.data.insert(middle, (op::DATA_END, vec![0; 4]));
        if !summary {
            parts.summary.clear();
        }
        let mut log = parts.join();
        let (place, _) = places(&log)[middle];
        let footer = log.len() - mcap::MAGIC.len() - 20;
        let start = place as u64 + 9 + 4;
        log[footer..footer + 8].copy_from_slice(&start.to_le_bytes());
        ends_early(&log, place, RecordKind::DataEnd);
        // Whatever the checksum of that summary.
        log[footer + 16] = 1;
        ends_early(&log, place, RecordKind::DataEnd);
    }
}

/// Most readers take zeros for records that they skip.
#[test]
fn data_after_zeros_after_the_end_is_reported() {
    for chunks in [true, false] {
        let whole = Shape::with(|options| options.use_chunks(chunks)).write();
        let mut parts = Parts::of(&whole);
        let start = match chunks {
            true => op::CHUNK,
            false => op::MESSAGE,
        };
        let first = (parts.data.iter()).position(|(opcode, _)| *opcode == start);
        let data = parts.data.split_off(first.expect("data"));
        parts.data.push((op::DATA_END, vec![0; 4]));
        let mut unclosed = parts.join();
        let place = places(&unclosed)[parts.data.len() - 1].0;
        unclosed.truncate(place + 9 + 4);
        for zeros in [9, 18, 90_000, 9_000_000] {
            let mut log = unclosed.clone();
            log.resize(log.len() + zeros, 0);
            for (opcode, body) in &data {
                push_record(&mut log, *opcode, body);
            }
            ends_early(&log, place, RecordKind::DataEnd);
            // The same in a log that was closed, and whose footer calls that its summary.
            let mut footer = [0; 20];
            footer[..8].copy_from_slice(&(place as u64 + 9 + 4).to_le_bytes());
            push_record(&mut log, op::FOOTER, &footer);
            log.extend_from_slice(mcap::MAGIC);
            ends_early(&log, place, RecordKind::DataEnd);
        }
        // After a record of opcode 0 that is not empty.
        let mut log = unclosed.clone();
        push_record(&mut log, 0, b"nothing");
        push_record(&mut log, data[0].0, &data[0].1);
        ends_early(&log, place, RecordKind::DataEnd);
    }
}

#[test]
fn nothing_but_zeros_after_the_end_hides_nothing() {
    let whole = Shape::default().write();
    let data_end = places(&whole)
        .into_iter()
        .find(|(_, opcode)| *opcode == op::DATA_END);
    let (data_end, _) = data_end.expect("the end");
    for zeros in [1, 8, 9, 10, 70_000, 3_000_000] {
        for end in [
            data_end + 9 + 4,
            whole.len() - mcap::MAGIC.len(),
            whole.len(),
        ] {
            let mut log = whole[..end].to_vec();
            log.resize(end + zeros, 0);
            let streamed = check(&log, &Request::default(), 100_000).expect("a readable log");
            assert_eq!(streamed.original.breaks_off_at, None);
        }
    }
}

#[test]
fn a_footer_in_a_summary_is_reported() {
    let mut parts = Parts::of(&Shape::default().write());
    parts.summary.insert(1, (op::FOOTER, vec![0; 20]));
    let log = parts.join();
    let (place, _) = places(&log)[parts.data.len() + 2];
    ends_early(&log, place, RecordKind::Footer);
}

#[test]
fn after_the_end_of_a_log_that_was_not_closed_only_a_summary_may_follow() {
    let whole = Shape::default().write();
    let unclosed = &whole[..whole.len() - mcap::MAGIC.len()];
    check(unclosed, &Request::default(), 1000).expect("a readable log");
    let data_end = places(&whole)
        .into_iter()
        .find(|(_, opcode)| *opcode == op::DATA_END);
    let (data_end, _) = data_end.expect("the end");
    for record in one_of_each() {
        let mut log = unclosed.to_vec();
        push_record(&mut log, record.opcode, &record.body);
        let follows = matches!(
            record.opcode,
            op::SCHEMA
                | op::CHANNEL
                | op::STATISTICS
                | op::CHUNK_INDEX
                | op::ATTACHMENT_INDEX
                | op::METADATA_INDEX
                | op::SUMMARY_OFFSET
                | op::FOOTER
        );
        match follows {
            true => drop(check(&log, &Request::default(), 1000).expect("a readable log")),
            false => ends_early(&log, data_end, RecordKind::DataEnd),
        }
    }
    let mut private = unclosed.to_vec();
    push_record(&mut private, 0x80, b"private");
    check(&private, &Request::default(), 1000).expect("a readable log");
}

#[test]
fn a_record_that_no_chunk_holds_is_reported_in_one() {
    for record in one_of_each() {
        let log = Place::Chunk.put(record.opcode, &record.body);
        let folder = Folder::with(LOG, &log);
        let opened = Log::open(&folder.path(LOG));
        let (_, streamed) = pipe(Path::new(LOG), &log[..], |_| true);
        match record.opcode {
            op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                opened.expect("a readable log");
                streamed.expect("a readable log");
            }
            _ => {
                let expected = "damaged at byte … there is a … in the chunk there, at byte … of its content, and no chunk holds";
                assert_reads(&opened.expect_err("it is damaged").to_string(), expected);
                assert_reads(&streamed.expect_err("it is damaged").to_string(), expected);
            }
        }
    }
}

#[test]
fn a_log_that_ends_early_is_refused_by_every_command() {
    let Some(log) = hostile_log("opcode-15.mcap") else {
        return;
    };
    let folder = Folder::with(LOG, &log);
    let message = "flight.mcap: damaged at byte 14365: the DataEnd record there ends the log's data, but the log goes on";
    let options = "--depression 30 --attitude /telemetry";
    for command in [
        format!("inspect {LOG} {options}"),
        format!("enrich {LOG} {options}"),
        format!("enrich {LOG} {options} --in-place"),
        format!("restore {LOG}"),
    ] {
        folder.refuses(&command, 1, message);
    }
    // In a pipe, the next program gets all of it.
    let (output, streamed) = pipe(Path::new(LOG), &log[..], |_| true);
    assert_reads(&streamed.expect_err("it is damaged").to_string(), message);
    assert!(output == log);
}

proptest! {
    #![proptest_config(crate::support::cases(192))]

    /// A message outside chunks whose opcode is another, in a log that may break off later.
    #[test]
    fn no_message_is_hidden_by_one_that_became_the_end(
        shape in any_shape(),
        which in any::<prop::sample::Index>(),
        as_footer in any::<bool>(),
        cut in prop::option::of(0.0..1.0),
    ) {
        let options = shape.options.use_chunks(false);
        let mut log = Shape { options, messages: 30, ..shape }.write();
        let messages: Vec<usize> = places(&log)
            .into_iter()
            .filter(|(_, opcode)| *opcode == op::MESSAGE)
            .map(|(place, _)| place)
            .collect();
        let place = messages[which.index(messages.len())];
        log[place] = if as_footer { op::FOOTER } else { op::DATA_END };
        if let Some(cut) = cut {
            log.truncate((cut * log.len() as f64) as usize);
        }
        let rest = places(&log).into_iter().filter(|(_, opcode)| *opcode == op::MESSAGE).count();
        let folder = Folder::with(LOG, &log);
        let opened = Log::open(&folder.path(LOG));
        let (output, streamed) = pipe(&folder.path(LOG), &log[..], |_| true);
        match (opened, streamed) {
            (Ok(opened), Ok(streamed)) => {
                for found in [opened, streamed.original] {
                    prop_assert_eq!(found.contents.statistics.message_count, rest as u64);
                }
            }
            (Err(opened), Err(streamed)) => {
                prop_assert_eq!(opened.to_string(), streamed.to_string());
                if matches!(opened, ReadError::Damaged { damage: Damage::EarlyEnd(_), .. }) {
                    prop_assert!(output == log);
                    let at = matches!(opened, ReadError::Damaged { offset, .. } if offset == place as u64);
                    prop_assert!(at, "{}", opened);
                }
            }
            (opened, streamed) => panic!("{opened:?} {streamed:?}"),
        }
    }
}
