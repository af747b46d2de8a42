//! A new file, which appears under its name only when it is complete.

#[cfg(unix)]
use std::os::unix::fs::PermissionsExt;
use std::{
    ffi::OsString,
    fs::{self, File, Permissions},
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;

use super::error::WriteError;
use crate::{
    fs::{grant, sync_folder},
    log::journal::journal_of,
};

/// The permissions of a new file before the user's mask is applied.
#[cfg(unix)]
const NEW_FILE: u32 = 0o666;

/// A file that is to be written.
#[derive(Debug, Clone)]
pub struct Destination {
    path: PathBuf,
    folder: PathBuf,
    overwrite: bool,
}

impl Destination {
    /// Checks that a result may be written to `path`. `input` is the path of the log, if it is in a file.
    ///
    /// # Errors
    /// Something is there already and may not be overwritten, it is the input itself, its folder does not exist, or a
    /// journal has been left there.
    pub fn new(input: Option<&Path>, path: &Path, overwrite: bool) -> Result<Self, WriteError> {
        let names_a_folder = path.as_os_str().as_encoded_bytes().ends_with(b"/");
        if path.is_dir() || names_a_folder {
            return Err(WriteError::OutputIsFolder { path: path.into() });
        }
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            return Err(WriteError::NoFolder {
                path: path.into(),
                folder,
            });
        }
        let resolved = fs::canonicalize(path);
        if let (Some(Ok(input)), Ok(output)) = (input.map(fs::canonicalize), &resolved)
            && input == *output
        {
            return Err(WriteError::OutputIsInput { path: path.into() });
        }
        if fs::symlink_metadata(path).is_ok() && !overwrite {
            return Err(WriteError::OutputExists { path: path.into() });
        }
        // The next run that opens the result would take it for the log that was being changed.
        let journal = journal_of(path);
        if journal.exists() {
            let path = path.into();
            return Err(WriteError::JournalInTheWay { path, journal });
        }
        Ok(Self {
            path: path.into(),
            folder,
            overwrite,
        })
    }

    /// The file's name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Creates the file under a temporary name in the same folder, with these permissions, or else with those of any
    /// new file.
    pub(crate) fn create(&self, permissions: Option<Permissions>) -> Result<Pending, WriteError> {
        let mut prefix = OsString::from(".");
        prefix.push(self.path.file_name().unwrap_or_default());
        prefix.push(".");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(".part");
        #[cfg(unix)]
        builder.permissions(Permissions::from_mode(NEW_FILE));
        let file = builder
            .tempfile_in(&self.folder)
            .and_then(|file| match permissions {
                Some(permissions) => grant(file.as_file(), permissions).map(|()| file),
                None => Ok(file),
            })
            .map_err(|source| WriteError::CannotCreate {
                path: self.path.clone(),
                source,
            })?;
        Ok(Pending {
            file,
            destination: self.clone(),
        })
    }

    /// The error for an output that cannot be written.
    pub(crate) fn write_error(&self, source: io::Error) -> WriteError {
        WriteError::output(&self.path, source)
    }
}

/// A file that is being written. It is removed again unless it is committed.
#[derive(Debug)]
pub(crate) struct Pending {
    file: NamedTempFile,
    destination: Destination,
}

impl Pending {
    pub fn file(&self) -> &File {
        self.file.as_file()
    }

    /// Makes the file durable and gives it its name.
    ///
    /// # Errors
    /// Something that may not be overwritten has been created there meanwhile, or the disk fails.
    pub fn commit(self) -> Result<(), WriteError> {
        let Self { file, destination } = self;
        let failed = |source| destination.write_error(source);
        file.as_file().sync_all().map_err(failed)?;
        let persisted = if destination.overwrite {
            file.persist(&destination.path)
        } else {
            file.persist_noclobber(&destination.path)
        };
        persisted.map_err(|error| match error.error.kind() {
            ErrorKind::AlreadyExists => WriteError::OutputExists {
                path: destination.path.clone(),
            },
            _ => failed(error.error),
        })?;
        sync_folder(&destination.path).map_err(failed)
    }
}
