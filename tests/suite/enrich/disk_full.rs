//! A full disk, or a file that may not grow: a clear error, and everything as it was.
#![cfg(unix)]

use std::{collections::BTreeSet, fs};

use flightcam::writer::journal::JournalStep;

use crate::support::{folder::*, interrupted::*, shapes::*, small_disk::run_mounting, *};

/// What `ulimit -f` counts in.
const BLOCK: usize = 512;

const UNLIMITED: usize = 1 << 30;

/// The outcome of a run that may run out of space.
#[derive(Debug, PartialEq)]
enum Outcome {
    /// There was enough.
    Done,
    /// It failed and left everything as it was.
    Undone,
    /// It failed, and so did undoing it. The next run did that.
    Recovered,
}

/// Runs the program where no file may be longer than that many blocks. Unless that is enough it must fail, with the
/// error that belongs to the outcome.
#[track_caller]
fn run(folder: &Folder, limit: usize, arguments: &str, message: &str) -> Outcome {
    let before = folder.checksums();
    let (code, out, err) = folder.run_limited(limit, arguments);
    if code != 1 {
        assert_eq!(err, "");
        return Outcome::Done;
    }
    assert_eq!(out, "");
    assert_reads(&err, &format!("error: {message}: File too large"));
    if !folder.path(JOURNAL).exists() {
        assert_eq!(
            folder.checksums(),
            before,
            "{arguments} with {limit} blocks"
        );
        return Outcome::Undone;
    }
    assert_reads(
        &err,
        "and the log flight.mcap could not be restored (File too large …); … has its old end … when there is \
         room again, `flightcam restore` does that",
    );
    // A log that is still intact is rolled back like one that is not.
    folder.run_limited(UNLIMITED, "inspect flight.mcap --depression 30");
    assert_eq!(
        folder.checksums(),
        before,
        "{arguments} with {limit} blocks"
    );
    Outcome::Recovered
}

/// Limits in blocks: those at which that many bytes just fit or just do not, and none at all.
fn limits(lengths: &[usize]) -> BTreeSet<usize> {
    let around = |length: &usize| [length / BLOCK, length.div_ceil(BLOCK)];
    lengths.iter().flat_map(around).chain([0]).collect()
}

/// A log whose end is short, and one whose end is long and shrinks to nothing. Each with its result.
fn logs() -> [[Vec<u8>; 2]; 2] {
    let fixture = fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture");
    [fixture, with_zeros_at_the_end()].map(|log| {
        let (result, _) = enrich_bytes(&log).expect("a result");
        [log, result]
    })
}

#[test]
fn a_new_file_that_runs_out_of_space_is_removed() {
    for [log, result] in logs() {
        for (input, arguments, output, expected) in [
            (&log, "enrich flight.mcap --depression 30", RESULT, &result),
            (
                &result,
                "restore flight.mcap -o original.mcap",
                "original.mcap",
                &log,
            ),
            (
                &result,
                "enrich flight.mcap --depression 30",
                RESULT,
                &result,
            ),
        ] {
            let tail = log.len() - original_tail(&result).data_end as usize;
            let kept = if input == &log { 0 } else { tail };
            for limit in limits(&[kept, log.len() / 2, log.len(), result.len()]) {
                let folder = Folder::with(LOG, input);
                let message = match limit * BLOCK < kept {
                    true => {
                        "flight.mcap: cannot uncompress the original's end into a temporary file"
                            .into()
                    }
                    false => format!("{output}: cannot write the output"),
                };
                let outcome = run(&folder, limit, arguments, &message);
                let is_enough = limit * BLOCK >= expected.len().max(kept);
                let done = if is_enough {
                    Outcome::Done
                } else {
                    Outcome::Undone
                };
                assert_eq!(outcome, done, "{arguments} with {limit} blocks");
                if is_enough {
                    assert!(folder.read(output) == *expected);
                }
            }
        }
    }
}

#[test]
fn a_change_in_place_that_runs_out_of_space_is_undone() {
    for [log, result] in logs() {
        for change in CHANGES {
            let Ends { before, after, .. } = Ends::of(&log, change);
            let arguments = match change {
                Change::Enrich => "enrich flight.mcap --depression 30 --in-place",
                Change::Replace => "enrich flight.mcap --depression 60 --in-place",
                Change::Restore => "restore flight.mcap",
            };
            let tail = log.len() - original_tail(&result).data_end as usize;
            let kept = if change == Change::Enrich { 0 } else { tail };
            let journal = journal_length(&before, change);
            let room = limits(&[kept, journal, log.len() / 2, log.len(), after.len()]);
            for limit in room {
                let folder = Folder::with(LOG, &before);
                let room = limit * BLOCK;
                let (expected, message) = if room < kept {
                    let message =
                        "flight.mcap: cannot uncompress the original's end into a temporary file";
                    (Outcome::Undone, message)
                } else if room < journal {
                    (Outcome::Undone, "…flight.mcap…: cannot …")
                } else if room >= after.len() {
                    (Outcome::Done, "")
                } else if room >= before.len() {
                    (Outcome::Undone, "flight.mcap: cannot write the log")
                } else {
                    (Outcome::Recovered, "flight.mcap: cannot write the log")
                };
                let outcome = run(&folder, limit, arguments, message);
                assert_eq!(outcome, expected, "{arguments} with {limit} blocks");
                if outcome == Outcome::Done {
                    assert!(folder.read_only_one(LOG) == after);
                }
            }
        }
    }
}

/// How long the journal of a change is.
fn journal_length(log: &[u8], change: Change) -> usize {
    let folder = Folder::with(LOG, log);
    interrupt(&folder, change, JournalStep::JournalDurable);
    folder.read(JOURNAL).len()
}

#[test]
fn a_log_that_cannot_be_rolled_back_for_lack_of_space_keeps_its_journal() {
    let ends = Ends::of(&with_zeros_at_the_end(), Change::Enrich);
    for arguments in ["inspect flight.mcap --depression 30", "restore flight.mcap"] {
        let folder = before_the_first_write(&ends, Change::Enrich);
        folder.add(LOG, &ends.before[..ends.start]);
        let journal = folder.read(JOURNAL);
        let (code, _, err) = folder.run_limited(10, arguments);
        assert_eq!(code, 1);
        assert_reads(
            &err,
            "error: flight.mcap: cannot bring the log back to what it was before an interrupted run: File too large",
        );
        assert!(folder.read(JOURNAL) == journal);
        folder.run(arguments, 0);
        assert!(folder.read_only_one(LOG) == ends.before);
    }
}

#[test]
fn a_stream_that_runs_out_of_space_is_an_error() {
    let folder = Folder::with_flight();
    let before = folder.contents();
    let (code, out, err) =
        folder.run_limited(100, "enrich flight.mcap --depression 30 -o - > result.mcap");
    assert_eq!((code, out.as_str()), (1, ""));
    assert_reads(
        &err,
        "error: standard output: cannot write the output: File too large",
    );
    fs::remove_file(folder.path("result.mcap")).expect("what the shell made");
    assert_eq!(folder.contents(), before);
}

/// Runs the program on disks of many sizes, up to a sufficient one, which hold only the log and what is made of it,
/// and then looks at what is there. Returns how many runs ran out of space.
fn on_small_disks(
    log: &[u8],
    arguments: &str,
    (output, result): (&str, &[u8]),
    sufficient: usize,
) -> Option<usize> {
    let folder = Folder::with(LOG, log);
    folder.add("disk/after/.keep", "");
    let (mut done, mut failed) = (0, 0);
    let (least, most) = (log.len() / 1024 + 4, sufficient / 1024);
    for kilobytes in (least..=most).step_by((most - least) / 10) {
        let script = format!(
            "mount -t tmpfs -o size={kilobytes}k tmpfs disk && cp {LOG} disk && cd disk && \
             {{ TMPDIR=. \"$flightcam\" {arguments}; code=$?; }} && rm -rf ../after && cp -a . ../after && exit $code"
        );
        let run = run_mounting(&folder, &script)?;
        let err = String::from_utf8_lossy(&run.stderr);
        let after = Folder::copy_of(&folder.path("after"));
        match run.status.code() {
            Some(0 | 3) => {
                done += 1;
                assert_eq!(err, "");
                assert!(after.read(output) == result);
            }
            Some(1) => {
                failed += 1;
                assert_reads(&err, "error: … flight.… No space left on device");
                assert!(after.read_only_one(LOG) == log, "{err}");
            }
            other => panic!("{other:?}: {err}"),
        }
    }
    assert!(
        done > 0,
        "{sufficient} bytes are not enough for {arguments}"
    );
    Some(failed)
}

#[test]
fn a_full_disk_loses_nothing() {
    let copied = "enrich flight.mcap --depression 30";
    let in_place = "enrich flight.mcap --depression 30 --in-place";
    let restore = "restore flight.mcap -o flight.original";
    let failed = logs().map(|[log, result]| {
        // Restoring takes the original's end in a temporary file and in the journal.
        let enough = 3 * (log.len() + result.len());
        Some([
            on_small_disks(&log, copied, (RESULT, &result), enough)?,
            on_small_disks(&log, in_place, (LOG, &result), enough)?,
            on_small_disks(&result, in_place, (LOG, &result), enough)?,
            on_small_disks(&result, "restore flight.mcap", (LOG, &log), enough)?,
            on_small_disks(&result, restore, ("flight.original", &log), enough)?,
        ])
    });
    if let [Some(of_short_end), Some(of_long_end)] = failed {
        println!("found no room: {of_short_end:?} and {of_long_end:?} of some 10 runs each");
        assert!(of_short_end.iter().all(|&failed| failed > 0));
        assert!(of_long_end[0] > 0 && of_long_end[3] > 0);
    }
}
