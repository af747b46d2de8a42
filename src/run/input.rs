//! Where a log comes from.

use std::{
    io::Read,
    path::{Path, PathBuf},
};

use crate::fs::ReadAt;

/// Where a log comes from. Any path is one.
#[non_exhaustive]
pub enum Input<'a> {
    /// A file.
    File(PathBuf),
    /// What can be read by position as a file can: an object in a bucket, memory.
    Bytes {
        /// What reports and errors call it.
        name: PathBuf,
        /// The bytes.
        bytes: Box<dyn ReadAt>,
    },
    /// What is read once, from front to back: a pipe.
    Stream {
        /// What reports and errors call it.
        name: PathBuf,
        /// The stream.
        stream: Box<dyn Read + 'a>,
    },
}

impl<'a> Input<'a> {
    /// What can be read by position as a file can, and what reports and errors call it.
    pub fn bytes(name: impl AsRef<Path>, bytes: impl ReadAt + 'static) -> Self {
        Self::Bytes {
            name: name.as_ref().into(),
            bytes: Box::new(bytes),
        }
    }

    /// What is read once, from front to back, and what reports and errors call it.
    pub fn stream(name: impl AsRef<Path>, stream: impl Read + 'a) -> Self {
        Self::Stream {
            name: name.as_ref().into(),
            stream: Box::new(stream),
        }
    }

    /// What reports and errors call it.
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
