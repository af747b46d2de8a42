//! What the user decides about a run.

use crate::{geometry::DepressionAngle, source::request::Request, transform::MaxGap};

/// How to enrich a log.
#[derive(Debug, Clone)]
pub struct Options {
    /// How far below the horizon the camera looks.
    pub depression: DepressionAngle,
    /// The longest time between two attitude samples that still belong together.
    pub max_gap: MaxGap,
    /// How the log's telemetry is found.
    pub telemetry: Request,
    /// Whether an output that exists is replaced.
    pub overwrite: bool,
}

impl Options {
    /// With everything but the camera's angle left to the defaults.
    pub fn new(depression: DepressionAngle) -> Self {
        Self {
            depression,
            max_gap: MaxGap::default(),
            telemetry: Request::default(),
            overwrite: false,
        }
    }
}
