//! What is on the disk before what. Killing a run cannot show that; the order of its system calls does.
#![cfg(target_os = "linux")]

use std::{
    fs,
    process::{Command, Output},
};

use assert_cmd::cargo::cargo_bin;
use flightcam::writer::journal::JournalStep;

use crate::support::{folder::*, interrupted::*, shapes::*, *};

/// The system calls that change files; not every machine has all of them.
const CALLS: &str = "trace=flock,write,pwrite64,?copy_file_range,?sendfile,ftruncate,fsync,?unlink,unlinkat,\
                     ?rename,?renameat,renameat2,?link,linkat";

/// Runs the program under strace. `None`, with a message, where that is not possible.
fn run_traced(folder: &Folder, options: &[&str], arguments: &str) -> Option<Output> {
    let run = |options: &[&str], program: &[&str]| {
        let mut strace = Command::new("strace");
        strace.arg("-f").args(options).args(program);
        strace.current_dir(folder.path(".")).output()
    };
    let works = run(&["-o", "/dev/null"], &["true"]);
    if !works.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: this machine has no strace, or lets no test use it");
        return None;
    }
    let mut program = vec![cargo_bin!("flightcam").to_str().expect("a name")];
    program.extend(arguments.split(' '));
    Some(run(options, &program).expect("it runs"))
}

/// Runs the program and returns its calls that concern the folder, each with its file, without repetitions. `None`,
/// with a message, where strace is not available.
fn calls(folder: &Folder, arguments: &str) -> Option<Vec<String>> {
    let traced = tempfile::NamedTempFile::new().expect("a temporary file");
    let trace = traced.path().to_str().expect("a name");
    let run = run_traced(folder, &["-y", "-e", CALLS, "-o", trace], arguments)?;
    assert!(run.status.success());
    let place = folder.path("").canonicalize().expect("the folder");
    let place = place.to_str().expect("a name");
    let trace = fs::read_to_string(traced.path()).expect("the trace");
    let mut calls: Vec<String> = trace.lines().filter_map(|line| call(line, place)).collect();
    calls.dedup();
    Some(calls)
}

/// A line of a trace, as `write flight.mcap`.
fn call(line: &str, folder: &str) -> Option<String> {
    let (_, call) = line.split_once(' ')?;
    let (call, arguments) = call.trim_start().split_once('(')?;
    let call = match call {
        "write" | "pwrite64" | "copy_file_range" | "sendfile" => "write",
        "unlink" | "unlinkat" => "remove",
        "flock" | "fsync" | "ftruncate" => call,
        _ if call.starts_with("rename") || call.starts_with("link") => "rename",
        // The end of a call whose start was seen.
        _ => return None,
    };
    // Of two files the second is the one that is written.
    let (_, file) = arguments.rsplit_once(folder)?;
    let file = match file.trim_start_matches('/').split(['>', '"']).next()? {
        "" => "the folder",
        file if file.starts_with('#') => "a file without a name",
        file if file.ends_with(".flightcam-part") => "a hidden file",
        file => file,
    };
    Some(format!("{call} {file}"))
}

const CHANGE: [&str; 11] = [
    "flock flight.mcap",
    "write a file without a name",
    "fsync a file without a name",
    "rename flight.mcap.flightcam-journal",
    "fsync the folder",
    "write flight.mcap",
    "ftruncate flight.mcap",
    "fsync flight.mcap",
    "remove flight.mcap.flightcam-journal",
    "fsync the folder",
    "flock flight.mcap",
];

#[test]
fn the_journal_is_durable_before_the_log_changes_and_kept_until_the_change_is() {
    let folder = Folder::with_flight();
    for arguments in [
        "enrich flight.mcap --depression 30 --in-place",
        "enrich flight.mcap --depression 60 --in-place",
        "restore flight.mcap",
    ] {
        let Some(calls) = calls(&folder, arguments) else {
            return;
        };
        assert_eq!(calls, CHANGE, "{arguments}");
    }
}

#[test]
fn a_rolled_back_log_is_durable_before_its_journal_is_removed() {
    let folder = Folder::with_flight();
    interrupt(&folder, Change::Enrich, JournalStep::JournalDurable);
    if let Some(calls) = calls(&folder, "inspect flight.mcap --depression 30") {
        assert_eq!(calls, [&CHANGE[..1], &CHANGE[5..]].concat());
    }
}

#[test]
fn a_new_file_is_durable_before_it_gets_its_name() {
    let folder = Folder::with_flight();
    for arguments in [
        "enrich flight.mcap --depression 30",
        "enrich flight.mcap --depression 60 --force",
        "restore flight.enriched.mcap -o original.mcap",
    ] {
        let Some(calls) = calls(&folder, arguments) else {
            return;
        };
        let mut expected = vec![
            "write a file without a name",
            "fsync a file without a name",
            "rename the folder",
            "fsync the folder",
        ];
        if arguments.contains("--force") {
            // The name is taken, so the file gets it by way of another one.
            expected.splice(3..3, ["rename a hidden file", "rename the folder"]);
        }
        let written = calls.iter().filter(|call| !call.starts_with("flock"));
        assert!(written.eq(&expected), "{arguments}: {calls:#?}");
    }
}

/// The calls of a change in place that may fail, and how many there are of each.
const FALLIBLE: [(&str, usize); 6] = [
    ("write", 1),
    ("pwrite64", 5),
    ("fsync", 4),
    ("ftruncate", 1),
    ("linkat", 1),
    ("?unlink,unlinkat", 1),
];

#[test]
fn a_disk_error_leaves_the_log_unchanged_or_fully_changed() {
    let log = Shape::default().write();
    let (enriched, _) = enrich_bytes(&log).expect("a result");
    for (before, after, arguments) in [
        (
            &log,
            &enriched,
            "enrich flight.mcap --depression 30 --in-place --quiet",
        ),
        (&enriched, &log, "restore flight.mcap --quiet"),
    ] {
        for (call, times) in FALLIBLE {
            for time in 1..=times {
                let folder = Folder::with(LOG, before);
                let fault = format!("inject={call}:error=EIO:when={time}");
                let options = ["-o", "/dev/null", "-e", &fault];
                let Some(run) = run_traced(&folder, &options, arguments) else {
                    return;
                };
                let err = String::from_utf8_lossy(&run.stderr);
                let expected = match run.status.code() {
                    Some(0) => after,
                    Some(1) if err.contains("Input/output error") => before,
                    code => panic!("{arguments}: {call} {time}: {code:?}: {err}"),
                };
                assert!(
                    folder.read_only_one(LOG) == *expected,
                    "{arguments}: {call} {time}: {err}"
                );
            }
        }
    }
}
