//! The journal next to a log: whatever a power cut leaves of either, the log is recovered.

use std::{fs, path::PathBuf, sync::mpsc};

use flightcam::{
    Output, enrich,
    log::{Access, Log, file::LogFile},
};
use proptest::prelude::*;

use crate::support::{folder::*, rewriting::with_attachment, shapes::*, *};

const JOURNAL: &str = "flight.mcap.flightcam-journal";

/// A folder with a log and a complete journal, as left by a change that was interrupted before it touched the log.
/// And where the log's data ends.
fn cut_short(log: &[u8]) -> (Folder, usize) {
    let folder = Folder::with(LOG, log);
    let file = LogFile::open(&folder.path(LOG), Access::Change).expect("it is opened");
    let log = Log::read(file).expect("a log");
    log.file
        .change_from(log.data_end, &|_| {})
        .expect("a journal");
    (folder, log.data_end as usize)
}

/// Opens the log, which must be as it was, with nothing next to it.
#[track_caller]
fn is_found_whole(folder: &Folder, log: &[u8]) {
    let opened = Log::open(&folder.path(LOG)).expect("a log");
    assert!(opened.file.was_recovered());
    assert_eq!(opened.file.length(), log.len() as u64);
    drop(opened);
    assert!(folder.read_only_one(LOG) == log);
}

#[test]
fn an_incomplete_journal_is_removed_and_the_log_left_unchanged() {
    let log = Shape::default().write();
    let (folder, data_end) = cut_short(&log);
    let journal = folder.read(JOURNAL);
    // A log that differs from what the journal has.
    let log = with_attachment(&log);
    let zeros = vec![0; journal.len()];
    let cut = (0..journal.len()).map(|length| journal[..length].to_vec());
    let zeroed = (0..journal.len()).map(|length| [&journal[..length], &zeros[length..]].concat());
    let blank = (0..100).map(|length| vec![0; length]);
    let flipped = (0..journal.len()).map(|place| {
        let mut flipped = journal.clone();
        flipped[place] ^= 1 << (place % 8);
        flipped
    });
    let longer = [journal.as_slice(), &[0]].concat();
    let all = cut
        .chain(zeroed)
        .chain(blank)
        .chain(flipped)
        .chain([longer]);
    for torn in all {
        folder.add(LOG, &log);
        folder.add(JOURNAL, torn);
        is_found_whole(&folder, &log);
    }
    assert!(data_end < log.len());
}

proptest! {
    #![proptest_config(crate::support::cases(64))]

    #[test]
    fn whatever_was_written_over_the_logs_end_is_undone(
        shape in any_shape(),
        is_torn: bool,
        is_enriched: bool,
        garbage in prop::collection::vec(any::<u8>(), 0..5000),
        length in 0..20_000u64,
    ) {
        let mut log = shape.write();
        if is_enriched {
            log = enrich_bytes(&log).expect("a result").0;
        }
        if is_torn {
            log.truncate(log.len() - 20);
        }
        let (folder, data_end) = cut_short(&log);
        let whole = folder.contents();
        let mut changed = log[..data_end].to_vec();
        changed.extend(garbage);
        folder.add(LOG, changed);
        let file = fs::File::options().write(true).open(folder.path(LOG)).expect("the log");
        file.set_len(data_end as u64 + length).expect("another length");
        drop(file);
        prop_assert_eq!(folder.contents().len(), whole.len());
        is_found_whole(&folder, &log);
    }
}

#[test]
fn every_command_rolls_a_log_back_and_says_so() {
    let log = Shape::default().write();
    let (enriched, _) = enrich_bytes(&log).expect("a result");
    let again = "enrich flight.mcap --depression 30";
    let note = "an earlier run … was interrupted while it changed the log";
    for (log, command, file, expected) in [
        (
            &log,
            "inspect flight.mcap --depression 30".to_owned(),
            LOG,
            &log,
        ),
        (&log, again.to_owned(), RESULT, &enriched),
        (&log, format!("{again} --in-place"), LOG, &enriched),
        (&log, "restore flight.mcap".to_owned(), LOG, &log),
        (
            &log,
            "restore flight.mcap -o original.mcap".to_owned(),
            "original.mcap",
            &log,
        ),
        (&enriched, "restore flight.mcap".to_owned(), LOG, &log),
        (
            &enriched,
            "restore flight.mcap -o original.mcap".to_owned(),
            "original.mcap",
            &log,
        ),
    ] {
        let (folder, data_end) = cut_short(log);
        folder.add(LOG, [&log[..data_end], b"half of a result"].concat());
        let (out, err) = folder.run(&command, 0);
        assert_reads(&out, note);
        assert_eq!(err, "");
        assert!(folder.read(file) == *expected, "{command}");
        if file != LOG {
            assert!(folder.read(LOG) == *log, "{command}");
            fs::remove_file(folder.path(file)).expect("removed");
        }
        folder.read_only_one(LOG);
    }
}

/// Checks that every command refuses the log in a folder, with these words and everything as it was.
#[track_caller]
fn is_refused(folder: &Folder, message: &str) {
    for command in [
        "inspect flight.mcap",
        "enrich flight.mcap --depression 30",
        "enrich flight.mcap --depression 30 --in-place",
        "restore flight.mcap",
        "restore flight.mcap -o original.mcap",
    ] {
        folder.refuses(command, 1, message);
    }
}

#[test]
fn the_journal_of_another_log_changes_nothing() {
    let (folder, data_end) = cut_short(&Shape::default().write());
    let other = Shape {
        topic_after_topic: true,
        ..Shape::default()
    }
    .write();
    let mut changed_at_the_start = folder.read(LOG);
    changed_at_the_start[30] ^= 1;
    let mut changed_at_the_end = folder.read(LOG);
    changed_at_the_end[data_end - 1] ^= 1;
    let shorter = folder.read(LOG)[..data_end - 1].to_vec();
    let place = folder.path(LOG).canonicalize().expect("the log");
    let message = format!(
        "error: {LOG}: … {JOURNAL} beside it is left from an interrupted change of another log ({}) … put that log \
         back in its place, or remove the journal if that log is lost",
        place.display()
    );
    for log in [other, changed_at_the_start, changed_at_the_end, shorter] {
        folder.add(LOG, log);
        is_refused(&folder, &message);
    }
}

#[test]
fn a_journal_of_another_program_or_version_is_left_unchanged() {
    let folder = Folder::with(LOG, Shape::default().write());
    let mut journal = b"flightcam journal 2\nof which nothing is known".to_vec();
    journal.extend_from_slice(&crc32fast::hash(&journal).to_le_bytes());
    folder.add(JOURNAL, journal);
    is_refused(
        &folder,
        "flight.mcap: cannot bring the log back to what it was before an interrupted run",
    );
}

#[test]
fn an_output_is_refused_where_a_journal_exists() {
    let (folder, _) = cut_short(&Shape::default().write());
    folder.add("other.mcap", Shape::default().write());
    let message = format!(
        "{LOG}: {JOURNAL} beside it is left from an interrupted change … flightcam restore … remove the journal … -o"
    );
    let replace = format!("enrich other.mcap --depression 30 -o {LOG} --force");
    folder.refuses(&replace, 1, &message);
    let log = folder.read(LOG);
    fs::remove_file(folder.path(LOG)).expect("moved away");
    folder.refuses(&replace, 1, &message);
    folder.add(LOG, log);
    folder.run(&format!("restore {LOG}"), 0);
    folder.writes(LOG, &replace, 0);
}

#[test]
#[cfg(unix)]
fn a_journal_has_the_permissions_of_its_log() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::with(LOG, Shape::default().write());
    let (log, journal) = (folder.path(LOG), folder.path(JOURNAL));
    let mode = |path: &PathBuf| fs::metadata(path).expect("a file").permissions().mode() & 0o777;
    for wanted in [0o600, 0o640, 0o666] {
        fs::set_permissions(&log, fs::Permissions::from_mode(wanted)).expect("set");
        let (saw, found) = mpsc::channel();
        let journal = journal.clone();
        let options = options().on_step(move |_| {
            if journal.exists() {
                saw.send(mode(&journal)).expect("it is read below");
            }
        });
        enrich(&log, Output::InPlace, &options).expect("a result");
        let found: Vec<u32> = found.try_iter().collect();
        assert_eq!(mode(&log), wanted);
        // But not yet when it has just been created, and is empty.
        assert!(found.len() > 2 && found[1..].iter().all(|&found| found == wanted));
    }
}

#[test]
#[cfg(unix)]
fn a_log_whose_name_is_too_long_for_a_journal_is_only_read() {
    let name = format!("{}.mcap", "a".repeat(245));
    let folder = Folder::with(&name, Shape::default().write());
    let message = format!("{name}.flightcam-journal: cannot save the log's end");
    folder.refuses(
        &format!("enrich {name} --depression 30 --in-place"),
        1,
        &message,
    );
    folder.run(&format!("inspect {name} --depression 30"), 0);
    folder.writes(
        "x.mcap",
        &format!("enrich {name} --depression 30 -o x.mcap"),
        0,
    );
}
