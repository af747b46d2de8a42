//! Appending disturbs nothing: whatever the shape of the log, the result has every byte and every message.

use std::ops::ControlFlow;

use flightcam::{
    Error, enrich,
    log::{
        ReadError,
        record::{parse, push_record, serialize},
    },
    report::Note,
    run::RunError,
    writer::{IdKind, WriteError},
};
use mcap::{
    Summary,
    records::{ChunkIndex, Statistics, op},
};
use proptest::prelude::*;

use crate::support::{shapes::any_shape, *};

#[test]
fn the_demonstration_log_keeps_all_that_it_had() {
    let log = std::fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture");
    let (result, report) = enrich_bytes(&log).expect("the fixture is enriched");
    let derived = judge(&log, &result, false);
    assert_eq!(derived.len(), 3309 + 3310 + 3310);
    assert_eq!(report.bytes_added, result.len() as i64 - log.len() as i64);
    assert_ne!(
        Parts::of(&log).data_section_crc,
        0,
        "the fixture exercises resuming the checksum"
    );
    assert_ne!(Parts::of(&result).data_section_crc, 0);
}

#[test]
fn an_output_that_another_program_creates_meanwhile_is_not_overwritten() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("result.mcap");
    let fixture = repository("fixtures/survey_flight.mcap");
    let theirs = output.clone();
    let options = options().watch(move |_| {
        std::fs::write(&theirs, "theirs").expect("written");
        ControlFlow::Continue(())
    });
    let error = enrich(&fixture, &output, &options);
    assert!(
        matches!(error, Err(Error::Write(WriteError::OutputExists { .. }))),
        "{error:?}"
    );
    assert_eq!(std::fs::read(&output).expect("their file"), b"theirs");
    let files = std::fs::read_dir(folder.path())
        .expect("the folder")
        .count();
    assert_eq!(files, 1, "no temporary file is left");
}

#[test]
fn the_same_log_gives_the_same_bytes() {
    let log = Shape::default().write();
    let (first, _) = enrich_bytes(&log).expect("a result");
    let (second, _) = enrich_bytes(&log).expect("a result");
    assert!(first == second);
}

proptest! {
    #![proptest_config(crate::support::cases(96))]

    #[test]
    fn a_log_of_any_shape_gives_the_same_messages_and_loses_nothing(shape in any_shape()) {
        let log = shape.write();
        let (result, report) = enrich_bytes(&log).expect("a result");
        prop_assert_eq!(judge(&log, &result, false), expected_of_any_shape());
        prop_assert!(report.complete);
    }

    #[test]
    fn a_truncated_log_is_enriched_up_to_its_end(shape in any_shape(), at in 0.0..1.0) {
        let log = shape.write();
        let torn = &log[..(at * log.len() as f64) as usize];
        match enrich_bytes(torn) {
            Ok((result, report)) => {
                let derived = judge(torn, &result, true);
                prop_assert!(!derived.is_empty());
                let whole = whole_records(torn);
                let ended = Parts::records(whole).any(|(opcode, _)| opcode == op::DATA_END);
                prop_assert_eq!(report.complete, ended || whole.len() == torn.len());
                prop_assert!(!report.notes.is_empty());
            }
            // Too little is left of it to derive anything from.
            Err(Error::Read(
                ReadError::Empty { .. } | ReadError::NotMcap { .. } | ReadError::Damaged { .. },
            ) | Error::Telemetry(_) | Error::Run(RunError::NothingDerived { .. })) => {
                let whole = whole_records(torn);
                let telemetry = stream(whole, true).into_iter().filter(|m| m.topic == TELEMETRY);
                prop_assert_eq!(telemetry.count(), 0);
            }
            Err(other) => prop_assert!(false, "{}", other),
        }
    }
}

#[test]
fn new_messages_go_outside_chunks_where_others_are_outside_chunks() {
    let log = Shape::with(|options| options.use_chunks(false)).write();
    let (result, _) = enrich_bytes(&log).expect("a result");
    assert_eq!(judge(&log, &result, false), expected_of_any_shape());
    let summary = Summary::read(&result)
        .expect("a summary")
        .expect("a summary");
    assert!(
        summary.chunk_indexes.is_empty(),
        "a chunk index would hide the messages outside chunks"
    );
    assert!(
        !Parts::of(&result)
            .data
            .iter()
            .any(|(opcode, _)| *opcode == op::CHUNK)
    );
}

#[test]
fn a_log_with_messages_in_and_outside_chunks_hides_none_of_them() {
    let log = mixed_log();
    let (result, report) = enrich_bytes(&log).expect("a result");
    assert_eq!(judge(&log, &result, false), expected_of_any_shape());
    let summary = Summary::read(&result)
        .expect("a summary")
        .expect("a summary");
    assert!(summary.chunk_indexes.is_empty());
    assert!(
        report
            .notes
            .iter()
            .any(|note| matches!(note, Note::LooseMessages { .. }))
    );
}

#[test]
fn chunks_without_message_indexes_get_new_ones() {
    let log = Shape::with(|options| options.emit_message_indexes(false)).write();
    let (result, _) = enrich_bytes(&log).expect("a result");
    judge(&log, &result, false);
    let summary = Summary::read(&result)
        .expect("a summary")
        .expect("a summary");
    assert!(summary.chunk_indexes.len() > 3);
    for chunk in &summary.chunk_indexes {
        let indexes = summary
            .read_message_indexes(&result, chunk)
            .expect("message indexes");
        let indexed: usize = indexes.values().map(Vec::len).sum();
        let messages = summary
            .stream_chunk(&result, chunk)
            .expect("a chunk")
            .count();
        assert_eq!(indexed, messages);
        assert_ne!(messages, 0);
    }
}

#[test]
fn the_data_section_may_end_without_a_data_end_record() {
    let log = Shape::default().write();
    let parts = Parts::of(&log);
    let mut without = mcap::MAGIC.to_vec();
    for (opcode, body) in &parts.data {
        push_record(&mut without, *opcode, body);
    }
    let data_end = without.len() as u64;
    let footer = serialize(&mcap::records::Footer::default());
    push_record(&mut without, op::FOOTER, &footer);
    without.extend_from_slice(mcap::MAGIC);

    let (result, report) = enrich_bytes(&without).expect("a result");
    assert_eq!(judge(&without, &result, false), expected_of_any_shape());
    assert_eq!(report.bytes_kept, data_end);
    assert!(report.complete, "a log with a footer was closed");
}

#[test]
fn zeros_left_by_a_file_system_are_not_records() {
    let log = Shape::with(|options| options.emit_summary_records(false)).write();
    let parts = Parts::of(&log);
    let mut zeros = mcap::MAGIC.to_vec();
    for (opcode, body) in &parts.data {
        push_record(&mut zeros, *opcode, body);
    }
    let whole = zeros.len();
    zeros.resize(whole + 8192, 0);
    let (result, report) = enrich_bytes(&zeros).expect("a result");
    assert_eq!(judge(&zeros, &result, true), expected_of_any_shape());
    assert_eq!(report.bytes_kept, whole as u64);
    assert!(!report.complete);
}

#[test]
fn wrong_statistics_in_the_summary_are_corrected() {
    for spoil in [
        (|s: &mut Statistics| s.message_count += 1) as fn(&mut Statistics),
        |s| s.chunk_count = 0,
        |s| s.message_end_time += 5,
        |s| s.channel_message_counts.clear(),
        |s| {
            s.channel_message_counts.insert(77, 3);
        },
    ] {
        let mut parts = Parts::of(&Shape::default().write());
        for (opcode, body) in &mut parts.summary {
            if *opcode == op::STATISTICS {
                let mut statistics: Statistics = parse(body).expect("statistics");
                spoil(&mut statistics);
                *body = serialize(&statistics);
            }
        }
        let log = parts.join();
        let (result, _) = enrich_bytes(&log).expect("a result");
        assert_eq!(judge(&log, &result, false), expected_of_any_shape());
    }
}

#[test]
fn a_summary_that_lacks_a_chunk_is_completed() {
    let mut parts = Parts::of(&Shape::default().write());
    let forgotten = parts
        .summary
        .iter()
        .position(|(opcode, _)| *opcode == op::CHUNK_INDEX);
    parts.summary.remove(forgotten.expect("a chunk index"));
    let log = parts.join();
    let (result, _) = enrich_bytes(&log).expect("a result");
    assert_eq!(judge(&log, &result, false), expected_of_any_shape());
}

#[test]
fn a_summary_whose_checksum_is_wrong_is_not_believed() {
    let mut log = Shape::default().write();
    let topic = b"/other";
    let in_summary = log.windows(topic.len()).rposition(|window| window == topic);
    log[in_summary.expect("the topic's name in the summary") + 1] = b'X';
    let (result, report) = enrich_bytes(&log).expect("a result");
    // The log is not whole to a reader that checks its summary, but its data section is.
    assert_eq!(judge(&log, &result, true), expected_of_any_shape());
    assert_eq!(report.notes, [Note::SummaryMissing]);
}

#[test]
fn fields_that_a_later_format_appends_to_summary_records_survive() {
    let shape = Shape {
        attachment_and_metadata: true,
        ..Shape::default()
    };
    let mut parts = Parts::of(&shape.write());
    for (opcode, body) in &mut parts.summary {
        if *opcode != op::STATISTICS {
            body.extend_from_slice(b"later");
        }
    }
    parts.summary.push((0x90, b"private".to_vec()));
    let log = parts.join();
    let (result, report) = enrich_bytes(&log).expect("a result");
    assert_eq!(judge(&log, &result, false), expected_of_any_shape());
    assert_eq!(report.notes, []);
    let kept = Parts::of(&result).summary;
    for record in parts
        .summary
        .iter()
        .filter(|(opcode, _)| *opcode != op::STATISTICS)
    {
        assert!(kept.contains(record), "record with opcode {:#x}", record.0);
    }
}

#[test]
fn ids_are_the_next_above_the_largest_or_the_lowest_free() {
    for (channel_ids, schema_id, new_channels, new_schemas) in [
        ([1, 2], 1, [3, 4, 5], [2, 3, 4]),
        ([0, 1], 5, [2, 3, 4], [6, 7, 8]),
        ([65535, 0], 65535, [1, 2, 3], [1, 2, 3]),
        ([65534, 3], 65534, [65535, 0, 1], [65535, 1, 2]),
    ] {
        let shape = Shape {
            channel_ids,
            schema_id,
            ..Shape::default()
        };
        let log = shape.write();
        let (result, _) = enrich_bytes(&log).expect("a result");
        judge(&log, &result, false);
        let summary = Summary::read(&result)
            .expect("a summary")
            .expect("a summary");
        let new = DERIVED.map(|topic| {
            let channel = summary
                .channels
                .values()
                .find(|channel| channel.topic == topic);
            let channel = channel.expect("the new channel");
            (channel.id, channel.schema.as_ref().expect("its schema").id)
        });
        // The rotation comes last: the first attitude has none yet.
        let [rotation, orientation, velocity] = new;
        let (channels, schemas): (Vec<u16>, Vec<u16>) =
            [orientation, velocity, rotation].into_iter().unzip();
        assert_eq!(channels, new_channels);
        assert_eq!(schemas, new_schemas);
    }
}

#[test]
fn an_id_that_only_a_chunk_a_count_or_an_index_has_is_not_reused() {
    // Channel 3 is defined in the last chunk, has no messages, and is not in the summary, but for its trace.
    let log = |trace: fn(&mut Statistics), in_index: bool| {
        let mut parts = Parts::of(&Shape::with(|options| options.compression(None)).write());
        let silent = mcap::records::Channel {
            id: 3,
            schema_id: 0,
            topic: "/silent".into(),
            message_encoding: "json".into(),
            metadata: Default::default(),
        };
        let mut content = Vec::new();
        push_record(&mut content, op::CHANNEL, &serialize(&silent));
        let header = mcap::records::ChunkHeader {
            message_start_time: 0,
            message_end_time: 0,
            uncompressed_size: content.len() as u64,
            uncompressed_crc: 0,
            compression: String::new(),
            compressed_size: content.len() as u64,
        };
        let chunk_start_offset = whole_length(&parts.data);
        let mut body = serialize(&header);
        body.extend(content);
        let chunk_length = (9 + body.len()) as u64;
        parts.data.push((op::CHUNK, body));
        let mut index = ChunkIndex {
            message_start_time: 0,
            message_end_time: 0,
            chunk_start_offset,
            chunk_length,
            message_index_offsets: Default::default(),
            message_index_length: 0,
            compression: String::new(),
            compressed_size: header.compressed_size,
            uncompressed_size: header.uncompressed_size,
        };
        if in_index {
            let empty = mcap::records::MessageIndex {
                channel_id: 3,
                records: Vec::new(),
            };
            index
                .message_index_offsets
                .insert(3, chunk_start_offset + chunk_length);
            index.message_index_length = 9 + serialize(&empty).len() as u64;
            parts.data.push((op::MESSAGE_INDEX, serialize(&empty)));
        }
        parts.summary.push((op::CHUNK_INDEX, serialize(&index)));
        for (opcode, body) in &mut parts.summary {
            if *opcode == op::STATISTICS {
                let mut statistics: Statistics = parse(body).expect("statistics");
                statistics.chunk_count += 1;
                trace(&mut statistics);
                *body = serialize(&statistics);
            }
        }
        parts.data_section_crc = 0;
        parts.join()
    };
    let logs = [
        log(|statistics| statistics.channel_count = 3, false),
        log(
            |statistics| statistics.channel_message_counts.extend([(3, 0)]),
            true,
        ),
        log(|_| {}, true),
        log(|_| {}, false),
    ];
    for log in logs {
        let (result, _) = enrich_bytes(&log).expect("a result");
        judge(&log, &result, false);
        let summary = Summary::read(&result)
            .expect("a summary")
            .expect("a summary");
        let new = summary
            .channels
            .values()
            .filter(|channel| DERIVED.contains(&channel.topic.as_str()));
        assert!(new.into_iter().all(|channel| channel.id > 3));
    }
}

/// Where the next record would start.
fn whole_length(records: &[(u8, Vec<u8>)]) -> u64 {
    let bodies: usize = records.iter().map(|(_, body)| 9 + body.len()).sum();
    (mcap::MAGIC.len() + bodies) as u64
}

#[test]
fn damage_in_the_middle_of_a_closed_log_is_not_mistaken_for_its_end() {
    let mut parts = Parts::of(&Shape::with(|options| options.emit_statistics(false)).write());
    let middle = parts.data.len() / 2;
    parts
        .data
        .insert(middle, (0, b"no record has this opcode".to_vec()));
    parts.data_section_crc = 0;
    let offset = whole_length(&parts.data[..middle]);
    match enrich_bytes(&parts.join()) {
        Err(Error::Read(ReadError::Damaged { offset: found, .. })) => assert_eq!(found, offset),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_log_that_uses_every_channel_id_is_refused() {
    let mut parts = Parts::of(&Shape::default().write());
    for id in 3..=u16::MAX {
        let channel = mcap::records::Channel {
            id,
            schema_id: 0,
            topic: format!("/{id}"),
            message_encoding: "json".into(),
            metadata: Default::default(),
        };
        parts.data.push((op::CHANNEL, serialize(&channel)));
    }
    // One is left: enough for the first topic, not for the second.
    parts.summary.clear();
    parts.data_section_crc = 0;
    let error = enrich_bytes(&parts.join()).expect_err("no room");
    assert!(
        matches!(
            error,
            Error::Write(WriteError::NoFreeId {
                kind: IdKind::Channel,
                ..
            })
        ),
        "{error}"
    );
}

/// A log whose chunk indexes, and the chunks themselves if they lie alike, say that all but the first start at their
/// last message.
fn with_wrong_start_times(alike: bool) -> Vec<u8> {
    let mut parts = Parts::of(&Shape::default().write());
    for (opcode, body) in &mut parts.summary {
        if *opcode == op::CHUNK_INDEX {
            let mut index: ChunkIndex = parse(body).expect("a chunk index");
            if index.message_start_time > 1_000_000_000 {
                index.message_start_time = index.message_end_time;
                *body = serialize(&index);
            }
        }
    }
    for (opcode, body) in &mut parts.data {
        if alike && *opcode == op::CHUNK && body[..8] != 1_000_000_000u64.to_le_bytes() {
            body.copy_within(8..16, 0);
        }
    }
    parts.data_section_crc = 0;
    parts.join()
}

#[test]
fn a_chunk_and_an_index_with_a_wrong_start_time_are_an_error() {
    let result = enrich_bytes(&with_wrong_start_times(true)).map(|(_, report)| report);
    let error = result.expect_err("samples would come out of order");
    assert!(error.to_string().contains("its index says"), "{error}");
}

#[test]
fn an_index_with_another_start_time_than_its_chunk_is_not_believed() {
    let log = with_wrong_start_times(false);
    let (result, report) = enrich_bytes(&log).expect("a readable log");
    judge(&log, &result, false);
    assert!(report.notes.contains(&Note::SummaryIncomplete));
}

#[test]
fn a_chunk_with_a_flipped_bit_is_an_error() {
    let log = Shape::with(|options| options.compression(None)).write();
    let at = log
        .windows(7)
        .position(|window| window == b"\"roll\":")
        .expect("telemetry");
    let mut damaged = log;
    damaged[at + 9] ^= 1;
    let error = enrich_bytes(&damaged).expect_err("the checksum is wrong");
    assert!(error.to_string().contains("checksum"), "{error}");
}
