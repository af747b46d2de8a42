//! Hints for a log whose own numbers show that it was read wrongly.

use std::collections::BTreeMap;

use flightcam::{
    check::{
        Findings, Oddity,
        reading::{AttitudeReading, Form, VectorReading},
        verdict::Reading,
    },
    sample::Kind,
    source::request::HowAsked,
};

/// What the user can do, in the way in which each kind of sample was asked for.
pub fn hint(findings: &Findings, asked: &BTreeMap<Kind, HowAsked>) -> String {
    let mut hints: Vec<String> = findings.oddities.iter().filter_map(of_oddity).collect();
    let first = findings.explanations.first();
    let readings = first.into_iter().flatten();
    hints.extend(readings.filter_map(|reading| of_reading(reading, asked)));
    let elsewhere = findings.oddities.iter().find_map(|oddity| match oddity {
        Oddity::ScalarElsewhere { fits, .. } => Some(Reading::Attitude(*fits)),
        _ => None,
    });
    if let Some(reading) = elsewhere.filter(|_| first.is_none()) {
        hints.extend(of_reading(&reading, asked));
    }
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
    let (kind, word, key) = match reading {
        Reading::Velocity(VectorReading { axes, unit }) => {
            let word = match unit.name {
                "m/s" => axes.to_string(),
                name => format!("{axes}:{name}"),
            };
            let key = format!("frame = \"{axes}\" and unit = \"{}\"", unit.name);
            (Kind::Velocity, word, key)
        }
        Reading::Attitude(reading) => {
            let (word, key) = of_attitude(reading)?;
            (Kind::Attitude, word, key)
        }
        Reading::Gimbal {
            reference,
            flipped: false,
        } => {
            let name = reference.name();
            (
                Kind::Gimbal,
                name.to_owned(),
                format!("reference = \"{name}\""),
            )
        }
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

/// The words for an attitude's axes and order, in an argument and in a profile.
fn of_attitude(reading: &AttitudeReading) -> Option<(String, String)> {
    let axes = format!("{}-{}", reading.body, reading.world);
    let (word, key) = match reading.form {
        Form::Quaternion { scalar_last: true } => {
            (format!("xyzw:{axes}"), "order = \"xyzw\" and ".to_owned())
        }
        Form::Quaternion { scalar_last: false } => (axes.clone(), String::new()),
        Form::Angles {
            unit,
            swapped: false,
            opposite: [false, false, false],
        } => {
            let unit = unit.name;
            (format!("{unit}:{axes}"), format!("unit = \"{unit}\" and "))
        }
        Form::Angles { .. } | Form::OtherAngles => return None,
    };
    let has_words = !reading.inverse && reading.north_deg == 0.0;
    has_words.then(|| (word, format!("{key}convention = \"{axes}\"")))
}
