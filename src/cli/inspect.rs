//! `flightcam inspect`: what a log contains, and what `enrich` would produce.

use std::{fmt::Write as _, path::PathBuf};

use clap::Args;
use flightcam::{
    Error, Foreign, Note, Options, Watch,
    inspect::{
        FoundRole, Inspection, ListedTopic, Planned, RoleReport, Telemetry, TopicGroup, TopicList,
        inspect, topics,
    },
    sample::{Kind, VelocityFrom},
    text,
};
use indicatif::{HumanBytes, HumanCount};

use super::{
    Exit, announce,
    camera::CameraArguments,
    explain,
    input_output::input,
    print::{Page, print_result, to_json},
    telemetry::{EXAMPLES, TelemetryArguments},
    words::{self, plural},
};

/// Say which telemetry a log has, and what enrich would produce
///
/// Nothing is written. On a log with a summary only a part of it is read. The exit code is 0 if enrich would
/// find what it needs in the log, 1 if not.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Arguments {
    /// The flight log, an MCAP file
    input: PathBuf,

    /// List all topics instead: their messages' encoding and type, how many there are, and how many per second
    #[arg(long)]
    topics: bool,

    /// Print what was found as JSON
    #[arg(long)]
    json: bool,

    // Last, because their headings apply to everything after them.
    #[command(flatten)]
    camera: CameraArguments,

    #[command(flatten)]
    telemetry: TelemetryArguments,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    if arguments.topics {
        let watch = Watch::default().on_recovery(announce);
        let list = topics(input(&arguments.input)?, &watch)?;
        match arguments.json {
            true => print_result(&to_json(&list)),
            false => print_result(&list_topics(&list)),
        }
        return Ok(Exit::Done);
    }
    let options = Options::new()
        .depression(arguments.camera.depression)
        .mount(arguments.camera.mount)
        .telemetry(arguments.telemetry.request()?)
        .on_recovery(announce);
    let inspection = inspect(input(&arguments.input)?, &options)?;
    match arguments.json {
        true => print_result(&to_json(&inspection)),
        false => print_result(describe(&inspection).text()),
    }
    let grew = |note: &Note| matches!(note, Note::Grew { .. });
    Ok(match inspection.problem {
        Some(_) => Exit::Failed,
        None if inspection.notes.iter().any(grew) => Exit::PartlyUnreadable,
        None => Exit::Done,
    })
}

fn describe(inspection: &Inspection) -> Page {
    let mut page = Page::default();
    page.line("Log", describe_log(inspection));
    if inspection.scanned {
        page.line(
            "",
            "the whole log was read, because it has no complete summary",
        );
    }
    if let Some(telemetry) = &inspection.telemetry {
        describe_telemetry(&mut page, telemetry);
    }
    for note in &inspection.notes {
        page.line("Note", words::note(note));
    }
    for warning in &inspection.viewer_warnings {
        page.line("Viewers", words::viewer_warning(warning));
    }
    if let Some(telemetry) = &inspection.telemetry {
        page.paragraph(&table(telemetry));
        if !inspection.other_topics.is_empty() {
            let groups = inspection.other_topics.iter().map(describe_group);
            page.paragraph(&format!("Other topics\n{}", text::join(groups, "\n")));
        }
    }
    match (&inspection.problem, &inspection.telemetry) {
        // If there is no telemetry, the problem lists the other topics.
        (Some(problem), _) => {
            page.paragraph(&format!("enrich would fail: {}", explain(problem.error())));
        }
        (None, Some(telemetry)) => page.paragraph(&describe_plan(telemetry)),
        (None, None) => {}
    }
    page
}

fn describe_log(inspection: &Inspection) -> String {
    let name = text::path(&inspection.input);
    let bytes = HumanBytes(inspection.bytes);
    let messages = plural(inspection.messages, "message");
    let topics = plural(inspection.topics as u64, "topic");
    format!("{name}: {bytes}, {messages} on {topics}")
}

fn describe_telemetry(page: &mut Page, telemetry: &Telemetry) {
    page.line("Profile", words::profile(&telemetry.profile));
    for runner_up in telemetry.runners_up.iter().filter(|one| one.is_near()) {
        page.line("", runner_up);
    }
    if !telemetry.namespace.is_empty() {
        page.line("Vehicle", &telemetry.namespace);
    }
    page.line(
        "Camera",
        match &telemetry.camera {
            Some(camera) => words::camera(camera, &telemetry.profile),
            None => "not known from the log; give enrich --depression or --mount".to_owned(),
        },
    );
    for kind in Kind::USUAL {
        let label = words::label(kind);
        if kind == Kind::Velocity && telemetry.velocity_from == VelocityFrom::Position {
            page.line(&label, "from the position");
            continue;
        }
        match telemetry.roles.get(&kind) {
            Some(RoleReport::Found(found)) => describe_role(page, &label, found),
            Some(RoleReport::Missing { missing }) => page.line(&label, format!("none: {missing}")),
            None => {}
        }
    }
}

fn describe_role(page: &mut Page, label: &str, found: &FoundRole) {
    let FoundRole {
        topic,
        schema,
        encoding,
        ..
    } = found;
    let kind = match schema.is_empty() {
        true => encoding.to_string(),
        false => format!("{schema}, {encoding}"),
    };
    let fields = text::join(&found.fields, ", ");
    page.line(label, format!("{topic} ({kind}): {fields}"));
    for read_as in &found.read_as {
        page.line("", words::read_as(read_as));
    }
    for refused in &found.refused_frames {
        page.line("", words::refused_frames(refused));
    }
    if let Some(first) = &found.first {
        page.line("", format!("at first {}", words::first_sample(first)));
    }
    let of_how_many = match found.read == found.messages {
        true => String::new(),
        false => format!(" of {} that were read", HumanCount(found.read)),
    };
    for (reason, count) in &found.tally.dropped {
        let count = HumanCount(*count);
        page.line("", format!("{count}{of_how_many} {reason}"));
    }
    if found.tally.unselected > 0 {
        let count = HumanCount(found.tally.unselected);
        page.line("", format!("{count}{of_how_many} of another source"));
    }
    for unmet in &found.unmet_filters {
        page.line("", unmet);
    }
    if let Some(message) = &found.first_undecodable {
        page.line("", format!("the first that cannot be decoded is {message}"));
    }
}

/// Makes a table with one row of numbers per role.
fn table(telemetry: &Telemetry) -> String {
    let found = telemetry.roles.values().filter_map(|role| match role {
        RoleReport::Found(found) => Some(found.times[0]),
        RoleReport::Missing { .. } => None,
    });
    // Logs may start at time 0 with what was known before the flight.
    let start = found.min().unwrap_or(0);
    let header = [
        "",
        "messages",
        "rate",
        "largest gap",
        "invalid",
        "from",
        "to",
    ];
    let mut rows = vec![header.map(str::to_owned)];
    for kind in Kind::USUAL {
        let is_read = kind != Kind::Velocity || telemetry.velocity_from == VelocityFrom::Messages;
        if let Some(RoleReport::Found(found)) = telemetry.roles.get(&kind).filter(|_| is_read) {
            rows.push(row(&words::label(kind), found, start));
        }
    }
    let widths = widths(&rows);
    let mut text = String::new();
    for [label, numbers @ ..] in &rows {
        let _ = write!(text, "{label:<8}");
        for (number, width) in numbers.iter().zip(&widths[1..]) {
            let _ = write!(text, "  {number:>width$}");
        }
        text.push('\n');
    }
    let seconds = start as f64 / 1e9;
    let _ = writeln!(
        text,
        "Times count from the first of these messages, at {seconds:.3} s in log time."
    );
    text
}

/// How many characters the longest text in each column has.
fn widths<const N: usize>(rows: &[[String; N]]) -> [usize; N] {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    std::array::from_fn(|column| width(column).unwrap_or(0))
}

/// Makes a table with one row per topic.
fn list_topics(list: &TopicList) -> String {
    let header = ["messages", "rate", "topic", "type"].map(str::to_owned);
    let topics = list.topics.iter().map(|listed| {
        let ListedTopic {
            topic,
            encoding,
            schema,
            messages,
            rate_hz,
            ..
        } = listed;
        [
            HumanCount(*messages).to_string(),
            rate_hz.map_or_else(|| "–".to_owned(), |rate| format!("{rate:.1} Hz")),
            topic.to_string(),
            match schema.is_empty() {
                true => encoding.to_string(),
                false => format!("{schema}, {encoding}"),
            },
        ]
    });
    let rows: Vec<[String; 4]> = [header].into_iter().chain(topics).collect();
    let [count, hertz, name, _] = widths(&rows);
    let lines = rows.iter().map(|[messages, rate, topic, kind]| {
        format!("{messages:>count$}  {rate:>hertz$}  {topic:<name$}  {kind}")
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn row(label: &str, found: &FoundRole, start: u64) -> [String; 7] {
    let since = |time: u64| format!("{:.2} s", (time - start) as f64 / 1e9);
    let or_dash = |number: Option<String>| number.unwrap_or_else(|| "–".to_owned());
    [
        label.to_owned(),
        HumanCount(found.messages).to_string(),
        or_dash(found.rate_hz.map(|rate| format!("{rate:.1} Hz"))),
        or_dash(found.largest_gap_s.map(|gap| format!("{gap:.3} s"))),
        percentage(found.share_invalid),
        since(found.times[0]),
        since(found.times[1]),
    ]
}

/// Formats a share in per cent; only none is 0 %, and only all is 100 %.
fn percentage(share: f64) -> String {
    match share {
        0.0 | 1.0 => format!("{} %", share * 100.0),
        share => format!("{:.1} %", (share * 100.0).clamp(0.1, 99.9)),
    }
}

fn describe_plan(telemetry: &Telemetry) -> String {
    let mut text = "enrich would write\n".to_owned();
    for planned in &telemetry.would_write {
        let Planned {
            topic,
            schema,
            encoding,
            at_most,
            ..
        } = planned;
        let messages = plural(*at_most, "message");
        let _ = writeln!(text, "  {topic} ({schema}, {encoding}): up to {messages}");
    }
    for missing in &telemetry.would_not_write {
        let _ = writeln!(text, "but not\n  {}", words::missing(missing));
    }
    text
}

fn describe_group(group: &TopicGroup) -> String {
    let schemas = match group.schemas.is_empty() {
        true => "without schema".to_owned(),
        false => group.schemas.to_string(),
    };
    let messages = plural(group.messages, "message");
    let topics: Vec<&Foreign> = group.topics.iter().collect();
    let encoding = &group.encoding;
    if let [topic] = topics[..] {
        return format!("  {schemas} ({encoding}): {messages} on {topic}");
    }
    format!(
        "  {schemas} ({encoding}): {messages} on {} topics\n    {}",
        topics.len(),
        words::first_few(topics.iter())
    )
}
