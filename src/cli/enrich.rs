//! `flightcam enrich`: a log in, the same log with the camera's channels out.

use std::{
    path::{Path, PathBuf},
    sync::LazyLock,
};

use clap::{Args, ValueEnum, builder::PossibleValue, error::ErrorKind};
use flightcam::{
    Error, Options, Output, Report, enrich,
    messages::{Encoding, EncodingChoice},
    transform::{MaxGap, MinInterval},
    writer::Layout,
};

use super::{
    Exit, announce,
    camera::CameraArguments,
    input_output::{input, is_pipe, output},
    number,
    print::{print_aside, print_result, to_json},
    progress::Bar,
    report::describe,
    telemetry::{EXAMPLES, TelemetryArguments},
    visuals::VisualArguments,
    warn, wrong_arguments,
};

const USUAL: &str = "\
Examples:
  flightcam enrich flight.mcap                       a gimbal whose angles are in the log
  flightcam enrich flight.mcap --depression 30       a gimbal held 30° below the horizon
  flightcam enrich flight.mcap --mount 0,-30,0       a camera bolted to the airframe";

/// Add /camera/relative_rpy, /camera/orientation and /camera/velocity to a log
///
/// The result is a new file or, with --in-place, the log itself. Every byte of the log's data stays as it is, and
/// the new channels are appended after it. `flightcam restore` undoes this. If the log is already enriched, the
/// earlier result is replaced.
#[derive(Debug, Args)]
#[command(override_usage = "flightcam enrich <INPUT> [--depression <DEG>] [OPTIONS]")]
#[command(after_help = USUAL, after_long_help = format!("{USUAL}\n\n{EXAMPLES}"))]
pub struct Arguments {
    /// The flight log, an MCAP file; - reads standard input
    input: PathBuf,

    /// Where to write the result; - is standard output [default: NAME.enriched.mcap beside the log]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Change the log's own file. Nothing is lost, however the run ends: until it is done, what is being replaced
    /// is kept in a journal beside the log, and the next run of flightcam restores it from there
    #[arg(long, conflicts_with_all = ["output", "force"])]
    in_place: bool,

    /// The longest time between two attitude samples that still belong together
    #[arg(long, value_name = "SECONDS", value_parser = max_gap, default_value = "5", allow_negative_numbers = true)]
    max_gap: MaxGap,

    /// Leave out attitude samples that are closer than this to the one before, for logs that write them in bursts
    #[arg(long, value_name = "SECONDS", value_parser = min_interval, default_value = "0", allow_negative_numbers = true)]
    min_interval: MinInterval,

    /// How the new messages are encoded
    #[arg(long, value_enum, default_value = "auto")]
    encoding: EncodingArgument,

    /// Where in the log the new messages go
    #[arg(long, value_enum, default_value = "append")]
    layout: LayoutArgument,

    /// Replace an output that exists
    #[arg(long)]
    force: bool,

    /// Go on although the log's own numbers show that it was read wrongly
    #[arg(long)]
    trust: bool,

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
    visuals: VisualArguments,

    #[command(flatten)]
    telemetry: TelemetryArguments,
}

#[derive(Debug, Clone, Copy)]
struct EncodingArgument(EncodingChoice);

impl ValueEnum for EncodingArgument {
    fn value_variants<'a>() -> &'a [Self] {
        static VARIANTS: LazyLock<Vec<EncodingArgument>> = LazyLock::new(|| {
            let given = Encoding::ALL.map(EncodingChoice::Given);
            let choices = [EncodingChoice::Automatic].into_iter().chain(given);
            choices.map(EncodingArgument).collect()
        });
        &VARIANTS
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self.0 {
            EncodingChoice::Given(encoding) => {
                Some(PossibleValue::new(encoding.name()).help(encoding.summary()))
            }
            _ => Some(
                PossibleValue::new("auto")
                    .help("Like the telemetry: ROS 2 for ROS 2, JSON for JSON, otherwise protobuf"),
            ),
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum LayoutArgument {
    /// After the log's data, which stays as it is
    Append,
    /// After each chunk, what was derived for the same time, for readers that do not use the index. Cannot be
    /// undone
    Interleaved,
}

impl From<LayoutArgument> for Layout {
    fn from(argument: LayoutArgument) -> Self {
        match argument {
            LayoutArgument::Append => Self::Append,
            LayoutArgument::Interleaved => Self::Interleaved,
        }
    }
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let bar = Bar::new(arguments.quiet || arguments.reads_stdin() || arguments.writes_stdout());
    let mut options = arguments.options()?.watch(bar.watch());
    if !arguments.quiet {
        options = options.on_recovery(announce);
    }
    let report = enrich(input(&arguments.input)?, arguments.output()?, &options);
    bar.clear();
    let report = report?;
    arguments.print(&report);
    Ok(match report.complete {
        true => Exit::Done,
        false => Exit::PartlyUnreadable,
    })
}

impl Arguments {
    fn reads_stdin(&self) -> bool {
        is_pipe(&self.input)
    }

    fn writes_stdout(&self) -> bool {
        self.output.as_deref().is_some_and(is_pipe)
    }

    fn options(&self) -> Result<Options, Error> {
        Ok(Options::new()
            .depression(self.camera.depression)
            .mount(self.camera.mount)
            .max_gap(self.max_gap)
            .min_interval(self.min_interval)
            .trust(self.trust)
            .telemetry(self.telemetry.request()?)
            .encoding(self.encoding.0)
            .layout(self.layout.into())
            .visuals(self.visuals.options()))
    }

    /// Where the result goes. Contradictory arguments end the process here.
    fn output(&self) -> Result<Output<'static>, Error> {
        let refuse = |problem: &str| wrong_arguments(ErrorKind::ArgumentConflict, problem);
        match &self.output {
            _ if self.in_place && self.reads_stdin() => {
                refuse("standard input cannot be changed in place")
            }
            _ if self.in_place => Ok(Output::InPlace),
            None if self.reads_stdin() => refuse(
                "a log from standard input needs an output: -o FILE, or -o - for standard output",
            ),
            None => output(&beside(&self.input), self.force),
            Some(name) => output(name, self.force),
        }
    }

    fn print(&self, report: &Report) {
        let text = match (self.json, self.quiet) {
            (true, _) => Some(to_json(report)),
            (false, false) => Some(describe(report).text().to_owned()),
            (false, true) => None,
        };
        match text {
            Some(text) if self.writes_stdout() => print_aside(&text),
            Some(text) => print_result(&text),
            None => {}
        }
        if !report.complete && (self.quiet || self.json) {
            warn(&self.input, &report.notes);
        }
    }
}

/// The default output: `NAME.enriched.mcap` beside the log.
fn beside(log: &Path) -> PathBuf {
    let mut name = log.file_stem().unwrap_or_default().to_owned();
    name.push(".enriched.mcap");
    log.with_file_name(name)
}

fn min_interval(seconds: &str) -> Result<MinInterval, String> {
    MinInterval::from_seconds(number(seconds)?).map_err(|error| error.to_string())
}

fn max_gap(seconds: &str) -> Result<MaxGap, String> {
    MaxGap::from_seconds(number(seconds)?).map_err(|error| error.to_string())
}
