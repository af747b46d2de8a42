//! What all runs have in common, whether they enrich a log or restore one: input and output, progress, cancelling, and
//! the error at the end.

mod error;
mod input;
mod output;

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

use crate::{
    error::Error,
    watch::{Progress, Watch},
    writer::{WriteError, journal::JournalStep},
};

/// How often the watcher is called while the run's threads may be waiting for something.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// What the threads of a run share: its progress, and whether it continues.
///
/// A run ends early in one way only: it is cancelled, by its watcher or because something went wrong on one of its
/// threads. Each thread checks now and then whether it is, and then ends its work with [`Cancelled`]. The reason is
/// kept here, so no thread has to invent an error, and the error that is reported is the first one.
pub(crate) struct Run<'a> {
    watch: &'a Watch,
    /// The output's name, and what an interrupted run leaves there.
    output: PathBuf,
    left: Left,
    /// Bytes of telemetry to read and of log to copy, as far as they are known; and those done.
    total: AtomicU64,
    read: AtomicU64,
    copied: AtomicU64,
    is_cancelled: AtomicBool,
    reason: Mutex<Option<Reason>>,
}

/// Why a run is cancelled.
enum Reason {
    /// The watcher ended it.
    Interrupted,
    /// Something went wrong on one of its threads.
    Failed(Error),
}

/// The run is cancelled, for the reason that it keeps.
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

    /// Does the work of a run, with a thread beside it that regularly calls the watcher.
    ///
    /// The working threads call it as well, each time they have done something. But all of them may be waiting, for a
    /// disk or for the other end of a pipe, and even then the progress bar must move and Ctrl-C must work.
    ///
    /// # Errors
    /// The error of the work, or the one for which the run was cancelled.
    pub fn run_watched<T>(&self, work: impl FnOnce() -> Result<T, Stopped>) -> Result<T, Error> {
        let work = || work().map_err(|stopped| self.explain(stopped));
        if !self.watch.is_on() {
            return work();
        }
        thread::scope(|scope| {
            // Closed when the work ends, even by a panic, which ends the thread at once.
            let (_working, is_over) = mpsc::channel::<()>();
            scope.spawn(move || {
                while is_over.recv_timeout(POLL_INTERVAL) == Err(RecvTimeoutError::Timeout) {
                    self.ask();
                }
            });
            work()
        })
    }

    /// What watches it.
    pub fn watch(&self) -> &Watch {
        self.watch
    }

    /// Adds to the number of bytes to be done.
    pub fn expect(&self, bytes: u64) {
        self.total.fetch_add(bytes, Relaxed);
    }

    /// Notes how many bytes of the telemetry have been read.
    pub fn read(&self, bytes: u64) {
        self.read.store(bytes, Relaxed);
        self.ask();
    }

    /// Notes how many bytes of the log have been copied. Returns whether to continue.
    pub fn copied(&self, bytes: u64) -> ControlFlow<()> {
        self.copied.store(bytes, Relaxed);
        self.ask();
        match self.go_on() {
            Ok(()) => ControlFlow::Continue(()),
            Err(Cancelled) => ControlFlow::Break(()),
        }
    }

    /// Reports a step of a change in place. The watcher cannot end the run there.
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

    /// Whether to continue. This is cheap enough to be checked for each sample.
    pub fn go_on(&self) -> Result<(), Cancelled> {
        match self.is_cancelled.load(Relaxed) {
            false => Ok(()),
            true => Err(Cancelled),
        }
    }

    /// Cancels the run because of an error on a thread that is not joined yet.
    pub fn fail(&self, error: Error) {
        self.cancel(Reason::Failed(error));
    }

    fn cancel(&self, reason: Reason) {
        let mut first = self.reason.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(reason);
        self.is_cancelled.store(true, Relaxed);
    }

    /// Returns a guard that cancels the run when it is dropped. If all work is done by then, that changes nothing. If
    /// it is dropped because of an error or a panic, the other threads do not continue with work that is no longer of
    /// any use.
    pub fn cancel_at_end(&self) -> impl Drop {
        struct AtEnd<'a>(&'a AtomicBool);
        impl Drop for AtEnd<'_> {
            fn drop(&mut self) {
                self.0.store(true, Relaxed);
            }
        }
        AtEnd(&self.is_cancelled)
    }

    /// The error for which a thread ended its work.
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
