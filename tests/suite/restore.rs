//! Restoring: whatever flightcam made of a log, the original comes back byte for byte.

use std::{collections::BTreeSet, fs, io::Read as _};

use assert_cmd::cargo::cargo_bin_cmd;
use flightcam::{
    Note, Output, Watch, enrich,
    log::record::{FRAME_LENGTH, serialize},
    restore,
};
use mcap::{
    Summary,
    records::{MessageHeader, op},
};
use proptest::prelude::*;

use crate::support::{folder::*, rewriting::*, shapes::*, *};

/// Enriches a log and undoes that in every way there is. `None` if nothing can be derived from it.
#[track_caller]
fn goes_there_and_back(log: &[u8]) -> Option<()> {
    let (enriched, report) = enrich_bytes_with(log, &options_at(30.0)).ok()?;
    assert_ne!(enriched, log);
    let (other, _) = enrich_bytes_with(log, &options_at(60.0)).expect("what one angle gives");
    let (replaced, _) = enrich_bytes_with(&enriched, &options_at(60.0)).expect("a result");
    assert!(replaced == other, "a copy has the new result alone");

    let folder = Folder::with(LOG, log);
    let path = folder.path(LOG);
    let in_place = |angle| enrich(&path, Output::InPlace, &options_at(angle)).expect("a result");
    let reported = in_place(30.0);
    assert!(
        folder.read_only_one(LOG) == enriched,
        "in place gives what a copy has"
    );
    assert_eq!(
        (reported.bytes_kept, reported.bytes_added),
        (report.bytes_kept, report.bytes_added)
    );
    in_place(60.0);
    assert!(
        folder.read_only_one(LOG) == other,
        "the log has the new result alone"
    );

    let copied = folder.path("original.mcap");
    let restored = restore(&path, &copied, &Watch::default()).expect("the original");
    assert_eq!(restored.bytes, log.len() as u64);
    assert!(
        folder.read("original.mcap") == log,
        "restored to a new file"
    );
    assert!(folder.read(LOG) == other, "the enriched log stays");
    fs::remove_file(copied).expect("removed");

    let restored = restore(&path, Output::InPlace, &Watch::default()).expect("the original");
    assert_eq!(restored.bytes, log.len() as u64);
    assert!(restored.undone.is_some() && !restored.recovered);
    assert!(folder.read_only_one(LOG) == log, "restored in place");
    Some(())
}

#[test]
fn the_demonstration_log_is_restored() {
    let log = fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture");
    goes_there_and_back(&log).expect("it is enriched");
}

#[test]
fn real_logs_are_restored() {
    let Some(folder) = real_logs() else {
        return;
    };
    let entries = fs::read_dir(folder).expect("the real logs").flatten();
    let logs: Vec<_> = entries
        .map(|entry| entry.path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "mcap")
        })
        .collect();
    assert!(!logs.is_empty());
    for log in logs {
        let bytes = fs::read(&log).expect("a log");
        assert_eq!(goes_there_and_back(&bytes), Some(()), "{}", log.display());
    }
}

#[test]
fn a_log_whose_end_is_longer_than_what_replaces_it_is_restored() {
    for log in [with_repeated_schemas(), with_zeros_at_the_end()] {
        let (enriched, _) = enrich_bytes(&log).expect("a result");
        assert!(enriched.len() < log.len());
        goes_there_and_back(&log).expect("it is enriched");
    }
}

#[test]
fn a_log_with_several_chunks_of_results_is_restored() {
    goes_there_and_back(&long_log()).expect("it is enriched");
}

#[test]
fn a_log_of_one_reading_which_has_no_rotation_is_restored() {
    let shape = Shape {
        messages: 1,
        ..Shape::default()
    };
    goes_there_and_back(&shape.write()).expect("it is enriched");
}

/// In `fixtures/before_orientation`: what flightcam made of a flight, with the camera at 30°, when it did not write
/// orientations yet.
#[test]
fn a_result_from_before_there_were_orientations_is_replaced_and_restored() {
    let [log, earlier] = ["flight", "result"].map(|name| {
        let path = format!("fixtures/before_orientation/{name}.mcap");
        fs::read(repository(&path)).expect("the fixture")
    });
    let topics = judge(&log, &earlier, false)
        .into_iter()
        .map(|message| message.topic);
    let topics: BTreeSet<String> = topics.collect();
    assert_eq!(
        topics,
        ["/camera/relative_rpy", "/camera/velocity"]
            .map(str::to_owned)
            .into()
    );

    let (replaced, report) = enrich_bytes_with(&earlier, &options_at(60.0)).expect("a result");
    let (direct, _) = enrich_bytes_with(&log, &options_at(60.0)).expect("a result");
    assert!(replaced == direct, "nothing is left of the earlier result");
    let [Note::Replaced { earlier: run }] = &report.notes[..] else {
        panic!("{:?}", report.notes);
    };
    let camera = run.camera.as_ref().expect("a camera").as_str();
    assert!(camera.contains("30°"), "{camera}");

    let folder = Folder::with(LOG, &earlier);
    enrich(folder.path(LOG), Output::InPlace, &options_at(60.0)).expect("a result");
    assert!(folder.read_only_one(LOG) == direct, "in place, too");

    let folder = Folder::with(LOG, &earlier);
    restore(folder.path(LOG), Output::InPlace, &Watch::default()).expect("the original");
    assert!(folder.read_only_one(LOG) == log);
}

proptest! {
    #![proptest_config(crate::support::cases(32))]

    #[test]
    fn a_log_of_any_shape_is_restored(shape in any_shape()) {
        prop_assert_eq!(goes_there_and_back(&shape.write()), Some(()));
    }

    #[test]
    fn a_truncated_log_is_restored_with_its_torn_end(
        shape in any_shape(), at in 0.0..1.0
    ) {
        let log = shape.write();
        goes_there_and_back(&log[..(at * log.len() as f64) as usize]);
    }
}

const OTHER: &str = "another program has rewritten it since, or it is damaged";

/// Checks that restoring a log is refused in every way, and enriching it too, each with these words.
#[track_caller]
fn is_refused(log: impl AsRef<[u8]>, restoring: &str, enriching: &str) {
    let folder = Folder::with(LOG, log);
    let restoring = format!("{LOG}: cannot be restored: {restoring}");
    folder.refuses(&format!("restore {LOG}"), 1, &restoring);
    folder.refuses(&format!("restore {LOG} -o original.mcap"), 1, &restoring);
    let enriching = format!("{LOG}: {enriching}");
    for how in ["", "-o other.mcap", "--in-place"] {
        folder.refuses(
            &format!("enrich {LOG} --depression 60 {how}"),
            1,
            &enriching,
        );
    }
    // It is still a log, all of which can be described.
    folder.run(&format!("inspect {LOG} --depression 60"), 1);
}

/// As [`is_refused`], of a log that was enriched and rewritten.
#[track_caller]
fn is_lost(log: impl AsRef<[u8]>) {
    let enriching = format!(
        "has /camera/relative_rpy from an earlier run of flightcam (… 30° …), which cannot be replaced: {OTHER} … \
         enrich the original log instead"
    );
    is_refused(log, OTHER, &enriching);
}

#[test]
fn a_log_that_was_never_enriched_cannot_be_restored() {
    let folder = Folder::with_flight();
    let message = "flight.mcap: cannot be restored: it has nothing from flightcam";
    folder.refuses(&format!("restore {LOG}"), 1, message);
    folder.refuses(&format!("restore {LOG} -o original.mcap"), 1, message);
}

/// An enriched log that has an attachment and metadata of its own, and data that is longer than what is hashed of
/// it.
fn enriched_log() -> Vec<u8> {
    let shape = Shape {
        attachment_and_metadata: true,
        messages: 2500,
        ..Shape::with(|options| options.compression(None))
    };
    let (enriched, _) = enrich_bytes(&shape.write()).expect("a result");
    assert!(original_tail(&enriched).data_end > 3 * 64 * 1024);
    enriched
}

#[test]
fn a_log_that_another_program_rewrote_is_refused() {
    let enriched = enriched_log();
    is_lost(written_anew(&enriched));
    is_lost(with_attachment(&enriched));
    is_lost(with_metadata(&enriched));
    let mut with_private_record = Parts::of(&enriched);
    with_private_record.data.push((0x80, b"private".to_vec()));
    with_private_record.data_section_crc = 0;
    is_lost(with_private_record.join());
}

#[test]
fn a_log_to_which_another_program_added_since_is_refused() {
    let enriched = enriched_log();
    for kind in [op::MESSAGE, op::CHUNK, op::ATTACHMENT, op::METADATA] {
        // One of the log's own of that kind, or a message of its own. Its first chunk has none.
        let mut parts = Parts::of(&enriched);
        parts.data.retain(|(opcode, _)| *opcode == kind);
        let message = serialize(&MessageHeader {
            channel_id: 2,
            sequence: 0,
            log_time: 1_000_000_000,
            publish_time: 0,
        });
        let record = parts.data.into_iter().nth(usize::from(kind == op::CHUNK));
        let body = record.map_or(message, |(_, body)| body);
        is_lost(with_record_inside(&enriched, kind, body));
    }
}

#[test]
fn a_log_whose_beginning_has_changed_is_refused() {
    let enriched = enriched_log();
    let data_end = original_tail(&enriched).data_end as usize;
    // In the name of the library that wrote it, in the other topic's messages, and in the last of those.
    for place in [30, 60_000, data_end - 60_000, data_end - 400] {
        let mut changed = enriched.clone();
        changed[place] ^= 1;
        is_lost(changed);
    }
}

#[test]
fn a_log_whose_attachment_is_damaged_is_refused() {
    let enriched = enriched_log();
    is_lost(with_tail(&enriched, |tail| tail.tail_sha256[31] ^= 1));
    is_lost(with_tail(&enriched, |tail| tail.head_sha256[0] ^= 1));
    is_lost(with_tail(&enriched, |tail| tail.foot_sha256[0] ^= 1));
    is_lost(with_tail(&enriched, |tail| {
        tail.head_sha256.pop();
    }));
    is_lost(with_tail(&enriched, |tail| tail.tail_zstd[0] ^= 1));
    is_lost(with_tail(&enriched, |tail| {
        tail.tail_zstd.pop();
    }));
    is_lost(with_tail(&enriched, |tail| tail.tail_length -= 1));
    is_lost(with_tail(&enriched, |tail| tail.tail_length = u64::MAX));
    for data_end in [0, 1, enriched.len() as u64, u64::MAX] {
        is_lost(with_tail(&enriched, |tail| tail.data_end = data_end));
    }
}

#[test]
fn an_attachment_with_more_than_the_end_is_refused() {
    // A record that says nothing new, so that it may be mistaken for one that flightcam added.
    let mut parts = Parts::of(&Shape::default().write());
    let schema = parts
        .summary
        .iter()
        .find(|(opcode, _)| *opcode == op::SCHEMA);
    let schema = schema.expect("a schema").clone();
    let length = FRAME_LENGTH + schema.1.len();
    parts.data.push(schema);
    parts.data_section_crc = 0;
    let log = parts.join();
    let (enriched, _) = enrich_bytes(&log).expect("a result");
    let data_end = original_tail(&enriched).data_end as usize;
    let start = data_end - length;
    is_lost(with_end(&enriched, start, &log[start..]));

    // The same record at the start of the end, which does not have it there.
    let crafted = with_end(&enriched, data_end, &log[start..]);
    let folder = Folder::with(LOG, crafted);
    let message =
        format!("{LOG}: damaged at byte {data_end}: what is said to be the original's end");
    for command in [
        "restore",
        "restore -o x.mcap",
        "enrich --in-place",
        "enrich",
        "inspect",
    ] {
        folder.refuses(&format!("{command} {LOG}"), 1, &message);
    }
}

#[test]
#[cfg(unix)]
fn an_attachment_that_is_larger_than_declared_is_not_decompressed() {
    let enriched = with_tail(&enriched_log(), |tail| {
        let zeros = std::io::repeat(0).take(1 << 30);
        tail.tail_zstd = zstd::encode_all(zeros, 1).expect("compressed");
    });
    let folder = Folder::with(LOG, enriched);
    // In blocks of 512 bytes: a file may not be longer than the log.
    let limit = folder.read(LOG).len() / 512;
    let (code, _, err) = folder.run_limited(limit, &format!("restore {LOG}"));
    assert_eq!(code, 1);
    assert_reads(&err, &format!("error: {LOG}: cannot be restored: {OTHER}"));
}

/// Restores a log that may be damaged, which gives the original or leaves everything as it was. Whether it did.
#[track_caller]
fn restores_or_refuses(damaged: &[u8], original: &[u8]) -> bool {
    let folder = Folder::with(LOG, damaged);
    let restored = restore(folder.path(LOG), Output::InPlace, &Watch::default());
    let expected = match &restored {
        Ok(_) => original,
        Err(_) => damaged,
    };
    assert!(folder.read_only_one(LOG) == expected, "{restored:?}");
    restored.is_ok()
}

#[test]
fn a_log_that_was_cut_short_is_restored_if_the_attachment_is_whole() {
    let log = Shape::default().write();
    let (enriched, _) = enrich_bytes(&log).expect("a result");
    let summary = Summary::read(&enriched).expect("readable");
    let attachments = summary.expect("a summary").attachment_indexes;
    let attachment = attachments.last().expect("the attachment");
    let end = (attachment.offset + attachment.length) as usize;
    let start = original_tail(&enriched).data_end as usize;
    let lengths = [0, 1, 20, start - 1, start, end - 1, end, enriched.len() - 1];
    let between = (start..enriched.len()).step_by(97);
    for length in lengths.into_iter().chain(between) {
        let restored = restores_or_refuses(&enriched[..length], &log);
        assert_eq!(restored, length >= end, "{length} of {}", enriched.len());
    }
    // After the last chunk, so that there still is a trace of the earlier run.
    is_lost(&enriched[..end - 1]);
}

proptest! {
    #![proptest_config(crate::support::cases(256))]

    #[test]
    fn a_damaged_log_is_restored_or_left_unchanged(
        place in any::<prop::sample::Index>(), flipped in 1..=255u8
    ) {
        let log = Shape { messages: 20, ..Shape::default() }.write();
        let (mut damaged, _) = enrich_bytes(&log).expect("a result");
        let place = place.index(damaged.len());
        damaged[place] ^= flipped;
        restores_or_refuses(&damaged, &log);
    }
}

#[test]
fn an_original_is_restored_to_standard_output_and_the_report_goes_to_standard_error() {
    let log = mixed_log();
    let (enriched, _) = enrich_bytes(&log).expect("a result");
    let folder = Folder::with(LOG, enriched);
    let output = cargo_bin_cmd!("flightcam")
        .current_dir(folder.path(""))
        .args(["restore", LOG, "-o", "-"])
        .output()
        .expect("the program");
    assert!(output.status.success() && output.stdout == log);
    let report = String::from_utf8(output.stderr).expect("text");
    assert_reads(&report, "Undone … Result … standard output");
}
