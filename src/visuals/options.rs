//! What the caller decides about what viewers are shown.

use crate::camera::FieldOfView;

/// What viewers are shown, beside the camera's motion.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VisualOptions {
    pub(crate) rate: Option<VisualRate>,
    pub(crate) field_of_view: Option<FieldOfView>,
    pub(crate) ground: Option<Ground>,
    pub(crate) reach: Reach,
}

/// Ticks per second, unless the caller says otherwise: smooth to the eye.
const TICKS: f64 = 30.0;

/// Scenes per second, unless the caller says otherwise. They are much larger than transforms, which move what they show.
const SCENES: f64 = 10.0;

impl VisualOptions {
    /// Transforms, poses and numbers per second.
    pub(crate) fn tick_rate(&self) -> f64 {
        self.rate.map_or(TICKS, VisualRate::hertz)
    }

    /// Scenes per second.
    pub(crate) fn scene_rate(&self) -> f64 {
        self.rate.map_or(SCENES, VisualRate::hertz)
    }

    /// The defaults: scenes ten times a second and transforms thirty times; the field of view and the ground as the log
    /// says them.
    pub fn new() -> Self {
        Self::default()
    }

    /// How far what the camera sees of the ground is shown; by default five times the height.
    pub fn reach(self, reach: Reach) -> Self {
        Self { reach, ..self }
    }

    /// Whether what the profile or the log says of the field of view does not count.
    pub(crate) fn says_what_the_camera_sees(&self) -> bool {
        self.field_of_view.is_some()
    }

    /// Whether the log's own heights above the ground do not count.
    pub(crate) fn says_where_the_ground_is(&self) -> bool {
        self.ground.is_some()
    }

    /// How often scenes and transforms are written.
    pub fn rate(self, rate: impl Into<Option<VisualRate>>) -> Self {
        Self {
            rate: rate.into(),
            ..self
        }
    }

    /// What the camera sees. It takes precedence over what the profile says, and over a calibration that the log has.
    pub fn field_of_view(self, field_of_view: impl Into<Option<FieldOfView>>) -> Self {
        Self {
            field_of_view: field_of_view.into(),
            ..self
        }
    }

    /// Where the ground is. It takes precedence over heights above the ground that the log has, which say it otherwise;
    /// without either, it is at the height of the take-off.
    pub fn ground(self, ground: impl Into<Option<Ground>>) -> Self {
        Self {
            ground: ground.into(),
            ..self
        }
    }
}

/// How far what the camera sees of the ground is shown, as a multiple of the height: near the horizon it has no end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    heights: f64,
}

/// A reach that is out of range, or not a number.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("a reach of {0} heights is out of range: it must be from 1 to 100")]
pub struct ReachOutOfRange(pub f64);

impl Reach {
    /// Creates a reach from a multiple of the height above the ground.
    ///
    /// # Errors
    /// Less than 1, more than 100, or not a number.
    pub fn from_heights(heights: f64) -> Result<Self, ReachOutOfRange> {
        match (1.0..=100.0).contains(&heights) {
            true => Ok(Self { heights }),
            false => Err(ReachOutOfRange(heights)),
        }
    }

    /// The multiple.
    pub fn heights(self) -> f64 {
        self.heights
    }
}

impl Default for Reach {
    fn default() -> Self {
        Self { heights: 5.0 }
    }
}

/// How often something is written, per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisualRate {
    hertz: f64,
}

/// A rate that is out of range, or not a number.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a rate of {0} Hz is out of range: it must be from 0.1 to 60 Hz, beyond which viewers drop messages"
)]
pub struct VisualRateOutOfRange(pub f64);

impl VisualRate {
    /// Creates a rate from messages per second.
    ///
    /// # Errors
    /// Less than 0.1, more than 60, or not a number.
    pub fn from_hertz(hertz: f64) -> Result<Self, VisualRateOutOfRange> {
        match (0.1..=60.0).contains(&hertz) {
            true => Ok(Self { hertz }),
            false => Err(VisualRateOutOfRange(hertz)),
        }
    }

    /// Messages per second.
    pub fn hertz(self) -> f64 {
        self.hertz
    }
}

/// Where the ground is. It is taken to be level.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Ground {
    /// At the height of the first known position.
    TakeOff,
    /// At this altitude, in metres as the log counts altitudes.
    Altitude(f64),
}
