//! Where the command line says that a log comes from and a result goes to.
//!
//! Another kind of place (an address in a bucket) gets its name here, for all commands.

use std::{
    fs::File,
    io::{self, IsTerminal},
    path::Path,
};

use clap::error::ErrorKind;
use flightcam::{Error, Input, Output, log::ReadError};

use super::wrong_arguments;

/// Standard input or output.
const PIPE: &str = "-";

/// Whether a name is that of standard input or output.
pub fn is_pipe(name: &Path) -> bool {
    name.as_os_str() == PIPE
}

/// The input with this name.
pub fn input(name: &Path) -> Result<Input<'static>, Error> {
    if !is_pipe(name) {
        return Ok(Input::from(name));
    }
    let stdin = "standard input";
    Ok(Input::stream(stdin, open(stdin, duplicate(&io::stdin()))?))
}

/// The output with this name. A terminal as standard output ends the process here.
#[expect(
    clippy::disallowed_methods,
    reason = "what is written is a log, not text"
)]
pub fn output(name: &Path, overwrite: bool) -> Result<Output<'static>, Error> {
    if !is_pipe(name) {
        let path = name.into();
        return Ok(Output::File { path, overwrite });
    }
    if io::stdout().is_terminal() {
        wrong_arguments(
            ErrorKind::ArgumentConflict,
            "refusing to write binary MCAP to a terminal; redirect standard output, or name a file with -o",
        );
    }
    if is_fed_back() {
        wrong_arguments(
            ErrorKind::ArgumentConflict,
            "standard output is the file that standard input comes from",
        );
    }
    // Without a buffer, so that the system can copy from a file to it by itself.
    let stdout = "standard output";
    Ok(Output::handle(
        stdout,
        open(stdout, duplicate(&io::stdout()))?,
    ))
}

/// Whether standard input and standard output are the same file.
fn is_fed_back() -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let file = |stream: io::Result<File>| {
            let metadata = stream.and_then(|stream| stream.metadata()).ok();
            metadata.filter(|metadata| metadata.is_file())
        };
        #[expect(clippy::disallowed_methods, reason = "nothing is printed")]
        let stdout = file(duplicate(&io::stdout()));
        let pair = file(duplicate(&io::stdin())).zip(stdout);
        pair.is_some_and(|(one, other)| (one.dev(), one.ino()) == (other.dev(), other.ino()))
    }
    #[cfg(not(unix))]
    false
}

fn open(name: &str, stream: io::Result<File>) -> Result<File, ReadError> {
    stream.map_err(|source| ReadError::Io {
        action: "cannot be opened",
        path: name.into(),
        source,
    })
}

#[cfg(unix)]
fn duplicate(stream: &impl std::os::fd::AsFd) -> io::Result<File> {
    Ok(stream.as_fd().try_clone_to_owned()?.into())
}

#[cfg(windows)]
fn duplicate(stream: &impl std::os::windows::io::AsHandle) -> io::Result<File> {
    Ok(stream.as_handle().try_clone_to_owned()?.into())
}
