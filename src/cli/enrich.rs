//! `flightcam enrich`: a log in, the same log with the camera's channels out.

use std::{
    fmt::Write as _,
    io::{self, IsTerminal},
    path::PathBuf,
    time::{Duration, Instant},
};

use clap::{
    Args, ValueEnum,
    builder::{PathBufValueParser, TypedValueParser},
};
use flightcam::{
    Error, Options, Progress, Report,
    enrich::{default_output, enrich},
    messages::{Encoding, EncodingChoice},
    report::SampleReport,
    transform::{Breaks, MaxGap},
};
use indicatif::{HumanCount, ProgressBar, ProgressStyle};

use super::{
    Exit,
    camera::CameraArguments,
    complain, number, plural, print_result,
    telemetry::{EXAMPLES, TelemetryArguments},
};

const USUAL: &str = "\
Examples:
  flightcam enrich flight.mcap                       a gimbal whose angles the log has
  flightcam enrich flight.mcap --depression 30       a gimbal held 30° below the horizon
  flightcam enrich flight.mcap --mount 0,-30,0       a camera bolted to the airframe";

/// Write a log again with /camera/relative_rpy and /camera/velocity
///
/// The log stays as it is. The result is a new file with every byte of the log's data unchanged and the new
/// channels behind it.
#[derive(Debug, Args)]
#[command(override_usage = "flightcam enrich <INPUT> [--depression <DEG>] [OPTIONS]")]
#[command(after_help = USUAL, after_long_help = format!("{USUAL}\n\n{EXAMPLES}"))]
pub struct Arguments {
    /// The flight log, an MCAP file
    input: PathBuf,

    /// Where the result goes [default: NAME.enriched.mcap beside the log]
    #[arg(short, long, value_name = "FILE", value_parser = file_name())]
    output: Option<PathBuf>,

    /// The longest time between two attitude samples that still belong together
    #[arg(long, value_name = "SECONDS", value_parser = max_gap, default_value = "5", allow_negative_numbers = true)]
    max_gap: MaxGap,

    /// How the new messages are encoded
    #[arg(long, value_enum, default_value = "auto")]
    encoding: EncodingArgument,

    /// Replace an output that exists
    #[arg(long)]
    force: bool,

    /// Print no report and no progress, only errors
    #[arg(short, long)]
    quiet: bool,

    /// Print the report as JSON
    #[arg(long)]
    json: bool,

    // Last, because their headings hold for all that follows.
    #[command(flatten)]
    camera: CameraArguments,

    #[command(flatten)]
    telemetry: TelemetryArguments,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum EncodingArgument {
    /// As the telemetry is: ROS 2 for ROS 2, JSON for JSON, else protobuf
    Auto,
    /// flightcam.v1.RelativeRpy and flightcam.v1.CameraVelocity
    Protobuf,
    /// The same fields in JSON
    Json,
    /// geometry_msgs/msg/Vector3Stamped for both
    Ros2,
}

impl From<EncodingArgument> for EncodingChoice {
    fn from(argument: EncodingArgument) -> Self {
        match argument {
            EncodingArgument::Auto => Self::Automatic,
            EncodingArgument::Protobuf => Self::Given(Encoding::Protobuf),
            EncodingArgument::Json => Self::Given(Encoding::Json),
            EncodingArgument::Ros2 => Self::Given(Encoding::Ros2),
        }
    }
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let options = Options {
        depression: arguments.camera.depression,
        mount: arguments.camera.mount,
        max_gap: arguments.max_gap,
        telemetry: arguments.telemetry.request()?,
        encoding: arguments.encoding.into(),
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

    if arguments.json {
        let json = serde_json::to_string_pretty(&report);
        print_result(&json.expect("a report has only string keys"));
    } else if !arguments.quiet {
        print_result(&describe(&report));
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
    line("Camera", &report.camera.to_string());
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
    if let Some(gimbal) = &report.gimbal {
        describe_samples(&mut line, "Gimbal", gimbal);
    }
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
    let paths: Vec<String> = (report.written.iter())
        .map(|topic| {
            format!(
                "{}{}",
                topic.topic,
                telling_field(topic.topic, report.encoding.name)
            )
        })
        .collect();
    let _ = write!(
        text,
        "\nTo look at it, open the result in Foxglove (https://foxglove.dev), add a Plot panel, and plot {}.",
        paths.join(" and ")
    );
    text
}

/// The field of a topic's messages that shows most at a glance, as Foxglove writes its path.
fn telling_field(topic: &str, encoding: Encoding) -> &'static str {
    let is_velocity = topic == "/camera/velocity";
    match (is_velocity, encoding) {
        (false, Encoding::Protobuf | Encoding::Json) => ".yaw",
        (false, Encoding::Ros2) => ".vector.z",
        (true, Encoding::Protobuf | Encoding::Json) => ".x",
        (true, Encoding::Ros2) => ".vector.x",
    }
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
