//! What viewers are shown of a flight: samples and derived values → transforms, poses, things to draw, and numbers that
//! people read, at rates that a viewer can bear. Pure: without input and output.
//!
//! ```text
//! samples, moments of the transform ──▶ flight (ticks) ──▶ stage, show ──▶ the writer
//! ```

mod coverage;
mod flight;
mod ground;
mod options;
mod scene;
mod series;
mod show;
mod stage;
pub(crate) mod states;
mod terrain;
mod view;

pub use flight::{Flight, FlightRecorder, Tick, TickAttitudes};
pub use options::{
    Ground, Reach, ReachOutOfRange, VisualOptions, VisualRate, VisualRateOutOfRange,
};
pub use show::{Cadence, Show, StagedFlight};
pub use stage::Stage;
pub use terrain::Terrain;
