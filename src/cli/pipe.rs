//! Standard input and output as the ends of a pipe.

use std::{
    fs::File,
    io::{self, IsTerminal},
    path::Path,
};

use flightcam::Error;

/// What stands for them on the command line.
pub const NAME: &str = "-";

/// Whether a path stands for a pipe.
pub fn is_pipe(path: &Path) -> bool {
    path.as_os_str() == NAME
}

/// Whether standard output goes to somebody's eyes.
pub fn stdout_is_terminal() -> bool {
    io::stdout().is_terminal()
}

/// Standard output without a buffer, so that the system can copy from a file to it by itself.
pub fn stdout() -> Result<File, Error> {
    duplicate(&io::stdout()).map_err(|source| failed("cannot write to standard output", source))
}

/// Standard input without a buffer.
pub fn stdin() -> Result<File, Error> {
    duplicate(&io::stdin()).map_err(|source| failed("cannot read standard input", source))
}

fn failed(action: &'static str, source: io::Error) -> Error {
    Error::Io {
        action,
        path: NAME.into(),
        source,
    }
}

#[cfg(unix)]
fn duplicate(stream: &impl std::os::fd::AsFd) -> io::Result<File> {
    Ok(stream.as_fd().try_clone_to_owned()?.into())
}

#[cfg(windows)]
fn duplicate(stream: &impl std::os::windows::io::AsHandle) -> io::Result<File> {
    Ok(stream.as_handle().try_clone_to_owned()?.into())
}
