//! Copying a log's data.

use std::{
    io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write},
    ops::{ControlFlow, Range},
};

use super::error::WriteError;
use crate::log::{Log, file::LogFile};

/// How much is copied between two looks at whether to go on.
const STEP: u64 = 16 * 1024 * 1024;

/// What is in memory of a log that the system cannot copy by itself.
const BUFFER: u64 = 1024 * 1024;

/// Copies a log's bytes up to its data section's end, as [`copy_range`] does.
///
/// # Errors
/// Those of [`copy_range`].
pub fn copy_data(
    log: &Log,
    output: &mut impl Write,
    failed: impl Fn(io::Error) -> WriteError,
    copied: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<(), WriteError> {
    copy_range(&log.file, 0..log.data_end, output, failed, copied)
}

/// Copies some of the bytes that a log's file itself has. Between files the system does so without the bytes
/// passing through this program, and without copying them at all where the file system can share them.
///
/// # Errors
/// `copied`, which is called now and then with how far the copy is, breaks it off; or reading or writing fails,
/// which `failed` makes an error of.
pub fn copy_range(
    log: &LogFile,
    range: Range<u64>,
    output: &mut impl Write,
    failed: impl Fn(io::Error) -> WriteError,
    mut copied: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<(), WriteError> {
    let mut input = log.handle();
    input.seek(SeekFrom::Start(range.start)).map_err(&failed)?;
    let mut done = range.start;
    while done < range.end {
        let step = STEP.min(range.end - done);
        let buffer = BUFFER.min(step);
        let mut step = BufReader::with_capacity(buffer as usize, input.take(step));
        done += match io::copy(&mut step, output).map_err(&failed)? {
            0 => {
                return Err(failed(io::Error::new(
                    ErrorKind::UnexpectedEof,
                    "the log has become shorter while it was copied",
                )));
            }
            copied => copied,
        };
        if copied(done).is_break() {
            return Err(WriteError::Cancelled);
        }
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
    failed: impl Fn(io::Error) -> WriteError,
    mut copied: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<(), WriteError> {
    let length = log.file.length();
    let mut piece = Vec::new();
    let mut position = log.data_end;
    while position < length {
        let step = BUFFER.min(length - position);
        log.file.read_into(&mut piece, position, step)?;
        output.write_all(&piece).map_err(&failed)?;
        position += step;
        if copied(position).is_break() {
            return Err(WriteError::Cancelled);
        }
    }
    Ok(())
}
