//! `flightcam enrich`: a log in, the same log with the camera's channels out.

use std::path::PathBuf;

use clap::{Args, ValueEnum, error::ErrorKind};
use flightcam::{
    Error, Options, enrich,
    enrich::{default_output, enrich_stream, enrich_stream_to_file},
    enrich_in_place, enrich_to,
    messages::{Encoding, EncodingChoice},
    transform::MaxGap,
    writer::Layout,
};

use super::{
    Exit,
    camera::CameraArguments,
    complain, number,
    pipe::{self, is_pipe},
    print_aside, print_result,
    progress::Bar,
    report::describe,
    telemetry::{EXAMPLES, TelemetryArguments},
    words, wrong_arguments,
};

const USUAL: &str = "\
Examples:
  flightcam enrich flight.mcap                       a gimbal whose angles the log has
  flightcam enrich flight.mcap --depression 30       a gimbal held 30° below the horizon
  flightcam enrich flight.mcap --mount 0,-30,0       a camera bolted to the airframe";

/// Add /camera/relative_rpy and /camera/velocity to a log
///
/// The result is a new file, or with --in-place the log itself, with every byte of the log's data unchanged and
/// the new channels behind it. `flightcam restore` undoes it. Of a log that is enriched already the earlier result
/// is replaced.
#[derive(Debug, Args)]
#[command(override_usage = "flightcam enrich <INPUT> [--depression <DEG>] [OPTIONS]")]
#[command(after_help = USUAL, after_long_help = format!("{USUAL}\n\n{EXAMPLES}"))]
pub struct Arguments {
    /// The flight log, an MCAP file; - reads standard input
    input: PathBuf,

    /// Where the result goes; - writes to standard output [default: NAME.enriched.mcap beside the log]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Change the log's own file. However that ends, nothing is lost: until it is done, what is replaced is kept
    /// in a journal beside the log, from which the next run of flightcam recovers it
    #[arg(long, conflicts_with_all = ["output", "force"])]
    in_place: bool,

    /// The longest time between two attitude samples that still belong together
    #[arg(long, value_name = "SECONDS", value_parser = max_gap, default_value = "5", allow_negative_numbers = true)]
    max_gap: MaxGap,

    /// How the new messages are encoded
    #[arg(long, value_enum, default_value = "auto")]
    encoding: EncodingArgument,

    /// Where in the log the new messages lie
    #[arg(long, value_enum, default_value = "append")]
    layout: LayoutArgument,

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

/// Where the result goes.
enum Target {
    File(PathBuf),
    InPlace,
    Stdout,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum LayoutArgument {
    /// Behind the log's data, of which no byte changes
    Append,
    /// Behind each chunk what was derived from its time, for readers that use no index. Cannot be undone
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

impl Arguments {
    /// Where the result goes. Contradictory arguments end the process here.
    fn target(&self) -> Target {
        let refuse = |problem: &str| wrong_arguments(ErrorKind::ArgumentConflict, problem);
        match &self.output {
            _ if self.in_place && is_pipe(&self.input) => {
                refuse("standard input cannot be changed --in-place")
            }
            _ if self.in_place => Target::InPlace,
            None if is_pipe(&self.input) => refuse(
                "name the output of a log from standard input with -o; -o - is standard output",
            ),
            None => Target::File(default_output(&self.input)),
            Some(output) if !is_pipe(output) => Target::File(output.clone()),
            Some(_) if pipe::stdout_is_terminal() => refuse(
                "a log is nothing for a terminal; redirect standard output, or name a file with -o",
            ),
            Some(_) => Target::Stdout,
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
        layout: arguments.layout.into(),
        overwrite: arguments.force,
    };
    let input = &arguments.input;
    let target = arguments.target();
    let mut bar = Bar::new(arguments.quiet || is_pipe(input) || matches!(target, Target::Stdout));
    let watch = &mut |progress| bar.update(progress);
    let report = match (is_pipe(input), &target) {
        (false, Target::File(output)) => enrich(input, output, &options, watch),
        (_, Target::InPlace) => enrich_in_place(input, &options, watch),
        (false, Target::Stdout) => enrich_to(input, pipe::stdout()?, &options, watch),
        (true, Target::File(output)) => {
            enrich_stream_to_file(pipe::stdin()?, output, &options, watch)
        }
        (true, Target::Stdout) => enrich_stream(pipe::stdin()?, pipe::stdout()?, &options, watch),
    };
    bar.clear();
    let report = report?;

    let text = match (arguments.json, arguments.quiet) {
        (true, _) => {
            let json = serde_json::to_string_pretty(&report);
            Some(json.expect("a report has only string keys"))
        }
        (false, false) => Some(describe(&report)),
        (false, true) => None,
    };
    match (text, target) {
        (Some(text), Target::Stdout) => print_aside(&text),
        (Some(text), _) => print_result(&text),
        (None, _) => {}
    }
    if report.complete {
        return Ok(Exit::Done);
    }
    if arguments.quiet || arguments.json {
        for note in &report.notes {
            complain(
                "warning",
                &format!("{}: {}", input.display(), words::note(note)),
            );
        }
    }
    Ok(Exit::PartlyUnreadable)
}

fn max_gap(seconds: &str) -> Result<MaxGap, String> {
    MaxGap::from_seconds(number(seconds)?).map_err(|error| error.to_string())
}
