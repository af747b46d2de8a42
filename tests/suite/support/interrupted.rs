//! Changes in place that were interrupted, and what they leave.

use std::{
    fs,
    panic::{self, AssertUnwindSafe},
};

use flightcam::{Output, Watch, enrich, restore, writer::journal::JournalStep};

use super::{enrich_bytes_with, folder::*, options_at};

pub const JOURNAL: &str = "flight.mcap.flightcam-journal";

/// A change of a log in place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// Of the original.
    Enrich,
    /// Of the result that an angle of 30° gave, for one of 60°.
    Replace,
    /// Of the result that an angle of 30° gave.
    Restore,
}

pub const CHANGES: [Change; 3] = [Change::Enrich, Change::Replace, Change::Restore];

/// A log before a change and after it.
pub struct Ends {
    pub before: Vec<u8>,
    pub after: Vec<u8>,
    /// Where they begin to differ: the end of the log's own data.
    pub start: usize,
}

impl Ends {
    pub fn of(original: &[u8], change: Change) -> Self {
        let at = |degrees| {
            enrich_bytes_with(original, &options_at(degrees))
                .expect("a result")
                .0
        };
        let at_30 = at(30.0);
        let start = super::original_tail(&at_30).data_end as usize;
        let original = original.to_vec();
        let (before, after) = match change {
            Change::Enrich => (original, at_30),
            Change::Replace => (at_30, at(60.0)),
            Change::Restore => (at_30, original),
        };
        Self {
            before,
            after,
            start,
        }
    }
}

/// Changes [`LOG`] in place, up to a step at which the run ends as if it had been killed.
pub fn interrupt(folder: &Folder, change: Change, at: JournalStep) {
    let reached = move |step| {
        if step == at {
            panic::resume_unwind(Box::new("interrupted"));
        }
    };
    let log = folder.path(LOG);
    let run = || match change {
        Change::Enrich | Change::Replace => {
            let degrees = if change == Change::Enrich { 30.0 } else { 60.0 };
            let options = options_at(degrees).on_step(reached);
            enrich(&log, Output::InPlace, &options).map(drop)
        }
        Change::Restore => {
            let watch = Watch::default().on_step(reached);
            restore(&log, Output::InPlace, &watch).map(drop)
        }
    };
    let result = panic::catch_unwind(AssertUnwindSafe(run));
    assert!(result.is_err(), "it has come to {at:?}");
}

/// A folder with a log that has not been touched, and the whole journal of a change.
pub fn before_the_first_write(ends: &Ends, change: Change) -> Folder {
    let folder = Folder::with(LOG, &ends.before);
    interrupt(&folder, change, JournalStep::JournalDurable);
    assert!(fs::read(folder.path(LOG)).expect("the log") == ends.before);
    folder
}
