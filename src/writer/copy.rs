//! Copying a log's bytes as they are.

use std::{
    io::{self, Write},
    ops::{ControlFlow, Range},
};

use super::error::WriteError;
use crate::{fs, log::file::LogFile};

/// How much the kernel copies between checks whether to continue.
const STEP: u64 = 16 * 1024 * 1024;

/// How much is held in memory of a log that the kernel cannot copy.
const PIECE: u64 = 1024 * 1024;

/// Copies some of a log's bytes; if they are in a file, the kernel does so. `copied` is called now and then with the
/// offset up to which they are copied.
///
/// # Errors
/// Reading fails, writing fails, which `failed` turns into an error, or `copied` breaks the copy off.
pub fn copy_range(
    log: &LogFile,
    range: Range<u64>,
    output: &mut impl Write,
    failed: impl Fn(io::Error) -> WriteError,
    mut copied: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<(), WriteError> {
    let file = log.file_with(&range);
    let mut piece = Vec::new();
    let mut done = range.start;
    while done < range.end {
        let rest = range.end - done;
        done += match file {
            Some(file) => fs::copy(file, done, STEP.min(rest), output).map_err(|source| {
                let shorter = log.became_shorter();
                shorter.map_or_else(|| failed(source), WriteError::from)
            })?,
            None => {
                let length = PIECE.min(rest);
                log.read_into(&mut piece, done, length)?;
                output.write_all(&piece).map_err(&failed)?;
                length
            }
        };
        if copied(done).is_break() {
            return Err(WriteError::Cancelled);
        }
    }
    Ok(())
}
