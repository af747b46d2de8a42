//! How far apart, and how close, samples may be.

/// The longest time between two attitude samples, or two of the gimbal, that still belong together. Across a
/// longer one there is no relative rotation and no interpolation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MaxGap {
    nanoseconds: u64,
}

/// A maximum gap that is out of range, or not a number.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a maximum gap of {0} s is out of range: it must be greater than 0 and at most 1000000000 s"
)]
pub struct MaxGapOutOfRange(pub f64);

impl MaxGap {
    /// Creates a maximum gap from seconds, rounded to the nanosecond.
    ///
    /// # Errors
    /// Less than a nanosecond, more than 1e9 seconds, or not a number.
    pub fn from_seconds(seconds: f64) -> Result<Self, MaxGapOutOfRange> {
        let nanoseconds = (seconds * 1e9).round();
        if (1.0..=1e18).contains(&nanoseconds) {
            Ok(Self {
                nanoseconds: nanoseconds as u64,
            })
        } else {
            Err(MaxGapOutOfRange(seconds))
        }
    }

    /// The gap in seconds.
    pub fn seconds(self) -> f64 {
        self.nanoseconds as f64 / 1e9
    }

    /// Whether samples at these times, in nanoseconds and in order, belong together.
    pub(crate) fn spans(self, from: u64, to: u64) -> bool {
        to - from <= self.nanoseconds
    }
}

impl Default for MaxGap {
    fn default() -> Self {
        Self {
            nanoseconds: 5_000_000_000,
        }
    }
}

/// The shortest time between two attitude samples: one that is closer to the one before is left out. None by default.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MinInterval {
    nanoseconds: u64,
}

/// A minimum interval that is out of range, or not a number.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("a minimum interval of {0} s is out of range: it must be at least 0 and at most 1000 s")]
pub struct MinIntervalOutOfRange(pub f64);

impl MinInterval {
    /// Creates a minimum interval from seconds, rounded to the nanosecond; 0 leaves nothing out.
    ///
    /// # Errors
    /// Negative, more than 1000 seconds, or not a number.
    pub fn from_seconds(seconds: f64) -> Result<Self, MinIntervalOutOfRange> {
        let nanoseconds = (seconds * 1e9).round();
        if (0.0..=1e12).contains(&nanoseconds) {
            Ok(Self {
                nanoseconds: nanoseconds as u64,
            })
        } else {
            Err(MinIntervalOutOfRange(seconds))
        }
    }

    /// The interval in seconds.
    pub fn seconds(self) -> f64 {
        self.nanoseconds as f64 / 1e9
    }

    /// Whether a time in nanoseconds is shorter.
    pub(super) fn exceeds(self, nanoseconds: u64) -> bool {
        nanoseconds < self.nanoseconds
    }
}
