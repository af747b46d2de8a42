//! Profiles of the user's own, in files.

use std::{
    fs::{self, File},
    io::{self, Read as _},
    path::{Path, PathBuf},
};

use super::{NotAProfile, Profile, ProfileError};

/// The longest text that is taken for a profile, in bytes: many times as long as any that people write.
const LONGEST: u64 = 1024 * 1024;

/// A profile in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnProfile {
    /// The file.
    pub path: PathBuf,
    /// What is in it.
    pub text: String,
    /// The profile that it is.
    pub profile: Profile,
}

impl OwnProfile {
    /// Reads a profile from a file.
    ///
    /// # Errors
    /// The file cannot be read, or is not a profile.
    pub fn read(path: &Path) -> Result<Self, ProfileError> {
        let bad = |problem: NotAProfile| ProfileError::Bad {
            path: path.into(),
            problem: problem.into(),
        };
        let text = read(path).map_err(|source| ProfileError::Io {
            path: path.into(),
            source,
        })?;
        let profile = match text.len() as u64 {
            0..=LONGEST => Profile::parse(&text).map_err(bad)?,
            _ => return Err(bad(NotAProfile::TooLong)),
        };
        Ok(Self {
            path: path.into(),
            text,
            profile,
        })
    }

    /// Reads the profiles in a folder, one in each `.toml` file, in the order of the files' names. A folder that does not
    /// exist has none.
    ///
    /// # Errors
    /// The folder or a file cannot be read, a file is not a profile, or two profiles have the same name.
    pub fn all_in(folder: &Path) -> Result<Vec<Self>, ProfileError> {
        let unreadable = |source: io::Error| ProfileError::Folder {
            path: folder.into(),
            source,
        };
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries.map_err(unreadable)?,
        };
        let paths = entries.map(|entry| Ok(entry?.path()));
        let mut paths = paths.collect::<io::Result<Vec<_>>>().map_err(unreadable)?;
        paths.retain(|path| is_toml(path));
        paths.sort();
        let mut all: Vec<Self> = Vec::new();
        for path in paths {
            let own = Self::read(&path)?;
            if let Some(other) = all
                .iter()
                .find(|other| other.profile.name == own.profile.name)
            {
                return Err(ProfileError::SameName {
                    name: (&own.profile.name).into(),
                    paths: [other.path.clone(), path],
                });
            }
            all.push(own);
        }
        Ok(all)
    }
}

/// Whether the name of a file ends in `.toml`.
pub fn is_toml(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension == "toml")
}

/// Reads a text, of one that is too long only a little more than is allowed.
fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    let mut file = File::open(path)?.take(LONGEST + 1);
    file.read_to_string(&mut text)?;
    Ok(text)
}
