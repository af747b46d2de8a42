//! The command line: one file a subcommand, each with its arguments and what it prints.

mod enrich;
mod telemetry;

use std::{
    io::{self, Write},
    process::ExitCode,
};

use clap::{Parser, Subcommand};
use flightcam::Error;

/// Adds the camera's motion to drone flight logs in MCAP
///
/// flightcam reads a log, works out from the drone's attitude and velocity where the camera was looking and
/// how it moved, and writes the log again with that as new channels.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Enrich(enrich::Arguments),
}

/// What scripts learn from an exit; the README lists the codes.
enum Exit {
    Done,
    Failed,
    WrongArguments,
    PartlyUnreadable,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        match exit {
            Exit::Done => ExitCode::SUCCESS,
            Exit::Failed => ExitCode::from(1),
            Exit::WrongArguments => ExitCode::from(2),
            Exit::PartlyUnreadable => ExitCode::from(3),
        }
    }
}

/// Runs what the arguments ask for. Wrong arguments end the process here, with an explanation.
pub fn run() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Enrich(arguments) => enrich::run(&arguments),
    };
    result
        .unwrap_or_else(|error| {
            complain("error", &error.to_string());
            exit_for(&error)
        })
        .into()
}

/// Writes to standard error, which is not worth failing for.
fn complain(what: &str, message: &str) {
    let _ = writeln!(io::stderr(), "{what}: {message}");
}

fn exit_for(error: &Error) -> Exit {
    if error.is_usage() {
        Exit::WrongArguments
    } else {
        Exit::Failed
    }
}
