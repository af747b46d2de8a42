//! Where a clock was set back: the time of a log's messages goes back and runs on from there.
//!
//! Recorders stamp messages with a clock that may be set while they record, and one that is restarted may start with an
//! earlier time. Sorted by time, what came after such a step would lie among what came before it, and what is derived
//! from two neighbours would mean nothing. So a log is divided into *epochs*, numbered from 0, each of which is sorted by
//! itself. [`Series`] says what is a step and what is merely out of order, and [`Epochs`] which topics take a step
//! together.

mod epochs;
mod series;
mod survey;

pub use epochs::{ClockStep, Epochs, Now};
pub use series::{LATE, Place, Series};
pub use survey::{InSegment, LogEpochs, SampleTimes, series_of};
