//! The axes and units in which samples were read, and why these.

use serde::Serialize;

use crate::{
    decode::path::FieldPath,
    geometry::axes::{Axes, BodyAxes, WorldAxes},
    sample::GimbalReference,
    source::profile::convention::{
        AccelerationUnit, AngleUnit, Convention, EulerOrder, LengthUnit, RateUnit, SpeedUnit,
    },
    text::Foreign,
};

/// How the samples of one kind were read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ReadAs {
    /// What they were taken for.
    #[serde(flatten)]
    pub reading: Reading,
    /// Why these axes.
    pub because: Because,
    /// The names of frames in the messages, as far as the axes depend on them, and where they are.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<NamedFrame>,
}

/// What values were taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reading {
    /// An orientation as a quaternion.
    Quaternion {
        /// Between which frames it turns.
        axes: Convention,
        /// What a gimbal's is measured from.
        #[serde(skip_serializing_if = "Option::is_none")]
        reference: Option<GimbalReference>,
    },
    /// An orientation as roll, pitch and yaw.
    Angles {
        /// Between which frames it turns.
        axes: Convention,
        /// The unit of the angles.
        unit: AngleUnit,
        /// The order in which they turn.
        order: EulerOrder,
        /// What a gimbal's is measured from.
        #[serde(skip_serializing_if = "Option::is_none")]
        reference: Option<GimbalReference>,
    },
    /// A gimbal's pitch alone.
    Pitch {
        /// Its unit.
        unit: AngleUnit,
        /// Whether down is positive.
        is_positive_down: bool,
        /// What it is measured from.
        reference: GimbalReference,
    },
    /// A velocity.
    Velocity {
        /// Its axes.
        axes: Axes,
        /// Its unit.
        unit: SpeedUnit,
    },
    /// Angular rates.
    AngularRate {
        /// Their axes.
        axes: BodyAxes,
        /// Their unit.
        unit: RateUnit,
    },
    /// Accelerations.
    Acceleration {
        /// Their axes.
        axes: BodyAxes,
        /// Their unit.
        unit: AccelerationUnit,
    },
    /// A position relative to an origin of the log's own.
    Local {
        /// Its axes.
        axes: WorldAxes,
        /// Its unit.
        unit: LengthUnit,
    },
    /// A position on the globe.
    Geodetic {
        /// The unit of latitude and longitude.
        unit: AngleUnit,
        /// The unit of the altitude.
        altitude_unit: LengthUnit,
    },
    /// A height above the ground.
    Height {
        /// Its unit.
        unit: LengthUnit,
    },
}

/// Why axes were taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Because {
    /// The user says so.
    Given,
    /// The profile says so.
    Profile,
    /// Messages of this type are in these axes.
    Type,
    /// The names of the frames say so.
    FrameNames,
    /// Nothing says, and these are the usual ones.
    Assumed,
}

/// A frame that a message names.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NamedFrame {
    /// The field that names it.
    pub field: FieldPath,
    /// The name.
    pub name: Foreign,
}
