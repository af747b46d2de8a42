//! `flightcam restore`: an enriched log in, the original out.

use std::path::PathBuf;

use clap::Args;
use flightcam::{
    Error, Output, Watch,
    restore::{Restored, restore},
    text,
};
use indicatif::HumanCount;

use super::{
    Exit, announce,
    input_output::{input, is_pipe, output},
    print::{Page, print_aside, print_result, to_json},
    progress::Bar,
    warn, words,
};

/// Turn an enriched log back into the original, byte for byte
///
/// This changes the log's own file or, with -o, writes a new one. It refuses a log that another program has
/// rewritten since. After an interrupted run, it brings the log back to what it was.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The enriched log
    log: PathBuf,

    /// Write the original to a new file, and leave the enriched log as it is; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Replace an output that exists
    #[arg(long, requires = "output")]
    force: bool,

    /// Print only errors, no report and no progress
    #[arg(short, long)]
    quiet: bool,

    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let output = match &arguments.output {
        None => Output::InPlace,
        Some(name) => output(name, arguments.force)?,
    };
    let to_stdout = arguments.output.as_deref().is_some_and(is_pipe);
    let bar = Bar::new(arguments.quiet || to_stdout);
    let mut watch = Watch::new(bar.watch());
    if !arguments.quiet {
        watch = watch.on_recovery(announce);
    }
    let restored = restore(input(&arguments.log)?, output, &watch);
    bar.clear();
    let restored = restored?;
    let text = match (arguments.json, arguments.quiet) {
        (true, _) => Some(to_json(&restored)),
        (false, false) => Some(describe(&restored).text().to_owned()),
        (false, true) => None,
    };
    match text {
        Some(text) if to_stdout => print_aside(&text),
        Some(text) => print_result(&text),
        None => {}
    }
    // The only note there is: what another program was still writing was not read.
    if restored.notes.is_empty() {
        return Ok(Exit::Done);
    }
    if arguments.json || arguments.quiet {
        warn(&arguments.log, &restored.notes);
    }
    Ok(Exit::PartlyUnreadable)
}

fn describe(restored: &Restored) -> Page {
    let mut page = Page::default();
    page.line("Log", text::path(&restored.input));
    if restored.recovered {
        page.line(
            "Undone",
            "an earlier run that was interrupted while it changed the log",
        );
    }
    if let Some(earlier) = &restored.undone {
        page.line("Undone", format!("what flightcam added ({earlier})"));
    }
    for note in &restored.notes {
        page.line("Note", words::note(note));
    }
    let bytes = HumanCount(restored.bytes);
    let output = text::path(&restored.output);
    page.line("Result", format!("{output}, {bytes} bytes"));
    page
}
