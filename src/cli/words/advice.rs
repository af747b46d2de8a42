//! What would have to be read in another way, and the options that say it.

use flightcam::{
    CheckReport,
    check::{reading::Form, verdict::Reading},
    sample::Kind,
    source::{
        Origin, Reading as AsRead, WrittenQuaternion,
        request::{HowAsked, RoleArgument},
    },
    text,
};

use super::{as_argument::as_argument, checked, sample};
use crate::cli::hint::in_shell;

/// What would have to be read in another way, and the options that say it; empty if nothing.
pub fn advice(report: &CheckReport) -> String {
    let fitting = report.findings.fitting();
    let lines = fitting.iter().map(|readings| {
        let parts = readings.iter().map(|one| fix(report, one));
        text::join(parts, ", and ").to_string()
    });
    let lines: Vec<String> = lines.collect();
    match lines.as_slice() {
        [] => String::new(),
        [only] => format!("It fits if {only}"),
        [likeliest, others @ ..] => {
            format!("It fits if {likeliest}\nor if {}", others.join("\nor if "))
        }
    }
}

/// What a reading means, with the option that says it.
fn fix(report: &CheckReport, reading: &Reading) -> String {
    let kind = match reading {
        Reading::Attitude(_) => Kind::Attitude,
        Reading::Gimbal { .. } => Kind::Gimbal,
        Reading::AngularRate(_) => Kind::AngularRate,
        Reading::Acceleration(_) => Kind::Acceleration,
        _ => Kind::Velocity,
    };
    let how = checked::reading(reading);
    if let Reading::ShiftedVelocity { .. } = reading {
        return format!("the velocity's times are {how} (perhaps --time names a better time)");
    }
    let what = format!("the {} is read as {how}", sample::name(kind));
    match option(report, kind, reading) {
        Some(option) => format!("{what}: {option}"),
        None => format!("{what} (no option says that)"),
    }
}

/// The option that says it, in the way in which the user asked.
fn option(report: &CheckReport, kind: Kind, reading: &Reading) -> Option<String> {
    let is_listed = matches!(report.quaternion, Some(WrittenQuaternion::InOrder(_)));
    let words = as_argument(reading, is_listed, angle_unit(report, Kind::Gimbal))?;
    if let Some(HowAsked::OwnProfile { profile }) = report.asked.get(&kind) {
        return Some(format!(
            "in the profile {profile}, `{}` is to say {words}",
            kind.name()
        ));
    }
    let paths = paths(
        report.origins.get(&kind)?,
        is_to_be_spelt_out(report, reading),
    )?;
    let argument = format!("{paths}:{words}");
    RoleArgument::parse(kind, &argument).ok()?;
    let option = kind.name().replace('_', "-");
    Some(format!("--{option} {}", in_shell(&argument)?))
}

/// The unit of angles, which goes with their fields.
fn angle_unit(report: &CheckReport, kind: Kind) -> Option<String> {
    let readings = report.samples.get(&kind)?.read_as.iter();
    let mut units = readings.filter_map(|one| match one.reading {
        AsRead::Angles { unit, .. } | AsRead::Pitch { unit, .. } => Some(unit.name().to_owned()),
        _ => None,
    });
    units.next()
}

/// Whether the quaternion's numbers must be named one by one, because its message has them in other places.
fn is_to_be_spelt_out(report: &CheckReport, reading: &Reading) -> bool {
    let Reading::Attitude(attitude) = reading else {
        return false;
    };
    report.quaternion == Some(WrittenQuaternion::Named)
        && attitude.form == Form::Quaternion { scalar_last: false }
}

/// The paths of the fields, as an argument takes them.
fn paths(origin: &Origin, is_spelt_out: bool) -> Option<String> {
    let topic = origin.topic.as_str();
    let is_plain = topic.starts_with('/') && !topic.contains(['.', '[', '{', '"', ' ']);
    let topic = match is_plain {
        true => topic.to_owned(),
        false if topic.contains('"') => return None,
        false => format!("\"{topic}\""),
    };
    let select: String = origin
        .select
        .iter()
        .map(|filter| format!("{{{filter}}}"))
        .collect();
    let fields = origin
        .fields
        .iter()
        .map(|field| format!("{topic}{select}.{field}"));
    let paths: Vec<String> = match is_spelt_out {
        false => fields.collect(),
        true => fields
            .flat_map(|field| ["x", "y", "z", "w"].map(|name| format!("{field}.{name}")))
            .collect(),
    };
    Some(paths.join(","))
}
