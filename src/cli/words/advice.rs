//! What would have to be read in another way, and the options that say it.

use flightcam::{
    CheckReport,
    check::{
        Oddity,
        reading::{AttitudeReading, Form},
        verdict::Reading,
    },
    sample::Kind,
    source::{
        Origin, Reading as AsRead, WrittenQuaternion,
        request::{HowAsked, RoleArgument},
    },
    text,
};

use super::checked;
use crate::cli::hint::in_shell;

/// What would have to be read in another way, and the options that say it; empty if nothing.
pub fn advice(report: &CheckReport) -> String {
    let mut lines: Vec<String> = Vec::new();
    for explanation in &report.findings.explanations {
        let parts = explanation.iter().map(|one| fix(report, one));
        lines.push(text::join(parts, ", and ").to_string());
    }
    let elsewhere = report
        .findings
        .oddities
        .iter()
        .find_map(|oddity| match oddity {
            Oddity::ScalarElsewhere { fits, .. } => Some(Reading::Attitude(*fits)),
            _ => None,
        });
    if let (true, Some(fits)) = (lines.is_empty(), elsewhere) {
        lines.push(fix(report, &fits));
    }
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
    let what = format!("the {} is read as {how}", checked::name(kind));
    match option(report, kind, reading) {
        Some(option) => format!("{what}: {option}"),
        None => format!("{what} (no option says that)"),
    }
}

/// The option that says it, in the way in which the user asked.
fn option(report: &CheckReport, kind: Kind, reading: &Reading) -> Option<String> {
    let words = words(report, reading)?;
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

/// What follows the fields in an argument, without the first colon.
fn words(report: &CheckReport, reading: &Reading) -> Option<String> {
    let words = match reading {
        Reading::Velocity(vector) => {
            let unit = vector.unit.name;
            match unit {
                "m/s" => vec![vector.axes.to_string()],
                "cm/s" | "mm/s" => vec![vector.axes.to_string(), unit.to_owned()],
                _ => return None,
            }
        }
        Reading::AngularRate(vector) => {
            vec![own_axes(vector.axes), vector.unit.name.to_owned()]
        }
        Reading::Acceleration(vector) => match vector.unit.name {
            "m/s²" => vec![own_axes(vector.axes)],
            "g" => vec![own_axes(vector.axes), "g".to_owned()],
            _ => return None,
        },
        Reading::Attitude(attitude) => of_attitude(report, attitude)?,
        Reading::Gimbal {
            reference,
            flipped: false,
        } => {
            let unit = angle_unit(report, Kind::Gimbal);
            let reference = reference.name().to_owned();
            unit.into_iter().chain([reference]).collect()
        }
        _ => return None,
    };
    Some(words.join(":"))
}

/// The drone's axes, as options and profiles name them where no others are possible.
fn own_axes(axes: flightcam::profile::Axes) -> String {
    let axes = axes.to_string();
    axes.strip_prefix("body-").unwrap_or(&axes).to_owned()
}

fn of_attitude(report: &CheckReport, attitude: &AttitudeReading) -> Option<Vec<String>> {
    let is_listed = matches!(report.quaternion, Some(WrittenQuaternion::InOrder(_)));
    let form = match attitude.form {
        Form::Quaternion { scalar_last: true } => is_listed.then(|| "xyzw".to_owned()),
        Form::Quaternion { scalar_last: false } => None,
        Form::Angles {
            unit,
            swapped: false,
            opposite: [false, false, false],
        } => Some(unit.name.to_owned()),
        Form::Angles { .. } | Form::OtherAngles => return None,
    };
    let is_plain = !attitude.inverse && attitude.north_deg == 0.0;
    let axes = format!("{}-{}", attitude.body, attitude.world);
    is_plain.then(|| form.into_iter().chain([axes]).collect())
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
