//! Copying a log's data.

use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};

use crate::{error::Error, log::Log};

/// How much is copied between two looks at whether to go on.
const STEP: u64 = 16 * 1024 * 1024;

/// What is in memory of a log that the system cannot copy by itself.
const BUFFER: usize = 1024 * 1024;

/// Copies a log's bytes up to its data section's end. Between files the system does so without the bytes passing
/// through this program, and without copying them at all where the file system can share them.
///
/// # Errors
/// `copied`, which is told now and then how many bytes there are, says so; or reading or writing fails, which
/// `failed` makes an error of.
pub fn copy_data(
    log: &Log,
    output: &mut impl Write,
    failed: impl Fn(io::Error) -> Error,
    mut copied: impl FnMut(u64) -> Result<(), Error>,
) -> Result<(), Error> {
    let mut input = log.file.handle();
    input.seek(SeekFrom::Start(0)).map_err(&failed)?;
    let mut done = 0;
    while done < log.data_end {
        let step = input.take(STEP.min(log.data_end - done));
        let mut step = BufReader::with_capacity(BUFFER, step);
        done += match io::copy(&mut step, output).map_err(&failed)? {
            0 => {
                return Err(failed(io::Error::new(
                    ErrorKind::UnexpectedEof,
                    "the log has become shorter while it was copied",
                )));
            }
            copied => copied,
        };
        copied(done)?;
    }
    Ok(())
}

/// Copies what a log has from its data section's end on.
///
/// # Errors
/// Those of [`copy_data`], or the log cannot be read.
pub fn copy_end(
    log: &Log,
    output: &mut impl Write,
    failed: impl Fn(io::Error) -> Error,
    mut copied: impl FnMut(u64) -> Result<(), Error>,
) -> Result<(), Error> {
    let length = log.file.len();
    let mut piece = Vec::new();
    let mut position = log.data_end;
    while position < length {
        let step = (BUFFER as u64).min(length - position);
        log.file.read_into(&mut piece, position, step)?;
        output.write_all(&piece).map_err(&failed)?;
        position += step;
        copied(position)?;
    }
    Ok(())
}
