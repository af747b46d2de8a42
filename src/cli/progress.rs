//! What a run shows while it lasts, and how the user ends it.

use std::{
    io::{self, IsTerminal},
    ops::ControlFlow,
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    time::{Duration, Instant},
};

use flightcam::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::{consts::TERM_SIGNALS, flag};

/// A run that takes no longer shows no progress bar.
const MOMENT: Duration = Duration::from_millis(400);

/// A progress bar that appears on a terminal when the work takes longer than a moment. It notices when the user
/// ends the program.
#[derive(Clone)]
pub struct Bar(Arc<State>);

struct State {
    is_wanted: bool,
    start: Instant,
    bar: OnceLock<ProgressBar>,
    is_ended: Arc<AtomicBool>,
}

impl Bar {
    pub fn new(is_quiet: bool) -> Self {
        Self(Arc::new(State {
            is_wanted: !is_quiet && io::stderr().is_terminal(),
            start: Instant::now(),
            bar: OnceLock::new(),
            is_ended: catch_signals(),
        }))
    }

    /// Shows how far a run is; whether the user wants it to go on.
    pub fn watch(&self) -> impl Fn(Progress) -> ControlFlow<()> + Send + Sync + use<> {
        let Self(state) = self.clone();
        move |progress| {
            state.show(progress);
            match state.is_ended.load(Relaxed) {
                false => ControlFlow::Continue(()),
                true => ControlFlow::Break(()),
            }
        }
    }

    pub fn clear(self) {
        if let Some(bar) = self.0.bar.get() {
            bar.finish_and_clear();
        }
    }
}

impl State {
    fn show(&self, progress: Progress) {
        if self.is_wanted && self.start.elapsed() > MOMENT {
            let bar = self.bar.get_or_init(new_bar);
            bar.set_length(progress.total);
            bar.set_position(progress.done);
        }
    }
}

fn new_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {bytes}/{total_bytes}, {eta} left");
    ProgressBar::new(0).with_style(style.expect("the template is well-formed"))
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
