//! A new file, which appears under its name only when it is complete.

use std::{
    fs::{self, File, Permissions},
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use super::{
    error::WriteError,
    journal::{is_journal, journal_of},
};
use crate::fs::{NewFile, folder_of, sync_folder};

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
        let folder = folder_of(path).to_owned();
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
        if is_journal(path) {
            return Err(WriteError::OutputIsJournal { path: path.into() });
        }
        // The next run that opens the result would take it for the log that was being changed.
        let journal = journal_of(path);
        if fs::symlink_metadata(&journal).is_ok() {
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

    /// Creates the file, which has no name yet, in its folder, with these permissions, or else with those of any new
    /// file.
    pub(crate) fn create(&self, permissions: Option<Permissions>) -> Result<Pending, WriteError> {
        let name = self.path.file_name().unwrap_or_default();
        let file = NewFile::create(&self.folder, name, permissions);
        Ok(Pending {
            file: file.map_err(|source| WriteError::CannotCreate {
                path: self.path.clone(),
                source,
            })?,
            destination: self.clone(),
        })
    }

    /// The error for an output that cannot be written.
    pub(crate) fn write_error(&self, source: io::Error) -> WriteError {
        WriteError::output(&self.path, source)
    }
}

/// A file that is being written. Nothing is left of it unless it is committed.
#[derive(Debug)]
pub(crate) struct Pending {
    file: NewFile,
    destination: Destination,
}

impl Pending {
    pub fn file(&self) -> &File {
        self.file.file()
    }

    /// Makes the file durable and gives it its name.
    ///
    /// # Errors
    /// Something that may not be overwritten has been created there meanwhile, or the disk fails.
    pub fn commit(self) -> Result<(), WriteError> {
        let Self { file, destination } = self;
        let failed = |source| destination.write_error(source);
        file.file().sync_all().map_err(failed)?;
        let named = file.give_name(&destination.path, destination.overwrite);
        named.map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => WriteError::OutputExists {
                path: destination.path.clone(),
            },
            _ => failed(error),
        })?;
        sync_folder(&destination.path).map_err(failed)
    }
}
