//! The conventions that logs differ in: units, frames, orders, signs, and how to get from each to flightcam's
//! own (radians, metres, NED, FRD, w first).

mod orientation;

use nalgebra::Quaternion;
use serde::{Deserialize, Serialize};

pub use crate::geometry::axes::{Axes, BodyAxes, NotAxes, WorldAxes};
pub use orientation::{Convention, EulerOrder, FrameChange, NotAConvention};

/// The unit of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AngleUnit {
    /// One turn is 2π.
    Radians,
    /// One turn is 360.
    Degrees,
    /// One turn is 36000.
    Centidegrees,
    /// One turn is 3.6e9: MAVLink's unit of latitude and longitude.
    #[serde(rename = "degE7")]
    DegE7,
}

impl AngleUnit {
    /// An angle of this unit in radians; one of very many turns without these, because the rounding of so large a number
    /// would turn it elsewhere.
    pub fn to_radians(self, angle: f64) -> f64 {
        const VERY_MANY: f64 = 1000.0;
        if self == Self::Radians {
            return angle;
        }
        let angle = match angle.abs() > VERY_MANY * self.turn() {
            true => angle % self.turn(),
            false => angle,
        };
        self.to_degrees(angle).to_radians()
    }

    /// The name that reports use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radians => "radians",
            Self::Degrees => "degrees",
            Self::Centidegrees => "hundredths of a degree",
            Self::DegE7 => "1e-7 degrees",
        }
    }

    /// A whole turn.
    pub fn turn(self) -> f64 {
        match self {
            Self::Radians => std::f64::consts::TAU,
            Self::Degrees => 360.0,
            Self::Centidegrees => 360e2,
            Self::DegE7 => 360e7,
        }
    }

    /// An angle of this unit in degrees.
    pub fn to_degrees(self, angle: f64) -> f64 {
        match self {
            Self::Radians => angle.to_degrees(),
            Self::Degrees => angle,
            Self::Centidegrees => angle / 1e2,
            Self::DegE7 => angle / 1e7,
        }
    }
}

/// The unit of a velocity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
pub enum SpeedUnit {
    /// Metres per second.
    #[default]
    #[serde(rename = "m/s")]
    MetresPerSecond,
    /// Centimetres per second.
    #[serde(rename = "cm/s")]
    CentimetresPerSecond,
    /// Millimetres per second.
    #[serde(rename = "mm/s")]
    MillimetresPerSecond,
}

impl SpeedUnit {
    /// How many of this unit make a metre per second.
    pub fn per_metre_per_second(self) -> f64 {
        match self {
            Self::MetresPerSecond => 1.0,
            Self::CentimetresPerSecond => 1e2,
            Self::MillimetresPerSecond => 1e3,
        }
    }
}

/// The unit of an angular rate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
pub enum RateUnit {
    /// Radians per second.
    #[default]
    #[serde(rename = "rad/s")]
    RadiansPerSecond,
    /// Degrees per second.
    #[serde(rename = "deg/s")]
    DegreesPerSecond,
}

impl RateUnit {
    /// How many of this unit make a radian per second.
    pub fn per_radian_per_second(self) -> f64 {
        match self {
            Self::RadiansPerSecond => 1.0,
            Self::DegreesPerSecond => 180.0 / std::f64::consts::PI,
        }
    }
}

/// The unit of an acceleration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
pub enum AccelerationUnit {
    /// Metres per second squared.
    #[default]
    #[serde(rename = "m/s2")]
    MetresPerSecondSquared,
    /// Standard gravity, 9.80665 m/s².
    #[serde(rename = "g")]
    Gravities,
}

impl AccelerationUnit {
    /// How many of this unit make a metre per second squared.
    pub fn per_metre_per_second_squared(self) -> f64 {
        match self {
            Self::MetresPerSecondSquared => 1.0,
            Self::Gravities => 1.0 / 9.806_65,
        }
    }
}

/// The unit of a length.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
pub enum LengthUnit {
    /// Metres.
    #[default]
    #[serde(rename = "m")]
    Metres,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetres,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetres,
}

impl LengthUnit {
    /// How many of this unit make a metre.
    pub fn per_metre(self) -> f64 {
        match self {
            Self::Metres => 1.0,
            Self::Centimetres => 1e2,
            Self::Millimetres => 1e3,
        }
    }
}

/// The unit of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
pub enum TimeUnit {
    /// Seconds.
    #[serde(rename = "s")]
    Seconds,
    /// Milliseconds.
    #[serde(rename = "ms")]
    Milliseconds,
    /// Microseconds.
    #[serde(rename = "us")]
    Microseconds,
    /// Nanoseconds.
    #[serde(rename = "ns")]
    Nanoseconds,
}

impl TimeUnit {
    /// The number of nanoseconds in one unit.
    pub fn nanoseconds(self) -> u64 {
        match self {
            Self::Seconds => 1_000_000_000,
            Self::Milliseconds => 1_000_000,
            Self::Microseconds => 1_000,
            Self::Nanoseconds => 1,
        }
    }
}

/// The order of a quaternion's numbers in a list.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum QuaternionOrder {
    /// The scalar part first, as in PX4.
    #[default]
    Wxyz,
    /// The scalar part last, as in ROS.
    Xyzw,
}

impl QuaternionOrder {
    /// Makes a quaternion from numbers in this order.
    pub fn quaternion(self, numbers: [f64; 4]) -> Quaternion<f64> {
        let [a, b, c, d] = numbers;
        match self {
            Self::Wxyz => Quaternion::new(a, b, c, d),
            Self::Xyzw => Quaternion::new(d, a, b, c),
        }
    }
}

/// Which way an angle relative to the horizon is positive.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PositiveDirection {
    /// Up: a pitch.
    #[default]
    Up,
    /// Down: a depression angle, a tilt.
    Down,
}

impl PositiveDirection {
    /// Returns the angle, positive up.
    pub fn up(self, angle: f64) -> f64 {
        match self {
            Self::Up => angle,
            Self::Down => -angle,
        }
    }
}
