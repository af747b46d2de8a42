//! `flightcam check`.

use std::{io::Write as _, process::Stdio};

use serde_json::{Value, json};

use crate::support::{
    flights::{recorder::Recorder, recording::Reference, simulated::Simulated},
    folder::*,
    manoeuvres::Manoeuvre,
};

/// How a logger of one's own writes a flight: its numbers in JSON, under names that no profile knows.
struct Logger {
    /// The velocity, from north, east, down.
    velocity: fn([f64; 3]) -> [f64; 3],
    /// By how much it is stamped too late, in nanoseconds.
    late_by: u64,
    manoeuvre: Manoeuvre,
}

impl Default for Logger {
    fn default() -> Self {
        Self {
            velocity: |ned| ned,
            late_by: 0,
            manoeuvre: Manoeuvre::Free,
        }
    }
}

/// Where the logger has its numbers.
const ATTITUDE: &str = "--attitude /imu.r,/imu.p,/imu.y:degrees";
const GLOBE: &str = "--position /fix.lat,/fix.lon,/fix.alt:degE7:mm";

impl Logger {
    fn folder(&self) -> Folder {
        let flight = Simulated::new(self.manoeuvre, 40.0, Reference::Heading);
        let start = 1_700_000_000_000_000_000;
        let every = |milliseconds: u64| {
            let count = (flight.seconds() * 1e3) as u64 / milliseconds;
            (0..count).map(move |place| {
                let elapsed = place * milliseconds;
                (start + elapsed * 1_000_000, elapsed as f64 / 1e3)
            })
        };
        let mut log = Recorder::new();
        let attitudes = every(50).map(|(time, elapsed)| {
            let (r, p, y) = flight.attitude(elapsed).euler_angles();
            let [r, p, y] = [r, p, y].map(f64::to_degrees);
            (time, json!({"r": r, "p": p, "y": y}))
        });
        log.json("/imu", None, attitudes);
        let velocities = every(100).map(|(time, elapsed)| {
            let v = (self.velocity)(flight.velocity(elapsed).into());
            (time + self.late_by, json!({"v": v}))
        });
        log.json("/vel", None, velocities);
        let places = every(200).map(|(time, elapsed)| {
            let [lat, lon, alt] = flight.geodetic(elapsed);
            let [n, e, d]: [f64; 3] = flight.local(elapsed).into();
            let [lat, lon, alt] = [lat * 1e7, lon * 1e7, alt * 1e3].map(f64::round);
            (
                time,
                json!({"lat": lat, "lon": lon, "alt": alt, "n": n, "e": e, "u": -d}),
            )
        });
        log.json("/fix", None, places);
        Folder::with(LOG, log.finish())
    }
}

/// A JSON report.
fn json_of(folder: &Folder, arguments: &str, code: i32) -> Value {
    let (out, _) = folder.run(&format!("check {LOG} {arguments} --json"), code);
    serde_json::from_str(&out).expect("JSON")
}

/// The verdict on a subject by a witness.
fn verdict<'a>(report: &'a Value, subject: &str, witness: &str) -> &'a Value {
    let verdicts = report["verdicts"].as_array().expect("a list");
    let is_wanted = |one: &&Value| one["subject"] == subject && one["witness"] == witness;
    let found = verdicts.iter().find(is_wanted);
    found.unwrap_or_else(|| panic!("no {subject} by {witness} in {report:#}"))
}

/// The options that the report advises, as the shell gives them.
fn advised(report: &str) -> String {
    let (_, option) = report.split_once("It fits if ").expect("advice");
    let line = option.lines().next().expect("a line");
    let (_, option) = line.split_once(": ").expect("an option");
    option.replace('\'', "")
}

#[test]
fn places_on_the_globe_prove_a_velocity() {
    let folder = Logger::default().folder();
    let arguments = format!("{ATTITUDE} {GLOBE} --velocity /vel.v:ned");
    let (out, err) = folder.run(&format!("check {LOG} {arguments}"), 0);
    assert_reads(
        &out,
        "Log … flight.mcap … Attitude … /imu … Velocity … /vel … m/s in ned … Position … 1e-7 degrees, altitude in mm … \
         Velocity, horizontal … proven … by latitude, longitude, height: ned in m/s is off by … % of the motion, … \
         Velocity, vertical … proven … Clock of the velocity … proven … ms …, give or take … ms … Attitude … \
         Nothing contradicts how the log is read.",
    );
    assert_eq!(err, "");
}

#[test]
fn a_wrong_reading_is_named_with_the_option_that_mends_it() {
    let logger = Logger {
        velocity: |[n, e, d]| [e, n, -d].map(|component| component * 100.0),
        ..Logger::default()
    };
    let folder = logger.folder();
    let place = format!("{ATTITUDE} {GLOBE}");
    let (out, _) = folder.run(
        &format!("check {LOG} {place} --velocity /vel.v:ned:cm/s"),
        4,
    );
    assert_reads(
        &out,
        "Velocity, horizontal … wrong … by latitude, longitude, height: ned in cm/s is off by … \
         Something is certainly read wrongly. … It fits if the velocity is read as enu in cm/s: --velocity",
    );
    let option = advised(&out);
    assert_eq!(option, "--velocity /vel.v:enu:cm/s");
    let (out, _) = folder.run(&format!("check {LOG} {place} {option}"), 0);
    assert_reads(&out, "Velocity, horizontal … proven … enu in cm/s");
    folder.run(&format!("check {LOG} {place} {option} --quiet"), 0);
}

#[test]
fn a_local_position_in_the_same_axes_proves_nothing() {
    // East, north, up.
    let logger = Logger {
        velocity: |[n, e, d]| [e, n, -d],
        ..Logger::default()
    };
    let folder = logger.folder();
    for (axes, expected) in [("ned", "consistent"), ("enu", "contradicted")] {
        let positions = format!("--position /fix.e,/fix.n,/fix.u:{axes}");
        // How the drone leans is a witness too, and has axes of its own.
        let report = json_of(
            &folder,
            &format!("{ATTITUDE} --velocity /vel.v:ned {positions}"),
            4,
        );
        for subject in ["velocity_horizontal", "velocity_vertical"] {
            let verdict = verdict(&report, subject, "local_position");
            assert_eq!(verdict["verdict"], expected, "{verdict:#}");
        }
    }
}

#[test]
fn a_clock_that_is_late_is_measured() {
    let logger = Logger {
        late_by: 1_000_000_000,
        ..Logger::default()
    };
    let folder = logger.folder();
    let arguments = format!("{ATTITUDE} {GLOBE} --velocity /vel.v:ned");
    let report = json_of(&folder, &arguments, 4);
    let verdict = verdict(&report, "velocity_time", "geodetic_position");
    assert_eq!(verdict["verdict"], "contradicted", "{verdict:#}");
    let late = verdict["shift"]["late_by_s"].as_f64().expect("a number");
    assert!((late - 1.0).abs() < 0.05, "{late}");
    let (out, _) = folder.run(&format!("check {LOG} {arguments}"), 4);
    assert_reads(
        &out,
        "Clock of the velocity … wrong … ms late, give or take … It fits if the velocity's times are",
    );
}

#[test]
fn nothing_is_decided_where_nothing_moves() {
    let logger = Logger {
        manoeuvre: Manoeuvre::Hover,
        ..Logger::default()
    };
    let folder = logger.folder();
    let (out, _) = folder.run(
        &format!("check {LOG} {ATTITUDE} {GLOBE} --velocity /vel.v:enu"),
        0,
    );
    assert_reads(
        &out,
        "Velocity, horizontal … undecidable … it moved … m, and it takes 1.00 m … Nothing contradicts",
    );
}

#[test]
fn a_log_that_cannot_be_examined_is_an_error() {
    let folder = Logger::default().folder();
    folder.refuses(&format!("check {LOG}"), 1, "flight.mcap");
    folder.refuses("check none.mcap", 1, "none.mcap");
    folder.refuses(
        &format!("check {LOG} --position /fix.lat,/fix.lon"),
        2,
        "--position",
    );
    folder.refuses(
        &format!("check {LOG} --acceleration /imu.a"),
        2,
        "`:frd` or `:flu`",
    );
}

#[test]
fn a_log_is_checked_from_a_pipe_as_from_a_file() {
    let folder = Logger::default().folder();
    let arguments = format!("{ATTITUDE} {GLOBE} --velocity /vel.v:neu");
    let mut from_file = json_of(&folder, &arguments, 4);
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("flightcam"));
    command
        .args(["check", "-", "--json"])
        .args(arguments.split_whitespace());
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    stdin.write_all(&folder.read(LOG)).expect("it is read");
    drop(stdin);
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(4));
    let mut from_pipe: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for report in [&mut from_file, &mut from_pipe] {
        report["input"] = Value::Null;
    }
    assert_eq!(from_file, from_pipe);
}
