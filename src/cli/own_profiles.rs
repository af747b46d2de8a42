//! Where people keep profiles of their own.

use std::{env, path::PathBuf};

use flightcam::source::profile::{OwnProfile, Profile, ProfileError};

/// The folder: `$XDG_CONFIG_HOME/flightcam/profiles`, or `~/.config/flightcam/profiles`.
///
/// Source: <https://specifications.freedesktop.org/basedir-spec/latest/>, by which a path that is not absolute does not
/// count.
pub fn folder() -> Option<PathBuf> {
    let named = env::var_os("XDG_CONFIG_HOME").map(PathBuf::from);
    let named = named.filter(|path| path.is_absolute());
    let config = named.or_else(|| Some(env::home_dir()?.join(".config")))?;
    Some(config.join("flightcam").join("profiles"))
}

/// Those in the folder.
pub fn all() -> Result<Vec<OwnProfile>, ProfileError> {
    folder().map_or_else(|| Ok(Vec::new()), |folder| OwnProfile::all_in(&folder))
}

/// Finds a profile of one's own or a built-in one by its name, or reads it from a file.
pub fn load(name_or_file: &str) -> Result<Profile, ProfileError> {
    if Profile::is_in_a_file(name_or_file) {
        return Profile::load(name_or_file);
    }
    let own = all()?.into_iter();
    let mut named = own.filter(|own| own.profile.name == name_or_file);
    match named.next() {
        Some(own) => Ok(own.profile),
        None => Profile::load(name_or_file),
    }
}
