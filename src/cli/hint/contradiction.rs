//! Hints for a log whose own numbers show that it was read wrongly.

use std::collections::BTreeMap;

use flightcam::{
    check::{
        Findings, Oddity,
        reading::{Form, VectorReading},
        verdict::Reading,
    },
    sample::Kind,
    source::request::HowAsked,
};

use crate::cli::words::as_argument::as_argument;

/// What the user can do, in the way in which each kind of sample was asked for.
pub fn hint(findings: &Findings, asked: &BTreeMap<Kind, HowAsked>) -> String {
    let mut hints: Vec<String> = findings.oddities.iter().filter_map(of_oddity).collect();
    let likeliest = findings.fitting().into_iter().next();
    let readings = likeliest.iter().flatten();
    hints.extend(readings.filter_map(|reading| of_reading(reading, asked)));
    hints.push("`flightcam check` shows the evidence".to_owned());
    hints.push("--trust goes on regardless".to_owned());
    hints.join("; ")
}

fn of_oddity(oddity: &Oddity) -> Option<String> {
    match oddity {
        Oddity::ToAndFro { of, .. } => Some(format!(
            "record each source on a topic of its own or, if a field tells them apart, choose one with a filter, as in \
             --{} '/topic{{id==1}}.field:…'",
            of.name()
        )),
        Oddity::OneTime { .. } => Some(
            "name the field of the messages that holds their time, as in --time header.stamp or --time time_usec:us"
                .to_owned(),
        ),
        _ => None,
    }
}

/// How to say that something is read in another way, if there is a word for it.
fn of_reading(reading: &Reading, asked: &BTreeMap<Kind, HowAsked>) -> Option<String> {
    let word = as_argument(reading, true, None)?;
    let (kind, key) = match reading {
        Reading::Velocity(VectorReading { axes, unit }) => {
            let key = format!("frame = \"{axes}\" and unit = \"{}\"", unit.name);
            (Kind::Velocity, key)
        }
        Reading::Attitude(attitude) => {
            let form = match attitude.form {
                Form::Quaternion { scalar_last: true } => "order = \"xyzw\" and ".to_owned(),
                Form::Angles { unit, .. } => format!("unit = \"{}\" and ", unit.name),
                _ => String::new(),
            };
            let axes = format!("{}-{}", attitude.body, attitude.world);
            (Kind::Attitude, format!("{form}convention = \"{axes}\""))
        }
        Reading::Gimbal { reference, .. } => (
            Kind::Gimbal,
            format!("reference = \"{}\"", reference.name()),
        ),
        _ => return None,
    };
    let role = kind.name();
    Some(match asked.get(&kind)? {
        HowAsked::Argument => format!("put :{word} after the fields of --{role}"),
        HowAsked::OwnProfile { profile } => {
            format!("write {key} for the {role} in the profile {profile}")
        }
        _ => format!("name the fields with --{role}, and put :{word} after them"),
    })
}
