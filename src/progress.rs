//! How far a run is: telling whoever watches it, and ending it where they want no more of it.

use std::{cell::RefCell, ops::ControlFlow, path::PathBuf};

use crate::{
    error::Error,
    log::journal::Step,
    run::{Left, RunError},
    writer::WriteError,
};

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// In bytes: of the telemetry read, and of the log copied.
    Bytes {
        /// Done so far.
        done: u64,
        /// To do in all.
        total: u64,
    },
    /// A change of the log in place has come so far.
    Changed(Step),
}

/// Is told now and then how far a run is, and says whether it shall go on. A run that shall not leaves everything
/// as it was.
pub type Watch<'a> = &'a mut dyn FnMut(Progress) -> ControlFlow<()>;

/// A [`Watch`] for runs that nobody watches: they go on to their end.
pub fn unwatched(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Whoever watches a run.
pub(crate) struct Watcher<'a> {
    watch: RefCell<Watch<'a>>,
    /// What is written to, and what is left of it if that ends early, for errors.
    path: PathBuf,
    left: Left,
}

impl<'a> Watcher<'a> {
    pub fn new(watch: Watch<'a>, path: PathBuf, left: Left) -> Self {
        Self {
            watch: RefCell::new(watch),
            path,
            left,
        }
    }

    /// Tells of bytes.
    ///
    /// # Errors
    /// The run shall end.
    pub fn bytes(&self, done: u64, total: u64) -> Result<(), Error> {
        match self.tell(Progress::Bytes { done, total }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(RunError::Interrupted {
                path: self.path.clone(),
                left: self.left,
            }
            .into()),
        }
    }

    /// As [`bytes`](Self::bytes), for what is to know no error of a run.
    pub fn go_on(&self, done: u64, total: u64) -> ControlFlow<()> {
        self.tell(Progress::Bytes { done, total })
    }

    /// What a run ends with that ended with an error of writing.
    pub fn explain(&self, error: WriteError) -> Error {
        match error {
            WriteError::Cancelled => RunError::Interrupted {
                path: self.path.clone(),
                left: self.left,
            }
            .into(),
            other => other.into(),
        }
    }

    /// Tells of a step, after each of which it is too late, or too early, to end.
    pub fn step(&self, step: Step) {
        let _ = self.tell(Progress::Changed(step));
    }

    fn tell(&self, progress: Progress) -> ControlFlow<()> {
        let watch = &mut *self.watch.borrow_mut();
        watch(progress)
    }
}
