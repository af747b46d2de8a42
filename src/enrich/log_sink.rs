//! The sink that writes a log.

use std::collections::BTreeMap;

use super::{Sink, background::Background, held_back::HeldBack, job::Batch, showing::Showing};
use crate::{
    error::Error,
    log::file::LogFile,
    run::{Run, RunError, Stopped},
    writer::{LogWriter, Written, destination::Pending, journal::NewEnd},
};

/// Writes derived values into a log.
pub struct LogSink<'scope> {
    /// The log that is read.
    pub log: &'scope LogFile,
    pub writer: Box<dyn LogWriter + 'scope>,
    pub completion: Completion<'scope>,
    /// What viewers are shown, if that is known already: it is written among the derived values.
    pub showing: Option<Showing>,
    pub run: &'scope Run<'scope>,
}

/// What remains to be done when everything has been written.
pub enum Completion<'scope> {
    /// A new file is synced and gets its name.
    NewFile {
        pending: Pending,
        /// Copies the log's data to the file, unless the writer does.
        copy: Option<Background<'scope>>,
        /// Flushes the file to the disk, until the copy, or else the writer, is done.
        flush: Background<'scope>,
    },
    /// The log in place gets its new end.
    InPlace(NewEnd<'scope>),
    /// A stream that has the log's data gets what follows.
    Stream(HeldBack<'scope>),
    /// Nothing: a stream has everything.
    Interleaved,
}

impl Sink for LogSink<'_> {
    fn take(&mut self, batch: &Batch) -> Result<(), Stopped> {
        let is_showing = self.showing.is_some();
        if !is_showing {
            self.writer.go_to_epoch(batch.epoch)?;
        }
        for derived in &batch.values {
            if is_showing {
                self.show_before(batch.epoch, derived.stamp.log_time)?;
                self.writer.go_to_epoch(batch.epoch)?;
            }
            self.writer.write(derived.into())?;
        }
        Ok(self.run.go_on()?)
    }
}

impl LogSink<'_> {
    /// Writes what is shown before a time in an epoch.
    fn show_before(&mut self, epoch: u32, time: u64) -> Result<(), Stopped> {
        let Some(showing) = &mut self.showing else {
            return Ok(());
        };
        while let Some((epoch, shown)) = showing.next_before(epoch, time) {
            self.writer.go_to_epoch(epoch)?;
            self.writer.write((&shown).into())?;
        }
        Ok(())
    }

    /// Writes all that is shown and has not been written.
    pub fn show_rest(&mut self) -> Result<(), Stopped> {
        for (epoch, shown) in self.showing.take().into_iter().flatten() {
            self.run.go_on()?;
            self.writer.go_to_epoch(epoch)?;
            self.writer.write((&shown).into())?;
        }
        Ok(())
    }
}

impl LogSink<'_> {
    /// Completes the log, with `facts` on how its new messages were made. Returns also how many bytes other programs
    /// have added meanwhile to the log that was read; if they have changed it otherwise, no new file gets its name.
    pub fn finish(self, facts: BTreeMap<String, String>) -> Result<(Written, u64), Stopped> {
        let Self {
            log,
            writer,
            completion,
            run,
            ..
        } = self;
        match completion {
            Completion::NewFile {
                pending,
                copy,
                flush,
            } => {
                if let Some(copy) = copy {
                    copy.join(run)?;
                }
                let written = writer.finish(facts)?;
                flush.join(run)?;
                let grown_by = log.grown_by()?;
                pending.commit()?;
                Ok((written, grown_by))
            }
            Completion::InPlace(new_end) => {
                let written = writer.finish(facts)?;
                run.go_on()?;
                // What other programs added is checked before the log is changed.
                new_end.commit(&|step| run.reached(step))?;
                Ok((written, 0))
            }
            Completion::Stream(held) => {
                let written = writer.finish(facts)?;
                let grown_by = log.grown_by()?;
                held.release()?;
                Ok((written, grown_by))
            }
            Completion::Interleaved => Ok((writer.finish(facts)?, log.grown_by()?)),
        }
    }

    /// Leaves the result out, because of an error. What was written to a new file is dropped, and a stream gets the log's
    /// own end.
    pub fn give_up(self, error: Error) -> Stopped {
        let Completion::Stream(held) = self.completion else {
            return error.into();
        };
        match held.give_up() {
            Ok(true) => RunError::PassedOn {
                cause: Box::new(error),
            }
            .into(),
            Ok(false) => error.into(),
            Err(error) => error.into(),
        }
    }
}
