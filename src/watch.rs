//! Progress and cancellation.

use std::{fmt, ops::ControlFlow, sync::Arc};

use crate::writer::journal::{Interrupted, JournalStep};

/// The progress of a run, in bytes: of the telemetry read, and of the log copied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Bytes done so far.
    pub done: u64,
    /// Bytes to do in all, as far as that is known.
    pub total: u64,
}

/// The callbacks that get the progress of a run; by default none.
#[derive(Clone, Default)]
pub struct Watch {
    progress: Option<Arc<dyn Fn(Progress) -> ControlFlow<()> + Send + Sync>>,
    recovery: Option<Arc<Announce>>,
    step: Option<Arc<dyn Fn(JournalStep) + Send + Sync>>,
}

/// What is called before an interrupted change is undone.
type Announce = dyn Fn(&Interrupted) + Send + Sync;

impl Watch {
    /// Calls `watch` with the progress of the run, about twenty times a second or more. If it returns `Break`, the run
    /// ends with an error and leaves everything as it was.
    ///
    /// It is called from several threads, perhaps at the same time.
    pub fn new(watch: impl Fn(Progress) -> ControlFlow<()> + Send + Sync + 'static) -> Self {
        Self {
            progress: Some(Arc::new(watch)),
            ..Self::default()
        }
    }

    /// Calls `announce` before an interrupted change of the log is undone.
    pub fn on_recovery(self, announce: impl Fn(&Interrupted) + Send + Sync + 'static) -> Self {
        Self {
            recovery: Some(Arc::new(announce)),
            ..self
        }
    }

    /// Calls `reached` at each step of a change in place, for tests of what an interruption leaves at that step.
    #[doc(hidden)]
    pub fn on_step(self, reached: impl Fn(JournalStep) + Send + Sync + 'static) -> Self {
        Self {
            step: Some(Arc::new(reached)),
            ..self
        }
    }

    pub(crate) fn is_on(&self) -> bool {
        self.progress.is_some()
    }

    pub(crate) fn ask(&self, progress: Progress) -> ControlFlow<()> {
        match &self.progress {
            Some(watch) => watch(progress),
            None => ControlFlow::Continue(()),
        }
    }

    pub(crate) fn recovering(&self, interrupted: &Interrupted) {
        if let Some(announce) = &self.recovery {
            announce(interrupted);
        }
    }

    pub(crate) fn reached(&self, step: JournalStep) {
        if let Some(reached) = &self.step {
            reached(step);
        }
    }
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_tuple("Watch").field(&self.is_on()).finish()
    }
}
