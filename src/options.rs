//! What the user decides about a run.

use crate::{geometry::DepressionAngle, source::profile::ProfileChoice, transform::MaxGap};

/// How to enrich a log.
#[derive(Debug, Clone)]
pub struct Options {
    /// How far below the horizon the camera looks.
    pub depression: DepressionAngle,
    /// The longest time between two attitude samples that still belong together.
    pub max_gap: MaxGap,
    /// How the log names its telemetry.
    pub profile: ProfileChoice,
    /// Whether an output that exists is replaced.
    pub overwrite: bool,
}

impl Options {
    /// With everything but the camera's angle left to the defaults.
    pub fn new(depression: DepressionAngle) -> Self {
        Self {
            depression,
            max_gap: MaxGap::default(),
            profile: ProfileChoice::Automatic,
            overwrite: false,
        }
    }
}
