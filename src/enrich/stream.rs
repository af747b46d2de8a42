//! Enriching a log that comes through a pipe, in one pass: the log is passed on as it arrives and its telemetry is
//! spooled; then what is derived is appended.

use std::{
    io::{self, Read, Write},
    path::Path,
};

use super::{held_back::pass_on_end, plan::Plan, target::Target, write};
use crate::{
    error::Error,
    log::{
        Access, Log,
        stream::{Named, pass_through},
    },
    options::Options,
    report::Report,
    run::{Input, Output, Run, RunError, Stopped},
    source::{request::Request, stream_filter::StreamFilter},
    writer::{
        Layout,
        destination::Destination,
        original::{Lost, Original},
    },
};

/// A log that has been passed on, up to the end of its data section.
struct PassedOn {
    original: Original,
    /// The log's telemetry, as a log of its own.
    telemetry: Log,
}

/// Passes a log on to the output and appends the camera's channels. If nothing can be appended, a stream gets the log
/// as it is.
pub fn enrich(
    input: Named<Box<dyn Read + '_>>,
    output: Output,
    options: &Options,
    run: &Run,
) -> Result<Report, Stopped> {
    if options.layout == Layout::Interleaved {
        return Err(RunError::InterleavedStream.into());
    }
    match output {
        Output::InPlace => Err(RunError::NotAFileInPlace.into()),
        Output::File { path, overwrite } => {
            let pending = Destination::new(None, &path, overwrite)?.create(None)?;
            let mut file = pending.file();
            let passed = pass_on(
                input,
                &path,
                &mut file,
                StreamFilter::new(&options.telemetry).showing(options.shown_kinds()),
                run,
            )?;
            let report = append(&passed, &path, &mut file, options, run)?;
            pending.commit()?;
            Ok(report)
        }
        Output::Handle { name, mut handle } => {
            enrich_onward(input, &name, &mut handle, options, run)
        }
        Output::Stream { name, mut stream } => {
            enrich_onward(input, &name, &mut stream, options, run)
        }
    }
}

/// Enriches from stream to stream. Even if there is no result, the next program in the pipe gets a complete log.
fn enrich_onward(
    input: Named<Box<dyn Read + '_>>,
    name: &Path,
    output: &mut impl Write,
    options: &Options,
    run: &Run,
) -> Result<Report, Stopped> {
    let passed = pass_on(
        input,
        name,
        &mut *output,
        StreamFilter::new(&options.telemetry).showing(options.shown_kinds()),
        run,
    )
    .map_err(|stopped| match stopped {
        // Found at the end, when all of it has been passed on.
        Stopped::Failed(Error::Read(error)) if error.is_early_end() => {
            let cause = Box::new(error.into());
            RunError::PassedOn { cause }.into()
        }
        stopped => stopped,
    })?;
    let mut output = Noting {
        stream: output,
        is_written_to: false,
    };
    let result = append(&passed, name, &mut output, options, run);
    result.or_else(|stopped| {
        if output.is_written_to {
            return Err(stopped);
        }
        pass_on_end(&passed.original.log, name, &mut *output.stream)?;
        let cause = Box::new(run.explain(stopped));
        Err(RunError::PassedOn { cause }.into())
    })
}

/// Opens a log of which only the telemetry is read. One that comes through a pipe is read to its end, and what the filter
/// for the request includes is a log of its own.
pub fn telemetry(
    input: Input,
    filter: fn(&Request) -> StreamFilter,
    options: &Options,
    run: &Run,
) -> Result<Log, Stopped> {
    match input {
        Input::Stream { name, stream } => {
            let input = Named::new(&name, stream);
            let filter = filter(&options.telemetry).showing(options.shown_kinds());
            Ok(pass_on(input, &name, io::sink(), filter, run)?.telemetry)
        }
        input => Ok(Log::read(input.open(Access::Read, &options.watch)?)?),
    }
}

fn pass_on(
    input: Named<Box<dyn Read + '_>>,
    name: &Path,
    output: impl Write,
    mut filter: StreamFilter,
    run: &Run,
) -> Result<PassedOn, Stopped> {
    let watched = Watched {
        stream: input.stream,
        run,
        read: 0,
    };
    let passed = pass_through(
        Named::new(input.name, watched),
        Named::new(name, output),
        |passing| filter.include(passing),
    );
    let passed = passed.or_else(|error| {
        // If the run is cancelled, that is why the stream could not be read.
        run.go_on()?;
        Err(Stopped::from(error))
    })?;
    Ok(PassedOn {
        original: Original {
            log: passed.original,
            undone: Err(Lost::PassedOn),
        },
        telemetry: passed.telemetry,
    })
}

/// Appends the camera's channels to a log that has been passed on.
fn append(
    passed: &PassedOn,
    name: &Path,
    output: &mut dyn Write,
    options: &Options,
    run: &Run,
) -> Result<Report, Stopped> {
    let PassedOn {
        original,
        telemetry,
    } = passed;
    original.check_are_free(options.topics())?;
    let plan = Plan::new(telemetry, options)?;
    let target = Target::after_data(name, output);
    write(original, telemetry, plan, target, options, run)
}

/// A stream that ends when the run is cancelled.
struct Watched<'a, R> {
    stream: R,
    run: &'a Run<'a>,
    read: u64,
}

impl<R: Read> Read for Watched<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.run.go_on().map_err(io::Error::other)?;
        let read = self.stream.read(buffer)?;
        self.read += read as u64;
        self.run.expect(read as u64);
        // Whether to continue is checked before waiting for the next bytes.
        let _ = self.run.copied(self.read);
        Ok(read)
    }
}

/// A stream that notes whether it has been written to.
struct Noting<'a, W> {
    stream: &'a mut W,
    is_written_to: bool,
}

impl<W: Write> Write for Noting<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.is_written_to = true;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
