//! Copying a log's data into a new file while other work is done.

use std::{
    fs::File,
    io, panic,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
        mpsc,
    },
    thread::{self, Scope, ScopedJoinHandle},
    time::Duration,
};

use crate::{
    error::Error,
    log::Log,
    writer::{copy::copy_data, destination::Destination},
};

/// How often somebody who waits for the end of a copy looks how far it is.
const GLANCE: Duration = Duration::from_millis(50);

/// A copy under way. It stops when this is dropped.
pub struct Copying<'scope> {
    thread: Option<ScopedJoinHandle<'scope, Result<(), Error>>>,
    state: Arc<State>,
}

#[derive(Default)]
struct State {
    copied: AtomicU64,
    is_over: AtomicBool,
}

impl<'scope> Copying<'scope> {
    /// Starts to copy to the beginning of a file, whose handle's position is moved on by this.
    ///
    /// # Errors
    /// The system has no handle left.
    pub fn start<'env>(
        scope: &'scope Scope<'scope, 'env>,
        log: &'env Log,
        file: &File,
        destination: &'env Destination,
    ) -> io::Result<Self> {
        let state = Arc::<State>::default();
        let (copied, waiting) = (Arc::clone(&state), thread::current());
        let (mut file, flushed) = (file.try_clone()?, file.try_clone()?);
        let failed = |source| destination.write_error(source);
        let thread = scope.spawn(move || {
            let (more, to_flush) = mpsc::sync_channel(1);
            // What is on the disk when the last byte is copied need not be waited for then.
            let flusher = scope.spawn(move || flush(&flushed, &to_flush));
            let result = copy_data(log, &mut file, failed, |done| {
                copied.copied.store(done, Relaxed);
                let _ = more.try_send(());
                match copied.is_over.load(Relaxed) {
                    false => Ok(()),
                    // Nobody sees this: who has stopped has an error of their own.
                    true => Err(failed(io::ErrorKind::Interrupted.into())),
                }
            });
            drop(more);
            let result = result.and(join(flusher).map_err(failed));
            waiting.unpark();
            result
        });
        Ok(Self {
            thread: Some(thread),
            state,
        })
    }

    /// Bytes copied so far.
    pub fn done(&self) -> u64 {
        self.state.copied.load(Relaxed)
    }

    /// Waits for the end. `wait` is told now and then how many bytes were copied.
    ///
    /// # Errors
    /// The copy could not be made, or `wait` has enough of it.
    pub fn finish(mut self, mut wait: impl FnMut(u64) -> Result<(), Error>) -> Result<(), Error> {
        let thread = self.thread.take().expect("a copy is finished once");
        while !thread.is_finished() {
            thread::park_timeout(GLANCE);
            wait(self.done())?;
        }
        join(thread)
    }
}

impl Drop for Copying<'_> {
    fn drop(&mut self) {
        self.state.is_over.store(true, Relaxed);
    }
}

/// Brings to the disk what a file has, whenever there is more of it. An error of that is told only once, so it must
/// not be lost.
fn flush(file: &File, more: &mpsc::Receiver<()>) -> io::Result<()> {
    more.iter().try_for_each(|()| file.sync_data())
}

fn join<T>(thread: ScopedJoinHandle<T>) -> T {
    let result = thread.join();
    result.unwrap_or_else(|panic| panic::resume_unwind(panic))
}
