//! What the caller decides about what viewers are shown.

use crate::derived::visual::Calibration;

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

    /// Whether the log's own calibration does not count.
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

    /// What the camera sees. It takes precedence over a calibration that the log has.
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

/// How wide and how high the camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldOfView {
    degrees: [f64; 2],
}

/// Angles of a field of view in degrees, at least one of them out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a field of view of {}° by {}° is out of range: both angles must be from 0.1 to 170", .0[0], .0[1]
)]
pub struct FieldOfViewOutOfRange(pub [f64; 2]);

impl FieldOfView {
    /// Creates a field of view from its whole angle from left to right and from top to bottom, in degrees.
    ///
    /// # Errors
    /// One is less than 0.1, more than 170, or not a number.
    pub fn from_degrees(horizontal: f64, vertical: f64) -> Result<Self, FieldOfViewOutOfRange> {
        let degrees = [horizontal, vertical];
        match degrees.iter().all(|angle| (0.1..=170.0).contains(angle)) {
            true => Ok(Self { degrees }),
            false => Err(FieldOfViewOutOfRange(degrees)),
        }
    }

    /// The angles from left to right and from top to bottom, in degrees.
    pub fn degrees(self) -> [f64; 2] {
        self.degrees
    }

    /// A pinhole camera that sees as much, with square pixels as nearly as whole rows allow.
    pub fn calibration(self) -> Calibration {
        /// The pixels of a picture in a row, which the angles do not say.
        const WIDTH: u32 = 1920;
        let [right, down] = self.degrees.map(|angle| (angle / 2.0).to_radians().tan());
        let half = f64::from(WIDTH) / 2.0;
        let height = (f64::from(WIDTH) * down / right).round().clamp(1.0, 1e6);
        Calibration {
            width: WIDTH,
            height: height as u32,
            focal: [half / right, height / 2.0 / down],
            centre: [half, height / 2.0],
        }
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
