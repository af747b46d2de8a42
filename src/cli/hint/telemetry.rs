//! Hints for a log whose telemetry is not found or is ambiguous.

use super::{super::words::other_unit, in_shell};
use flightcam::{
    sample::Kind,
    source::{
        error::{Misfit, OtherTopics, TelemetryError},
        request::{self, RoleArgument},
    },
    text,
};

/// What the user can do about an error.
pub fn hint(error: &TelemetryError) -> Option<String> {
    let hint = advice(error);
    let all_topics = all_topics(error);
    let all = [hint, all_topics].into_iter().flatten();
    all.reduce(|hint, more| format!("{hint}; {more}"))
}

/// How to see all topics of a log, if an error leaves out some.
fn all_topics(error: &TelemetryError) -> Option<String> {
    let (path, instead) = match error {
        TelemetryError::NotFound { path, instead, .. }
        | TelemetryError::NoSuchNamespace { path, instead, .. }
        | TelemetryError::RoleDoesNotFit { path, instead, .. }
        | TelemetryError::ProfileDoesNotFit { path, instead, .. } => (path, instead),
        _ => return None,
    };
    let is_cut = matches!(instead.others, OtherTopics::Counted(_));
    let log = path.to_str().and_then(in_shell);
    let log = log.unwrap_or_else(|| "LOG".to_owned());
    is_cut.then(|| format!("`flightcam inspect {log} --topics` lists all topics"))
}

fn advice(error: &TelemetryError) -> Option<String> {
    Some(match error {
        TelemetryError::NotFound { tried, .. } => {
            let fields = tried
                .iter()
                .find_map(|one| give_fields(one.attitude.as_ref().err()?));
            fields.unwrap_or_else(|| {
                "say where it is with --attitude and --velocity (explained by `flightcam enrich --help`), \
                 or in a profile of your own (--profile FILE.toml, explained in docs/profiles.md)"
                    .to_owned()
            })
        }
        TelemetryError::SeveralTopicsFit { role, topics, .. } => choose_one(
            &format!("--{}", role.name()),
            topics.iter().find_map(|topic| role_argument(topic)),
        ),
        TelemetryError::SeveralProfilesFit { fits, .. } => {
            let mut profiles = fits.iter().map(|(profile, _)| profile.to_string());
            choose_one("--profile", profiles.next())
        }
        TelemetryError::SeveralVehicles { namespaces, .. } => choose_one(
            "--namespace",
            (namespaces.iter()).find_map(|namespace| namespace_argument(namespace)),
        ),
        TelemetryError::ImpossibleAngle {
            role, unit, asked, ..
        } => format!(
            "{}; --trust goes on regardless",
            other_unit(*role, *unit, asked)
        ),
        TelemetryError::SeveralSources { role, .. } if !has_option(*role) => {
            "choose one with `select` in the profile".to_owned()
        }
        TelemetryError::SeveralSources { role, example, .. } => {
            let paths = text::join(example, ",");
            // The units and axes come after the fields.
            let words = match example.iter().any(|path| path.field.is_some()) {
                true => ":…",
                false => "",
            };
            let option = format!("--{}", role.name());
            choose_one(&option, in_shell(&format!("{paths}{words}")))
        }
        TelemetryError::SeveralReadings { role, readings, .. } => {
            let has_option = has_option(*role);
            let role = role.name();
            let quoted = (readings.first())
                .filter(|_| has_option)
                .map(|reading| format!("{}:…", reading.quoted()));
            match quoted.and_then(|quoted| in_shell(&quoted)) {
                Some(argument) => format!(
                    "give the one that you mean, with the topic in double quotes and all of it in single ones for the \
                     shell: --{role} {argument}"
                ),
                None => "give the one that you mean, with the topic in double quotes".to_owned(),
            }
        }
        TelemetryError::NoSuchNamespace { .. } => "correct --namespace, or leave it out".to_owned(),
        TelemetryError::RoleDoesNotFit { role, .. } => {
            format!("correct --{}, or leave it out", role.name())
        }
        TelemetryError::ProfileDoesNotFit { misfit, .. } => give_fields(misfit)?,
        _ => return None,
    })
}

/// Whether an option says where a role is. Others are only in profiles.
fn has_option(role: Kind) -> bool {
    role != Kind::Height
}

fn choose_one(option: &str, example: Option<String>) -> String {
    match example {
        Some(value) => format!("choose one, for instance with {option} {value}"),
        None => format!("choose one with {option}"),
    }
}

/// What to type for a topic, if there is such a thing.
fn role_argument(topic: &str) -> Option<String> {
    let is_topic = |argument: &String| {
        let parsed = RoleArgument::parse(Kind::Attitude, argument);
        parsed
            == Ok(RoleArgument::Topic {
                topic: topic.to_owned(),
                select: Vec::new(),
            })
    };
    let ways = [topic.to_owned(), format!("\"{topic}\"")];
    // Braces may stand for a number.
    let mut ways = ways.into_iter().filter(|_| !topic.contains('{'));
    in_shell(&ways.find(is_topic)?)
}

/// What to type for a namespace, if there is such a thing.
fn namespace_argument(namespace: &str) -> Option<String> {
    let typed = if namespace.is_empty() { "/" } else { namespace };
    let is_namespace = request::namespace(typed).as_deref() == Ok(namespace);
    in_shell(typed).filter(|_| is_namespace)
}

fn give_fields(misfit: &Misfit) -> Option<String> {
    match misfit {
        Misfit::OnlyATopic { role } => {
            let role = role.name();
            Some(format!("give --{role} fields, not only a topic"))
        }
        _ => None,
    }
}
