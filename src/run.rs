//! What every run has, whether it enriches a log or restores one: an input and an output, perhaps somebody who
//! watches it, and an end.

mod error;
mod input;
mod output;
mod watch;

use std::{
    ops::ControlFlow,
    path::PathBuf,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::Duration,
};

pub use error::{Left, RunError};
pub use input::Input;
pub use output::Output;
pub use watch::{Progress, Watch};

use crate::{
    error::Error,
    log::journal::{Journal, JournalStep},
    writer::WriteError,
};

/// How often whoever watches a run is asked, whatever its threads wait for.
const GLANCE: Duration = Duration::from_millis(50);

/// What the threads of a run share: how far it is, and whether it goes on.
///
/// There is one way to end a run early: [`cancel`](Self::cancel). No thread is told; each looks now and then, and ends
/// its work with [`Cancelled`]. Why the run was cancelled is kept here, once, so that threads need not make up errors
/// and the first thing that went wrong is the one that is reported.
pub(crate) struct Run<'a> {
    watch: &'a Watch,
    /// What is written to, and what an interrupted run leaves there.
    output: PathBuf,
    left: Left,
    /// In bytes, as are those below: of the telemetry, and of what is copied of the log.
    total: AtomicU64,
    read: AtomicU64,
    copied: AtomicU64,
    is_cancelled: AtomicBool,
    reason: Mutex<Option<Reason>>,
}

/// Why a run is cancelled.
enum Reason {
    /// Whoever watches it wants no more of it.
    Interrupted,
    /// Something went wrong on one of its threads.
    Failed(Error),
}

/// The run is cancelled, for a reason that it keeps itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the run is cancelled")]
pub(crate) struct Cancelled;

/// Why a thread of a run ends its work early.
#[derive(Debug)]
pub(crate) enum Stopped {
    /// The run is cancelled.
    Cancelled,
    /// Something went wrong on this thread.
    Failed(Error),
}

impl From<Cancelled> for Stopped {
    fn from(Cancelled: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl<E: Into<Error>> From<E> for Stopped {
    fn from(error: E) -> Self {
        match error.into() {
            Error::Write(WriteError::Cancelled) => Self::Cancelled,
            error => Self::Failed(error),
        }
    }
}

impl<'a> Run<'a> {
    pub fn new(watch: &'a Watch, output: PathBuf, left: Left) -> Self {
        Self {
            watch,
            output,
            left,
            total: AtomicU64::new(0),
            read: AtomicU64::new(0),
            copied: AtomicU64::new(0),
            is_cancelled: AtomicBool::new(false),
            reason: Mutex::new(None),
        }
    }

    /// Does the work of the run, and meanwhile asks whoever watches it. Gives the error that the run ends with.
    ///
    /// The threads that work ask as well, each time they have done something. But all of them may be waiting for a
    /// disk, or for the other end of a pipe, so one thread does nothing else.
    pub fn attend<T>(&self, work: impl FnOnce() -> Result<T, Stopped>) -> Result<T, Error> {
        let work = || work().map_err(|stopped| self.explain(stopped));
        if !self.watch.is_anybody() {
            return work();
        }
        thread::scope(|scope| {
            // Closed when the work has ended, however it does.
            let (_working, is_over) = mpsc::channel::<()>();
            scope.spawn(move || {
                while is_over.recv_timeout(GLANCE) == Err(RecvTimeoutError::Timeout) {
                    self.ask();
                }
            });
            work()
        })
    }

    /// There is more to do than was known: that many bytes.
    pub fn expect(&self, bytes: u64) {
        self.total.fetch_add(bytes, Relaxed);
    }

    /// That many bytes of the telemetry are read.
    pub fn read(&self, bytes: u64) {
        self.read.store(bytes, Relaxed);
        self.ask();
    }

    /// That many bytes of the log are copied.
    pub fn copied(&self, bytes: u64) -> ControlFlow<()> {
        self.copied.store(bytes, Relaxed);
        self.ask();
        match self.go_on() {
            Ok(()) => ControlFlow::Continue(()),
            Err(Cancelled) => ControlFlow::Break(()),
        }
    }

    /// A change of the log in place has come to a step, after each of which it is too late, or too early, to end.
    pub fn reached(&self, step: JournalStep) {
        self.watch.reached(step);
    }

    fn ask(&self) {
        let progress = Progress {
            done: self.read.load(Relaxed) + self.copied.load(Relaxed),
            total: self.total.load(Relaxed),
        };
        if self.watch.ask(progress).is_break() {
            self.cancel(Reason::Interrupted);
        }
    }

    /// Whether to go on. This is cheap enough to be asked for each sample.
    pub fn go_on(&self) -> Result<(), Cancelled> {
        match self.is_cancelled.load(Relaxed) {
            false => Ok(()),
            true => Err(Cancelled),
        }
    }

    /// Ends the run early because of what went wrong on a thread that nobody waits for yet.
    pub fn fail(&self, error: Error) {
        self.cancel(Reason::Failed(error));
    }

    fn cancel(&self, reason: Reason) {
        let mut first = self.reason.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(reason);
        self.is_cancelled.store(true, Relaxed);
    }

    /// Cancels the run when the result is dropped. Nothing is lost by that where all has been done, and otherwise,
    /// be it after an error or a panic, no other thread goes on with what is of no use any more.
    pub fn cancel_at_end(&self) -> impl Drop {
        struct AtEnd<'a>(&'a AtomicBool);
        impl Drop for AtEnd<'_> {
            fn drop(&mut self) {
                self.0.store(true, Relaxed);
            }
        }
        AtEnd(&self.is_cancelled)
    }

    /// Brings a log back to what it was before a change in place. Gives what the run ends with.
    pub fn roll_back(&self, journal: Journal, stopped: Stopped) -> Stopped {
        let path = journal.log_path().to_owned();
        let cause = self.explain(stopped);
        match journal.roll_back() {
            Ok(()) => cause.into(),
            Err(rollback) => RunError::RollBack {
                path,
                cause: Box::new(cause),
                rollback,
            }
            .into(),
        }
    }

    /// The error that the run ends with.
    pub fn explain(&self, stopped: Stopped) -> Error {
        let reason = || {
            let mut reason = self.reason.lock().unwrap_or_else(PoisonError::into_inner);
            reason.take()
        };
        match stopped {
            Stopped::Failed(error) => error,
            Stopped::Cancelled => match reason() {
                Some(Reason::Failed(error)) => error,
                Some(Reason::Interrupted) | None => RunError::Interrupted {
                    path: self.output.clone(),
                    left: self.left,
                }
                .into(),
            },
        }
    }
}
