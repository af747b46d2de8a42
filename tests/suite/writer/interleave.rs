//! The interleaved layout: whatever the shape of the log, derived messages are where they belong, and nothing that
//! the log has is lost.

use std::{
    borrow::Cow,
    collections::BTreeMap,
    fs,
    io::{self, Cursor},
    mem::discriminant,
    ops::ControlFlow,
    path::Path,
    sync::{
        atomic::{AtomicUsize, Ordering::Relaxed},
        mpsc::{self, Receiver},
    },
};

use flightcam::{
    Error, Output, Progress, Report, Watch, enrich,
    log::record::{push_record, serialize},
    messages::{Encoding, EncodingChoice},
    report::Note,
    restore,
    run::RunError,
    writer::{Layout, WriteError, original::Lost},
};
use mcap::{
    Attachment, WriteOptions,
    records::{ChunkHeader, MessageHeader, Metadata, op},
};
use proptest::prelude::*;

use crate::support::{layout::*, shapes::any_shape, *};

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn a_log_of_any_shape_is_interleaved_without_a_loss(shape in any_shape()) {
        let log = shape.write();
        let (result, report) = interleave(&log);
        judge_interleaved(&log, false, &result, &report);
        prop_assert!(report.complete);
    }

    #[test]
    fn a_truncated_log_is_interleaved_up_to_its_end(shape in any_shape(), at in 0.3..1.0) {
        let log = shape.write();
        let torn = &log[..(at * log.len() as f64) as usize];
        // What is refused is refused in every layout.
        match (enrich_bytes_with(torn, &interleaved()), enrich_bytes(torn)) {
            (Ok((result, report)), _) => judge_interleaved(torn, true, &result, &report),
            (Err(error), Err(same)) => prop_assert_eq!(discriminant(&error), discriminant(&same)),
            (Err(error), Ok(_)) => prop_assert!(false, "{}", error),
        }
    }

    #[test]
    fn attachments_between_the_chunks_are_found_again(
        options in any_shape().prop_map(|shape| shape.options),
        every in 1..120usize,
    ) {
        let log = with_attachments(options, every);
        let (result, report) = interleave(&log);
        judge_interleaved(&log, false, &result, &report);
    }
}

/// A log with an attachment and a Metadata record now and then.
fn with_attachments(options: WriteOptions, every: usize) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = options.create(&mut file).expect("a writer");
    let mut channels = BTreeMap::new();
    for (number, message) in stream(&Shape::default().write(), false).iter().enumerate() {
        let topic = message.topic.as_str();
        let channel = *channels.entry(topic.to_owned()).or_insert_with(|| {
            let schema = br#"{"type":"object","properties":{"roll":{},"pitch":{},"yaw":{},"vx":{},"vy":{},"vz":{}}}"#;
            let schema = match topic {
                TELEMETRY => writer.add_schema("State", "jsonschema", schema).expect("a schema"),
                _ => 0,
            };
            let channel = writer.add_channel(schema, topic, "json", &BTreeMap::new());
            channel.expect("a channel")
        });
        if number.is_multiple_of(every) {
            let attachment = Attachment {
                log_time: message.log_time,
                create_time: 0,
                name: format!("{number}.txt"),
                media_type: "text/plain".into(),
                data: Cow::Owned(vec![7; number]),
            };
            writer.attach(&attachment).expect("an attachment");
            let metadata = Metadata {
                name: format!("{number}"),
                metadata: BTreeMap::new(),
            };
            writer.write_metadata(&metadata).expect("a Metadata record");
        }
        let header = MessageHeader {
            channel_id: channel,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        let written = writer.write_to_known_channel(&header, &message.payload);
        written.expect("a message");
    }
    writer.finish().expect("the log is finished");
    drop(writer);
    file.into_inner()
}

// ---- Places ----

#[test]
fn in_the_demonstration_log_each_chunk_is_followed_by_what_was_derived_from_it() {
    let log = fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture");
    let (result, report) = interleave(&log);
    judge_interleaved(&log, false, &result, &report);
    let are_derived: Vec<bool> = chunks(&result).iter().map(Chunk::is_derived).collect();
    assert!(are_derived.len() > 4);
    assert!(
        are_derived.chunks(2).all(|pair| pair == [false, true]),
        "{are_derived:?}"
    );
    assert!(report.notes.contains(&Note::CannotBeUndone));
}

#[test]
fn a_streaming_reader_of_an_ordered_log_gets_every_message_in_time_order() {
    let (result, _) = interleave(&Shape::default().write());
    let messages = stream(&result, false);
    for (place, message) in messages.iter().enumerate() {
        if !DERIVED.contains(&message.topic.as_str()) {
            continue;
        }
        let time = message.log_time;
        assert!(messages[place..].iter().all(|later| later.log_time >= time));
        let sample = |earlier: &ReadMessage| earlier.topic == TELEMETRY && earlier.log_time == time;
        assert!(messages[..place].iter().any(sample));
    }
}

#[test]
fn derived_messages_come_last_where_chunks_overlap_completely() {
    let shape = Shape {
        topic_after_topic: true,
        ..Shape::default()
    };
    let log = shape.write();
    let (result, report) = interleave(&log);
    judge_interleaved(&log, false, &result, &report);
    let chunks = chunks(&result);
    let first = chunks.iter().position(Chunk::is_derived);
    let last_telemetry_starts = chunks.iter().rposition(|chunk| !chunk.is_derived());
    assert!(
        first < last_telemetry_starts,
        "the telemetry's own chunks are in order"
    );
    assert!(first > Some(1), "the other topic's chunks come first");
}

#[test]
fn messages_derived_from_a_long_chunk_are_written_in_several_chunks() {
    let fixture = fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture");
    let mut parts = Parts::of(&fixture);
    // Outside chunks, without any sense of order: one run, as long as a run gets.
    parts
        .data
        .retain(|(opcode, _)| matches!(*opcode, op::HEADER));
    parts.summary.clear();
    let mut messages = Vec::new();
    each_record(&fixture, false, |record| match record {
        mcap::records::Record::Schema { header, data } => {
            let mut body = serialize(&header);
            body.extend_from_slice(&(data.len() as u32).to_le_bytes());
            body.extend_from_slice(&data);
            parts.data.push((op::SCHEMA, body));
        }
        mcap::records::Record::Channel(channel) => {
            parts.data.push((op::CHANNEL, serialize(&channel)));
        }
        mcap::records::Record::Message { header, data } => {
            let mut body = serialize(&header);
            body.extend_from_slice(&data);
            messages.push((op::MESSAGE, body));
        }
        _ => {}
    });
    parts.data.extend(messages);
    parts.data_section_crc = 0;
    let options = interleaved().encoding(EncodingChoice::Given(Encoding::Json));
    let (result, _) = enrich_bytes_with(&parts.join(), &options).expect("a result");
    let chunks = chunks(&result);
    let derived = chunks.iter().filter(|chunk| chunk.is_derived());
    let lengths: Vec<u64> = derived.map(|chunk| chunk.index.uncompressed_size).collect();
    assert!(lengths.len() > 1, "{lengths:?}");
    assert!(lengths.iter().all(|&length| length < 1024 * 1024 + 4096));
}

// ---- Shapes that need more than copying ----

#[test]
fn messages_outside_chunks_are_gathered_into_chunks() {
    for log in [
        Shape::with(|options| options.use_chunks(false)).write(),
        mixed_log(),
    ] {
        let (result, report) = interleave(&log);
        judge_interleaved(&log, false, &result, &report);
        let parts = Parts::of(&result);
        assert!(parts.data.iter().all(|(opcode, _)| *opcode != op::MESSAGE));
        let layout = Layout::Interleaved;
        assert!(report.notes.contains(&Note::LooseMessages { layout }));
        check_seeking(&result);
    }
}

#[test]
fn chunks_without_message_indexes_get_them() {
    let log = Shape::with(|options| options.emit_message_indexes(false)).write();
    let (result, report) = interleave(&log);
    judge_interleaved(&log, false, &result, &report);
    check_seeking(&result);
}

#[test]
fn message_indexes_that_lack_a_channel_are_written_anew() {
    let mut parts = Parts::of(&Shape::default().write());
    let is_index = |record: &(u8, Vec<u8>)| record.0 == op::MESSAGE_INDEX;
    let left_out = parts.data.iter().position(is_index);
    parts.data.remove(left_out.expect("a message index"));
    parts.summary.clear();
    parts.data_section_crc = 0;
    let log = parts.join();
    let (result, report) = interleave(&log);
    judge_interleaved(&log, false, &result, &report);
    check_seeking(&result);
}

/// What the message indexes say is at an offset is there.
fn check_seeking(result: &[u8]) {
    let summary = summary_of(result);
    for chunk in &summary.chunk_indexes {
        let indexes = summary.read_message_indexes(result, chunk);
        for (channel, entries) in indexes.expect("message indexes") {
            for entry in entries {
                let message = summary.seek_message(result, chunk, &entry);
                let message = message.expect("a message");
                assert_eq!(message.channel.id, channel.id);
                assert_eq!(message.log_time, entry.log_time);
            }
        }
    }
}

#[test]
fn a_chunk_without_messages_stays_in_its_place() {
    let mut parts = Parts::of(&Shape::default().write());
    let header = ChunkHeader {
        message_start_time: 0,
        message_end_time: 0,
        uncompressed_size: 0,
        uncompressed_crc: 0,
        compression: String::new(),
        compressed_size: 0,
    };
    let chunks = (0..parts.data.len()).filter(|&i| parts.data[i].0 == op::CHUNK);
    let places: Vec<usize> = chunks.collect();
    for place in [parts.data.len(), places[3], places[0]] {
        parts.data.insert(place, (op::CHUNK, serialize(&header)));
    }
    parts.summary.clear();
    parts.data_section_crc = 0;
    let log = parts.join();
    let (result, report) = interleave(&log);
    judge_interleaved(&log, false, &result, &report);
}

#[test]
fn fields_that_a_later_format_appends_to_summary_records_survive() {
    for with_indexes in [true, false] {
        let shape = Shape {
            attachment_and_metadata: true,
            ..Shape::with(|options| options.emit_message_indexes(with_indexes))
        };
        let mut parts = Parts::of(&shape.write());
        for (opcode, body) in &mut parts.summary {
            if *opcode != op::STATISTICS {
                body.extend_from_slice(b"later");
            }
        }
        parts.summary.push((0x90, b"private".to_vec()));
        let log = parts.join();
        let (result, report) = interleave(&log);
        judge_interleaved(&log, false, &result, &report);
        let kept = Parts::of(&result).summary;
        let survived = |opcode| {
            let records = kept.iter().filter(|record| record.0 == opcode);
            records
                .filter(|record| record.1.ends_with(b"later"))
                .count()
        };
        for opcode in [
            op::SCHEMA,
            op::CHANNEL,
            op::CHUNK_INDEX,
            op::ATTACHMENT_INDEX,
            op::METADATA_INDEX,
        ] {
            let records = parts.summary.iter().filter(|record| record.0 == opcode);
            assert_eq!(survived(opcode), records.count(), "opcode {opcode:#x}");
        }
        assert!(kept.contains(&(0x90, b"private".to_vec())));
    }
}

#[test]
fn a_wrong_checksum_is_not_replaced_by_a_right_one() {
    let mut parts = Parts::of(&Shape::default().write());
    assert_ne!(parts.data_section_crc, 0);
    let (sound, report) = interleave(&parts.join());
    assert_ne!(Parts::of(&sound).data_section_crc, 0);
    let is_told = |report: &Report| report.notes.contains(&Note::ChecksumWrong);
    assert!(!is_told(&report));

    parts.data_section_crc ^= 1;
    let (result, report) = interleave(&parts.join());
    assert_eq!(Parts::of(&result).data_section_crc, 0);
    assert!(is_told(&report));
    assert!(stream(&result, false) == stream(&sound, false));
}

#[test]
fn the_checksum_covers_messages_outside_chunks() {
    let mut parts = Parts::of(&Shape::with(|options| options.use_chunks(false)).write());
    let mut data = mcap::MAGIC.to_vec();
    for (opcode, body) in &parts.data {
        push_record(&mut data, *opcode, body);
    }
    parts.data_section_crc = crc32fast::hash(&data);
    let log = parts.join();
    let (result, report) = interleave(&log);
    judge_interleaved(&log, false, &result, &report);
    assert_ne!(Parts::of(&result).data_section_crc, 0);
}

// ---- In use ----

#[test]
fn interleaving_an_enriched_log_gives_what_its_original_gives() {
    let log = Shape::default().write();
    let (appended, _) = enrich_bytes(&log).expect("a result");
    let (of_enriched, report) = interleave(&appended);
    assert!(of_enriched == interleave(&log).0);
    assert!(
        report
            .notes
            .iter()
            .any(|note| matches!(note, Note::Replaced { .. }))
    );
}

#[test]
fn a_stream_gets_the_same_bytes_as_a_file() {
    for log in [Shape::default().write(), mixed_log()] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let input = folder.path().join("log.mcap");
        fs::write(&input, &log).expect("the log is written");
        let mut streamed = Vec::new();
        let name = Path::new("stream");
        let report = enrich(&input, Output::stream(name, &mut streamed), &interleaved());
        assert_eq!(report.expect("a report").output, name);
        assert!(streamed == interleave(&log).0);
    }
}

#[test]
fn interleaving_cannot_be_undone_and_the_report_says_so() {
    let (result, _) = interleave(&Shape::default().write());
    let folder = tempfile::tempdir().expect("a temporary folder");
    let log = folder.path().join("log.mcap");
    let output = folder.path().join("output.mcap");
    fs::write(&log, &result).expect("the log is written");
    let refusals = [
        restore(&log, Output::InPlace, &Watch::default()).map(drop),
        restore(&log, &output, &Watch::default()).map(drop),
        enrich(&log, &output, &options()).map(drop),
        enrich(&log, &output, &interleaved()).map(drop),
        enrich(&log, Output::InPlace, &options()).map(drop),
    ];
    for refused in refusals {
        let error = refused.expect_err("it is refused");
        assert!(matches!(
            error,
            Error::Run(RunError::NotRestorable {
                reason: Lost::Interleaved,
                ..
            }) | Error::Write(WriteError::AlreadyEnriched {
                reason: Lost::Interleaved,
                ..
            })
        ));
        let text = error.to_string();
        assert!(text.contains(&Lost::Interleaved.to_string()), "{text}");
    }
    assert!(fs::read(&log).expect("the log") == result);
    assert!(!output.exists());
}

#[test]
fn interleaving_is_not_done_in_place() {
    let before = Shape::default().write();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let log = folder.path().join("log.mcap");
    fs::write(&log, &before).expect("the log is written");
    let error = enrich(&log, Output::InPlace, &interleaved()).expect_err("it is refused");
    let refused = matches!(error, Error::Run(RunError::InterleavedInPlace));
    assert!(refused, "{error}");
    assert!(fs::read(&log).expect("the log") == before);
}

/// An output that takes nothing before progress was reported that many times.
struct Stalled {
    told: Receiver<()>,
    bytes: Vec<u8>,
}

impl io::Write for Stalled {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.bytes.is_empty() {
            let told = self.told.iter().take(20).count();
            assert_eq!(told, 20);
        }
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_run_can_be_stopped_while_its_output_stalls() {
    let (tell, told) = mpsc::channel();
    let bytes = Vec::new();
    let mut output = Stalled { told, bytes };
    let input = repository("fixtures/survey_flight.mcap");
    let name = Path::new("stream");
    let options = interleaved().watch(move |_| {
        let _ = tell.send(());
        ControlFlow::Continue(())
    });
    let report = enrich(&input, Output::stream(name, &mut output), &options);
    report.expect("a report");
    let log = fs::read(&input).expect("the fixture");
    assert!(output.bytes == interleave(&log).0);
}

#[test]
fn progress_reaches_its_end_and_can_be_stopped_anywhere() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let input = folder.path().join("log.mcap");
    let output = folder.path().join("result.mcap");
    fs::copy(repository("fixtures/survey_flight.mcap"), &input).expect("the fixture");
    for stop_after in 0.. {
        let (saw, seen) = mpsc::channel();
        let count = AtomicUsize::new(0);
        let options = interleaved().watch(move |progress| {
            saw.send(progress).expect("they are counted below");
            match count.fetch_add(1, Relaxed) >= stop_after {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let run = enrich(&input, &output, &options);
        let seen: Vec<Progress> = seen.try_iter().collect();
        let files = fs::read_dir(folder.path()).expect("the folder").count();
        match run {
            Err(Error::Run(RunError::Interrupted { path, .. })) => {
                assert_eq!(path, output);
                assert_eq!(files, 1, "nothing is left");
            }
            Err(other) => panic!("{other}"),
            Ok(_) => {
                assert!(stop_after > 3);
                let is_within = |progress: &Progress| progress.done <= progress.total;
                assert!(seen.iter().all(is_within), "{seen:?}");
                assert_eq!(files, 2);
                break;
            }
        }
    }
}
