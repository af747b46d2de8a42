//! Where a result goes.

use std::{
    fs::File,
    io::Write,
    path::{Path, PathBuf},
};

use super::Left;

/// Where a result goes. Any path is one: that of a new file.
#[non_exhaustive]
pub enum Output<'a> {
    /// A new file, which appears under its name when it is complete.
    File {
        /// Its path.
        path: PathBuf,
        /// Whether what is there already is replaced.
        overwrite: bool,
    },
    /// The file that the log comes from. However the run ends, nothing is lost: until it is done, what is replaced is
    /// kept in a journal beside the file, from which the next run recovers it.
    InPlace,
    /// What is open already, for instance a pipe. If it is a file, what is written goes to its handle's position.
    Handle {
        /// What reports and errors call it.
        name: PathBuf,
        /// The handle, to which the system can copy by itself.
        handle: File,
    },
    /// Anything else that takes bytes.
    Stream {
        /// What reports and errors call it.
        name: PathBuf,
        /// The stream.
        stream: Box<dyn Write + 'a>,
    },
}

impl<'a> Output<'a> {
    /// What is open already, for instance a pipe, and what reports and errors call it.
    pub fn handle(name: impl AsRef<Path>, handle: File) -> Self {
        Self::Handle {
            name: name.as_ref().into(),
            handle,
        }
    }

    /// Anything that takes bytes, and what reports and errors call it.
    pub fn stream(name: impl AsRef<Path>, stream: impl Write + 'a) -> Self {
        Self::Stream {
            name: name.as_ref().into(),
            stream: Box::new(stream),
        }
    }

    /// What reports and errors call it.
    pub(crate) fn name(&self, input: &Path) -> PathBuf {
        match self {
            Self::File { path, .. } => path.clone(),
            Self::InPlace => input.into(),
            Self::Handle { name, .. } | Self::Stream { name, .. } => name.clone(),
        }
    }

    /// What an interrupted run leaves there.
    pub(crate) fn left(&self) -> Left {
        match self {
            Self::File { .. } => Left::Nothing,
            Self::InPlace => Left::Unchanged,
            Self::Handle { .. } | Self::Stream { .. } => Left::Incomplete,
        }
    }
}

impl<P: AsRef<Path>> From<P> for Output<'_> {
    fn from(path: P) -> Self {
        Self::File {
            path: path.as_ref().into(),
            overwrite: false,
        }
    }
}
