//! Threads that copy a log to a new file, and that file to the disk, while other work is done.

use std::{
    fs::File,
    io, panic,
    path::PathBuf,
    sync::mpsc::{self, SyncSender},
    thread::{Scope, ScopedJoinHandle},
};

use crate::{
    log::Log,
    run::{Run, Stopped},
    writer::{WriteError, copy::copy_range},
};

/// A thread that is joined at the end of a run. An error on it cancels the run.
pub struct Background<'scope>(ScopedJoinHandle<'scope, ()>);

impl<'scope> Background<'scope> {
    fn start(
        scope: &'scope Scope<'scope, '_>,
        run: &'scope Run,
        work: impl FnOnce() -> Result<(), Stopped> + Send + 'scope,
    ) -> Self {
        Self(scope.spawn(move || {
            if let Err(Stopped::Failed(error)) = work() {
                run.fail(error);
            }
        }))
    }

    /// Waits for the thread to end.
    ///
    /// # Errors
    /// The run is cancelled, perhaps because of an error on this thread.
    pub fn join(self, run: &Run) -> Result<(), Stopped> {
        let Self(thread) = self;
        thread
            .join()
            .unwrap_or_else(|panic| panic::resume_unwind(panic));
        Ok(run.go_on()?)
    }
}

/// Notifies a thread that flushes a file to the disk when there is more of it. The thread ends when this is dropped.
pub struct Flusher(SyncSender<()>);

impl Flusher {
    /// Starts the thread. What it has flushed need not be waited for when the file is complete.
    ///
    /// # Errors
    /// The system has no handle left.
    pub fn start<'scope>(
        scope: &'scope Scope<'scope, '_>,
        file: &File,
        path: PathBuf,
        run: &'scope Run,
    ) -> io::Result<(Self, Background<'scope>)> {
        let file = file.try_clone()?;
        // Room for one is enough: a flush that has not started yet will include everything written until then.
        let (more, to_flush) = mpsc::sync_channel(1);
        // The system reports an error of flushing only once, so it must not be lost.
        let flush = move || {
            let flushed = to_flush.iter().try_for_each(|()| file.sync_data());
            Ok(flushed.map_err(|source| WriteError::output(&path, source))?)
        };
        Ok((Self(more), Background::start(scope, run, flush)))
    }

    /// Notifies the thread that there is more of the file.
    pub fn flush(&self) {
        let _ = self.0.try_send(());
    }
}

/// Starts a thread that copies a log's data to the start of a new file. It moves the position of the file's handle.
///
/// # Errors
/// The system has no handle left.
pub fn copy<'scope>(
    scope: &'scope Scope<'scope, '_>,
    log: &'scope Log,
    file: &File,
    path: PathBuf,
    flusher: Flusher,
    run: &'scope Run,
) -> io::Result<Background<'scope>> {
    let mut file = file.try_clone()?;
    let failed = move |source| WriteError::output(&path, source);
    Ok(Background::start(scope, run, move || {
        let copied = copy_range(&log.file, 0..log.data_end, &mut file, failed, |done| {
            flusher.flush();
            run.copied(done)
        });
        Ok(copied?)
    }))
}
