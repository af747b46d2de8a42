//! What is on the disk before what: no kill shows that, only the order of system calls does.
#![cfg(target_os = "linux")]

mod common;

use std::{fs, process::Command};

use assert_cmd::cargo::cargo_bin;
use common::folder::*;
use flightcam::log::{
    Log,
    file::{Access, LogFile},
    journal::Journal,
};

/// The system calls by which files come to be what they are; not every machine has all of them.
const CALLS: &str = "trace=flock,write,pwrite64,?copy_file_range,?sendfile,ftruncate,fsync,?unlink,unlinkat,\
                     ?rename,?renameat,renameat2,?link,linkat";

/// Runs the program and gives its calls that concern the folder, each with the file that it is for. Those that
/// follow one of the same kind are left out. `None`, with a word on why, where no calls can be had.
fn calls(folder: &Folder, arguments: &str) -> Option<Vec<String>> {
    let traced = tempfile::NamedTempFile::new().expect("a temporary file");
    let mut strace = Command::new("strace");
    strace
        .args(["-f", "-y", "-e", CALLS, "-o"])
        .arg(traced.path());
    strace
        .arg(cargo_bin!("flightcam"))
        .args(arguments.split(' '));
    let output = strace.current_dir(folder.path(".")).output();
    if !output.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: this machine has no strace, or lets no test use it");
        return None;
    }
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
        // The end of a call whose beginning was seen.
        _ => return None,
    };
    // Of two files the second is what is written.
    let (_, file) = arguments.rsplit_once(folder)?;
    let file = match file.trim_start_matches('/').split(['>', '"']).next()? {
        "" => "the folder",
        file if file.ends_with(".part") => "a hidden file",
        file => file,
    };
    Some(format!("{call} {file}"))
}

const CHANGE: [&str; 10] = [
    "flock flight.mcap",
    "write flight.mcap.flightcam-journal",
    "fsync flight.mcap.flightcam-journal",
    "fsync the folder",
    "write flight.mcap",
    "ftruncate flight.mcap",
    "fsync flight.mcap",
    "remove flight.mcap.flightcam-journal",
    "fsync the folder",
    "flock flight.mcap",
];

#[test]
fn the_old_end_is_on_the_disk_before_it_is_overwritten_and_until_the_new_one_is() {
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
fn a_log_that_was_brought_back_is_on_the_disk_before_the_journal_is_removed() {
    let folder = Folder::with_flight();
    let file = LogFile::open(&folder.path(LOG), Access::Change).expect("it is opened");
    let log = Log::read(file).expect("a log");
    Journal::begin(&log.file, log.data_end, &mut |_| {}).expect("a journal");
    drop(log);
    if let Some(calls) = calls(&folder, "inspect flight.mcap --depression 30") {
        assert_eq!(calls, [&CHANGE[..1], &CHANGE[4..]].concat());
    }
}

#[test]
fn a_new_file_is_on_the_disk_before_it_has_its_name() {
    let folder = Folder::with_flight();
    for arguments in [
        "enrich flight.mcap --depression 30",
        "enrich flight.mcap --depression 60 --force",
        "restore flight.enriched.mcap -o original.mcap",
    ] {
        let Some(calls) = calls(&folder, arguments) else {
            return;
        };
        let expected = [
            "write a hidden file",
            "fsync a hidden file",
            "rename the folder",
            "fsync the folder",
        ];
        let written = calls.iter().filter(|call| !call.starts_with("flock"));
        assert!(written.eq(&expected), "{arguments}: {calls:#?}");
    }
}
