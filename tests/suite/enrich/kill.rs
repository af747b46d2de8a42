//! A run that changes a log in place is killed: the next run finds the log intact, as before or as after the change.
//!
//! The program has no hook for this. A test starts this test program again as a child process, which calls the library
//! and kills itself at the moment it was given; or it kills flightcam from outside at any moment.
#![cfg(unix)]

use std::{
    env, fmt, fs,
    hash::{BuildHasher, RandomState},
    ops::ControlFlow,
    os::unix::{fs::FileExt, process::ExitStatusExt},
    path::Path,
    process::{Command, ExitStatus, Stdio},
    sync::atomic::{AtomicU64, Ordering::Relaxed},
    thread,
    time::Instant,
};

use assert_cmd::cargo::cargo_bin;
use flightcam::{
    Output, Watch, enrich,
    log::Access,
    restore,
    writer::journal::{self, JournalStep},
};
use signal_hook::{consts::SIGKILL, low_level::raise};

use crate::support::{folder::*, interrupted::*, shapes::*, small_disk::run_mounting, *};

/// What the next run does first with a log of which a change was killed.
#[derive(Debug)]
struct Recover;

/// When a run is killed.
#[derive(Debug, Clone, Copy)]
enum Moment {
    /// When it has come to a step.
    At(JournalStep),
    /// When it has reported its progress this many times.
    Progress(u64),
    /// When what the log has at some place has changed.
    Overwritten(u64),
}

/// A log, and all that is made of it here.
struct Logs {
    original: Vec<u8>,
    /// By the angle below the horizon.
    at_30: Vec<u8>,
    at_45: Vec<u8>,
    at_60: Vec<u8>,
    /// The exit code of a run that has read all that it can.
    code: i32,
}

impl Logs {
    fn of(original: Vec<u8>) -> Self {
        let at = |degrees| enrich_bytes_with(&original, &options_at(degrees)).expect("a result");
        let (at_30, report) = at(30.0);
        Self {
            at_30,
            at_45: at(45.0).0,
            at_60: at(60.0).0,
            code: if report.complete { 0 } else { 3 },
            original,
        }
    }

    fn before(&self, change: Change) -> &[u8] {
        match change {
            Change::Enrich => &self.original,
            Change::Replace | Change::Restore => &self.at_30,
        }
    }

    fn after(&self, change: Change) -> &[u8] {
        match change {
            Change::Enrich => &self.at_30,
            Change::Replace => &self.at_60,
            Change::Restore => &self.original,
        }
    }

    fn code_of(&self, change: Change) -> i32 {
        match change {
            Change::Enrich | Change::Replace => self.code,
            Change::Restore => 0,
        }
    }
}

// ---- The run that is killed ----

/// The environment variable that says what the child is to do.
const ORDERS: &str = "FLIGHTCAM_KILLED_RUN";

/// Not a test, but what the tests below run as a child process.
#[test]
fn child_process() {
    let Ok(orders) = env::var(ORDERS) else {
        return;
    };
    let mut orders = orders.splitn(4, ' ');
    let mut next = || orders.next().expect("orders");
    let (change, moment, number) = (next(), next(), next().parse::<u64>().expect("a number"));
    let log = Path::new(next());
    if moment == "Overwritten" {
        die_when_overwritten(log, number);
    }
    let (is_progress, is_at) = (moment == "Progress", moment == "At");
    let reports = AtomicU64::new(0);
    let watch = move |_| {
        if is_progress && reports.fetch_add(1, Relaxed) + 1 == number {
            die();
        }
        ControlFlow::Continue(())
    };
    let reached = move |step| {
        if is_at && step == JournalStep::ALL[number as usize] {
            die();
        }
    };
    let enrich_at = |degrees, watch| {
        let options = options_at(degrees).watch(watch).on_step(reached);
        drop(enrich(log, Output::InPlace, &options).expect("a result"));
    };
    match change {
        "Recover" => drop(journal::open(log, Access::Read, &|_| {}).expect("a log")),
        "Restore" => {
            let watch = Watch::new(watch).on_step(reached);
            drop(restore(log, Output::InPlace, &watch).expect("the original"));
        }
        "Replace" => enrich_at(60.0, watch),
        _ => enrich_at(30.0, watch),
    }
}

fn die() -> ! {
    raise(SIGKILL).expect("it can be raised");
    unreachable!("nobody survives that")
}

fn die_when_overwritten(log: &Path, place: u64) {
    let log = fs::File::open(log).expect("the log");
    let read = move || {
        let mut there = [0; 16];
        let length = log.read_at(&mut there, place).expect("it can be read");
        (length, there)
    };
    let before = read();
    thread::spawn(move || {
        while read() == before {
            std::hint::spin_loop();
        }
        die()
    });
}

/// Runs the child on a log until it dies, or ends.
fn run_child(log: &Path, change: impl fmt::Debug, moment: Moment) -> ExitStatus {
    let (moment, number) = match moment {
        Moment::At(step) => (
            "At",
            JournalStep::ALL
                .iter()
                .position(|&s| s == step)
                .expect("a step") as u64,
        ),
        Moment::Progress(times) => ("Progress", times),
        Moment::Overwritten(place) => ("Overwritten", place),
    };
    let mut child = Command::new(env::current_exe().expect("this test"));
    child.args(["--exact", "enrich::kill::child_process", "--nocapture"]);
    child.env(
        ORDERS,
        format!("{change:?} {moment} {number} {}", log.display()),
    );
    let status = child.stdout(Stdio::null()).status().expect("a child");
    assert!(
        status.success() || status.signal() == Some(SIGKILL),
        "{status}"
    );
    status
}

// ---- What is found then ----

/// What the next run finds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Found {
    /// The log as it was before the change, and no journal.
    Before,
    /// A journal, and the log as it was before the change.
    Saved,
    /// A journal, and something else.
    Half,
    /// The log as it was to be after the change, and no journal.
    After,
}

/// How many runs were killed, and what was found then.
#[derive(Default)]
struct Tally {
    killed: u32,
    found: Vec<Found>,
}

impl Tally {
    fn add(&mut self, status: ExitStatus, found: Found) {
        if status.signal() == Some(SIGKILL) {
            self.killed += 1;
            self.found.push(found);
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let count = |wanted| self.found.iter().filter(|&&found| found == wanted).count();
        let all = [Found::Before, Found::Saved, Found::Half, Found::After];
        let [before, saved, half, after] = all.map(count);
        write!(
            f,
            "{} runs were killed: {before} had changed nothing, {saved} had a journal, {half} had written to the log, \
             {after} had ended",
            self.killed
        )
    }
}

/// Looks at a log whose change was killed, as the next run does, which takes turns. Whatever that is, it must find the
/// log as it was before or after the change.
#[track_caller]
fn look(folder: &Folder, logs: &Logs, change: Change, turn: usize) -> Found {
    let (before, after) = (logs.before(change), logs.after(change));
    let left = folder.read(LOG);
    let found = match (folder.path(JOURNAL).exists(), left == before) {
        (false, true) => Found::Before,
        (true, true) => Found::Saved,
        (true, false) => Found::Half,
        (false, false) => {
            assert!(left == after, "without a journal the log is whole");
            Found::After
        }
    };
    let whole = if found == Found::After { after } else { before };
    let expected = match turn % 4 {
        0 => {
            folder.run("inspect flight.mcap --depression 45", 0);
            whole
        }
        1 => {
            folder.run(
                "enrich flight.mcap --depression 45 -o other.mcap",
                logs.code,
            );
            assert!(folder.read("other.mcap") == logs.at_45);
            fs::remove_file(folder.path("other.mcap")).expect("removed");
            whole
        }
        2 => {
            folder.run("enrich flight.mcap --depression 45 --in-place", logs.code);
            &logs.at_45
        }
        _ => {
            // There is nothing to undo, neither a result nor a change that was cut short.
            let is_done = matches!(found, Found::Before | Found::After) && whole == logs.original;
            folder.run("restore flight.mcap", i32::from(is_done));
            &logs.original
        }
    };
    assert!(
        folder.read_only_one(LOG) == expected,
        "{change:?}, {found:?}, turn {turn}"
    );
    found
}

fn fixture() -> Vec<u8> {
    fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture")
}

/// A log that breaks off in the middle of a record.
fn torn() -> Vec<u8> {
    let mut log = Shape::default().write();
    log.truncate(log.len() * 2 / 3);
    log
}

/// Logs whose results are longer, logs whose results are shorter than they are, and logs that break off.
fn logs() -> [Logs; 4] {
    [
        fixture(),
        with_repeated_schemas(),
        with_zeros_at_the_end(),
        torn(),
    ]
    .map(Logs::of)
}

#[test]
fn a_run_that_is_killed_at_a_step_loses_nothing() {
    let mut tally = Tally::default();
    for logs in logs() {
        for change in CHANGES {
            for step in JournalStep::ALL {
                let folder = Folder::with(LOG, logs.before(change));
                let status = run_child(&folder.path(LOG), change, Moment::At(step));
                assert_eq!(status.signal(), Some(SIGKILL), "{step:?}");
                let found = look(&folder, &logs, change, tally.killed as usize);
                let expected = match step {
                    JournalStep::JournalWritten => Found::Before,
                    JournalStep::JournalNamed | JournalStep::JournalDurable => Found::Saved,
                    JournalStep::LogWritten | JournalStep::LogCut | JournalStep::LogDurable => {
                        Found::Half
                    }
                    JournalStep::JournalRemoved => Found::After,
                };
                assert_eq!(found, expected, "{change:?}, {step:?}");
                tally.add(status, found);
            }
        }
    }
    println!("at the steps, {tally}");
}

#[test]
fn a_run_that_is_killed_while_it_reads_loses_nothing() {
    let mut tally = Tally::default();
    let logs = Logs::of(long_log());
    for change in CHANGES {
        for times in [1, 2, 3, 5, 8] {
            let folder = Folder::with(LOG, logs.before(change));
            let status = run_child(&folder.path(LOG), change, Moment::Progress(times));
            let found = look(&folder, &logs, change, tally.killed as usize);
            tally.add(status, found);
        }
    }
    assert!(tally.killed > 10);
    println!("while reading, {tally}");
}

/// How many bytes are the same before a change and after it.
fn same(before: &[u8], after: &[u8]) -> u64 {
    let bytes = before.iter().zip(after);
    bytes.take_while(|(before, after)| before == after).count() as u64
}

/// Draws a number between 0 and 1.
fn draw() -> f64 {
    RandomState::new().hash_one(()) as f64 / u64::MAX as f64
}

#[test]
fn a_run_that_is_killed_while_it_writes_loses_nothing() {
    let mut tally = Tally::default();
    for logs in logs().into_iter().chain([Logs::of(long_log())]) {
        for change in CHANGES {
            let (before, after) = (logs.before(change), logs.after(change));
            let (start, end) = (same(before, after), before.len().max(after.len()) as u64);
            let enough = tally.killed + 5;
            for turn in 0.. {
                let place = start + (draw() * (end - start) as f64) as u64;
                println!(
                    "{change:?} is killed when byte {place} of {start} to {end} is overwritten"
                );
                let folder = Folder::with(LOG, before);
                let status = run_child(&folder.path(LOG), change, Moment::Overwritten(place));
                tally.add(status, look(&folder, &logs, change, turn));
                if tally.killed == enough {
                    break;
                }
                assert!(turn < 100, "most places are overwritten");
            }
        }
    }
    println!("while writing, {tally}");
}

#[test]
fn a_run_that_is_killed_while_it_rolls_a_log_back_loses_nothing() {
    let mut tally = Tally::default();
    for logs in logs() {
        for change in CHANGES {
            let (before, after) = (logs.before(change), logs.after(change));
            let start = same(before, after);
            for turn in 0..4 {
                let folder = Folder::with(LOG, before);
                run_child(&folder.path(LOG), change, Moment::At(JournalStep::LogCut));
                let place = start + (draw() * (before.len() as u64 - start) as f64) as u64;
                println!("{change:?} is killed when byte {place} is brought back");
                let status = run_child(&folder.path(LOG), Recover, Moment::Overwritten(place));
                tally.add(status, look(&folder, &logs, change, turn));
            }
        }
    }
    assert!(tally.killed > 20, "most places are brought back");
    println!("while recovering, {tally}");
}

#[test]
fn a_program_that_is_killed_at_any_moment_loses_nothing() {
    let mut tally = Tally::default();
    for logs in [fixture(), with_zeros_at_the_end(), long_log()].map(Logs::of) {
        for change in CHANGES {
            let start = || {
                let folder = Folder::with(LOG, logs.before(change));
                let arguments: &[&str] = match change {
                    Change::Enrich => &["enrich", LOG, "--in-place", "--depression", "30"],
                    Change::Replace => &["enrich", LOG, "--in-place", "--depression", "60"],
                    Change::Restore => &["restore", LOG],
                };
                let mut program = Command::new(cargo_bin!("flightcam"));
                program.args(arguments).current_dir(folder.path("."));
                let program = program.stdout(Stdio::null()).spawn().expect("the program");
                (folder, program)
            };
            let begun = Instant::now();
            let (folder, mut program) = start();
            assert_eq!(
                program.wait().expect("it ends").code(),
                Some(logs.code_of(change))
            );
            let whole_run = begun.elapsed();
            assert!(folder.read_only_one(LOG) == logs.after(change));

            let enough = tally.killed + 7;
            for turn in 0.. {
                let delay = whole_run.mul_f64(draw());
                println!("{change:?} is killed after {delay:?} of {whole_run:?}");
                let (folder, mut program) = start();
                thread::sleep(delay);
                program.kill().expect("it is killed, or has ended");
                let status = program.wait().expect("it has ended");
                tally.add(status, look(&folder, &logs, change, turn));
                if tally.killed == enough {
                    break;
                }
                assert!(turn < 100, "most runs are killed");
            }
        }
    }
    println!("from outside, {tally}");
}

#[test]
fn a_program_that_is_killed_while_it_writes_a_new_file_leaves_nothing() {
    let log = long_log();
    let (result, _) = enrich_bytes(&log).expect("a result");
    let (mut killed, mut ended) = (0, 0);
    let begun = Instant::now();
    Folder::with(LOG, &log).run("enrich flight.mcap --depression 30", 0);
    let whole_run = begun.elapsed();
    for turn in 0..30 {
        let folder = Folder::with(LOG, &log);
        let mut program = Command::new(cargo_bin!("flightcam"));
        program.args(["enrich", LOG, "--depression", "30", "--quiet"]);
        if turn % 2 == 0 {
            folder.add(RESULT, "of another flight");
            program.arg("--force");
        }
        let program = program.current_dir(folder.path(".")).spawn();
        let mut program = program.expect("the program");
        thread::sleep(whole_run.mul_f64(draw()));
        program.kill().expect("it is killed, or has ended");
        match program.wait().expect("it has ended").signal() {
            Some(SIGKILL) => killed += 1,
            _ => ended += 1,
        }
        assert!(folder.read(LOG) == log);
        let names: Vec<_> = folder.contents().into_keys().collect();
        assert!(names.len() <= 2, "{names:?}");
        if folder.path(RESULT).exists() {
            let there = folder.read(RESULT);
            assert!(there == result || there == b"of another flight");
        }
    }
    println!("{killed} runs were killed, {ended} had ended");
    assert!(killed > 5);
}

#[test]
fn what_a_killed_run_leaves_without_unnamed_files_the_next_one_removes() {
    let log = long_log();
    let (result, _) = enrich_bytes(&log).expect("a result");
    let folder = Folder::with(LOG, &log);
    folder.add(".other.mcap.abcdef.flightcam-part", "of another output");
    // Without /proc, a file without a name cannot be given one.
    let enrich = "\"$flightcam\" enrich flight.mcap --depression 30 --quiet";
    let script = format!(
        "mount -t tmpfs tmpfs /proc && {{ {enrich} & }}; pid=$!; \
         while ! ls -a | grep -q '^.flight.enriched.mcap.*flightcam-part'; do :; done; \
         kill -9 $pid; wait $pid; ls -a | grep -c flightcam-part; \
         exec 9>.flight.enriched.mcap.in-use.flightcam-part; flock 9; {enrich}; ls -a | grep -c flightcam-part"
    );
    let Some(run) = run_mounting(&folder, &script) else {
        return;
    };
    let counts = String::from_utf8(run.stdout).expect("counts");
    // That of another output is left, and so is one that is locked because it is being written.
    assert_eq!(counts, "2\n2\n", "{}", String::from_utf8_lossy(&run.stderr));
    assert!(folder.read(RESULT) == result);
}
