//! A log is changed in its own file: by one run at a time, completely or not at all, wherever the file is.

use std::{
    iter,
    ops::ControlFlow,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering::Relaxed},
        mpsc,
    },
};

use flightcam::{
    Error, Output, Progress, Watch, enrich,
    log::{Access, file::LogFile},
    restore,
    writer::journal::JournalStep,
};

use crate::support::{folder::*, shapes::*, *};

/// All that may be done to a log while another program has it.
const COMMANDS: [&str; 5] = [
    "inspect flight.mcap",
    "enrich flight.mcap --depression 30",
    "enrich flight.mcap --depression 30 --in-place",
    "restore flight.mcap",
    "restore flight.mcap -o original.mcap",
];

const LOCKED: &str =
    "flight.mcap: another run of flightcam is using it … try again when that has ended";

#[test]
fn a_log_that_is_being_changed_is_refused_to_other_runs() {
    let folder = Arc::new(Folder::with(LOG, Shape::default().write()));
    let path = folder.path(LOG);
    let (saw, steps) = mpsc::channel();
    let meanwhile = {
        let folder = Arc::clone(&folder);
        move |step| {
            saw.send(step).expect("they are compared below");
            for command in COMMANDS {
                folder.refuses(command, 1, LOCKED);
            }
        }
    };
    let enrich_at = |degrees| {
        let options = options_at(degrees).on_step(meanwhile.clone());
        enrich(&path, Output::InPlace, &options).expect("a result");
    };
    enrich_at(30.0);
    enrich_at(60.0);
    let watch = Watch::default().on_step(meanwhile);
    restore(&path, Output::InPlace, &watch).expect("the original");
    let steps: Vec<JournalStep> = steps.try_iter().collect();
    assert_eq!(steps, JournalStep::ALL.repeat(3));
    folder.writes(RESULT, COMMANDS[1], 0);
}

#[test]
fn a_log_is_not_changed_while_it_is_read() {
    let (enriched, _) = enrich_bytes(&Shape::default().write()).expect("a result");
    let folder = Folder::with(LOG, enriched);
    let reading = LogFile::open(&folder.path(LOG), Access::Read).expect("it is opened");
    for changing in [
        "enrich flight.mcap --depression 30 --in-place",
        "restore flight.mcap",
    ] {
        folder.refuses(changing, 1, LOCKED);
    }
    folder.run("inspect flight.mcap --depression 30", 0);
    folder.writes(RESULT, "enrich flight.mcap --depression 30", 0);
    drop(reading);
    folder.writes(LOG, "restore flight.mcap", 0);
}

#[test]
fn a_log_is_unlocked_as_soon_as_its_run_has_ended() {
    let folder = Folder::with(LOG, Shape::default().write());
    for access in [Access::Read, Access::Change] {
        let file = LogFile::open(&folder.path(LOG), access).expect("it is opened");
        // Another thread's new process may have it open for a moment.
        let inherited = file
            .as_file()
            .expect("a file")
            .try_clone()
            .expect("a handle");
        drop(file);
        LogFile::open(&folder.path(LOG), Access::Change).expect("it is free");
        drop(inherited);
    }
}

/// What watches a run.
type Watching = Box<dyn Fn(Progress) -> ControlFlow<()> + Send + Sync>;

/// Ends a run on a log at each moment at which it can be ended, until it comes to its own end.
#[track_caller]
fn end_at_every_moment(log: &[u8], run: impl Fn(&Path, Watching) -> Result<(), Error>) -> Vec<u8> {
    for moment in iter::successors(Some(0), |moment| Some(2 * moment + 1)) {
        let folder = Folder::with(LOG, log);
        let passed = AtomicU32::new(0);
        let watch = move |_| match passed.fetch_add(1, Relaxed) >= moment {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let result = run(&folder.path(LOG), Box::new(watch));
        match result {
            Ok(()) => {
                assert!(moment > 0);
                return folder.read_only_one(LOG);
            }
            Err(error) => {
                assert_reads(
                    &error.to_string(),
                    "flight.mcap: interrupted; the log is as it was",
                );
                assert!(folder.read_only_one(LOG) == log, "at moment {moment}");
            }
        }
    }
    unreachable!("the run never ends")
}

#[test]
fn a_run_that_is_interrupted_leaves_the_log_as_it_was() {
    for log in [long_log(), with_zeros_at_the_end()] {
        let enriched = end_at_every_moment(&log, |log, watch| {
            enrich(log, Output::InPlace, &options().watch(watch)).map(drop)
        });
        let other = end_at_every_moment(&enriched, |log, watch| {
            enrich(log, Output::InPlace, &options_at(60.0).watch(watch)).map(drop)
        });
        let original = end_at_every_moment(&other, |log, watch| {
            restore(log, Output::InPlace, &Watch::new(watch)).map(drop)
        });
        assert!(original == log);
    }
}

#[cfg(unix)]
mod on_unix {
    use std::{
        fs,
        os::unix::fs::{MetadataExt, symlink},
        panic::{self, AssertUnwindSafe},
        process::{Child, Command, Output, Stdio},
        thread,
        time::Duration,
    };

    use super::*;
    use crate::support::{interrupted::JOURNAL, small_disk::run_mounting};
    use assert_cmd::cargo::cargo_bin;

    /// A log with which the program is busy for a while.
    fn folder_with_long_log() -> (Folder, Vec<u8>) {
        let shape = Shape::with(|options| options.chunk_size(Some(1024 * 1024)));
        let log = Shape {
            messages: 40_000,
            ..shape
        }
        .write();
        (Folder::with(LOG, &log), log)
    }

    /// Starts the program and waits until it has a new file in the folder, which has no name yet.
    fn start(folder: &Folder, arguments: &str) -> Child {
        let mut program = Command::new(cargo_bin!("flightcam"));
        program
            .args(arguments.split(' '))
            .current_dir(folder.path("."));
        program.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut program = program.spawn().expect("the program");
        let open = format!("/proc/{}/fd", program.id());
        let is_new = |entry: fs::DirEntry| {
            let file = fs::read_link(entry.path()).unwrap_or_default();
            file.to_string_lossy().contains("/#")
        };
        while !(fs::read_dir(&open).into_iter().flatten().flatten()).any(is_new) {
            let ended = program.try_wait().expect("it can be asked");
            assert_eq!(ended, None, "it is busy for long enough");
            thread::sleep(Duration::from_millis(1));
        }
        program
    }

    fn signal(program: &Child, signals: &[&str]) {
        for signal in signals {
            let mut kill = Command::new("kill");
            kill.args([format!("-{signal}"), program.id().to_string()]);
            assert!(kill.status().expect("it is sent").success());
        }
    }

    fn ended(program: Child) -> (Option<i32>, String) {
        let Output { status, stderr, .. } = program.wait_with_output().expect("it ends");
        (status.code(), String::from_utf8(stderr).expect("words"))
    }

    #[test]
    fn a_signal_ends_the_program_with_everything_as_it_was() {
        let (folder, log) = folder_with_long_log();
        let (enrich, in_place) = (
            "enrich flight.mcap --depression 30",
            "enrich flight.mcap --depression 30 --in-place",
        );
        for by in ["INT", "TERM"] {
            for (arguments, message) in [
                (
                    enrich,
                    "flight.enriched.mcap: interrupted; nothing was written",
                ),
                (in_place, "flight.mcap: interrupted; the log is as it was"),
            ] {
                let program = start(&folder, arguments);
                signal(&program, &[by]);
                let (code, err) = ended(program);
                assert_eq!((code, err), (Some(1), format!("error: {message}\n")));
                assert!(
                    folder.read_only_one(LOG) == log,
                    "{arguments} ended by {by}"
                );
            }
        }
    }

    #[test]
    fn a_second_signal_ends_the_program_at_once() {
        let (folder, log) = folder_with_long_log();
        let says_nothing = |_| {
            let program = start(&folder, "enrich flight.mcap --depression 30 --in-place");
            // Stopped meanwhile, so that both come before it can do anything about the first.
            signal(&program, &["STOP", "INT", "TERM", "CONT"]);
            let (code, words) = ended(program);
            assert_eq!(code, Some(1));
            assert!(folder.read_only_one(LOG) == log);
            words.is_empty()
        };
        // Another of its threads may see the first before the second is delivered, but not each time.
        assert!((0..10).any(says_nothing));
    }

    #[test]
    fn a_symbolic_link_stays_a_link_to_the_result() {
        let log = Shape::default().write();
        let (enriched, _) = enrich_bytes(&log).expect("a result");
        let folder = Arc::new(Folder::with("logs/flight.mcap", &log));
        symlink("logs/flight.mcap", folder.path("link.mcap")).expect("a link");
        let (saw, journals) = mpsc::channel();
        let meanwhile = Arc::clone(&folder);
        let options = options().on_step(move |_| {
            let journal = meanwhile.path("logs").join(JOURNAL);
            saw.send(journal.exists()).expect("it is read below");
            meanwhile.refuses(
                "restore logs/flight.mcap",
                1,
                "logs/flight.mcap: another run",
            );
        });
        enrich(
            folder.path("link.mcap"),
            flightcam::Output::InPlace,
            &options,
        )
        .expect("a result");
        assert!(
            journals.try_iter().any(|exists| exists),
            "the journal lies beside the file itself"
        );
        assert!(folder.read("logs/flight.mcap") == enriched);
        assert!(
            fs::symlink_metadata(folder.path("link.mcap"))
                .expect("the link")
                .is_symlink()
        );

        // A change interrupted under one name is rolled back under the other.
        let half = || {
            let reached = |step| {
                if step == JournalStep::LogWritten {
                    panic::resume_unwind(Box::new("interrupted"));
                }
            };
            let options = options_at(60.0).on_step(reached);
            enrich(
                folder.path("link.mcap"),
                flightcam::Output::InPlace,
                &options,
            )
            .map(drop)
        };
        assert!(panic::catch_unwind(AssertUnwindSafe(half)).is_err());
        assert!(folder.read("logs/flight.mcap") != enriched);
        folder.run("inspect logs/flight.mcap --depression 30", 0);
        assert!(folder.read("logs/flight.mcap") == enriched);
        folder.run("restore link.mcap", 0);
        assert!(folder.read("logs/flight.mcap") == log);
        assert_eq!(folder.contents().len(), 3, "the link, the folder, the log");
    }

    #[test]
    fn every_hard_link_of_a_log_leads_to_the_result() {
        let log = Shape::default().write();
        let folder = Arc::new(Folder::with(LOG, &log));
        fs::hard_link(folder.path(LOG), folder.path("other.mcap")).expect("another name");
        let meanwhile = Arc::clone(&folder);
        let options = options().on_step(move |_| {
            meanwhile.refuses("restore other.mcap", 1, "other.mcap: another run");
        });
        enrich(folder.path(LOG), flightcam::Output::InPlace, &options).expect("a result");
        let inode = |name| fs::metadata(folder.path(name)).expect("a file").ino();
        assert_eq!(inode(LOG), inode("other.mcap"));
        folder.run("restore other.mcap", 0);
        assert!(folder.read(LOG) == log);
    }

    #[test]
    fn a_log_on_a_read_only_disk_can_be_read_but_not_changed() {
        let folder = Folder::with(LOG, Shape::default().write());
        folder.add("disk/.keep", "");
        let run = |arguments: &str, prepare: &str| {
            let script = format!(
                "mount -t tmpfs tmpfs disk && cp {LOG} disk && cd disk && {prepare} && \
                 mount -o remount,ro . && exec \"$flightcam\" {arguments}"
            );
            let run = run_mounting(&folder, &script)?;
            let err = String::from_utf8(run.stderr).expect("words");
            Some((run.status.code(), err))
        };
        for (arguments, prepare, message) in [
            ("inspect flight.mcap --depression 30", "true", ""),
            (
                "enrich flight.mcap --depression 30 -o ../result.mcap",
                "true",
                "",
            ),
            (
                "enrich flight.mcap --depression 30 --in-place",
                "true",
                "error: flight.mcap: cannot open the log: Read-only file system",
            ),
            (
                "inspect flight.mcap",
                "touch flight.mcap.flightcam-journal",
                "error: flight.mcap: cannot bring the log back to what it was before an interrupted run: Read-only",
            ),
        ] {
            let Some((code, err)) = run(arguments, prepare) else {
                return;
            };
            assert_eq!(
                code,
                Some(i32::from(!message.is_empty())),
                "{arguments}: {err}"
            );
            assert!(err.starts_with(message), "{err}");
        }
    }
}
