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
        /// Whether a file that exists is replaced.
        overwrite: bool,
    },
    /// The log's own file. However the run ends, nothing is lost: until it is done, what is replaced is kept in a
    /// journal beside the file, from which the next run recovers it.
    InPlace,
    /// An open file or pipe, written to from its current position.
    Handle {
        /// Its name in reports and errors.
        name: PathBuf,
        /// The handle, to which the kernel can copy a log's bytes.
        handle: File,
    },
    /// Anything else that bytes can be written to.
    Stream {
        /// Its name in reports and errors.
        name: PathBuf,
        /// The stream.
        stream: Box<dyn Write + 'a>,
    },
}

impl<'a> Output<'a> {
    /// Wraps an open file or pipe; `name` is its name in reports and errors.
    pub fn handle(name: impl AsRef<Path>, handle: File) -> Self {
        Self::Handle {
            name: name.as_ref().into(),
            handle,
        }
    }

    /// Wraps anything that bytes can be written to; `name` is its name in reports and errors.
    pub fn stream(name: impl AsRef<Path>, stream: impl Write + 'a) -> Self {
        Self::Stream {
            name: name.as_ref().into(),
            stream: Box::new(stream),
        }
    }

    /// Its name in reports and errors, which is the input's if it is changed in place.
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
