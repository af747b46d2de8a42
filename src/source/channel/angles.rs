//! Angles that are too large for the unit in which they were read.

use crate::source::profile::convention::AngleUnit;

/// A little more than a quarter, a half and a whole turn, for filters that overshoot.
const QUARTER: f64 = 0.2546;
const HALF: f64 = 0.52;
const WHOLE: f64 = 1.0027;

/// A yaw that goes on counting after a turn passes from one message to the next without a jump, and begins within the
/// first turn. Messages further apart than this, in nanoseconds, show nothing of that.
const ADJACENT: u64 = 500_000_000;

/// The angles of a message, in its unit.
#[derive(Debug, Clone, Copy)]
pub enum Angles {
    RollPitchYaw([f64; 3]),
    Pitch(f64),
}

/// The largest of the angles that one reading has read, in its unit.
#[derive(Debug, Clone, Copy)]
pub struct AngleWatch {
    roll: f64,
    pitch: f64,
    yaw: f64,
    /// The smallest yaw, whatever its sign.
    least_yaw: f64,
    /// The largest step of the yaw.
    step: f64,
    last: Option<(u64, f64)>,
}

/// An angle that is larger than angles of its unit should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OversizedAngle {
    /// The angle, in its unit.
    pub angle: f64,
    /// The unit in which it was read.
    pub unit: AngleUnit,
    /// Whether it certainly is none of that unit: a yaw may go on counting after a turn.
    pub is_certain: bool,
}

impl Default for AngleWatch {
    fn default() -> Self {
        Self {
            roll: 0.0,
            pitch: 0.0,
            yaw: 0.0,
            least_yaw: f64::INFINITY,
            step: 0.0,
            last: None,
        }
    }
}

impl AngleWatch {
    /// Notes the angles of a message.
    pub fn note(&mut self, time: u64, angles: Angles) {
        let [roll, pitch, yaw] = match angles {
            Angles::RollPitchYaw(angles) => angles,
            Angles::Pitch(pitch) => [0.0, pitch, 0.0],
        };
        self.roll = self.roll.max(roll.abs());
        self.pitch = self.pitch.max(pitch.abs());
        self.yaw = self.yaw.max(yaw.abs());
        self.least_yaw = self.least_yaw.min(yaw.abs());
        if let Some((last_time, last_yaw)) = self.last.replace((time, yaw))
            && time.abs_diff(last_time) <= ADJACENT
        {
            self.step = self.step.max((yaw - last_yaw).abs());
        }
    }

    /// Adds what a clone has noted in other messages.
    pub fn merge(&mut self, clone: &Self) {
        self.roll = self.roll.max(clone.roll);
        self.pitch = self.pitch.max(clone.pitch);
        self.yaw = self.yaw.max(clone.yaw);
        self.least_yaw = self.least_yaw.min(clone.least_yaw);
        self.step = self.step.max(clone.step);
    }

    /// An angle that is too large, if there is one.
    pub fn oversized(&self, unit: AngleUnit) -> Option<OversizedAngle> {
        let [quarter, half, whole] = [QUARTER, HALF, WHOLE].map(|turns| turns * unit.turn());
        // One that goes on counting would have begun within a turn, and would not jump where a turn is complete.
        let is_no_count = self.least_yaw > whole || self.step > half;
        let found = [
            (self.pitch, quarter, self.pitch > half),
            (self.yaw, whole, is_no_count),
            (self.roll, whole, true),
        ];
        let beyond = found.into_iter().filter(|(angle, limit, _)| angle > limit);
        let certain_first = beyond.max_by_key(|&(_, _, is_certain)| is_certain);
        certain_first.map(|(angle, _, is_certain)| OversizedAngle {
            angle,
            unit,
            is_certain,
        })
    }
}
