//! What the samples of each role are made of: fields, and the conventions that they are in.
//!
//! `F` stands for a field: its path in a profile, its slot in a decoder.

use serde::{Deserialize, Deserializer, Serialize, de::DeserializeOwned};
use toml::Value;

use super::{
    components::Components,
    convention::{
        AccelerationUnit, AngleUnit, Axes, BodyAxes, Convention, EulerOrder, LengthUnit,
        PositiveDirection, QuaternionOrder, RateUnit, SpeedUnit, WorldAxes,
    },
    error::BadRole,
};
use crate::{
    decode::path::FieldPath,
    sample::{GimbalReference, Kind},
};

/// The fields of one role.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum RoleFields<F = FieldPath> {
    /// Fields of the drone's attitude.
    Attitude(AttitudeFields<F>),
    /// Fields of the drone's velocity over ground.
    Velocity(VelocityFields<F>),
    /// Fields of the angles of a gimbal.
    Gimbal(GimbalFields<F>),
    /// Fields of the drone's position.
    Position(Coordinates<F>),
    /// The field of its height above the ground.
    Height(HeightFields<F>),
    /// Fields of its angular rates.
    AngularRate(AngularRateFields<F>),
    /// Fields of its accelerations.
    Acceleration(AccelerationFields<F>),
}

/// The drone's attitude.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(bound(deserialize = "F: DeserializeOwned"))]
pub struct AttitudeFields<F = FieldPath> {
    /// How the drone is turned; not a [`Pitch`] alone.
    pub orientation: Orientation<F>,
    /// The frames between which the orientation turns. If it is not given, the type of the messages has to tell, or
    /// else angles are taken to turn front, right, down into north, east, down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub convention: Option<Convention>,
    /// A count of the estimator's jumps.
    pub reset_counter: Option<OptionalField<F>>,
}

/// The drone's velocity over ground.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(bound(deserialize = "F: DeserializeOwned"))]
pub struct VelocityFields<F = FieldPath> {
    /// The velocity.
    pub vector: Components<3, F>,
    /// Its axes.
    pub frame: Axes,
    /// Its unit.
    #[serde(default)]
    pub unit: SpeedUnit,
    /// Whether the profile fits only a log that has it.
    #[serde(default)]
    pub required: bool,
}

/// The drone's angular rates.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(bound(deserialize = "F: DeserializeOwned"))]
pub struct AngularRateFields<F = FieldPath> {
    /// The rates.
    pub vector: Components<3, F>,
    /// The axes that they are about.
    pub frame: BodyAxes,
    /// Their unit.
    #[serde(default)]
    pub unit: RateUnit,
}

/// What the drone's accelerometer measures.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(bound(deserialize = "F: DeserializeOwned"))]
pub struct AccelerationFields<F = FieldPath> {
    /// The specific force.
    pub vector: Components<3, F>,
    /// Its axes.
    pub frame: BodyAxes,
    /// Its unit.
    #[serde(default)]
    pub unit: AccelerationUnit,
}

/// The angles of a gimbal.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(bound(deserialize = "F: DeserializeOwned"))]
pub struct GimbalFields<F = FieldPath> {
    /// How the gimbal holds the camera.
    pub orientation: Orientation<F>,
    /// What the angles are measured from.
    pub reference: GimbalReference,
    /// The frames between which the orientation turns: [`Convention::FLU_ENU`] if camera and reference have their z axes
    /// up. If it is not given: as for an attitude.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub convention: Option<Convention>,
}

/// The drone's position.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(
    rename_all = "snake_case",
    deny_unknown_fields,
    bound(deserialize = "F: DeserializeOwned")
)]
pub enum Coordinates<F = FieldPath> {
    /// A position on the globe.
    Geodetic {
        /// The latitude, north of the equator.
        latitude: F,
        /// The longitude, east of Greenwich.
        longitude: F,
        /// The altitude, above whatever the log takes for zero.
        altitude: F,
        /// The unit of latitude and longitude.
        unit: AngleUnit,
        /// The unit of the altitude.
        #[serde(default)]
        altitude_unit: LengthUnit,
    },
    /// A position relative to an origin of the log's own.
    Local {
        /// The position.
        vector: Components<3, F>,
        /// Its axes.
        frame: WorldAxes,
        /// Its unit.
        #[serde(default)]
        unit: LengthUnit,
    },
}

/// The drone's height above the ground.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
pub struct HeightFields<F = FieldPath> {
    /// The height.
    pub field: F,
    /// Its unit.
    #[serde(default)]
    pub unit: LengthUnit,
}

/// An orientation.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(
    rename_all = "snake_case",
    deny_unknown_fields,
    bound(deserialize = "F: DeserializeOwned")
)]
pub enum Orientation<F = FieldPath> {
    /// A rotation.
    Quaternion(Quaternion<F>),
    /// Roll, pitch, yaw.
    Euler(Euler<F>),
    /// The angle of a gimbal's optical axis above the horizon alone: no roll, and no yaw.
    Pitch(Pitch<F>),
}

/// A quaternion: one field that has all of it, or four in the given order.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "Value", bound(deserialize = "F: DeserializeOwned"))]
pub struct Quaternion<F = FieldPath> {
    /// The fields.
    pub fields: Components<4, F>,
    /// The order of a list, or of the fields. The members of a message are identified by their names.
    pub order: QuaternionOrder,
}

/// Three angles, by default `R = Rz(yaw) Ry(pitch) Rx(roll)`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Euler<F = FieldPath> {
    /// The angle about the front axis.
    pub roll: F,
    /// The angle about the side axis.
    pub pitch: F,
    /// The angle about the vertical axis.
    pub yaw: F,
    /// The unit of all three.
    pub unit: AngleUnit,
    /// The order in which they turn.
    #[serde(default)]
    pub order: EulerOrder,
}

/// A pitch angle alone.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Pitch<F = FieldPath> {
    /// The field.
    pub field: F,
    /// Its unit.
    pub unit: AngleUnit,
    /// Which way is positive.
    #[serde(default)]
    pub positive: PositiveDirection,
}

/// A field that not every version of a schema has.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table, as in { field = \"count\" }"
)]
pub struct OptionalField<F = FieldPath> {
    /// The field.
    pub field: F,
    /// Whether a schema without the field is fine.
    #[serde(default)]
    pub optional: bool,
}

impl<F> RoleFields<F> {
    /// The role.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Attitude(_) => Kind::Attitude,
            Self::Velocity(_) => Kind::Velocity,
            Self::Gimbal(_) => Kind::Gimbal,
            Self::Position(_) => Kind::Position,
            Self::Height(_) => Kind::Height,
            Self::AngularRate(_) => Kind::AngularRate,
            Self::Acceleration(_) => Kind::Acceleration,
        }
    }

    /// The fields without which there is no sample.
    pub fn fields(&self) -> Vec<&F> {
        match self {
            Self::Attitude(attitude) => attitude.orientation.fields(),
            Self::Velocity(velocity) => velocity.vector.fields(),
            Self::AngularRate(rate) => rate.vector.fields(),
            Self::Acceleration(acceleration) => acceleration.vector.fields(),
            Self::Gimbal(gimbal) => gimbal.orientation.fields(),
            Self::Position(Coordinates::Local { vector, .. }) => vector.fields(),
            Self::Position(Coordinates::Geodetic {
                latitude,
                longitude,
                altitude,
                ..
            }) => vec![latitude, longitude, altitude],
            Self::Height(height) => vec![&height.field],
        }
    }

    /// The unit of the angles of an orientation, if it is made of angles.
    pub fn angle_unit(&self) -> Option<AngleUnit> {
        let orientation = match self {
            Self::Attitude(attitude) => &attitude.orientation,
            Self::Gimbal(gimbal) => &gimbal.orientation,
            Self::Velocity(_)
            | Self::Position(_)
            | Self::Height(_)
            | Self::AngularRate(_)
            | Self::Acceleration(_) => return None,
        };
        match orientation {
            Orientation::Quaternion(_) => None,
            Orientation::Euler(euler) => Some(euler.unit),
            Orientation::Pitch(pitch) => Some(pitch.unit),
        }
    }

    /// Whether a profile fits only a log that has these.
    pub(in crate::source) fn is_required(&self) -> bool {
        matches!(self, Self::Velocity(velocity) if velocity.required)
    }

    /// Checks what the types leave open.
    pub(in crate::source) fn check(&self) -> Result<(), BadRole> {
        match self {
            Self::Gimbal(GimbalFields {
                orientation: Orientation::Pitch(_),
                reference,
                convention,
            }) => match (reference, convention) {
                (GimbalReference::Earth, _) => Err(BadRole::PitchFromNorth),
                (_, None | Some(Convention::FRD_NED)) => Ok(()),
                (_, Some(_)) => Err(BadRole::PitchWithConvention),
            },
            _ => Ok(()),
        }
    }
}

impl RoleFields {
    /// Reads a role's fields from its table in a profile, which has other keys too.
    pub(super) fn read<'de, D: Deserializer<'de>>(kind: Kind, role: D) -> Result<Self, D::Error> {
        /// The key of these fields has to be found among the others.
        #[derive(Deserialize)]
        struct InRole {
            #[serde(flatten)]
            coordinates: Coordinates,
        }
        Ok(match kind {
            Kind::Attitude => Self::Attitude(AttitudeFields::deserialize(role)?),
            Kind::Velocity => Self::Velocity(VelocityFields::deserialize(role)?),
            Kind::Gimbal => Self::Gimbal(GimbalFields::deserialize(role)?),
            Kind::Position => {
                let InRole { coordinates } = InRole::deserialize(role)?;
                Self::Position(coordinates)
            }
            Kind::Height => Self::Height(HeightFields::deserialize(role)?),
            Kind::AngularRate => Self::AngularRate(AngularRateFields::deserialize(role)?),
            Kind::Acceleration => Self::Acceleration(AccelerationFields::deserialize(role)?),
        })
    }
}

impl<F> Orientation<F> {
    /// The fields.
    fn fields(&self) -> Vec<&F> {
        match self {
            Self::Quaternion(quaternion) => quaternion.fields.fields(),
            Self::Euler(Euler {
                roll, pitch, yaw, ..
            }) => vec![roll, pitch, yaw],
            Self::Pitch(pitch) => vec![&pitch.field],
        }
    }
}

impl<F: DeserializeOwned> TryFrom<Value> for Quaternion<F> {
    type Error = toml::de::Error;

    fn try_from(text: Value) -> Result<Self, Self::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields, bound(deserialize = "F: DeserializeOwned"))]
        struct Ordered<F> {
            fields: Components<4, F>,
            order: QuaternionOrder,
        }
        let Ordered { fields, order } = match text {
            table @ Value::Table(_) => table.try_into()?,
            fields => Ordered {
                fields: fields.try_into()?,
                order: QuaternionOrder::default(),
            },
        };
        Ok(Self { fields, order })
    }
}
