//! `flightcam profiles`: which logs are understood, and profiles as starting points for your own.

use clap::Args;
use flightcam::{Error, source::profile::Profile};

use super::{Exit, print::print_result};

/// List the built-in profiles, or print one as a starting point for your own
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  flightcam profiles flat > mine.toml
  flightcam enrich flight.mcap --profile mine.toml --depression 30")]
pub struct Arguments {
    /// The profile to print, with the sources of its conventions
    name: Option<String>,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let text = match &arguments.name {
        Some(name) => Profile::built_in_text(name)?.trim_end().to_owned(),
        None => list(&Profile::built_in()),
    };
    print_result(&text);
    Ok(Exit::Done)
}

fn list(profiles: &[Profile]) -> String {
    let width = profiles.iter().map(|profile| profile.name.len()).max();
    let width = width.unwrap_or(0);
    let lines: Vec<String> = (profiles.iter())
        .map(|profile| {
            let by_name = match profile.automatic {
                true => "",
                false => " (only by --profile)",
            };
            format!("{:<width$}  {}{by_name}", profile.name, profile.description)
        })
        .collect();
    lines.join("\n")
}
