//! Standard input and output as the ends of a pipe.

use std::{
    fs::File,
    io::{self, IsTerminal},
    path::Path,
};

use flightcam::{
    Error,
    log::{ReadError, stream::Named},
};

/// What stands for them on the command line.
const NAME: &str = "-";

/// Whether a path stands for a pipe.
pub fn is_pipe(path: &Path) -> bool {
    path.as_os_str() == NAME
}

/// Whether standard output goes to somebody's eyes.
pub fn stdout_is_terminal() -> bool {
    io::stdout().is_terminal()
}

/// Standard output without a buffer, so that the system can copy from a file to it by itself.
pub fn stdout() -> Result<Named<'static, File>, Error> {
    named("standard output", duplicate(&io::stdout()))
}

/// Standard input without a buffer.
pub fn stdin() -> Result<Named<'static, File>, Error> {
    named("standard input", duplicate(&io::stdin()))
}

fn named(name: &'static str, stream: io::Result<File>) -> Result<Named<'static, File>, Error> {
    let name = Path::new(name);
    match stream {
        Ok(stream) => Ok(Named { name, stream }),
        Err(source) => Err(ReadError::Io {
            action: "cannot be opened",
            path: name.into(),
            source,
        }
        .into()),
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
