//! Where a result goes.

use std::{
    fs::{File, OpenOptions},
    io::{IsTerminal, Write},
    path::{Path, PathBuf},
};

use super::Left;
use crate::{
    fs::is_at,
    writer::{SpecialFile, WriteError},
};

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

    /// Opens an output that has a path and is not a regular file: a pipe, or a device that takes a stream of bytes. It is
    /// written to, never replaced. `input` is the path of the log, if it is in a file.
    ///
    /// # Errors
    /// It cannot be opened, or it is something that no log can be written to, such as the input itself.
    pub(crate) fn open_special(self, input: Option<&Path>) -> Result<Self, WriteError> {
        match self {
            Self::Handle { name, handle } if is_input(&handle, input) => {
                Err(WriteError::OutputIsInput { path: name })
            }
            Self::File { path, .. } if special::is_special(&path)? => {
                let handle = OpenOptions::new().write(true).open(&path);
                let handle = handle.map_err(|source| WriteError::output(&path, source))?;
                if handle.is_terminal() {
                    let kind = SpecialFile::Terminal;
                    return Err(WriteError::OutputIsSpecial { path, kind });
                }
                Ok(Self::Handle { name: path, handle })
            }
            other => Ok(other),
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

/// Whether a handle is that of the input's file.
fn is_input(handle: &File, input: Option<&Path>) -> bool {
    let is_file = handle.metadata().is_ok_and(|metadata| metadata.is_file());
    is_file && input.is_some_and(|input| is_at(handle, input).unwrap_or(false))
}

#[cfg(unix)]
mod special {
    use std::{fs, os::unix::fs::FileTypeExt, path::Path};

    use crate::{
        fs::folder_of,
        writer::{SpecialFile, WriteError},
    };

    /// Whether a path is that of something that is written to and not replaced.
    pub fn is_special(path: &Path) -> Result<bool, WriteError> {
        let Ok(metadata) = fs::metadata(path) else {
            return Ok(false);
        };
        let kind = metadata.file_type();
        let refuse = |kind| {
            Err(WriteError::OutputIsSpecial {
                path: path.into(),
                kind,
            })
        };
        if kind.is_block_device() {
            return refuse(SpecialFile::BlockDevice);
        }
        if kind.is_socket() {
            return refuse(SpecialFile::Socket);
        }
        // Opened anew, it would be written from its start, whatever the other handle is for.
        if kind.is_file() && is_link_of_system(path) {
            return refuse(SpecialFile::OpenFile);
        }
        Ok(kind.is_fifo() || kind.is_char_device())
    }

    /// Whether a path is a link that belongs to the system, such as `/dev/stdout`: its target is an open file.
    fn is_link_of_system(path: &Path) -> bool {
        let is_link = fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink());
        let folder = fs::canonicalize(folder_of(path)).unwrap_or_default();
        is_link && (folder == Path::new("/dev") || folder.starts_with("/proc"))
    }
}

#[cfg(not(unix))]
mod special {
    use std::path::Path;

    use crate::writer::WriteError;

    /// A path is always that of a regular file here.
    pub fn is_special(_path: &Path) -> Result<bool, WriteError> {
        Ok(false)
    }
}
