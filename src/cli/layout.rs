//! `flightcam layout`: an enriched log in, the layout in which a viewer shows it out.

use std::path::PathBuf;

use clap::{Args, ValueEnum, builder::PossibleValue};
use flightcam::{Error, Viewer, Watch, layout, report::Note};

use super::{
    Exit, announce,
    input_output::{input, is_pipe, output},
    print::print_result,
    warn,
};

/// Write the layout in which a viewer shows an enriched log
///
/// The layout has a panel for all that the log has: drone and camera in 3D, the track on a map, plots, states, pictures.
/// It fits this log: the map shows its place, and the 3D view is as wide as the flight. `flightcam enrich --visuals` adds
/// what most of the panels show; without that there are plots only.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  flightcam enrich flight.mcap --depression 30 --visuals -o shown.mcap
  flightcam layout shown.mcap -o layout.json")]
pub struct Arguments {
    /// The enriched log
    log: PathBuf,

    /// Write the layout to a file; - is standard output [default: -]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// The viewer whose layout is written
    #[arg(
        long = "for",
        value_name = "VIEWER",
        value_enum,
        default_value = "lichtblick"
    )]
    viewer: ViewerArgument,

    /// Replace an output that exists
    #[arg(long, requires = "output")]
    force: bool,
}

#[derive(Debug, Clone, Copy)]
struct ViewerArgument(Viewer);

impl ValueEnum for ViewerArgument {
    fn value_variants<'a>() -> &'a [Self] {
        const { &[Self(Viewer::Lichtblick), Self(Viewer::Foxglove)] }
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self.0 {
            Viewer::Foxglove => {
                "As Foxglove's SDK writes layouts, for its viewer in notebooks. It was never tried"
            }
            _ => {
                "A file for Lichtblick, in which it was seen to work. Foxglove's app has files of the same kind"
            }
        };
        Some(PossibleValue::new(self.0.name()).help(help))
    }
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let watch = Watch::default().on_recovery(announce);
    let layout = layout(input(&arguments.log)?, arguments.viewer.0, &watch)?;
    match arguments.output.as_deref().filter(|name| !is_pipe(name)) {
        None => print_result(&layout.to_string()),
        Some(name) => layout.write(output(name, arguments.force)?)?,
    }
    // That an interrupted run was undone has been said.
    let lost = |note: &&Note| !matches!(note, Note::Recovered);
    let notes: Vec<Note> = layout.notes().iter().filter(lost).cloned().collect();
    warn(&arguments.log, &notes);
    Ok(match notes.is_empty() {
        true => Exit::Done,
        false => Exit::PartlyUnreadable,
    })
}
