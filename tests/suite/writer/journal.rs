//! The journal next to a log: whatever an interruption leaves, the log is recovered.

// Journals and logs that no interruption leaves.
mod distrusted;

use std::{fs, path::Path, sync::mpsc};

use flightcam::{
    Options, Output, enrich, inspect,
    log::Access,
    writer::journal::{self, JournalStep},
};
use proptest::prelude::*;

use crate::support::{folder::*, interrupted::*, shapes::*, *};

/// Opens the log, which must be as it was before the change, with nothing next to it.
#[track_caller]
fn is_found_whole(folder: &Folder, before: &[u8]) {
    let opened = journal::open(&folder.path(LOG), Access::Read, &|_| {}).expect("a log");
    assert!(opened.was_recovered());
    assert_eq!(opened.length(), before.len() as u64);
    drop(opened);
    assert!(folder.read_only_one(LOG) == before);
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

/// Logs whose results are longer, logs whose results are shorter than they are, and logs that break off.
fn originals() -> [Vec<u8>; 3] {
    let mut torn = Shape::default().write();
    torn.truncate(torn.len() * 2 / 3);
    [Shape::default().write(), with_zeros_at_the_end(), torn]
}

#[test]
fn a_log_that_was_written_up_to_any_byte_is_found_whole() {
    for original in originals() {
        for change in CHANGES {
            let ends = Ends::of(&original, change);
            let Ends {
                before,
                after,
                start,
            } = &ends;
            let folder = before_the_first_write(&ends, change);
            let journal = folder.read(JOURNAL);
            let last = after.len();
            let step = (last - start) / 12 + 1;
            for written in (*start..last).step_by(step).chain([last - 1, last]) {
                let rest = before.get(written..).unwrap_or_default();
                let overwritten = [&after[..written], rest].concat();
                // The system may have lost what was beyond, or have cut the log already.
                for left in [overwritten, after[..written].to_vec()] {
                    folder.add(LOG, left);
                    folder.add(JOURNAL, &journal);
                    is_found_whole(&folder, before);
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(crate::support::cases(48))]

    #[test]
    fn whatever_part_of_a_change_has_reached_the_disk_is_undone(
        shape in any_shape(),
        is_torn: bool,
        change in prop::sample::select(CHANGES.to_vec()),
        sectors in prop::collection::vec(0..3u8, 64),
        is_longest: bool,
    ) {
        let mut original = shape.write();
        if is_torn {
            original.truncate(original.len() - 20);
        }
        let ends = Ends::of(&original, change);
        let folder = before_the_first_write(&ends, change);
        let Ends { before, after, start } = &ends;
        let length = if is_longest { before.len().max(after.len()) } else { after.len() };
        let byte = |end: &[u8], place: usize| end.get(place).copied().unwrap_or(0);
        let left: Vec<u8> = (0..length)
            .map(|place| match sectors[(place / 512) % sectors.len()] {
                _ if place < *start => before[place],
                0 => byte(before, place),
                1 => byte(after, place),
                _ => 0,
            })
            .collect();
        folder.add(LOG, left);
        is_found_whole(&folder, before);
    }
}

#[test]
fn every_command_rolls_a_log_back_and_says_so_first() {
    let log = Shape::default().write();
    let enriched = Ends::of(&log, Change::Enrich).after;
    let again = "enrich flight.mcap --depression 30";
    let note = "an earlier run … was interrupted while it changed the log";
    for (change, command, file, expected) in [
        (
            Change::Enrich,
            "inspect flight.mcap --depression 30",
            LOG,
            &log,
        ),
        (Change::Enrich, again, RESULT, &enriched),
        (
            Change::Enrich,
            &format!("{again} --in-place"),
            LOG,
            &enriched,
        ),
        (Change::Enrich, "restore flight.mcap", LOG, &log),
        (
            Change::Enrich,
            "restore flight.mcap -o original.mcap",
            "original.mcap",
            &log,
        ),
        (Change::Restore, "restore flight.mcap", LOG, &log),
        (
            Change::Replace,
            "restore flight.mcap -o original.mcap",
            "original.mcap",
            &log,
        ),
    ] {
        let ends = Ends::of(&log, change);
        let folder = Folder::with(LOG, &ends.before);
        interrupt(&folder, change, JournalStep::LogWritten);
        let (out, err) = folder.run(command, 0);
        assert_reads(&out, note);
        assert_eq!(
            err,
            format!(
                "note: {LOG}: an earlier run was interrupted while it changed the log; first the log gets its old end \
                 back, from {JOURNAL}\n"
            )
        );
        assert!(folder.read(file) == *expected, "{command}");
        if file != LOG {
            assert!(folder.read(LOG) == ends.before, "{command}");
            fs::remove_file(folder.path(file)).expect("removed");
        }
        folder.read_only_one(LOG);
    }
}

#[test]
fn what_is_about_to_be_done_is_announced_before_it_is_done() {
    let ends = Ends::of(&Shape::default().write(), Change::Enrich);
    let folder = Folder::with(LOG, &ends.before);
    interrupt(&folder, Change::Enrich, JournalStep::LogDurable);
    let found = folder.read(LOG);
    let (saw, announced) = mpsc::channel();
    let path = folder.path(LOG);
    let options = options().on_recovery(move |interrupted| {
        let there = fs::read(&path).expect("the log");
        saw.send((interrupted.clone(), there))
            .expect("it is read below");
    });
    inspect(folder.path(LOG), &options).expect("a log");
    let (interrupted, there) = announced.try_recv().expect("an announcement");
    assert!(there == found && announced.try_recv().is_err());
    assert_eq!(interrupted.found_length, found.len() as u64);
    assert_eq!(interrupted.old_length, ends.before.len() as u64);
    assert!(folder.read_only_one(LOG) == ends.before);
}

#[test]
fn an_output_is_refused_where_a_journal_exists() {
    let ends = Ends::of(&Shape::default().write(), Change::Enrich);
    let folder = before_the_first_write(&ends, Change::Enrich);
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
    let mode = |path: &Path| fs::metadata(path).expect("a file").permissions().mode() & 0o777;
    for wanted in [0o600, 0o640, 0o666] {
        fs::set_permissions(&log, fs::Permissions::from_mode(wanted)).expect("set");
        let (saw, found) = mpsc::channel();
        let journal = journal.clone();
        let options: Options = options().on_step(move |_| {
            if journal.exists() {
                saw.send(mode(&journal)).expect("it is read below");
            }
        });
        enrich(&log, Output::InPlace, &options).expect("a result");
        let found: Vec<u32> = found.try_iter().collect();
        assert_eq!(mode(&log), wanted);
        assert!(found.len() > 2 && found.iter().all(|&found| found == wanted));
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
