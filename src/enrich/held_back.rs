//! What follows a log's data in a stream, held back until it is known to be right. What a stream has received cannot be
//! taken back.

use std::{
    fs::File,
    io::{self, Seek, SeekFrom, Write},
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use crate::{
    log::Log,
    writer::{WriteError, copy::copy_range},
};

/// A stream that has received a log's data, and what is to follow, in a temporary file.
pub struct HeldBack<'a> {
    held: File,
    stream: Box<dyn Write + 'a>,
    name: PathBuf,
    /// The log, if its end is to follow when nothing else can.
    log: Option<&'a Log>,
}

impl<'a> HeldBack<'a> {
    /// Holds back what follows in the stream of this name. With `log`, its end can [follow](Self::give_up) instead.
    ///
    /// # Errors
    /// There is no room for a temporary file.
    pub fn new(
        stream: Box<dyn Write + 'a>,
        name: PathBuf,
        log: Option<&'a Log>,
    ) -> Result<Self, WriteError> {
        Ok(Self {
            held: tempfile::tempfile().map_err(temporary)?,
            stream,
            name,
            log,
        })
    }

    /// The stream's name.
    pub fn name(&self) -> &Path {
        &self.name
    }

    /// The file to write to.
    ///
    /// # Errors
    /// The system has no handle left.
    pub fn file(&self) -> Result<File, WriteError> {
        self.held.try_clone().map_err(temporary)
    }

    /// Writes to the stream what was held back.
    ///
    /// # Errors
    /// The stream cannot be written.
    pub fn release(mut self) -> Result<(), WriteError> {
        self.held.seek(SeekFrom::Start(0)).map_err(temporary)?;
        let failed = |source| WriteError::output(&self.name, source);
        io::copy(&mut self.held, &mut self.stream).map_err(failed)?;
        self.stream.flush().map_err(failed)
    }

    /// Writes the log's own end to the stream instead, so that it has the log as it is. Returns whether it has.
    ///
    /// # Errors
    /// The stream cannot be written, or the log cannot be read.
    pub fn give_up(mut self) -> Result<bool, WriteError> {
        let Some(log) = self.log else {
            return Ok(false);
        };
        pass_on_end(log, &self.name, &mut self.stream)?;
        Ok(true)
    }
}

/// Writes a log's own end to a stream of this name that has the log's data.
///
/// # Errors
/// The stream cannot be written, or the log cannot be read.
pub fn pass_on_end(log: &Log, name: &Path, mut stream: impl Write) -> Result<(), WriteError> {
    let failed = |source| WriteError::output(name, source);
    let end = log.data_end..log.file.length();
    copy_range(&log.file, end, &mut stream, failed, |_| {
        ControlFlow::Continue(())
    })?;
    stream.flush().map_err(failed)
}

fn temporary(source: io::Error) -> WriteError {
    WriteError::output(&std::env::temp_dir(), source)
}
