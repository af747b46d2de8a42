//! `flightcam inspect`: what a log has, and what `enrich` would make of it.

use std::{fmt::Write as _, path::PathBuf};

use clap::Args;
use flightcam::{
    Error, Options,
    inspect::{FoundRole, Inspection, Role, Telemetry, TopicGroup, inspect},
    sample::Kind,
};
use indicatif::{HumanBytes, HumanCount};

use super::{
    Exit,
    camera::CameraArguments,
    plural, print_result,
    telemetry::{EXAMPLES, TelemetryArguments},
};

/// How many topics of a group are named.
const NAMED: usize = 6;

/// Say which telemetry a log has, and what enrich would make of it
///
/// Nothing is written. On a log with a summary only a part of it is read. The exit code is 0 if enrich would
/// find what it needs, 1 if not.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Arguments {
    /// The flight log, an MCAP file
    input: PathBuf,

    /// Print what was found as JSON
    #[arg(long)]
    json: bool,

    // Last, because their headings hold for all that follows.
    #[command(flatten)]
    camera: CameraArguments,

    #[command(flatten)]
    telemetry: TelemetryArguments,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let options = Options {
        depression: arguments.camera.depression,
        mount: arguments.camera.mount,
        telemetry: arguments.telemetry.request()?,
        ..Options::default()
    };
    let inspection = inspect(&arguments.input, &options)?;
    print_result(&if arguments.json {
        serde_json::to_string_pretty(&inspection).expect("an inspection has only string keys")
    } else {
        describe(&inspection)
    });
    Ok(match inspection.problem {
        None => Exit::Done,
        Some(_) => Exit::Failed,
    })
}

fn describe(inspection: &Inspection) -> String {
    let mut text = String::new();
    let mut line = |label: &str, content: &str| {
        let _ = writeln!(text, "{label:<12}{content}");
    };
    line("Log", &describe_log(inspection));
    if inspection.scanned {
        line(
            "",
            "it has no summary that accounts for everything, so all of it was read",
        );
    }
    if let Some(telemetry) = &inspection.telemetry {
        let Telemetry {
            profile, reason, ..
        } = telemetry;
        line("Profile", &format!("{profile}, because {reason}"));
        for other in telemetry.runners_up.iter().filter(|other| other.fits) {
            let content = format!(
                "{} would fit, but not as well: {}",
                other.profile, other.reason
            );
            line("", &content);
        }
        line(
            "Camera",
            &match telemetry.camera {
                Some(camera) => camera.to_string(),
                None => {
                    "not told by the log: enrich needs --depression DEG or --mount ROLL,PITCH,YAW"
                        .to_owned()
                }
            },
        );
        text.push('\n');
        text.push_str(&table(telemetry));
    }
    if !inspection.other_topics.is_empty() {
        text.push_str("\nOther topics\n");
        for group in &inspection.other_topics {
            let _ = writeln!(text, "  {}", describe_group(group));
        }
    }
    match (&inspection.problem, &inspection.telemetry) {
        (Some(problem), _) => {
            let _ = write!(text, "\nenrich would fail: {problem}");
        }
        (None, Some(telemetry)) => {
            text.push_str("\nenrich would write");
            for planned in &telemetry.would_write {
                let messages = plural(planned.at_most, "message");
                let _ = write!(
                    text,
                    "\n  {} ({}, {}): up to {messages}",
                    planned.topic, planned.schema, planned.encoding
                );
            }
        }
        (None, None) => {}
    }
    text
}

fn describe_log(inspection: &Inspection) -> String {
    let name = inspection.input.display();
    let bytes = HumanBytes(inspection.bytes);
    let messages = plural(inspection.messages, "message");
    let topics = plural(inspection.topics as u64, "topic");
    format!("{name}: {bytes}, {messages} on {topics}")
}

/// One row a role, and below it what is missing.
fn table(telemetry: &Telemetry) -> String {
    let found = telemetry.roles.values().filter_map(|role| match role {
        Role::Found(found) => Some(found.times[0]),
        Role::Missing { .. } => None,
    });
    // Logs may start at time 0 with what was known before the flight.
    let start = found.min().unwrap_or(0);
    let header = [
        "",
        "topic",
        "type",
        "messages",
        "rate",
        "largest gap",
        "invalid",
        "from",
        "to",
    ];
    let mut rows = vec![header.map(str::to_owned)];
    let mut notes = String::new();
    // In the order in which people think of them.
    for kind in [Kind::Attitude, Kind::Velocity, Kind::Gimbal, Kind::Position] {
        match telemetry.roles.get(&kind) {
            Some(Role::Found(found)) => {
                rows.push(row(kind, found, start));
                notes.push_str(&note(kind, found));
            }
            Some(Role::Missing { missing }) => {
                let _ = writeln!(notes, "no {}: {missing}", kind.name());
            }
            None => {}
        }
    }
    let widths: Vec<usize> = (0..header.len())
        .map(|column| {
            let cells = rows.iter().map(|row| row[column].chars().count());
            cells.max().unwrap_or(0)
        })
        .collect();
    let mut text = String::new();
    for row in rows {
        let cells = row
            .iter()
            .zip(&widths)
            .enumerate()
            .map(|(column, (cell, &width))| {
                // Names to the left, numbers to the right.
                match column {
                    0..=2 => format!("{cell:<width$}"),
                    _ => format!("{cell:>width$}"),
                }
            });
        let cells: Vec<String> = cells.collect();
        let _ = writeln!(text, "{}", cells.join("  ").trim_end());
    }
    text + &notes
}

fn row(kind: Kind, found: &FoundRole, start: u64) -> [String; 9] {
    let since = |time: u64| format!("{:.2} s", (time - start) as f64 / 1e9);
    let or_dash = |number: Option<String>| number.unwrap_or_else(|| "–".to_owned());
    [
        kind.name().to_owned(),
        found.topic.clone(),
        format!("{} ({})", found.schema, found.encoding),
        HumanCount(found.messages).to_string(),
        or_dash(found.rate_hz.map(|rate| format!("{rate:.1} Hz"))),
        or_dash(found.largest_gap_s.map(|gap| format!("{gap:.3} s"))),
        percentage(found.share_invalid()),
        since(found.times[0]),
        since(found.times[1]),
    ]
}

/// A share in per cent, which says 0 % and 100 % only of none and all.
fn percentage(share: f64) -> String {
    match share {
        0.0 | 1.0 => format!("{} %", share * 100.0),
        share => format!("{:.1} %", (share * 100.0).clamp(0.1, 99.9)),
    }
}

/// What the table has no room for.
fn note(kind: Kind, found: &FoundRole) -> String {
    let mut text = String::new();
    let fields = found.fields.join(", ");
    let name = kind.name();
    let _ = write!(text, "{name}: {fields}");
    if let Some(first) = &found.first {
        let _ = write!(text, "; at first {first}");
    }
    text.push('\n');
    for (reason, count) in &found.tally.dropped {
        let read = match found.read == found.messages {
            true => String::new(),
            false => format!(" of {} that were looked at", HumanCount(found.read)),
        };
        let _ = writeln!(
            text,
            "{name}: {}{read} {}",
            HumanCount(*count),
            reason.describe()
        );
    }
    text
}

fn describe_group(group: &TopicGroup) -> String {
    let named: Vec<&str> = group
        .topics
        .iter()
        .take(NAMED)
        .map(String::as_str)
        .collect();
    let more = match group.topics.len() - named.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let schemas = match group.schemas.as_str() {
        "" => "without schema",
        schemas => schemas,
    };
    format!(
        "{schemas} ({}): {} on {}: {}{more}",
        group.encoding,
        plural(group.messages, "message"),
        plural(group.topics.len() as u64, "topic"),
        named.join(", ")
    )
}
