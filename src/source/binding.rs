//! What a profile says of a channel, with its fields resolved to the slots that the decoder fills.

use super::profile::convention::{
    AngleUnit, Convention, LengthUnit, PositionFrame, PositiveDirection, QuaternionOrder,
    SpeedUnit, TimeUnit, VelocityFrame,
};
use crate::decode::path::FieldPath;
use crate::sample::{GimbalReference, Kind};

/// Where the decoder puts a field's value.
pub type Slot = usize;

/// How the messages of a channel are read as samples of one kind.
#[derive(Debug)]
pub struct Role {
    pub kind: Kind,
    /// The fields of the first reading, as the profile names them.
    pub fields: Vec<FieldPath>,
    /// Of which the first whose condition holds is used.
    pub readings: Vec<Reading>,
}

/// One way to read a message as a sample.
#[derive(Debug)]
pub struct Reading {
    pub condition: Option<BoundCondition>,
    pub time: BoundTime,
    pub valid: Vec<Slot>,
    pub quantity: Quantity,
}

/// What must hold for a message to be read so.
#[derive(Debug)]
pub struct BoundCondition {
    pub slot: Slot,
    pub test: BoundTest,
}

/// What the slot must hold.
#[derive(Debug)]
pub enum BoundTest {
    Is(i64),
    HasBits(u64),
}

/// What the time of a sample is.
#[derive(Debug, Clone, Copy)]
pub enum BoundTime {
    LogTime,
    PublishTime,
    Number { slot: Slot, unit: TimeUnit },
    SecondsAndNanoseconds([Slot; 2]),
}

/// What a sample is made of.
#[derive(Debug)]
pub enum Quantity {
    Attitude {
        orientation: BoundOrientation,
        convention: Convention,
        reset_counter: Option<Slot>,
    },
    Velocity {
        vector: BoundComponents<3>,
        frame: VelocityFrame,
        unit: SpeedUnit,
    },
    Gimbal {
        orientation: BoundOrientation,
        convention: Convention,
        reference: GimbalReference,
    },
    Geodetic {
        latitude_longitude_altitude: BoundComponents<3>,
        unit: AngleUnit,
        altitude_unit: LengthUnit,
    },
    Local {
        vector: BoundComponents<3>,
        frame: PositionFrame,
        unit: LengthUnit,
    },
}

#[derive(Debug)]
pub enum BoundOrientation {
    Quaternion {
        components: BoundComponents<4>,
        order: QuaternionOrder,
    },
    Euler {
        rpy: BoundComponents<3>,
        unit: AngleUnit,
    },
    Pitch {
        slot: Slot,
        unit: AngleUnit,
        positive: PositiveDirection,
    },
}

/// Where the components of a vector or a quaternion are.
#[derive(Debug)]
pub enum BoundComponents<const N: usize> {
    List(Slot),
    Each([Slot; N]),
}
