//! Copying a log's data into a new file while other work is done.

use std::{
    fs::File,
    io,
    sync::{Arc, mpsc},
    thread::Scope,
};

use super::task::{Copied, Task};
use crate::{
    error::Error,
    log::Log,
    writer::{copy::copy_data, destination::Destination},
};

/// A copy under way. It stops when this is dropped.
pub struct Copying<'scope> {
    task: Option<Task<'scope, ()>>,
    copied: Arc<Copied>,
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
        let copied = Arc::<Copied>::default();
        let told = Arc::clone(&copied);
        let (mut file, flushed) = (file.try_clone()?, file.try_clone()?);
        let failed = |source| destination.write_error(source);
        let task = Task::start(scope, move || {
            let (more, to_flush) = mpsc::sync_channel(1);
            // What is on the disk when the last byte is copied need not be waited for then.
            let flusher = Task::start(scope, move || {
                Ok(flush(&flushed, &to_flush).map_err(failed)?)
            });
            let result = copy_data(log, &mut file, failed, |done| {
                let _ = more.try_send(());
                told.tell(done)
            });
            drop(more);
            Ok(result?).and(flusher.join(|| Ok(())))
        });
        Ok(Self {
            task: Some(task),
            copied,
        })
    }

    /// Bytes copied so far.
    pub fn done(&self) -> u64 {
        self.copied.bytes()
    }

    /// Waits for the end. `wait` is told now and then how many bytes were copied.
    ///
    /// # Errors
    /// The copy could not be made, or `wait` has enough of it.
    pub fn finish(mut self, mut wait: impl FnMut(u64) -> Result<(), Error>) -> Result<(), Error> {
        let task = self.task.take().expect("a copy is finished once");
        task.join(|| wait(self.copied.bytes()))
    }
}

impl Drop for Copying<'_> {
    fn drop(&mut self) {
        self.copied.abandon();
    }
}

/// Brings to the disk what a file has, whenever there is more of it. An error of that is told only once, so it must
/// not be lost.
pub fn flush(file: &File, more: &mpsc::Receiver<()>) -> io::Result<()> {
    more.iter().try_for_each(|()| file.sync_data())
}
