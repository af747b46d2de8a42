//! `flightcam check`: whether a log's own numbers bear out how it is read.

use std::path::PathBuf;

use clap::Args;
use flightcam::{
    CheckReport, Error, Options, check, report::SampleReport, sample::Kind,
    source::request::RoleArgument, text,
};
use indicatif::HumanCount;

use super::{
    Exit, announce,
    camera::CameraArguments,
    explain,
    input_output::{input, is_pipe},
    print::{Page, print_result, to_json},
    progress::Bar,
    telemetry::{EXAMPLES, TelemetryArguments, role},
    warn,
    words::{
        self,
        advice::advice,
        checked::{self, SUBJECTS},
    },
};

/// Check whether a log's own numbers bear out how it is read
///
/// Nothing is written. The log's series are compared with each other: the velocity with the positions, the attitude
/// with the velocity, with angular rates and accelerations, the gimbal's angles with the drone's. What must be read in
/// another way is named, with the option that says so. The exit code is 4 if something is certainly read wrongly.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES)]
pub struct Arguments {
    /// The flight log, an MCAP file; - reads standard input
    input: PathBuf,

    /// Print only errors, no report and no progress
    #[arg(short, long)]
    quiet: bool,

    /// Print the report as JSON
    #[arg(long)]
    json: bool,

    // Last, because their headings apply to everything after them.
    #[command(flatten)]
    camera: CameraArguments,

    #[command(flatten)]
    telemetry: TelemetryArguments,

    /// Where the drone's angular rates are, as in /imu.gyro:frd
    #[arg(long, value_name = "PATHS:AXES[:UNIT]", value_parser = role(Kind::AngularRate))]
    angular_rate: Option<RoleArgument>,

    /// Where its accelerations are, one g upwards at rest, as in /imu.accel:flu:g
    #[arg(long, value_name = "PATHS:AXES[:UNIT]", value_parser = role(Kind::Acceleration))]
    acceleration: Option<RoleArgument>,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let bar = Bar::new(arguments.quiet || is_pipe(&arguments.input));
    let mut request = arguments.telemetry.request()?;
    let only_checked = [
        (Kind::AngularRate, &arguments.angular_rate),
        (Kind::Acceleration, &arguments.acceleration),
    ];
    for (kind, argument) in only_checked {
        if let Some(argument) = argument {
            request.roles.insert(kind, argument.clone());
        }
    }
    let mut options = Options::new()
        .depression(arguments.camera.depression)
        .mount(arguments.camera.mount)
        .telemetry(request)
        .watch(bar.watch());
    if !arguments.quiet {
        options = options.on_recovery(announce);
    }
    let report = check(input(&arguments.input)?, &options);
    bar.clear();
    let report = report?;
    match (arguments.json, arguments.quiet) {
        (true, _) => print_result(&to_json(&report)),
        (false, false) => print_result(describe(&report).text()),
        (false, true) => {}
    }
    if !report.complete && (arguments.quiet || arguments.json) {
        warn(&arguments.input, &report.notes);
    }
    Ok(match (report.contradicted, report.complete) {
        (true, _) => Exit::FoundWrong,
        (false, true) => Exit::Done,
        (false, false) => Exit::PartlyUnreadable,
    })
}

fn describe(report: &CheckReport) -> Page {
    let mut page = Page::with_labels(14);
    page.line("Log", text::path(&report.input));
    page.line("Profile", words::profile(&report.profile));
    for kind in Kind::LISTED {
        if let Some(samples) = report.samples.get(&kind) {
            describe_samples(&mut page, &words::label(kind), samples);
        }
    }
    for note in &report.notes {
        page.line("Note", words::note(note));
    }
    describe_verdicts(&mut page, report);
    if let Some(problem) = &report.problem {
        page.paragraph(&format!("Wrong: {}", explain(problem.error())));
    }
    page.paragraph(&conclusion(report));
    page
}

fn describe_samples(page: &mut Page, label: &str, samples: &SampleReport) {
    let Some(topic) = &samples.topic else {
        return;
    };
    let used = HumanCount(samples.tally.used);
    let total = HumanCount(samples.tally.total());
    page.line(label, format!("{topic}: {used} of {total} samples usable"));
    for read_as in &samples.read_as {
        page.line("", words::read_as(read_as));
    }
}

/// The verdicts on each subject, those that matter most first.
fn describe_verdicts(page: &mut Page, report: &CheckReport) {
    for (heading, subjects) in SUBJECTS {
        let verdicts = report.findings.verdicts.iter();
        let mut verdicts: Vec<_> = verdicts
            .filter(|verdict| subjects.contains(&verdict.subject))
            .collect();
        verdicts.sort_by_key(|verdict| checked::outcome(&verdict.outcome).0);
        if verdicts.is_empty() {
            continue;
        }
        page.paragraph(heading);
        for verdict in verdicts {
            let (_, outcome) = checked::outcome(&verdict.outcome);
            page.line(&format!("  {outcome}"), checked::evidence(verdict));
        }
    }
    if !report.findings.oddities.is_empty() {
        page.paragraph("By itself");
    }
    for oddity in &report.findings.oddities {
        let label = if oddity.is_certain() {
            "  wrong"
        } else {
            "  note"
        };
        page.line(label, checked::oddity(oddity));
    }
}

/// What follows from all of it.
fn conclusion(report: &CheckReport) -> String {
    if report.contradicted {
        let advice = advice(report);
        return match advice.is_empty() {
            true => "Something is certainly read wrongly.".to_owned(),
            false => format!("Something is certainly read wrongly.\n{advice}"),
        };
    }
    match report.findings.verdicts.is_empty() {
        true => "Nothing could be compared: the log has no two series that say something about each other.",
        false => "Nothing contradicts how the log is read.",
    }
    .to_owned()
}
