//! Where a log comes from.

use std::{
    io::Read,
    path::{Path, PathBuf},
};

use super::RunError;
use crate::{
    error::Error,
    fs::ReadAt,
    log::{Access, file::LogFile},
    watch::Watch,
    writer::journal,
};

/// Where a log comes from. Any path is one.
#[non_exhaustive]
pub enum Input<'a> {
    /// A file.
    File(PathBuf),
    /// Anything else that can be read by position: an object in a bucket, memory.
    Bytes {
        /// Its name in reports and errors.
        name: PathBuf,
        /// The bytes.
        bytes: Box<dyn ReadAt>,
    },
    /// Something that is read once, from front to back: a pipe.
    Stream {
        /// Its name in reports and errors.
        name: PathBuf,
        /// The stream.
        stream: Box<dyn Read + 'a>,
    },
}

impl<'a> Input<'a> {
    /// Wraps anything that can be read by position; `name` is its name in reports and errors.
    pub fn bytes(name: impl AsRef<Path>, bytes: impl ReadAt + 'static) -> Self {
        Self::Bytes {
            name: name.as_ref().into(),
            bytes: Box::new(bytes),
        }
    }

    /// Wraps something that is read once, from front to back; `name` is its name in reports and errors.
    pub fn stream(name: impl AsRef<Path>, stream: impl Read + 'a) -> Self {
        Self::Stream {
            name: name.as_ref().into(),
            stream: Box::new(stream),
        }
    }

    /// The path of the file, if it is one.
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Bytes { .. } | Self::Stream { .. } => None,
        }
    }

    /// Opens it for reading by position. If a change in place was interrupted, that is undone first.
    ///
    /// # Errors
    /// It is a stream, or it cannot be opened.
    pub(crate) fn open(self, access: Access, watch: &Watch) -> Result<LogFile, Error> {
        match self {
            Self::File(path) => {
                let announce = |interrupted: &_| watch.recovering(interrupted);
                Ok(journal::open(&path, access, &announce)?)
            }
            Self::Bytes { name, bytes } => Ok(LogFile::from_bytes(&name, bytes)?),
            Self::Stream { name, .. } => Err(RunError::Stream { name }.into()),
        }
    }

    /// Its name in reports and errors.
    pub fn name(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Bytes { name, .. } | Self::Stream { name, .. } => name,
        }
    }
}

impl<P: AsRef<Path>> From<P> for Input<'_> {
    fn from(path: P) -> Self {
        Self::File(path.as_ref().into())
    }
}
