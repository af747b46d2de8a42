//! Enriching a log that comes through a pipe, in one pass: it is passed on while it comes, and what follows from its
//! telemetry, which was followed on the way, goes behind it.

use std::{
    io::{self, Read, Write},
    ops::ControlFlow,
    path::Path,
};

use super::{derivation::Derivation, output};
use crate::{
    error::Error,
    log::{
        Log,
        stream::{Named, Streamed, pass_through},
    },
    options::Options,
    progress::{Watch, Watcher},
    report::Report,
    run::{Left, RunError},
    source::stream_filter::StreamFilter,
    writer::{
        Layout, WriteError,
        copy::copy_end,
        destination::Destination,
        original::{Lost, Original},
    },
};

/// Passes a log on from one stream to another, and adds the camera's channels behind it.
///
/// # Errors
/// What was wrong, and what to do about it. Where nothing can be derived, the output gets the log as it is; after
/// other errors it is not whole. Only the layout [`Layout::Append`] can be written.
pub fn enrich_stream(
    input: Named<impl Read>,
    output: Named<impl Write + Send>,
    options: &Options,
    watch: Watch,
) -> Result<Report, Error> {
    let Named { name, mut stream } = output;
    let watcher = Watcher::new(watch, name.into(), Left::Incomplete);
    let streamed = pass_on(input, name, &mut stream, options, &watcher)?;
    let (original, telemetry) = split(streamed);
    let mut is_begun = false;
    let output = Named {
        name,
        stream: &mut stream,
    };
    let result = Derivation::new(&original, &telemetry, options).and_then(|derivation| {
        output::behind(&original.log, output, derivation, &watcher, |_| {
            is_begun = true;
            Ok(())
        })
    });
    match result {
        Err(cause) if !is_begun => {
            let failed = |source| WriteError::io("cannot write the output", name, source);
            copy_end(&original.log, &mut stream, failed, |_| {
                ControlFlow::Continue(())
            })?;
            stream.flush().map_err(failed)?;
            Err(RunError::PassedOn {
                cause: Box::new(cause),
            }
            .into())
        }
        result => result,
    }
}

/// As [`enrich_stream`], to a new file.
///
/// # Errors
/// What was wrong, and what to do about it. Nothing is left at `output` then.
pub fn enrich_stream_to_file(
    input: Named<impl Read>,
    output: &Path,
    options: &Options,
    watch: Watch,
) -> Result<Report, Error> {
    let destination = Destination::new(input.name, output, options.overwrite)?;
    let watcher = Watcher::new(watch, output.into(), Left::Nothing);
    let pending = destination.create(None)?;
    let mut file = pending.file();
    let streamed = pass_on(input, output, &mut file, options, &watcher)?;
    let (original, telemetry) = split(streamed);
    let derivation = Derivation::new(&original, &telemetry, options)?;
    let output = Named {
        name: output,
        stream: file,
    };
    let report = output::behind(&original.log, output, derivation, &watcher, |_| Ok(()))?;
    pending.commit()?;
    Ok(report)
}

fn pass_on(
    input: Named<impl Read>,
    name: &Path,
    output: &mut impl Write,
    options: &Options,
    watcher: &Watcher,
) -> Result<Streamed, Error> {
    if options.layout == Layout::Interleaved {
        return Err(RunError::InterleavedStream.into());
    }
    let mut filter = StreamFilter::new(&options.telemetry);
    let watched = Named {
        name: input.name,
        stream: Watched {
            stream: input.stream,
            watcher,
            read: 0,
        },
    };
    let output = Named {
        name,
        stream: output,
    };
    let passed = pass_through(watched, output, |passing| filter.include(passing));
    // That the run shall end is told to the reader of the stream in no words of its own.
    passed.map_err(|error| watcher.bytes(0, 0).err().unwrap_or(error.into()))
}

/// The log that was passed on, and the one that has its telemetry.
fn split(streamed: Streamed) -> (Original, Log) {
    let original = Original {
        log: streamed.original,
        undone: Err(Lost::PassedOn),
    };
    (original, streamed.telemetry)
}

/// A stream that ends where whoever watches has enough.
struct Watched<'a, 'w, R> {
    stream: R,
    watcher: &'a Watcher<'w>,
    read: u64,
}

impl<R: Read> Read for Watched<'_, '_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let told = self.watcher.bytes(self.read, self.read);
        told.map_err(io::Error::other)?;
        let read = self.stream.read(buffer)?;
        self.read += read as u64;
        Ok(read)
    }
}
