//! Where a result may go: what a path names is replaced only if it is a regular file, and only on demand.
#![cfg(unix)]

use std::{
    fs,
    ops::ControlFlow,
    os::unix::{
        fs::{FileTypeExt, symlink},
        net::UnixListener,
    },
    path::{Path, PathBuf},
    process::Command,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::SeqCst},
    },
    thread,
    time::Duration,
};

use assert_cmd::cargo::cargo_bin;
use flightcam::{Error, enrich, error::WriteError};
use mcap::records::op;

use crate::support::{folder::*, *};

const ENRICH: &str = "enrich flight.mcap --depression 30 --quiet -o";

fn log_and_result() -> (Vec<u8>, Vec<u8>) {
    let log = mixed_log();
    let (result, _) = enrich_bytes(&log).expect("a result");
    (log, result)
}

/// A folder with an enriched log under the name `result.mcap`, too.
fn folder() -> Folder {
    let (log, result) = log_and_result();
    let folder = Folder::with(LOG, log);
    folder.add("result.mcap", result);
    folder
}

/// Runs a tool that makes something special in a folder. `None`, with a message, if that is not allowed.
fn make(folder: &Folder, tool: &str) -> Option<PathBuf> {
    let mut words = tool.split(' ');
    let mut command = Command::new(words.next().expect("a tool"));
    let made = command.args(words).current_dir(folder.path("")).status();
    if !made.is_ok_and(|status| status.success()) {
        eprintln!("skipped: `{tool}` does not work here");
        return None;
    }
    let name = tool.split(' ').nth(1).expect("a name");
    Some(folder.path(name))
}

#[test]
fn a_named_pipe_is_written_to_and_stays_one() {
    let (log, result) = log_and_result();
    let folder = folder();
    let Some(pipe) = make(&folder, "mkfifo pipe") else {
        return;
    };
    for (arguments, expected) in [
        (format!("{ENRICH} pipe"), &result),
        (format!("{ENRICH} pipe --force"), &result),
        (
            "restore result.mcap --quiet -o pipe --force".to_owned(),
            &log,
        ),
    ] {
        let reader = {
            let pipe = pipe.clone();
            thread::spawn(move || fs::read(pipe).expect("it is read"))
        };
        folder.run(&arguments, 0);
        assert!(
            reader.join().expect("what came") == *expected,
            "{arguments}"
        );
        assert!(fs::metadata(&pipe).expect("the pipe").file_type().is_fifo());
    }
}

#[test]
fn a_device_is_written_to_and_stays_one() {
    let folder = folder();
    // Those of the system are not put at risk.
    let devices = [("null", "mknod null c 1 3"), ("full", "mknod full c 1 7")];
    for (name, tool) in devices {
        let Some(device) = make(&folder, tool) else {
            return;
        };
        symlink(name, folder.path("link")).expect("a link");
        for output in [name, "link"] {
            for command in [ENRICH, "restore result.mcap --quiet -o"] {
                for force in ["", " --force"] {
                    let arguments = format!("{command} {output}{force}");
                    let (_, err) = folder.run(&arguments, i32::from(name == "full"));
                    assert_eq!(err.contains("No space left"), name == "full", "{err}");
                    let kind = fs::symlink_metadata(&device)
                        .expect("the device")
                        .file_type();
                    assert!(kind.is_char_device(), "{arguments}");
                }
            }
        }
        assert!(
            fs::symlink_metadata(folder.path("link"))
                .expect("the link")
                .is_symlink()
        );
        fs::remove_file(folder.path("link")).expect("removed");
    }
}

#[test]
fn a_block_device_and_a_socket_are_refused() {
    let folder = folder();
    let _socket = UnixListener::bind(folder.path("socket")).expect("a socket");
    let is_socket = |name| {
        fs::metadata(folder.path(name))
            .expect("it")
            .file_type()
            .is_socket()
    };
    let mut cases = vec![("socket", "a socket")];
    if make(&folder, "mknod disk b 7 200").is_some() {
        cases.push(("disk", "a block device"));
    }
    for (name, kind) in cases {
        let message = format!(
            "error: {name}: is {kind}, to which no log can be written\nhint: choose another output"
        );
        for force in ["", " --force"] {
            let (out, err) = folder.run(&format!("{ENRICH} {name}{force}"), 1);
            assert_eq!(out, "");
            assert_reads(&err, &format!("{message}…"));
            assert!(is_socket(name) || name == "disk");
            let metadata = fs::metadata(folder.path(name)).expect("it is there");
            assert!(!metadata.is_file());
        }
    }
}

/// Runs a shell script in a folder; `$0` is the program. Returns the exit code and standard error.
fn shell(folder: &Folder, script: &str) -> (Option<i32>, String) {
    let mut shell = Command::new("sh");
    shell.args(["-c", script]).arg(cargo_bin!("flightcam"));
    let output = shell
        .current_dir(folder.path(""))
        .output()
        .expect("a shell");
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

#[test]
fn the_systems_name_of_an_open_file_is_refused() {
    if !Path::new("/proc/self/fd").exists() {
        eprintln!("skipped: there is no /proc");
        return;
    }
    let folder = folder();
    folder.add("notes.txt", "of the flight");
    for redirection in [">> notes.txt", "< notes.txt", "1<> notes.txt"] {
        for name in ["/proc/self/fd/1", "/proc/self/fd/0"] {
            if redirection.starts_with('<') == name.ends_with('0') {
                for force in ["", " --force"] {
                    let (code, err) = shell(
                        &folder,
                        &format!("\"$0\" {ENRICH} {name}{force} {redirection}"),
                    );
                    assert_eq!(code, Some(1), "{err}");
                    let message =
                        "is another name of an open file … write to standard output with -o -";
                    assert_reads(&err, &format!("error: {name}: {message}…"));
                    assert_eq!(folder.read("notes.txt"), b"of the flight");
                }
            }
        }
    }
}

#[test]
fn a_log_is_not_written_into_itself() {
    let folder = folder();
    let before = folder.contents();
    for script in [
        format!("\"$0\" {ENRICH} - >> {LOG}"),
        format!("\"$0\" {ENRICH} - 1<> {LOG}"),
        "\"$0\" restore result.mcap --quiet -o - 1<> result.mcap".to_owned(),
        format!("\"$0\" enrich - --depression 30 -o - < {LOG} >> {LOG}"),
    ] {
        let (code, err) = shell(&folder, &script);
        assert_eq!(code, Some(2), "{script}: {err}");
        assert_eq!(folder.contents(), before, "{script}");
    }
}

#[test]
fn a_journal_is_no_output() {
    let folder = folder();
    let journal = "other.mcap.flightcam-journal";
    let message = format!("{journal}: has the name of a journal … choose another output");
    for force in ["", " --force"] {
        folder.refuses(&format!("{ENRICH} {journal}{force}"), 1, &message);
        symlink("nowhere", folder.path(journal)).expect("a link");
        let (_, err) = folder.run(&format!("{ENRICH} other.mcap{force}"), 1);
        assert_reads(&err, &format!("error: other.mcap: {journal} beside it…"));
        fs::remove_file(folder.path(journal)).expect("removed");
    }
}

#[test]
fn a_link_is_replaced_on_demand_and_what_it_leads_to_stays() {
    let (_, result) = log_and_result();
    for target in ["notes.txt", "nowhere"] {
        let folder = folder();
        folder.add("notes.txt", "of the flight");
        symlink(target, folder.path("link.mcap")).expect("a link");
        let (_, err) = folder.run(&format!("{ENRICH} link.mcap"), 1);
        assert_reads(&err, "error: link.mcap: exists already…");
        assert_eq!(
            fs::read_link(folder.path("link.mcap")).expect("a link"),
            PathBuf::from(target)
        );
        folder.run(&format!("{ENRICH} link.mcap --force"), 0);
        let kind = fs::symlink_metadata(folder.path("link.mcap")).expect("the result");
        assert!(kind.is_file());
        assert!(folder.read("link.mcap") == result);
        assert_eq!(folder.read("notes.txt"), b"of the flight");
        assert!(!folder.path("nowhere").exists());
    }
}

#[test]
fn a_regular_file_is_replaced_on_demand_only() {
    let (log, result) = log_and_result();
    let folder = folder();
    folder.add("other.mcap", "of another flight");
    folder.refuses(
        &format!("{ENRICH} other.mcap"),
        1,
        "other.mcap: exists already",
    );
    folder.run(&format!("{ENRICH} other.mcap --force"), 0);
    assert!(folder.read("other.mcap") == result);
    folder.refuses(
        "restore result.mcap -o other.mcap",
        1,
        "other.mcap: exists already",
    );
    folder.run("restore result.mcap -o other.mcap --force --quiet", 0);
    assert!(folder.read("other.mcap") == log);
    let names: Vec<_> = folder.contents().into_keys().collect();
    assert_eq!(names.len(), 3, "{names:?}");
}

#[test]
fn a_file_that_appears_during_the_run_is_not_replaced() {
    let folder = folder();
    let path = folder.path("other.mcap");
    let appears = path.clone();
    let options = options().watch(move |_| {
        fs::write(&appears, "of another program").expect("written");
        ControlFlow::Continue(())
    });
    let error = enrich(folder.path(LOG), &path, &options).expect_err("it is there");
    let exists = matches!(error, Error::Write(WriteError::OutputExists { .. }));
    assert!(exists, "{error}");
    assert_eq!(folder.read("other.mcap"), b"of another program");
}

/// A log so long that copying it is watched several times.
fn long_log() -> Vec<u8> {
    let mut parts = Parts::of(&mixed_log());
    parts.summary.clear();
    parts.data_section_crc = 0;
    let content = vec![7; 40 << 20];
    let mut attachment = vec![0; 8 + 8 + 4 + 4];
    attachment.extend((content.len() as u64).to_le_bytes());
    attachment.extend(&content);
    attachment.extend([0; 4]);
    parts.data.push((op::ATTACHMENT, attachment));
    parts.join()
}

#[test]
fn a_new_file_has_no_name_before_all_of_the_log_is_copied() {
    let folder = Folder::with(LOG, long_log());
    let path = folder.path("other.mcap");
    let (named, is_held_up) = (path.clone(), AtomicBool::new(false));
    let is_named_early = Arc::new(AtomicBool::new(false));
    let noted = Arc::clone(&is_named_early);
    let options = options().watch(move |progress| {
        // The first to have done so much is usually the copy, which is held up, so that all else is done first.
        if progress.done >= 16 << 20 && !is_held_up.swap(true, SeqCst) {
            for _ in 0..50 {
                thread::sleep(Duration::from_millis(10));
                noted.fetch_or(named.exists(), SeqCst);
            }
        }
        ControlFlow::Continue(())
    });
    enrich(folder.path(LOG), &path, &options).expect("a result");
    assert!(!is_named_early.load(SeqCst));
}
