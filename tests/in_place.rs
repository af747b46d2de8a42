//! A log is changed in its own file: by one run at a time, to its end or not at all, wherever the file lies.

mod common;

use std::{iter, ops::ControlFlow, path::Path};

use common::{folder::*, shapes::*, *};
use flightcam::{
    Error, Progress, Watch, enrich_in_place,
    log::{
        file::{Access, LogFile},
        journal::Step,
    },
    restore,
};

/// What may be done to a log without another program's knowing.
const COMMANDS: [&str; 5] = [
    "inspect flight.mcap",
    "enrich flight.mcap --depression 30",
    "enrich flight.mcap --depression 30 --in-place",
    "restore flight.mcap",
    "restore flight.mcap -o original.mcap",
];

const LOCKED: &str =
    "flight.mcap: another run of flightcam is using it; try again when that has ended";

#[test]
fn nobody_meets_a_change_that_is_under_way() {
    let folder = Folder::with(LOG, Shape::default().write());
    let path = folder.path(LOG);
    let mut steps = Vec::new();
    let mut meanwhile = |progress| {
        if let Progress::Changed(step) = progress {
            steps.push(step);
            for command in COMMANDS {
                folder.refuses(command, 1, LOCKED);
            }
        }
        ControlFlow::Continue(())
    };
    enrich_in_place(&path, &options(), &mut meanwhile).expect("a result");
    enrich_in_place(&path, &options_at(60.0), &mut meanwhile).expect("a result");
    restore(&path, &mut meanwhile).expect("the original");
    assert_eq!(steps, Step::ALL.repeat(3));
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
fn a_log_is_free_as_soon_as_its_run_has_ended() {
    let folder = Folder::with(LOG, Shape::default().write());
    for access in [Access::Read, Access::Change] {
        let file = LogFile::open(&folder.path(LOG), access).expect("it is opened");
        // What another thread's new process has open for a moment.
        let inherited = file.handle().try_clone().expect("a handle");
        drop(file);
        LogFile::open(&folder.path(LOG), Access::Change).expect("it is free");
        drop(inherited);
    }
}

/// Lets a run on a log end at each moment at which it can, until it comes to its own end.
#[track_caller]
fn end_at_every_moment(log: &[u8], run: impl Fn(&Path, Watch) -> Result<(), Error>) -> Vec<u8> {
    for moment in iter::successors(Some(0), |moment| Some(2 * moment + 1)) {
        let folder = Folder::with(LOG, log);
        let mut passed = 0;
        let result = run(&folder.path(LOG), &mut |progress| {
            passed += u32::from(matches!(progress, Progress::Bytes { .. }));
            match passed > moment {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
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
fn a_run_that_is_told_to_end_leaves_the_log_as_it_was() {
    for log in [long_log(), with_zeros_at_the_end()] {
        let enriched = end_at_every_moment(&log, |log, watch| {
            enrich_in_place(log, &options(), watch).map(drop)
        });
        let other = end_at_every_moment(&enriched, |log, watch| {
            enrich_in_place(log, &options_at(60.0), watch).map(drop)
        });
        let original = end_at_every_moment(&other, |log, watch| restore(log, watch).map(drop));
        assert!(original == log);
    }
}
