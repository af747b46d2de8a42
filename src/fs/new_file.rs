//! A new file that gets its name when it is complete.

use std::{
    ffi::{OsStr, OsString},
    fs::{self, File, Permissions},
    io::{self, ErrorKind},
    path::Path,
};

use tempfile::{NamedTempFile, TempPath};

use super::grant;

/// The end of the hidden name that a file has until it gets its own, where it cannot be without a name.
const HIDDEN: &str = ".flightcam-part";

/// The permissions of a new file before the user's mask is applied.
#[cfg(unix)]
const NEW_FILE: u32 = 0o666;

/// A file that is being written. Unless it gets its name, nothing is left of it.
///
/// Where the system has files without a name, it is one of them, so that nothing is left even if the process is killed.
/// Elsewhere it has a hidden name. What a killed process leaves there, the next one with the same output removes.
#[derive(Debug)]
pub struct NewFile {
    file: File,
    hidden: Option<TempPath>,
}

impl NewFile {
    /// Creates a file in a folder, which is to be called `name`, with these permissions, or else with those of any new
    /// file.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn create(
        folder: &Path,
        name: &OsStr,
        permissions: Option<Permissions>,
    ) -> io::Result<Self> {
        let new = match without_name(folder) {
            Some(file) => Self { file, hidden: None },
            None => Self::hidden(folder, name)?,
        };
        match permissions {
            Some(permissions) => grant(&new.file, permissions).map(|()| new),
            None => Ok(new),
        }
    }

    fn hidden(folder: &Path, name: &OsStr) -> io::Result<Self> {
        let prefix = hidden_prefix(name);
        remove_abandoned(folder, &prefix);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(HIDDEN);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(NEW_FILE));
        let (file, path) = builder.tempfile_in(folder)?.into_parts();
        // By this others see that it is not abandoned. Where there are no locks, nothing is ever removed.
        let _ = file.try_lock();
        Ok(Self {
            file,
            hidden: Some(path),
        })
    }

    /// The file itself.
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Gives the file its name. With `overwrite`, it replaces a file of that name.
    ///
    /// # Errors
    /// There is a file of that name ([`ErrorKind::AlreadyExists`]), or it cannot be replaced.
    pub fn give_name(self, path: &Path, overwrite: bool) -> io::Result<()> {
        match (self.hidden, overwrite) {
            (Some(hidden), true) => Ok(hidden.persist(path)?),
            (Some(hidden), false) => Ok(hidden.persist_noclobber(path)?),
            (None, overwrite) => match link(&self.file, path) {
                Err(error) if overwrite && error.kind() == ErrorKind::AlreadyExists => {
                    replace(&self.file, path)
                }
                linked => linked,
            },
        }
    }
}

/// Replaces a file by one that has no name. A link replaces nothing, so that gets a hidden name first.
fn replace(file: &File, path: &Path) -> io::Result<()> {
    let folder = super::folder_of(path);
    let prefix = hidden_prefix(path.file_name().unwrap_or_default());
    remove_abandoned(folder, &prefix);
    let _ = file.try_lock();
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(HIDDEN);
    let hidden: NamedTempFile<()> = builder.make_in(folder, |hidden| link(file, hidden))?;
    Ok(hidden.into_temp_path().persist(path)?)
}

fn hidden_prefix(name: &OsStr) -> OsString {
    let mut prefix = OsString::from(".");
    prefix.push(name);
    prefix.push(".");
    prefix
}

/// Removes the hidden files that killed processes have left, as far as that can be told and done.
fn remove_abandoned(folder: &Path, prefix: &OsStr) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.as_encoded_bytes();
        let is_hidden = name.starts_with(prefix.as_encoded_bytes())
            && name.ends_with(HIDDEN.as_bytes())
            && entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_hidden && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The files of this process by their numbers, through which a file without a name can be given one.
#[cfg(target_os = "linux")]
const OPEN_FILES: &str = "/proc/self/fd";

/// Creates a file without a name; `None` if the file system has no such files.
#[cfg(target_os = "linux")]
fn without_name(folder: &Path) -> Option<File> {
    use rustix::fs::{Mode, OFlags, open};
    if !Path::new(OPEN_FILES).is_dir() {
        return None;
    }
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    let file = open(folder, flags, Mode::from_raw_mode(NEW_FILE)).ok()?;
    Some(file.into())
}

/// Gives a file without a name its first one.
#[cfg(target_os = "linux")]
fn link(file: &File, path: &Path) -> io::Result<()> {
    use std::os::fd::AsRawFd;

    use rustix::fs::{AtFlags, CWD, linkat};
    let open = format!("{OPEN_FILES}/{}", file.as_raw_fd());
    Ok(linkat(CWD, open, CWD, path, AtFlags::SYMLINK_FOLLOW)?)
}

#[cfg(not(target_os = "linux"))]
fn without_name(_folder: &Path) -> Option<File> {
    None
}

#[cfg(not(target_os = "linux"))]
fn link(_file: &File, _path: &Path) -> io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}
