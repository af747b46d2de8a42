//! The layout of a viewer that fits an enriched log: which panels there are, what each shows, and from where.
//!
//! | file | subject |
//! | --- | --- |
//! | `types` | what panels can do with messages, by the names of their types |
//! | `survey` | the topics of a log, their fields, and what the run that enriched it says about it |
//! | `panel` | what a layout consists of, whichever viewer it is for |
//! | `compose` | which panels fit a log, and where they are |
//! | `space`, `plots`, `states` | what they show |
//! | `settings`, `lichtblick`, `foxglove` | how layouts are written: what both viewers have in common, and each |
//!
//! A topic, a field or a frame is in a layout only if the log has it.

mod colours;
mod compose;
mod foxglove;
mod lichtblick;
mod panel;
mod plots;
mod settings;
mod space;
mod states;
mod survey;
mod types;

use std::{
    fmt,
    io::Write,
    path::{Path, PathBuf},
};

use serde::Serialize;
use serde_json::Value;

use crate::{
    error::Error,
    log::{Access, Log},
    report::Note,
    run::{Input, Output},
    text,
    watch::Watch,
    writer::{WriteError, destination::Destination},
};
use survey::Survey;

/// A viewer of logs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Viewer {
    /// [Lichtblick](https://github.com/lichtblick-suite/lichtblick): the files that it imports. They were seen to work in
    /// it. Foxglove's app has files of the same kind.
    #[default]
    Lichtblick,
    /// [Foxglove](https://foxglove.dev): the layouts of its SDK, for its viewer in notebooks. They agree with the SDK's
    /// types, but were never seen in a viewer.
    Foxglove,
}

impl Viewer {
    /// The name in options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lichtblick => "lichtblick",
            Self::Foxglove => "foxglove",
        }
    }
}

/// A layout that fits a log. Displayed and serialised it is JSON as its viewer reads it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct ViewerLayout {
    content: Value,
    #[serde(skip)]
    input: PathBuf,
    #[serde(skip)]
    notes: Vec<Note>,
}

/// Why there is no layout for a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum LayoutError {
    #[error(
        "{}: is not enriched, so there is nothing to show of the camera",
        text::path(path)
    )]
    NotEnriched { path: PathBuf },
}

/// Makes the layout that shows an enriched log in a viewer.
///
/// It shows most of a log that was enriched with [visuals](crate::Options::visuals); of another one it shows the numbers.
///
/// ```no_run
/// use flightcam::{Viewer, Watch};
///
/// let layout = flightcam::layout("result.mcap", Viewer::Lichtblick, &Watch::default())?;
/// layout.write("layout.json")?;
/// # Ok::<(), flightcam::Error>(())
/// ```
///
/// # Errors
/// The log cannot be read, or is not enriched.
pub fn layout<'a>(
    input: impl Into<Input<'a>>,
    viewer: Viewer,
    watch: &Watch,
) -> Result<ViewerLayout, Error> {
    let log = Log::read(input.into().open(Access::Read, watch)?)?;
    let content = compose::compose(&Survey::new(&log)?)?;
    let content = content.ok_or_else(|| LayoutError::NotEnriched {
        path: log.file.path().into(),
    })?;
    let notes = [Note::on_recovery(&log), Note::on_lost_end(&log)];
    let notes = notes
        .into_iter()
        .chain([Note::on_growth(log.file.grown_by()?)]);
    Ok(ViewerLayout {
        content: match viewer {
            Viewer::Lichtblick => lichtblick::file(&content),
            Viewer::Foxglove => foxglove::file(&content),
        },
        input: log.file.path().into(),
        notes: notes.flatten().collect(),
    })
}

impl ViewerLayout {
    /// What the user should know about the log.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Writes the layout. A new file appears under its name when it is complete.
    ///
    /// # Errors
    /// The output cannot be written, or is the log itself.
    pub fn write<'a>(&self, output: impl Into<Output<'a>>) -> Result<(), Error> {
        match output.into().open_special(Some(&self.input))? {
            Output::InPlace => Err(WriteError::OutputIsInput {
                path: self.input.clone(),
            }
            .into()),
            Output::File { path, overwrite } => {
                let destination = Destination::new(Some(&self.input), &path, overwrite)?;
                let pending = destination.create(None)?;
                self.write_to(&path, pending.file())?;
                Ok(pending.commit()?)
            }
            Output::Handle { name, handle } => self.write_to(&name, &handle),
            Output::Stream { name, stream } => self.write_to(&name, stream),
        }
    }

    fn write_to(&self, name: &Path, mut out: impl Write) -> Result<(), Error> {
        let written = out.write_all(format!("{self}\n").as_bytes());
        let flushed = written.and_then(|()| out.flush());
        Ok(flushed.map_err(|source| WriteError::output(name, source))?)
    }
}

impl fmt::Display for ViewerLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&text::to_json(&self.content))
    }
}
