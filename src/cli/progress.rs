//! What a run shows while it lasts, and how the user ends it.

use std::{
    io::{self, IsTerminal},
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    time::{Duration, Instant},
};

use flightcam::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::{consts::TERM_SIGNALS, flag};

/// A progress bar that appears on a terminal when the work takes longer than a moment. It notices when the user
/// ends the program.
pub struct Bar {
    wanted: bool,
    start: Instant,
    bar: Option<ProgressBar>,
    is_ended: Arc<AtomicBool>,
}

impl Bar {
    const MOMENT: Duration = Duration::from_millis(400);

    pub fn new(is_quiet: bool) -> Self {
        Self {
            wanted: !is_quiet && io::stderr().is_terminal(),
            start: Instant::now(),
            bar: None,
            is_ended: catch_signals(),
        }
    }

    pub fn update(&mut self, progress: Progress) -> ControlFlow<()> {
        if let Progress::Bytes { done, total } = progress {
            if self.bar.is_none() && self.wanted && self.start.elapsed() > Self::MOMENT {
                let style =
                    ProgressStyle::with_template("{wide_bar} {bytes}/{total_bytes}, {eta} left");
                let style = style.expect("the template is well-formed");
                self.bar = Some(ProgressBar::new(total).with_style(style));
            }
            if let Some(bar) = &self.bar {
                bar.set_length(total);
                bar.set_position(done);
            }
        }
        match self.is_ended.load(Relaxed) {
            false => ControlFlow::Continue(()),
            true => ControlFlow::Break(()),
        }
    }

    pub fn clear(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Whether the user, or the system, asked the program to end. Asking a second time ends it at once.
fn catch_signals() -> Arc<AtomicBool> {
    let is_ended = Arc::new(AtomicBool::new(false));
    for &signal in TERM_SIGNALS {
        // What cannot be caught ends the program as if nobody had tried.
        let _ = flag::register_conditional_shutdown(signal, 1, Arc::clone(&is_ended));
        let _ = flag::register(signal, Arc::clone(&is_ended));
    }
    is_ended
}
