//! `flightcam manual`: manual pages, made from what `--help` says.

use std::{fs, io, path::PathBuf};

use clap::{Args, Command, CommandFactory, builder::StyledStr};
use clap_mangen::{
    Man,
    roff::{Roff, roman},
};
use flightcam::Error;

use super::{
    Cli, Exit,
    print::{complain, print_result},
};

/// Print the manual page, or write one for each command
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  flightcam manual | man -l -                 read it now
  flightcam manual ~/.local/share/man/man1    install all pages, then `man flightcam-enrich`")]
pub struct Arguments {
    /// The folder to write a page for each command to, as in flightcam-enrich.1
    folder: Option<PathBuf>,
}

/// A manual page and the name of its file.
struct Page {
    file: String,
    text: Vec<u8>,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let written = match &arguments.folder {
        None => page(program()).map(|page| {
            print_result(String::from_utf8_lossy(&page.text).trim_end());
        }),
        Some(folder) => pages().and_then(|pages| {
            fs::create_dir_all(folder)?;
            (pages.into_iter()).try_for_each(|page| fs::write(folder.join(page.file), page.text))
        }),
    };
    match written {
        Ok(()) => Ok(Exit::Done),
        Err(error) => {
            complain("error", &format!("cannot write the manual: {error}"));
            Ok(Exit::Failed)
        }
    }
}

fn program() -> Command {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    program
}

/// The page of the program, and one for each of its commands.
fn pages() -> io::Result<Vec<Page>> {
    let program = program();
    let commands: Vec<Command> = program.get_subcommands().cloned().collect();
    commands.into_iter().chain([program]).map(page).collect()
}

fn page(command: Command) -> io::Result<Page> {
    let after = command.get_after_long_help().or(command.get_after_help());
    let after = after.map(StyledStr::to_string).unwrap_or_default();
    let man = Man::new(command.after_help(None).after_long_help(None))
        // An empty date would be left out, and the rest of the title would take its place.
        .date(" ")
        .source(concat!("flightcam ", env!("CARGO_PKG_VERSION")))
        .manual("User Commands");
    let mut text = Vec::new();
    man.render(&mut text)?;
    sections(&after).to_writer(&mut text)?;
    Ok(Page {
        file: man.get_filename(),
        text,
    })
}

/// Converts what `--help` says after the options, keeping its lines. Lines like `Examples:` become headings.
fn sections(text: &str) -> Roff {
    let mut roff = Roff::new();
    for line in text.lines() {
        match line.strip_suffix(':') {
            Some(heading) if !line.starts_with(' ') => {
                roff.control("SH", [heading.to_uppercase().as_str()]);
                roff.control("nf", []); // The heading turned filling on.
            }
            _ => {
                roff.text([roman(line)]);
            }
        }
    }
    roff
}
