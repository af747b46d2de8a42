//! The sink that writes a log.

use std::collections::BTreeMap;

use super::{Sink, background::Background};
use crate::{
    derived::Derived,
    log::journal::Journal,
    run::{Run, Stopped},
    writer::{LogWriter, Written, destination::Pending},
};

/// Writes derived values into a log.
pub struct LogSink<'scope> {
    pub writer: Box<dyn LogWriter + 'scope>,
    pub completion: Completion<'scope>,
    pub run: &'scope Run<'scope>,
}

/// How a result becomes one that lasts, once all is written.
pub enum Completion<'scope> {
    /// A new file gets its name.
    NewFile {
        pending: Pending,
        /// The log's data is copied to the file, if the writer does not do that.
        copy: Option<Background<'scope>>,
        /// The file is brought to the disk. This ends when nobody has more for it, the copy or else the writer.
        flush: Background<'scope>,
    },
    /// A log that is changed in place loses its journal.
    InPlace(Journal<'scope>),
    /// A stream has got all of it.
    Stream,
}

impl Sink for LogSink<'_> {
    fn take(&mut self, values: &[Derived]) -> Result<(), Stopped> {
        for derived in values {
            self.writer.write(derived)?;
        }
        Ok(self.run.go_on()?)
    }
}

impl LogSink<'_> {
    /// Completes the log, with `facts` on how its new messages were made.
    pub fn finish(self, facts: BTreeMap<String, String>) -> Result<Written, Stopped> {
        let Self {
            writer,
            completion,
            run,
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
                pending.commit()?;
                Ok(written)
            }
            Completion::InPlace(journal) => {
                let finish = || {
                    let written = writer.finish(facts)?;
                    run.go_on()?;
                    journal.commit(written.length, &|step| run.reached(step))?;
                    Ok(written)
                };
                finish().map_err(|stopped| run.roll_back(journal, stopped))
            }
            Completion::Stream => Ok(writer.finish(facts)?),
        }
    }

    /// Leaves the log's file as it was, and no new file. Gives what the run ends with.
    pub fn abandon(self, stopped: Stopped) -> Stopped {
        match self.completion {
            Completion::InPlace(journal) => self.run.roll_back(journal, stopped),
            Completion::NewFile { .. } | Completion::Stream => stopped,
        }
    }
}
