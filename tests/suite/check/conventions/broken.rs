//! A log read with one convention broken.

use std::{
    fmt::Write as _,
    io::{Cursor, Write as _},
};

use flightcam::{
    CheckReport, Options, Request, SampleReport, check,
    check::{Outcome, reading::VectorReading, verdict::Reading},
    sample::{GimbalReference, Kind},
    source::{
        self,
        profile::{Profile, ProfileChoice},
    },
};
use mcap::{MessageStream, WriteOptions};
use toml::{Table, Value};

use crate::support::flights::Recording;

/// What is said in a profile in place of what is right.
pub struct Break {
    pub name: &'static str,
    pub kind: Kind,
    key: &'static str,
    value: &'static str,
}

const fn a(name: &'static str, kind: Kind, key: &'static str, value: &'static str) -> Break {
    Break {
        name,
        kind,
        key,
        value,
    }
}

pub const BREAKS: [Break; 28] = [
    a("velocity ned", Kind::Velocity, "frame", "ned"),
    a("velocity enu", Kind::Velocity, "frame", "enu"),
    a("velocity nwu", Kind::Velocity, "frame", "nwu"),
    a("velocity neu", Kind::Velocity, "frame", "neu"),
    a("velocity end", Kind::Velocity, "frame", "end"),
    a("velocity swd", Kind::Velocity, "frame", "swd"),
    a("velocity body-frd", Kind::Velocity, "frame", "body-frd"),
    a("velocity body-flu", Kind::Velocity, "frame", "body-flu"),
    a("velocity m/s", Kind::Velocity, "unit", "m/s"),
    a("velocity cm/s", Kind::Velocity, "unit", "cm/s"),
    a("velocity mm/s", Kind::Velocity, "unit", "mm/s"),
    a("attitude degrees", Kind::Attitude, "unit", "degrees"),
    a("attitude radians", Kind::Attitude, "unit", "radians"),
    a("attitude frd-ned", Kind::Attitude, "convention", "frd-ned"),
    a("attitude flu-enu", Kind::Attitude, "convention", "flu-enu"),
    a("attitude flu-nwu", Kind::Attitude, "convention", "flu-nwu"),
    a("attitude frd-enu", Kind::Attitude, "convention", "frd-enu"),
    a("attitude wxyz", Kind::Attitude, "order", "wxyz"),
    a("attitude xyzw", Kind::Attitude, "order", "xyzw"),
    a("angular rate frd", Kind::AngularRate, "frame", "frd"),
    a("angular rate flu", Kind::AngularRate, "frame", "flu"),
    a("angular rate deg/s", Kind::AngularRate, "unit", "deg/s"),
    a("acceleration frd", Kind::Acceleration, "frame", "frd"),
    a("acceleration flu", Kind::Acceleration, "frame", "flu"),
    a("acceleration g", Kind::Acceleration, "unit", "g"),
    a("gimbal earth", Kind::Gimbal, "reference", "earth"),
    a("gimbal heading", Kind::Gimbal, "reference", "heading"),
    a("gimbal airframe", Kind::Gimbal, "reference", "airframe"),
];

impl Break {
    /// The text of a built-in profile with this said for all places of its kind.
    fn profile(&self, name: &str) -> Profile {
        let text = Profile::built_in_text(name).expect("a built-in profile");
        let mut profile: Table = text.parse().expect("TOML");
        let say = |alternative: &mut Value| {
            let table = alternative.as_table_mut().expect("a table");
            // What belongs to an orientation's numbers is with them, and only some have it.
            let form = match (self.kind, self.key) {
                (_, "order") => "quaternion",
                (Kind::Attitude, "unit") => "euler",
                _ => {
                    table.insert(self.key.to_owned(), self.value.into());
                    return;
                }
            };
            let orientation = table.get_mut("orientation").and_then(Value::as_table_mut);
            if let Some(Value::Table(numbers)) = orientation.and_then(|one| one.get_mut(form)) {
                numbers.insert(self.key.to_owned(), self.value.into());
            }
        };
        match profile.get_mut(self.kind.name()) {
            Some(Value::Array(alternatives)) => alternatives.iter_mut().for_each(say),
            Some(alternative) => say(alternative),
            None => {}
        }
        let text = toml::to_string(&profile).expect("TOML");
        Profile::parse(&text).expect("a profile")
    }
}

/// What became of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Nothing was broken, and something is proven.
    Right,
    /// Nothing was broken, and at best something is consistent.
    Consistent,
    /// The log itself says more than the profile, or has nothing of the kind: nothing was broken.
    Unbroken,
    /// The messages contradict the profile and are refused.
    Refused,
    /// It is contradicted, and the first explanation is the right reading.
    Condemned,
    /// It is contradicted, and the right reading is another explanation than the first.
    AmongOthers,
    /// It is contradicted, but the right reading is no explanation.
    OtherReading,
    /// It is not contradicted.
    Undecidable,
    /// Something that is wrong is proven, or something that is right is contradicted.
    Wrong,
}

pub struct Examined {
    pub verdict: Verdict,
    pub report: CheckReport,
}

fn check_with(log: &[u8], profile: Profile) -> Result<CheckReport, String> {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(log).expect("written");
    let request = Request {
        profile: ProfileChoice::Given(Box::new(profile)),
        ..Request::default()
    };
    check(file.path(), &Options::new().telemetry(request)).map_err(|error| error.to_string())
}

/// Checks a log as its profile reads it.
pub fn examine(log: &[u8], recording: &Recording) -> Examined {
    let text = Profile::built_in_text(recording.profile).expect("a built-in profile");
    let report = check_with(log, Profile::parse(text).expect("a profile")).expect("it is checked");
    let verdicts = &report.findings.verdicts;
    let is_proven = verdicts.iter().any(|one| one.outcome == Outcome::Proven);
    let verdict = match (report.contradicted, is_proven) {
        (true, _) => Verdict::Wrong,
        (false, true) => Verdict::Right,
        (false, false) => Verdict::Consistent,
    };
    Examined { verdict, report }
}

/// Checks a log with one convention broken; `right` is what is found with none.
pub fn examine_broken(
    log: &[u8],
    recording: &Recording,
    right: &CheckReport,
    broken: &Break,
) -> Examined {
    let report = match check_with(log, broken.profile(recording.profile)) {
        Ok(report) => report,
        Err(_) => {
            return Examined {
                verdict: Verdict::Refused,
                report: right.clone(),
            };
        }
    };
    let (was, is) = (&right.samples[&broken.kind], &report.samples[&broken.kind]);
    let is_other_order = broken.key == "order" && report.quaternion != right.quaternion;
    let verdict = match () {
        () if is.tally.used < was.tally.used => Verdict::Refused,
        () if was.tally.used == 0 => Verdict::Unbroken,
        () if readings(is) == readings(was) && !is_other_order => Verdict::Unbroken,
        // An angle that no unit allows.
        () if report.problem.is_some() => Verdict::Condemned,
        () if report.contradicted => match place_of(&report, right, broken) {
            Some(0) => Verdict::Condemned,
            Some(_) => Verdict::AmongOthers,
            None => Verdict::OtherReading,
        },
        () => Verdict::Undecidable,
    };
    Examined { verdict, report }
}

fn readings(samples: &SampleReport) -> Vec<source::Reading> {
    samples.read_as.iter().map(|one| one.reading).collect()
}

/// Checks a log whose velocities are stamped too late.
pub fn examine_late(log: &[u8], recording: &Recording, milliseconds: u64) -> Examined {
    let Examined { report, .. } = examine(log, recording);
    let late_by = milliseconds as f64 / 1e3;
    let is_right = |explanation: &Vec<Reading>| match explanation[..] {
        [Reading::ShiftedVelocity { late_by_s }] => (late_by_s - late_by).abs() < 0.1,
        _ => false,
    };
    let verdict = match report.findings.explanations.first() {
        Some(first) if is_right(first) => Verdict::Condemned,
        Some(_) => Verdict::OtherReading,
        None => Verdict::Undecidable,
    };
    Examined { verdict, report }
}

/// Which of the explanations is the right reading.
fn place_of(report: &CheckReport, right: &CheckReport, broken: &Break) -> Option<usize> {
    let right = right.samples[&broken.kind].read_as.first()?.reading;
    let explanations = &report.findings.explanations;
    explanations
        .iter()
        .position(|explanation| match &explanation[..] {
            [reading] => is_meant(reading, right, broken),
            _ => false,
        })
}

fn is_meant(found: &Reading, right: source::Reading, broken: &Break) -> bool {
    let is_vector = |found: &VectorReading, axes: String, per_own: f64| {
        found.axes.to_string() == axes && found.unit.per_own == per_own
    };
    match (found, right) {
        (Reading::Velocity(found), source::Reading::Velocity { axes, unit }) => {
            is_vector(found, axes.to_string(), unit.per_metre_per_second())
        }
        (
            Reading::Attitude(found),
            source::Reading::Quaternion { axes, .. } | source::Reading::Angles { axes, .. },
        ) => {
            (found.body, found.world) == (axes.body(), axes.world())
                && !found.inverse
                && found.north_deg == 0.0
        }
        (Reading::AngularRate(found), source::Reading::AngularRate { axes, .. }) => {
            found.axes.to_string().ends_with(&axes.to_string())
        }
        (Reading::Acceleration(found), source::Reading::Acceleration { axes, .. }) => {
            found.axes.to_string().ends_with(&axes.to_string())
        }
        (
            Reading::Gimbal {
                reference,
                flipped: false,
            },
            _,
        ) if broken.kind == Kind::Gimbal => {
            let right = match right {
                source::Reading::Quaternion { reference, .. } => reference,
                source::Reading::Angles { reference, .. } => reference,
                _ => None,
            };
            // The tilt alone does not tell what the yaw is measured from.
            let is_level = |one: GimbalReference| one != GimbalReference::Airframe;
            right.is_some_and(|right| is_level(right) == is_level(*reference))
        }
        _ => false,
    }
}

/// The log with its velocities stamped too late; `None` if they are not on a topic of their own.
pub fn late(log: &[u8], right: &CheckReport, milliseconds: u64) -> Option<Vec<u8>> {
    let topic = |kind: Kind| {
        right.samples[&kind]
            .topic
            .as_ref()
            .map(|topic| topic.as_str().to_owned())
    };
    let velocity = topic(Kind::Velocity)?;
    let is_alone = [Kind::Attitude, Kind::Position]
        .iter()
        .all(|&kind| topic(kind).as_deref() != Some(&velocity));
    if !is_alone {
        return None;
    }
    let mut file = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression_threads(0);
    let mut writer = options.create(&mut file).expect("a writer");
    for message in MessageStream::new(log).expect("a readable log") {
        let mut message = message.expect("a message");
        if message.channel.topic == velocity {
            message.log_time += milliseconds * 1_000_000;
        }
        writer.write(&message).expect("it is written");
    }
    writer.finish().expect("the log is finished");
    drop(writer);
    Some(file.into_inner())
}

/// The verdicts in a few lines.
pub fn summary(report: &CheckReport) -> String {
    let mut text = String::new();
    for one in &report.findings.verdicts {
        let residuals: Vec<String> = one
            .candidates
            .iter()
            .map(|candidate| format!("{:.2} {:?}", candidate.residual, candidate.reading))
            .collect();
        let _ = writeln!(
            text,
            "  {:?} {:?} {:?} {:?} {:?} {residuals:?}",
            one.subject, one.witness, one.outcome, one.motion, one.shift
        );
    }
    let _ = writeln!(text, "  {:?}", report.findings.oddities);
    text
}
