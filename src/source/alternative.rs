//! The alternatives that a profile lists for each role, as one thing.

use super::{
    binder::Binder,
    binding::{BoundOrientation, Quantity, Reading, Role},
    profile::{
        AttitudeSource, Coordinates, GimbalOrientation, GimbalSource, Orientation, Place,
        PositionSource, Profile, VelocitySource,
    },
};
use crate::decode::{error::SchemaError, path::FieldPath};
use crate::sample::Kind;

/// One of the alternatives that a profile lists for a role.
pub trait Alternative {
    const KIND: Kind;

    /// The alternatives of a profile.
    fn of(profile: &Profile) -> &[Self]
    where
        Self: Sized;

    /// Which messages it reads.
    fn place(&self) -> &Place;

    /// Which messages it reads.
    fn place_mut(&mut self) -> &mut Place;

    /// The fields that it makes a sample of.
    fn fields(&self) -> Vec<&FieldPath>;

    /// Resolves what it makes a sample of.
    fn bind(&self, binder: &mut Binder) -> Result<Quantity, SchemaError>;
}

/// Binds those alternatives for which the schema has the fields, up to the first that needs no condition.
///
/// # Errors
/// There is none; the error tells what the one that lacks the least lacks.
pub fn bind_role<A: Alternative>(
    binder: &mut Binder,
    profile: &Profile,
    alternatives: &[&A],
) -> Result<Role, SchemaError> {
    let mut role = Role {
        kind: A::KIND,
        fields: Vec::new(),
        readings: Vec::new(),
    };
    let mut nearest: Option<(f64, SchemaError)> = None;
    for &alternative in alternatives {
        match binder.attempt(|binder| bind_reading(binder, profile, alternative)) {
            Ok(reading) => {
                if role.readings.is_empty() {
                    role.fields = alternative.fields().into_iter().cloned().collect();
                }
                let needs_no_condition = reading.condition.is_none();
                role.readings.push(reading);
                if needs_no_condition {
                    break;
                }
            }
            Err(unreadable @ SchemaError::Unreadable(_)) => return Err(unreadable),
            Err(unresolved) => {
                let share = unresolved.lacks() as f64 / alternative.fields().len() as f64;
                if nearest.as_ref().is_none_or(|(least, _)| share < *least) {
                    nearest = Some((share, unresolved));
                }
            }
        }
    }
    match nearest {
        Some((_, unresolved)) if role.readings.is_empty() => Err(unresolved),
        _ => Ok(role),
    }
}

/// Those alternatives that are meant for a type of message.
///
/// # Errors
/// All are meant for others.
pub fn meant_for<'p, A: Alternative>(
    schema_name: &str,
    alternatives: impl Iterator<Item = &'p A>,
) -> Result<Vec<&'p A>, SchemaError> {
    let plain = |name: &str| name.replace("/msg/", "/");
    let is_meant = |place: &Place| {
        let schemas = &place.schemas;
        schemas.is_empty() || (schemas.iter()).any(|wanted| plain(wanted) == plain(schema_name))
    };
    let (fitting, others): (Vec<&A>, Vec<&A>) =
        alternatives.partition(|source| is_meant(source.place()));
    match others.first() {
        Some(other) if fitting.is_empty() => Err(SchemaError::OtherType {
            name: schema_name.to_owned(),
            wanted: other.place().schemas.clone(),
        }),
        _ => Ok(fitting),
    }
}

fn bind_reading<A: Alternative>(
    binder: &mut Binder,
    profile: &Profile,
    alternative: &A,
) -> Result<Reading, SchemaError> {
    let place = alternative.place();
    Ok(Reading {
        condition: match &place.when {
            Some(condition) => Some(binder.condition(condition)?),
            None => None,
        },
        quantity: alternative.bind(binder)?,
        valid: (place.valid.iter())
            .map(|path| binder.number(path))
            .collect::<Result<_, _>>()?,
        time: binder.time(place.time.as_ref().unwrap_or(&profile.time))?,
    })
}

impl Alternative for AttitudeSource {
    const KIND: Kind = Kind::Attitude;

    fn of(profile: &Profile) -> &[Self] {
        &profile.attitude
    }

    fn place(&self) -> &Place {
        &self.place
    }

    fn place_mut(&mut self) -> &mut Place {
        &mut self.place
    }

    fn fields(&self) -> Vec<&FieldPath> {
        match &self.orientation {
            Orientation::Quaternion(quaternion) => quaternion.fields.paths(),
            Orientation::Euler(euler) => euler.paths(),
        }
    }

    fn bind(&self, binder: &mut Binder) -> Result<Quantity, SchemaError> {
        let orientation = match &self.orientation {
            Orientation::Quaternion(quaternion) => binder.quaternion(quaternion)?,
            Orientation::Euler(euler) => binder.euler(euler)?,
        };
        let reset_counter = match &self.reset_counter {
            None => None,
            Some(counter) if counter.optional && !binder.has(&counter.field) => None,
            Some(counter) => Some(binder.number(&counter.field)?),
        };
        Ok(Quantity::Attitude {
            orientation,
            convention: self.convention,
            reset_counter,
        })
    }
}

impl Alternative for VelocitySource {
    const KIND: Kind = Kind::Velocity;

    fn of(profile: &Profile) -> &[Self] {
        &profile.velocity
    }

    fn place(&self) -> &Place {
        &self.place
    }

    fn place_mut(&mut self) -> &mut Place {
        &mut self.place
    }

    fn fields(&self) -> Vec<&FieldPath> {
        self.vector.paths()
    }

    fn bind(&self, binder: &mut Binder) -> Result<Quantity, SchemaError> {
        Ok(Quantity::Velocity {
            vector: binder.components(&self.vector, ["x", "y", "z"])?,
            frame: self.frame,
            unit: self.unit,
        })
    }
}

impl Alternative for GimbalSource {
    const KIND: Kind = Kind::Gimbal;

    fn of(profile: &Profile) -> &[Self] {
        &profile.gimbal
    }

    fn place(&self) -> &Place {
        &self.place
    }

    fn place_mut(&mut self) -> &mut Place {
        &mut self.place
    }

    fn fields(&self) -> Vec<&FieldPath> {
        match &self.orientation {
            GimbalOrientation::Quaternion(quaternion) => quaternion.fields.paths(),
            GimbalOrientation::Euler(euler) => euler.paths(),
            GimbalOrientation::Pitch(pitch) => vec![&pitch.field],
        }
    }

    fn bind(&self, binder: &mut Binder) -> Result<Quantity, SchemaError> {
        Ok(Quantity::Gimbal {
            orientation: match &self.orientation {
                GimbalOrientation::Quaternion(quaternion) => binder.quaternion(quaternion)?,
                GimbalOrientation::Euler(euler) => binder.euler(euler)?,
                GimbalOrientation::Pitch(pitch) => BoundOrientation::Pitch {
                    slot: binder.number(&pitch.field)?,
                    unit: pitch.unit,
                    positive: pitch.positive,
                },
            },
            convention: self.convention,
            reference: self.reference,
        })
    }
}

impl Alternative for PositionSource {
    const KIND: Kind = Kind::Position;

    fn of(profile: &Profile) -> &[Self] {
        &profile.position
    }

    fn place(&self) -> &Place {
        &self.place
    }

    fn place_mut(&mut self) -> &mut Place {
        &mut self.place
    }

    fn fields(&self) -> Vec<&FieldPath> {
        match &self.coordinates {
            Coordinates::Geodetic {
                latitude,
                longitude,
                altitude,
                ..
            } => vec![latitude, longitude, altitude],
            Coordinates::Local { vector, .. } => vector.paths(),
        }
    }

    fn bind(&self, binder: &mut Binder) -> Result<Quantity, SchemaError> {
        Ok(match &self.coordinates {
            Coordinates::Geodetic {
                latitude,
                longitude,
                altitude,
                unit,
                altitude_unit,
            } => Quantity::Geodetic {
                latitude_longitude_altitude: binder.each([latitude, longitude, altitude])?,
                unit: *unit,
                altitude_unit: *altitude_unit,
            },
            Coordinates::Local {
                vector,
                frame,
                unit,
            } => Quantity::Local {
                vector: binder.components(vector, ["x", "y", "z"])?,
                frame: *frame,
                unit: *unit,
            },
        })
    }
}
