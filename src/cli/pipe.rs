//! Standard input and output as the ends of a pipe.

use std::{
    fs::File,
    io::{self, IsTerminal},
    path::Path,
};

use flightcam::{Error, Input, Output, log::ReadError};

/// Their name on the command line.
const NAME: &str = "-";

/// Whether a path is that of a pipe.
pub fn is_pipe(path: &Path) -> bool {
    path.as_os_str() == NAME
}

/// Whether standard output is shown to somebody.
pub fn stdout_is_terminal() -> bool {
    io::stdout().is_terminal()
}

/// Standard output without a buffer, so that the system can copy from a file to it by itself.
pub fn stdout() -> Result<Output<'static>, Error> {
    let name = "standard output";
    Ok(Output::handle(name, open(name, duplicate(&io::stdout()))?))
}

/// Standard input without a buffer.
pub fn stdin() -> Result<Input<'static>, Error> {
    let name = "standard input";
    Ok(Input::stream(name, open(name, duplicate(&io::stdin()))?))
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
