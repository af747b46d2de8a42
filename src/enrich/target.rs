//! Where a result goes: checking it first, and making a sink of it later.

use std::{
    fs::File,
    io::Write,
    ops::ControlFlow,
    path::{Path, PathBuf},
    thread::Scope,
};

use super::{
    background::{self, Flusher},
    held_back::HeldBack,
    log_sink::{Completion, LogSink},
};
use crate::{
    error::Error,
    fs::WriteAt,
    log::{Access, Log},
    messages::Format,
    run::{Output, Run, RunError, Stopped},
    writer::{
        Appender, Interleaver, Layout, LogWriter, WriteError, copy::copy_range,
        destination::Destination, journal::NewEnd,
    },
};

/// Where a result goes, and in which layout. It is checked early, and created only when there is something to write.
pub struct Target<'a> {
    medium: Medium<'a>,
    layout: Layout,
}

enum Medium<'a> {
    NewFile(Destination),
    InPlace {
        log: PathBuf,
    },
    Handle {
        name: PathBuf,
        handle: File,
    },
    Stream {
        name: PathBuf,
        stream: Box<dyn Write + 'a>,
    },
    /// A stream or a new file that the log's data has been passed on to already.
    AfterData {
        name: PathBuf,
        stream: &'a mut dyn Write,
    },
}

impl<'a> Target<'a> {
    /// Checks an output; `log` is the path of the input, if it is a file.
    ///
    /// # Errors
    /// The result cannot go there.
    pub fn new(log: Option<&Path>, output: Output<'a>, layout: Layout) -> Result<Self, Error> {
        let medium = match output {
            Output::File { path, overwrite } => {
                Medium::NewFile(Destination::new(log, &path, overwrite)?)
            }
            Output::InPlace => match (layout, log) {
                (Layout::Interleaved, _) => return Err(RunError::InterleavedInPlace.into()),
                (Layout::Append, None) => return Err(RunError::NotAFileInPlace.into()),
                (Layout::Append, Some(log)) => Medium::InPlace { log: log.into() },
            },
            Output::Handle { name, handle } => Medium::Handle { name, handle },
            Output::Stream { name, stream } => Medium::Stream { name, stream },
        };
        Ok(Self { medium, layout })
    }

    /// A stream or a new file that the log's data has been passed on to already.
    pub fn after_data(name: &Path, stream: &'a mut dyn Write) -> Self {
        let name = name.into();
        Self {
            medium: Medium::AfterData { name, stream },
            layout: Layout::Append,
        }
    }

    /// How the log's file has to be opened.
    pub fn access(&self) -> Access {
        match self.medium {
            Medium::InPlace { .. } => Access::Change,
            _ => Access::Read,
        }
    }

    /// Its name in reports and errors.
    pub fn name(&self) -> &Path {
        match &self.medium {
            Medium::NewFile(destination) => destination.path(),
            Medium::InPlace { log } => log,
            Medium::Handle { name, .. }
            | Medium::Stream { name, .. }
            | Medium::AfterData { name, .. } => name,
        }
    }

    /// How many bytes of the log have to be copied there.
    pub fn bytes_to_copy(&self, log: &Log) -> u64 {
        match self.medium {
            Medium::NewFile(_) | Medium::Handle { .. } | Medium::Stream { .. } => log.data_end,
            Medium::InPlace { .. } | Medium::AfterData { .. } => 0,
        }
    }

    /// Creates the output, and a sink that writes to it.
    ///
    /// # Errors
    /// It cannot be created or written to, or the log cannot be read.
    pub fn begin<'scope>(
        self,
        scope: &'scope Scope<'scope, '_>,
        log: &'scope Log,
        format: Format,
        run: &'scope Run<'scope>,
    ) -> Result<LogSink<'scope>, Stopped>
    where
        'a: 'scope,
    {
        let Self { medium, layout } = self;
        match medium {
            Medium::NewFile(destination) => new_file(scope, log, &destination, layout, format, run),
            Medium::InPlace { .. } => in_place(log, format, run),
            Medium::Handle { name, handle } => into_stream(log, handle, name, layout, format, run),
            Medium::Stream { name, stream } => into_stream(log, stream, name, layout, format, run),
            Medium::AfterData { name, stream } => held_back(
                log,
                HeldBack::new(Box::new(stream), name, None)?,
                format,
                run,
            ),
        }
    }
}

type BoxedWriter<'w> = Box<dyn LogWriter + 'w>;

/// Writes to a new file. In the layout `append` the kernel copies the log there while its telemetry is read.
fn new_file<'scope>(
    scope: &'scope Scope<'scope, '_>,
    log: &'scope Log,
    destination: &Destination,
    layout: Layout,
    format: Format,
    run: &'scope Run<'scope>,
) -> Result<LogSink<'scope>, Stopped> {
    let path = || destination.path().to_owned();
    let failed = |source| destination.write_error(source);
    let pending = destination.create(log.file.permissions()?)?;
    let file = pending.file();
    let (flusher, flush) = Flusher::start(scope, file, path(), run).map_err(failed)?;
    let (writer, copy) = match layout {
        Layout::Append => {
            let copy = background::copy(scope, log, file, path(), flusher, run).map_err(failed)?;
            // It writes by position, so it does not have to wait for the copy.
            let out = WriteAt::new(file, log.data_end).map_err(failed)?;
            (append(log, out, path(), format)?, Some(copy))
        }
        Layout::Interleaved => {
            let out = file.try_clone().map_err(failed)?;
            let copied = move |done| {
                flusher.flush();
                run.copied(done)
            };
            (interleave(log, out, path(), format, copied)?, None)
        }
    };
    let completion = Completion::NewFile {
        pending,
        copy,
        flush,
    };
    Ok(LogSink {
        log: &log.file,
        writer,
        completion,
        showing: None,
        run,
    })
}

/// Writes to the log's own file, which is changed when its new end is complete.
fn in_place<'scope>(
    log: &'scope Log,
    format: Format,
    run: &'scope Run<'scope>,
) -> Result<LogSink<'scope>, Stopped> {
    let new_end = NewEnd::begin(&log.file, log.data_end)?;
    let writer = append(log, new_end.out()?, log.file.path().into(), format)?;
    Ok(LogSink {
        log: &log.file,
        writer,
        completion: Completion::InPlace(new_end),
        showing: None,
        run,
    })
}

/// Writes to a stream, which in the layout `append` gets the log first.
fn into_stream<'scope, W: Write + 'scope>(
    log: &'scope Log,
    mut stream: W,
    name: PathBuf,
    layout: Layout,
    format: Format,
    run: &'scope Run<'scope>,
) -> Result<LogSink<'scope>, Stopped> {
    let copied = |done| run.copied(done);
    match layout {
        Layout::Append => {
            let failed = |source| WriteError::output(&name, source);
            copy_range(&log.file, 0..log.data_end, &mut stream, failed, copied)?;
            held_back(
                log,
                HeldBack::new(Box::new(stream), name, Some(log))?,
                format,
                run,
            )
        }
        Layout::Interleaved => Ok(LogSink {
            log: &log.file,
            writer: interleave(log, stream, name, format, copied)?,
            completion: Completion::Interleaved,
            showing: None,
            run,
        }),
    }
}

/// Writes what follows a log's data in a stream, which gets it when it is complete.
fn held_back<'scope>(
    log: &'scope Log,
    held: HeldBack<'scope>,
    format: Format,
    run: &'scope Run<'scope>,
) -> Result<LogSink<'scope>, Stopped> {
    Ok(LogSink {
        log: &log.file,
        writer: append(log, held.file()?, held.name().into(), format)?,
        completion: Completion::Stream(held),
        showing: None,
        run,
    })
}

fn append<'w>(
    log: &'w Log,
    out: impl Write + 'w,
    path: PathBuf,
    format: Format,
) -> Result<BoxedWriter<'w>, WriteError> {
    Ok(Box::new(Appender::begin(log, out, path, format)?))
}

fn interleave<'w>(
    log: &'w Log,
    out: impl Write + 'w,
    path: PathBuf,
    format: Format,
    copied: impl FnMut(u64) -> ControlFlow<()> + 'w,
) -> Result<BoxedWriter<'w>, WriteError> {
    let interleaver = Interleaver::begin(log, out, path, format, Box::new(copied))?;
    Ok(Box::new(interleaver))
}
