//! What the threads of a run tell each other.

use std::{
    ops::ControlFlow,
    panic,
    sync::{
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
        mpsc::{self, Receiver, RecvTimeoutError},
    },
    thread::{Scope, ScopedJoinHandle},
    time::Duration,
};

use crate::error::Error;

/// How often whoever waits for another thread looks at how far it is.
pub const GLANCE: Duration = Duration::from_millis(50);

/// Something that another thread does.
pub struct Task<'scope, T> {
    thread: ScopedJoinHandle<'scope, Result<T, Error>>,
    /// Is closed when it is done.
    working: Receiver<()>,
}

impl<'scope, T: Send + 'scope> Task<'scope, T> {
    /// Starts a thread for it.
    pub fn start(
        scope: &'scope Scope<'scope, '_>,
        task: impl FnOnce() -> Result<T, Error> + Send + 'scope,
    ) -> Self {
        let (open, working) = mpsc::channel();
        let thread = scope.spawn(move || {
            let _open = open;
            task()
        });
        Self { thread, working }
    }

    /// Waits for its end. `wait` is called now and then until then.
    ///
    /// # Errors
    /// The task fails, or `wait` has enough of it.
    pub fn join(self, mut wait: impl FnMut() -> Result<(), Error>) -> Result<T, Error> {
        while self.working.recv_timeout(GLANCE) == Err(RecvTimeoutError::Timeout) {
            wait()?;
        }
        let result = self.thread.join();
        result.unwrap_or_else(|panic| panic::resume_unwind(panic))
    }
}

/// How much of the log another thread has copied, and whether it shall go on.
#[derive(Debug, Default)]
pub struct Copied {
    bytes: AtomicU64,
    is_abandoned: AtomicBool,
}

impl Copied {
    /// Bytes so far.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Relaxed)
    }

    /// Tells of bytes; whether anybody waits for more.
    pub fn tell(&self, bytes: u64) -> ControlFlow<()> {
        self.bytes.store(bytes, Relaxed);
        match self.is_abandoned.load(Relaxed) {
            false => ControlFlow::Continue(()),
            true => ControlFlow::Break(()),
        }
    }

    /// Nobody waits for more.
    pub fn abandon(&self) {
        self.is_abandoned.store(true, Relaxed);
    }
}
