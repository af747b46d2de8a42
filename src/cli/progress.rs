//! The progress bar, and the signals with which the user interrupts a run.

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

/// Runs that take no longer than this show no progress bar.
const MOMENT: Duration = Duration::from_millis(400);

/// A progress bar that appears on a terminal if the work takes longer than a moment. It also notices when the user
/// interrupts the program.
#[derive(Clone)]
pub struct Bar(Arc<State>);

struct State {
    is_wanted: bool,
    start: Instant,
    bar: OnceLock<ProgressBar>,
    is_ended: Arc<AtomicBool>,
}

impl Bar {
    #[expect(clippy::disallowed_methods, reason = "nothing is printed")]
    pub fn new(is_quiet: bool) -> Self {
        Self(Arc::new(State {
            is_wanted: !is_quiet && io::stderr().is_terminal(),
            start: Instant::now(),
            bar: OnceLock::new(),
            is_ended: catch_signals(),
        }))
    }

    /// Returns a callback that shows the progress of a run and stops the run once the user has interrupted it.
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

/// Returns a flag that is set when the user or the system asks the program to end. A second request ends it at once.
fn catch_signals() -> Arc<AtomicBool> {
    let is_ended = Arc::new(AtomicBool::new(false));
    for &signal in TERM_SIGNALS {
        // Signals that cannot be caught keep their default behaviour.
        let _ = flag::register_conditional_shutdown(signal, 1, Arc::clone(&is_ended));
        let _ = flag::register(signal, Arc::clone(&is_ended));
    }
    is_ended
}
