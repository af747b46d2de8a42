//! `flightcam enrich`: a log in, the same log with the camera's channels out.

use std::{
    fmt::Write as _,
    io::{self, ErrorKind, IsTerminal, Write},
    path::PathBuf,
    time::{Duration, Instant},
};

use clap::{
    Args, CommandFactory,
    builder::{PathBufValueParser, TypedValueParser},
};
use flightcam::{
    Error, Options, Progress, Report,
    enrich::{default_output, enrich},
    geometry::DepressionAngle,
    report::SampleReport,
    transform::{Breaks, MaxGap},
};
use indicatif::{HumanCount, ProgressBar, ProgressStyle};

use super::{
    Cli, Exit, complain,
    telemetry::{EXAMPLES, TelemetryArguments},
};

/// Write a log again with /camera/relative_rpy and /camera/velocity
///
/// Every byte of the log's data is kept as it is; the new channels lie behind it.
#[derive(Debug, Args)]
#[command(override_usage = "flightcam enrich <INPUT> --depression <DEG> [OPTIONS]")]
#[command(after_help = "Example:\n  flightcam enrich flight.mcap --depression 30", after_long_help = EXAMPLES)]
pub struct Arguments {
    /// The flight log, an MCAP file
    input: PathBuf,

    /// Where the result goes [default: NAME.enriched.mcap beside the log]
    #[arg(short, long, value_name = "FILE", value_parser = file_name())]
    output: Option<PathBuf>,

    /// How far the camera looks below the horizon, in degrees: 0 ahead, 30 for a gimbal pitch of -30,
    /// 90 straight down [required]
    #[arg(long, value_name = "DEG", value_parser = depression_angle, allow_negative_numbers = true)]
    depression: Option<DepressionAngle>,

    /// The longest time between two attitude samples that still belong together
    #[arg(long, value_name = "SECONDS", value_parser = max_gap, default_value = "5", allow_negative_numbers = true)]
    max_gap: MaxGap,

    #[command(flatten)]
    telemetry: TelemetryArguments,

    /// Replace an output that exists
    #[arg(long)]
    force: bool,

    /// Print no report and no progress, only errors
    #[arg(short, long)]
    quiet: bool,

    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let Some(depression) = arguments.depression else {
        explain_depression();
    };
    let options = Options {
        depression,
        max_gap: arguments.max_gap,
        telemetry: arguments.telemetry.request()?,
        overwrite: arguments.force,
    };
    let input = &arguments.input;
    let output = arguments.output.clone();
    let output = output.unwrap_or_else(|| default_output(input));

    let mut bar = Bar::new(!arguments.quiet && io::stderr().is_terminal());
    let report = enrich(input, &output, &options, &mut |progress| {
        bar.update(progress)
    });
    bar.clear();
    let report = report?;

    let printed = if arguments.json {
        let json = serde_json::to_string_pretty(&report);
        print(&json.expect("a report has only string keys"))
    } else if arguments.quiet {
        Ok(())
    } else {
        print(&describe(&report))
    };
    if let Err(error) = printed {
        // The result is complete all the same.
        complain("warning", &format!("cannot write the report: {error}"));
    }
    if report.complete {
        return Ok(Exit::Done);
    }
    if arguments.quiet || arguments.json {
        for note in &report.notes {
            complain("warning", &format!("{}: {note}", input.display()));
        }
    }
    Ok(Exit::PartlyUnreadable)
}

/// Ends the process: there is no angle that would be right for somebody who did not think of it.
fn explain_depression() -> ! {
    let mut command = Cli::command();
    command.build();
    let enrich = command.find_subcommand_mut("enrich");
    enrich
        .expect("this subcommand exists")
        .error(
            clap::error::ErrorKind::MissingRequiredArgument,
            "--depression DEG is missing: the angle of the camera's optical axis below the horizon, \
             which the log does not tell\n\n  \
             --depression 0    the camera looks ahead, at the horizon\n  \
             --depression 30   it looks 30° down: a gimbal pitch of -30°\n  \
             --depression 90   it looks straight down (nadir)\n\n\
             The angle is in degrees, greater than -90 and at most 90.",
        )
        .exit()
}

fn depression_angle(degrees: &str) -> Result<DepressionAngle, String> {
    let degrees: f64 = number(degrees)?;
    DepressionAngle::from_degrees(degrees).map_err(|error| error.to_string())
}

fn max_gap(seconds: &str) -> Result<MaxGap, String> {
    MaxGap::from_seconds(number(seconds)?).map_err(|error| error.to_string())
}

/// A path to a file. A lone dash, which elsewhere means a pipe, would be taken for a name.
fn file_name() -> impl TypedValueParser {
    PathBufValueParser::new().try_map(|path| match path.as_os_str() == "-" {
        true => Err("flightcam does not write to a pipe; name a file"),
        false => Ok(path),
    })
}

fn number(text: &str) -> Result<f64, String> {
    text.parse()
        .map_err(|_| "not a number; write it as 30 or 30.5".to_owned())
}

/// Writes a result to standard output. A reader that stops reading early is no error.
fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let written = writeln!(out, "{text}").and_then(|()| out.flush());
    written.or_else(|error| match error.kind() {
        ErrorKind::BrokenPipe => Ok(()),
        _ => Err(error),
    })
}

fn describe(report: &Report) -> String {
    let mut text = String::new();
    let mut line = |label: &str, content: &str| {
        let _ = writeln!(text, "{label:<12}{content}");
    };
    line("Log", &report.input.display().to_string());
    line(
        "Profile",
        &format!("{}, {}", report.profile.name, report.profile.reason),
    );
    line("Camera", &describe_angle(report.depression_deg));
    describe_samples(&mut line, "Attitude", &report.attitude);
    let Breaks { gaps, resets } = report.breaks;
    if gaps > 0 {
        let gaps = plural(gaps, "gap");
        let max_gap = report.max_gap_s;
        line(
            "",
            &format!("no rotation across {gaps} longer than {max_gap} s"),
        );
    }
    if resets > 0 {
        let resets = plural(resets, "reset");
        line(
            "",
            &format!("no rotation across {resets} of the attitude estimator"),
        );
    }
    describe_samples(&mut line, "Velocity", &report.velocity);
    for topic in &report.written {
        let messages = plural(topic.messages, "message");
        line("Written", &format!("{}: {messages}", topic.topic));
    }
    for topic in &report.not_written {
        line("Not written", &format!("{}: {}", topic.topic, topic.reason));
    }
    line(
        "Bytes",
        &format!(
            "{} copied unchanged, {} appended",
            HumanCount(report.bytes_copied),
            HumanCount(report.bytes_appended)
        ),
    );
    for note in &report.notes {
        line("Note", note);
    }
    line("Result", &report.output.display().to_string());
    let fields: Vec<&str> = report
        .written
        .iter()
        .map(|topic| match topic.topic {
            "/camera/velocity" => "/camera/velocity.x",
            _ => "/camera/relative_rpy.yaw",
        })
        .collect();
    let _ = write!(
        text,
        "\nTo look at it, open the result in Foxglove (https://foxglove.dev), add a Plot panel, and plot {}.",
        fields.join(" and ")
    );
    text
}

fn describe_angle(depression_deg: f64) -> String {
    if depression_deg == 0.0 {
        "looks at the horizon".to_owned()
    } else if depression_deg < 0.0 {
        format!("looks {}° above the horizon", -depression_deg)
    } else {
        format!("looks {depression_deg}° below the horizon")
    }
}

/// A count of things, with the thing's plural where it is due.
fn plural(count: u64, thing: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{} {thing}{ending}", HumanCount(count))
}

fn describe_samples(line: &mut impl FnMut(&str, &str), label: &str, samples: &SampleReport) {
    let Some(topic) = &samples.topic else {
        return;
    };
    let (used, total) = (samples.tally.used, samples.tally.total());
    line(
        label,
        &format!(
            "{topic}: {} of {} samples used",
            HumanCount(used),
            HumanCount(total)
        ),
    );
    for (reason, count) in &samples.tally.dropped {
        line(
            "",
            &format!("{} dropped: {}", HumanCount(*count), reason.describe()),
        );
    }
}

/// A progress bar that appears when the work takes longer than a moment.
struct Bar {
    wanted: bool,
    start: Instant,
    bar: Option<ProgressBar>,
}

impl Bar {
    const MOMENT: Duration = Duration::from_millis(400);

    fn new(wanted: bool) -> Self {
        Self {
            wanted,
            start: Instant::now(),
            bar: None,
        }
    }

    fn update(&mut self, progress: Progress) {
        if self.bar.is_none() && self.wanted && self.start.elapsed() > Self::MOMENT {
            let style =
                ProgressStyle::with_template("{wide_bar} {bytes}/{total_bytes}, {eta} left");
            let style = style.expect("the template is well-formed");
            self.bar = Some(ProgressBar::new(progress.total).with_style(style));
        }
        if let Some(bar) = &self.bar {
            bar.set_length(progress.total);
            bar.set_position(progress.done);
        }
    }

    fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
