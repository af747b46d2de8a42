//! The command line: one file per subcommand, with its arguments and what it prints.

mod camera;
mod check;
mod completions;
mod enrich;
mod hint;
mod input_output;
mod inspect;
mod layout;
mod manual;
mod own_profiles;
mod print;
mod profiles;
mod progress;
mod report;
mod restore;
mod telemetry;
mod visuals;
mod words;

use std::{path::Path, process::ExitCode};

use clap::{CommandFactory, Parser, Subcommand, error::ErrorKind};
use flightcam::{Error, Note, text, writer::journal::Interrupted};
use print::{complain, exit_with};

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  failed; the log is unchanged
  2  wrong arguments
  3  done, but part of the log could not be read
  4  check: something in the log is certainly read wrongly";

/// Add the camera's motion to drone flight logs in MCAP
///
/// flightcam reads a log, works out from the drone's attitude and velocity where the camera was looking and
/// how it moved, and adds that to the log as new channels.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100, after_long_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Enrich(enrich::Arguments),
    Inspect(inspect::Arguments),
    Check(check::Arguments),
    Layout(layout::Arguments),
    Restore(restore::Arguments),
    Profiles(profiles::Arguments),
    Completions(completions::Arguments),
    Manual(manual::Arguments),
}

/// The program's exit codes, which [`EXIT_CODES`] explains.
enum Exit {
    Done,
    Failed,
    WrongArguments,
    PartlyUnreadable,
    FoundWrong,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        match exit {
            Exit::Done => ExitCode::SUCCESS,
            Exit::Failed => ExitCode::from(1),
            Exit::WrongArguments => ExitCode::from(2),
            Exit::PartlyUnreadable => ExitCode::from(3),
            Exit::FoundWrong => ExitCode::from(4),
        }
    }
}

/// Runs what the arguments ask for. Wrong arguments end the process here, with an explanation.
pub fn run() -> ExitCode {
    // Report hitting the file-size limit as a write error; by default SIGXFSZ would kill the process.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
    let result = match Cli::try_parse()
        .unwrap_or_else(|error| exit_with(error))
        .command
    {
        Command::Enrich(arguments) => enrich::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Layout(arguments) => layout::run(&arguments),
        Command::Restore(arguments) => restore::run(&arguments),
        Command::Profiles(arguments) => profiles::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Manual(arguments) => manual::run(&arguments),
    };
    result
        .unwrap_or_else(|error| {
            complain("error", &explain(&error));
            exit_for(&error)
        })
        .into()
}

/// Says that an interrupted change of a log is about to be undone.
fn announce(interrupted: &Interrupted) {
    let Interrupted { log, journal, .. } = interrupted;
    let journal = Path::new(journal.file_name().unwrap_or_default());
    complain(
        "note",
        &format!(
            "{}: an earlier run was interrupted while it changed the log; first the log gets its old end back, from {}",
            text::path(log),
            text::path(journal),
        ),
    );
}

/// Writes notes on a log to standard error, if nothing else tells people of them.
fn warn(log: &Path, notes: &[Note]) {
    for note in notes {
        complain(
            "warning",
            &format!("{}: {}", text::path(log), words::note(note)),
        );
    }
}

/// Describes an error and, below it, what to do about it.
fn explain(error: &Error) -> String {
    match hint::hint(error) {
        Some(hint) => format!("{error}\nhint: {hint}"),
        None => error.to_string(),
    }
}

fn exit_for(error: &Error) -> Exit {
    if hint::is_usage(error) {
        Exit::WrongArguments
    } else {
        Exit::Failed
    }
}

/// Ends the process because of arguments that do not go together.
fn wrong_arguments(kind: ErrorKind, problem: &str) -> ! {
    exit_with(Cli::command().error(kind, problem))
}

fn number(text: &str) -> Result<f64, String> {
    text.parse()
        .map_err(|_| "not a number; write it as 30 or 30.5".to_owned())
}
