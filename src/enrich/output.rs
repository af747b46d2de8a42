//! Where the result of a run goes: to a new file, into the log itself, or to a stream.

use std::{cell::OnceCell, fs::File, io::Write, path::Path, sync::mpsc, thread};

use super::{
    copying::{Copying, flush},
    derivation::{BoxedWriter, Derivation},
    task::{Copied, Task},
};
use crate::{
    error::Error,
    log::{Log, journal::Journal, locked::WriteAt, stream::Named},
    progress::Watcher,
    report::Report,
    run::RunError,
    writer::{
        Appender, Interleaver, Layout, WriteError, copy::copy_data, destination::Destination,
    },
};

/// Writes a new file.
pub fn to_new_file(
    log: &Log,
    destination: &Destination,
    derivation: Derivation,
    watcher: &Watcher,
) -> Result<Report, Error> {
    let failed = |source| destination.write_error(source);
    let mut pending = None;
    let create = || {
        let metadata = log.file.handle().metadata().map_err(failed)?;
        let created = destination.create(Some(metadata.permissions()))?;
        let file = pending.insert(created).file();
        Ok(file.try_clone().map_err(failed)?)
    };
    let report = match derivation.layout() {
        Layout::Append => append_to_copy(log, create, destination, derivation, watcher),
        Layout::Interleaved => interleave_to_file(log, create, destination, derivation, watcher),
    }?;
    pending.expect("the writer was begun").commit()?;
    Ok(report)
}

/// Appends to a file into which the log is copied while its telemetry is read.
fn append_to_copy(
    log: &Log,
    create: impl FnOnce() -> Result<File, Error>,
    destination: &Destination,
    derivation: Derivation,
    watcher: &Watcher,
) -> Result<Report, Error> {
    let failed = |source| destination.write_error(source);
    let path = destination.path();
    let format = derivation.format.clone();
    let (writer, findings) = thread::scope(|scope| {
        let copying = OnceCell::new();
        let begin = || {
            let file = create()?;
            let started = Copying::start(scope, log, &file, destination).map_err(failed)?;
            let _ = copying.set(started);
            let behind = WriteAt::new(&file, log.data_end).map_err(failed)?;
            let appender = Appender::begin(log, behind, path.into(), format)?;
            Ok(Box::new(appender) as BoxedWriter)
        };
        let read = |read, of| {
            let copied = copying.get().map_or(0, Copying::done);
            watcher.bytes(copied + read, log.data_end + of)
        };
        let (writer, findings, read) = derivation.run(begin, read, || {})?;
        let copying = copying.into_inner().expect("the writer was begun");
        copying.finish(|copied| watcher.bytes(copied + read, log.data_end + read))?;
        Ok::<_, Error>((writer, findings))
    })?;
    let written = writer.finish(findings.facts())?;
    Ok(findings.report(path.into(), written))
}

/// Interleaves into a file, which is brought to the disk meanwhile.
fn interleave_to_file(
    log: &Log,
    create: impl FnOnce() -> Result<File, Error>,
    destination: &Destination,
    derivation: Derivation,
    watcher: &Watcher,
) -> Result<Report, Error> {
    let failed = |source| destination.write_error(source);
    let (more, to_flush) = mpsc::sync_channel(1);
    thread::scope(|scope| {
        let mut flusher = None;
        let create = || {
            let file = create()?;
            let flushed = file.try_clone().map_err(failed)?;
            let flush = move || Ok(flush(&flushed, &to_flush).map_err(failed)?);
            flusher = Some(Task::start(scope, flush));
            Ok(file)
        };
        let copied = move || _ = more.try_send(());
        let report = interleave(log, create, copied, destination.path(), derivation, watcher)?;
        flusher.expect("the writer was begun").join(|| Ok(()))?;
        Ok(report)
    })
}

/// Writes the log anew, with the new messages in it, into what `create` makes. `more` is called whenever more of
/// the log is there.
fn interleave<W: Write + Send>(
    log: &Log,
    create: impl FnOnce() -> Result<W, Error>,
    more: impl Fn() + Send,
    path: &Path,
    derivation: Derivation,
    watcher: &Watcher,
) -> Result<Report, Error> {
    let format = derivation.format.clone();
    let copied = Copied::default();
    let abandon = || copied.abandon();
    let begin = || {
        let copied = &copied;
        let copied = Box::new(move |done| {
            more();
            copied.tell(done)
        });
        let interleaver = Interleaver::begin(log, create()?, path.into(), format, copied)?;
        Ok(Box::new(interleaver) as BoxedWriter)
    };
    let tell = |read, of| watcher.bytes(copied.bytes() + read, log.data_end + of);
    let (writer, findings, read) = derivation.run(begin, tell, abandon)?;
    let facts = findings.facts();
    let written = thread::scope(|scope| {
        let finishing = Task::start(scope, || Ok(writer.finish(facts)?));
        let written = finishing.join(|| tell(read, read));
        written.inspect_err(|_| abandon())
    })?;
    Ok(findings.report(path.into(), written))
}

/// Replaces the end of the log in its own file.
pub fn in_place(log: &Log, derivation: Derivation, watcher: &Watcher) -> Result<Report, Error> {
    let mut journal = None;
    let changed = change(log, derivation, watcher, &mut journal);
    match journal {
        Some(journal) => conclude(journal, log.file.path(), changed),
        None => changed,
    }
}

/// Brings a log back to what it was, unless all went well.
pub fn conclude<T>(journal: Journal, log: &Path, changed: Result<T, Error>) -> Result<T, Error> {
    changed.map_err(|cause| match journal.roll_back() {
        Ok(()) => cause,
        Err(rollback) => RunError::RollBack {
            path: log.into(),
            cause: Box::new(cause),
            rollback,
        }
        .into(),
    })
}

/// As [`in_place`], with the journal left to the caller to conclude.
fn change<'a>(
    log: &'a Log,
    derivation: Derivation,
    watcher: &Watcher,
    journal: &mut Option<Journal<'a>>,
) -> Result<Report, Error> {
    let path = log.file.path();
    let format = derivation.format.clone();
    let mut step = |step| watcher.step(step);
    let begin = || {
        *journal = Some(log.file.change_from(log.data_end, &mut step)?);
        let end = WriteAt::new(log.file.handle(), log.data_end);
        let end = end.map_err(|source| WriteError::io("cannot write the log", path, source))?;
        let appender = Appender::begin(log, end, path.into(), format)?;
        Ok(Box::new(appender) as BoxedWriter)
    };
    let tell = |read, of| watcher.bytes(read, of);
    let (writer, findings, _) = derivation.run(begin, tell, || {})?;
    let written = writer.finish(findings.facts())?;
    let journal = journal.as_ref().expect("the writer was begun");
    journal.commit(written.length, &mut |step| watcher.step(step))?;
    Ok(findings.report(path.into(), written))
}

/// Writes to a stream, which in the layout `append` gets the log first.
pub fn to_stream(
    log: &Log,
    output: Named<impl Write + Send>,
    derivation: Derivation,
    watcher: &Watcher,
) -> Result<Report, Error> {
    let name = output.name;
    if derivation.layout() == Layout::Interleaved {
        return interleave(log, || Ok(output.stream), || {}, name, derivation, watcher);
    }
    let failed = |source| WriteError::io("cannot write the output", name, source);
    let copied = |done| watcher.go_on(done, log.data_end);
    behind(log, output, derivation, watcher, |stream| {
        let copied = copy_data(log, stream, failed, copied);
        copied.map_err(|error| watcher.explain(error))
    })
}

/// Writes to a stream that has the log when `begin`, which is called before the first byte, has ended.
pub fn behind<W: Write + Send>(
    log: &Log,
    output: Named<W>,
    derivation: Derivation,
    watcher: &Watcher,
    begin: impl FnOnce(&mut W) -> Result<(), Error>,
) -> Result<Report, Error> {
    let Named { name, mut stream } = output;
    let format = derivation.format.clone();
    let begin = || {
        begin(&mut stream)?;
        let appender = Appender::begin(log, stream, name.into(), format)?;
        Ok(Box::new(appender) as BoxedWriter)
    };
    let read = |read, of| watcher.bytes(log.data_end + read, log.data_end + of);
    let (writer, findings, _) = derivation.run(begin, read, || {})?;
    let written = writer.finish(findings.facts())?;
    Ok(findings.report(name.into(), written))
}
