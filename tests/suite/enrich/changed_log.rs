//! Logs that another program writes to while they are read.

use std::{
    fs::{self, File, OpenOptions},
    io::{Read, Write},
    ops::ControlFlow,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::Duration,
};

use assert_cmd::cargo::cargo_bin;
use flightcam::{
    Error, Note, Output, Watch,
    enrich::{derive, enrich},
    error::{JournalError, ReadError},
    report::Report,
    restore::restore,
    run::Input,
    watch::Progress,
    writer::{Layout, journal::JournalStep},
};
use serde_json::Value;

use crate::support::{folder::*, *};

const ADDED: &[u8] = b"what a recorder adds";

/// The demonstration flight, while it is being recorded.
fn beginning() -> Vec<u8> {
    let flight = fs::read(repository("fixtures/survey_flight.mcap")).expect("the flight");
    flight[..flight.len() / 2].to_vec()
}

fn flight() -> Vec<u8> {
    fs::read(repository("fixtures/survey_flight.mcap")).expect("the flight")
}

// ---- What the other program does ----

type Change = fn(&Path);

fn grow(log: &Path) {
    let file = OpenOptions::new().append(true).open(log);
    file.expect("the log").write_all(ADDED).expect("written");
}

fn shorten(log: &Path) {
    let file = OpenOptions::new().write(true).open(log).expect("the log");
    let length = file.metadata().expect("its length").len();
    file.set_len(length - 1000).expect("shortened");
}

/// Writes the same again, some time later. The log is whole all the time, or the run could fail because of that.
fn rewrite(log: &Path) {
    let content = fs::read(log).expect("the log");
    let mut file = File::options().write(true).open(log).expect("the log");
    file.write_all(&content).expect("written");
    drop(file);
    touch(log);
}

fn touch(log: &Path) {
    let file = File::options().write(true).open(log).expect("the log");
    let modified = file.metadata().expect("metadata").modified();
    let later = modified.expect("a time") + Duration::from_secs(10);
    file.set_modified(later).expect("another time");
}

/// Puts another file in the log's place.
fn replace(log: &Path) {
    let other = log.with_file_name("other");
    fs::write(&other, ADDED).expect("written");
    fs::rename(other, log).expect("renamed");
}

/// A watcher that makes the change as soon as there is something to do, which is known when the log has been opened.
fn at_first(
    log: PathBuf,
    change: Change,
) -> impl Fn(Progress) -> ControlFlow<()> + Send + Sync + 'static {
    let is_done = AtomicBool::new(false);
    move |progress| {
        if progress.total > 0 && !is_done.swap(true, Ordering::SeqCst) {
            change(&log);
        }
        ControlFlow::Continue(())
    }
}

// ---- How a run reads a log ----

/// A run over a log; returns what it wrote, whether it read everything, and its notes.
type Reading = fn(&Folder, Watched) -> Result<(Vec<u8>, bool, Vec<Note>), Error>;
type Watched = Box<dyn Fn(Progress) -> ControlFlow<()> + Send + Sync>;

fn reported(result: Vec<u8>, report: Report) -> (Vec<u8>, bool, Vec<Note>) {
    (result, report.complete, report.notes)
}

fn to_new_file(folder: &Folder, watch: Watched) -> Result<(Vec<u8>, bool, Vec<Note>), Error> {
    let options = options().watch(watch);
    let report = enrich(folder.path(LOG), folder.path(RESULT), &options)?;
    Ok(reported(folder.read(RESULT), report))
}

fn interleaved(folder: &Folder, watch: Watched) -> Result<(Vec<u8>, bool, Vec<Note>), Error> {
    let options = options().layout(Layout::Interleaved).watch(watch);
    let report = enrich(folder.path(LOG), folder.path(RESULT), &options)?;
    Ok(reported(folder.read(RESULT), report))
}

fn to_stream(folder: &Folder, watch: Watched) -> Result<(Vec<u8>, bool, Vec<Note>), Error> {
    let mut result = Vec::new();
    let output = Output::stream("stream", &mut result);
    let report = enrich(folder.path(LOG), output, &options().watch(watch))?;
    Ok(reported(result, report))
}

fn values(folder: &Folder, watch: Watched) -> Result<(Vec<u8>, bool, Vec<Note>), Error> {
    let mut values = String::new();
    let report = derive(folder.path(LOG), &options().watch(watch), |batch| {
        values += &format!("{batch:?}");
        ControlFlow::Continue(())
    })?;
    let report = report.expect("its end");
    Ok((values.into_bytes(), report.complete, report.notes))
}

/// The original of an enriched log.
fn restored(folder: &Folder, watch: Watched) -> Result<(Vec<u8>, bool, Vec<Note>), Error> {
    let output = folder.path(RESULT);
    let restored = restore(folder.path(LOG), &output, &Watch::new(watch))?;
    let is_complete = restored.notes.is_empty();
    Ok((folder.read(RESULT), is_complete, restored.notes))
}

/// Each with a log for it.
fn readings() -> Vec<(&'static str, Reading, Vec<u8>)> {
    let (enriched, _) = enrich_bytes(&flight()).expect("a result");
    vec![
        ("to a new file", to_new_file, flight()),
        ("to a new file", to_new_file, beginning()),
        ("interleaved", interleaved, flight()),
        ("to a stream", to_stream, beginning()),
        ("values", values, flight()),
        ("restored", restored, enriched),
    ]
}

fn unwatched() -> Watched {
    Box::new(|_| ControlFlow::Continue(()))
}

#[test]
fn a_log_that_grows_gives_what_was_there_at_the_start_and_that_is_said() {
    for (name, read, log) in readings() {
        let undisturbed = read(&Folder::with(LOG, &log), unwatched()).expect("a result");
        let folder = Folder::with(LOG, &log);
        let watch = Box::new(at_first(folder.path(LOG), grow));
        let (result, is_complete, mut notes) = read(&folder, watch).expect("a result");
        assert!(result == undisturbed.0, "{name}: the result is another");
        assert!(!is_complete, "{name}");
        let added_bytes = ADDED.len() as u64;
        let grew = |note: &Note| *note == Note::Grew { added_bytes };
        let place = notes.iter().position(grew);
        notes.remove(place.unwrap_or_else(|| panic!("{name}: {notes:?}")));
        assert_eq!(notes, undisturbed.2, "{name}");
        assert!(folder.read(LOG) == [&log, ADDED].concat(), "{name}");
    }
}

#[test]
fn a_log_that_is_changed_or_becomes_shorter_gives_no_result() {
    for (change, is_expected) in [
        (
            shorten as Change,
            (|error| matches!(error, Error::Read(ReadError::BecameShorter { .. })))
                as fn(&Error) -> bool,
        ),
        (rewrite, |error| {
            matches!(error, Error::Read(ReadError::Changed { .. }))
        }),
        (touch, |error| {
            matches!(error, Error::Read(ReadError::Changed { .. }))
        }),
    ] {
        for (name, read, log) in readings() {
            let folder = Folder::with(LOG, &log);
            let watch = Box::new(at_first(folder.path(LOG), change));
            let error = read(&folder, watch).expect_err("an error");
            assert!(is_expected(&error), "{name}: {error}");
            folder.read_only_one(LOG);
        }
    }
}

#[test]
fn a_log_that_grows_ends_the_program_with_code_3() {
    let folder = Folder::with(LOG, flight());
    let undisturbed = to_stream(&folder, unwatched()).expect("a result");
    for arguments in [&[][..], &["--json"], &["--quiet"]] {
        let mut command = Command::new(cargo_bin!("flightcam"));
        command.args(["enrich", LOG, "-o", "-", "--depression", "30"]);
        command.args(arguments).current_dir(folder.path(""));
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut program = command.spawn().expect("it runs");
        let mut out = program.stdout.take().expect("a pipe");
        // The log is open once its first byte comes, and longer than a pipe holds.
        let mut result = vec![0];
        out.read_exact(&mut result).expect("a byte");
        grow(&folder.path(LOG));
        out.read_to_end(&mut result).expect("the rest");
        assert!(result == undisturbed.0, "what was added was copied");
        let output = program.wait_with_output().expect("its end");
        let said = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(3), "{said}");
        let words =
            "another program is still writing the log: it grew by 20 bytes while it was read";
        assert_reads(&said, words);
        if arguments == ["--json"] {
            assert_reads(
                &said,
                r#""complete": false … "kind": "grew" … "added_bytes": 20"#,
            );
        }
        fs::write(folder.path(LOG), flight()).expect("the log again");
    }
}

#[test]
fn inspect_says_that_a_log_grows() {
    /// More than enough, because the log grows all the time.
    const TRIES: usize = 50;
    let folder = Folder::with(LOG, flight());
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(Ordering::SeqCst) {
                grow(&folder.path(LOG));
            }
        });
        let inspected = (0..TRIES).find_map(|_| {
            let mut command = Command::new(cargo_bin!("flightcam"));
            command.args(["inspect", LOG, "--json"]);
            let output = command.current_dir(folder.path("")).output().expect("it");
            (output.status.code() == Some(3)).then_some(output.stdout)
        });
        is_over.store(true, Ordering::SeqCst);
        let json: Value =
            serde_json::from_slice(&inspected.expect("one that says so")).expect("JSON");
        let notes = json["notes"].as_array().expect("notes");
        let grew = notes.iter().find(|note| note["kind"] == "grew");
        assert!(
            grew.expect("one")["added_bytes"]
                .as_u64()
                .expect("a number")
                > 0
        );
        assert!(json["problem"].is_null());
    });
}

#[test]
fn a_log_that_was_written_to_since_it_was_opened_is_not_changed_in_place() {
    let changes: [(&str, Change); 5] = [
        ("grew", grow),
        ("shorter", shorten),
        ("rewritten", rewrite),
        ("touched", touch),
        ("replaced", replace),
    ];
    let steps = [
        JournalStep::JournalWritten,
        JournalStep::JournalNamed,
        JournalStep::JournalDurable,
    ];
    for (name, change) in changes {
        for at in steps {
            let folder = Folder::with(LOG, flight());
            let path = folder.path(LOG);
            let options = options().on_step(move |step| {
                assert!(steps.contains(&step), "{step:?}");
                if step == at {
                    change(&path);
                }
            });
            let error = enrich(folder.path(LOG), Output::InPlace, &options).expect_err("an error");
            let is_changed = matches!(error, Error::Journal(JournalError::Changed { .. }));
            assert!(is_changed, "{name}: {error}");
            let expected = Folder::with(LOG, flight());
            change(&expected.path(LOG));
            assert!(folder.read_only_one(LOG) == expected.read(LOG), "{name}");
        }
    }
}

#[test]
fn what_is_no_file_is_not_said_to_change() {
    let mut result = Vec::new();
    let output = Output::stream("stream", &mut result);
    let input = Input::bytes("bytes", flight());
    let report = enrich(input, output, &options()).expect("a result");
    assert!(report.complete);
}
