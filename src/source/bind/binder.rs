//! Resolving a profile's fields against the schema of one channel.

use super::{BindError, ChannelName, Slot, TimeSlots};
use crate::{
    decode::{
        error::{Expected, SchemaError},
        field::{FieldKind, Shape, Wanted},
        path::{FieldPath, Filter},
        schema::MessageSchema,
        value::FieldValue,
    },
    source::profile::{
        AccelerationFields, AngularRateFields, AttitudeFields, Components, Condition, Coordinates,
        Euler, GimbalFields, HeightFields, OptionalField, Orientation, Pitch, Quaternion,
        RoleFields, SampleTime, Test, TimeField, VelocityFields, convention::QuaternionOrder,
    },
};

/// The fields of a message that is a vector.
const XYZ: [&str; 3] = ["x", "y", "z"];

/// Resolves fields against the schema of one channel, and collects them for its decoder.
#[derive(Debug)]
pub struct Binder<'a> {
    schema: &'a MessageSchema<'a>,
    /// The channel.
    pub channel: ChannelName<'a>,
    /// The fields that were resolved, in the order of their slots.
    pub wanted: Vec<Wanted>,
    /// The fields that are missing in the schema. They are reported all at once.
    missing: Option<SchemaError>,
}

impl<'a> Binder<'a> {
    /// Starts with nothing resolved.
    pub fn new(schema: &'a MessageSchema<'a>, channel: ChannelName<'a>) -> Self {
        Self {
            schema,
            channel,
            wanted: Vec::new(),
            missing: None,
        }
    }

    /// Does what `resolve` does, all or nothing: if fields are missing in the schema or something else is wrong,
    /// nothing stays wanted.
    ///
    /// # Errors
    /// The errors of `resolve`, or all the fields that are missing.
    pub fn attempt<T>(
        &mut self,
        resolve: impl FnOnce(&mut Self) -> Result<T, BindError>,
    ) -> Result<T, BindError> {
        let already_wanted = self.wanted.len();
        let resolved = resolve(self);
        let missing = self.missing.take();
        let resolved = match (resolved, missing) {
            (Err(error), Some(missing)) if error.is_of_frames() => Err(missing.into()),
            (Ok(_), Some(missing)) => Err(missing.into()),
            (resolved, _) => resolved,
        };
        if resolved.is_err() {
            self.wanted.truncate(already_wanted);
        }
        resolved
    }

    /// Resolves the fields of a role.
    pub fn role(&mut self, fields: &RoleFields) -> Result<RoleFields<Slot>, BindError> {
        Ok(match fields {
            RoleFields::Attitude(attitude) => RoleFields::Attitude(AttitudeFields {
                orientation: self.orientation(&attitude.orientation)?,
                convention: attitude.convention,
                reset_counter: match &attitude.reset_counter {
                    Some(counter) => self.optional(counter)?,
                    None => None,
                },
            }),
            RoleFields::Velocity(velocity) => RoleFields::Velocity(VelocityFields {
                vector: self.components(&velocity.vector, XYZ)?,
                frame: velocity.frame,
                unit: velocity.unit,
                required: velocity.required,
            }),
            RoleFields::Gimbal(gimbal) => RoleFields::Gimbal(GimbalFields {
                orientation: self.orientation(&gimbal.orientation)?,
                reference: gimbal.reference,
                convention: gimbal.convention,
            }),
            RoleFields::Position(coordinates) => {
                RoleFields::Position(self.coordinates(coordinates)?)
            }
            RoleFields::Height(height) => RoleFields::Height(HeightFields {
                field: self.number(&height.field)?,
                unit: height.unit,
            }),
            RoleFields::AngularRate(rate) => RoleFields::AngularRate(AngularRateFields {
                vector: self.components(&rate.vector, XYZ)?,
                frame: rate.frame,
                unit: rate.unit,
            }),
            RoleFields::Acceleration(acceleration) => {
                RoleFields::Acceleration(AccelerationFields {
                    vector: self.components(&acceleration.vector, XYZ)?,
                    frame: acceleration.frame,
                    unit: acceleration.unit,
                })
            }
        })
    }

    fn coordinates(&mut self, coordinates: &Coordinates) -> Result<Coordinates<Slot>, BindError> {
        Ok(match coordinates {
            Coordinates::Geodetic {
                latitude,
                longitude,
                altitude,
                unit,
                altitude_unit,
            } => Coordinates::Geodetic {
                latitude: self.number(latitude)?,
                longitude: self.number(longitude)?,
                altitude: self.number(altitude)?,
                unit: *unit,
                altitude_unit: *altitude_unit,
            },
            Coordinates::Local {
                vector,
                frame,
                unit,
            } => Coordinates::Local {
                vector: self.components(vector, XYZ)?,
                frame: *frame,
                unit: *unit,
            },
        })
    }

    fn orientation(&mut self, orientation: &Orientation) -> Result<Orientation<Slot>, BindError> {
        Ok(match orientation {
            Orientation::Quaternion(quaternion) => {
                Orientation::Quaternion(self.quaternion(quaternion)?)
            }
            Orientation::Euler(euler) => Orientation::Euler(Euler {
                roll: self.number(&euler.roll)?,
                pitch: self.number(&euler.pitch)?,
                yaw: self.number(&euler.yaw)?,
                unit: euler.unit,
                order: euler.order,
            }),
            Orientation::Pitch(pitch) => Orientation::Pitch(Pitch {
                field: self.number(&pitch.field)?,
                unit: pitch.unit,
                positive: pitch.positive,
            }),
        })
    }

    fn quaternion(&mut self, quaternion: &Quaternion) -> Result<Quaternion<Slot>, BindError> {
        let fields = self.components(&quaternion.fields, ["w", "x", "y", "z"])?;
        let order = match (&quaternion.fields, &fields) {
            // The members of a message were just named in this order.
            (Components::Together(_), Components::Each(_)) => QuaternionOrder::Wxyz,
            _ => quaternion.order,
        };
        Ok(Quaternion { fields, order })
    }

    /// Resolves a vector or a quaternion; if it is a message, its members have these names.
    fn components<const N: usize>(
        &mut self,
        components: &Components<N>,
        names: [&str; N],
    ) -> Result<Components<N, Slot>, BindError> {
        match components {
            Components::Each(paths) => self.each(paths),
            Components::Together(path) => match self.kind_of(path)? {
                Some(FieldKind::List | FieldKind::Unknown) => {
                    Ok(Components::Together(self.slot(path, Shape::List)))
                }
                Some(FieldKind::Message(_)) => self.each(&names.map(|name| path.child(name))),
                Some(kind) => Err(wrong_shape(path, Expected::Vector, kind)),
                None => Ok(Components::Together(Slot::default())),
            },
        }
    }

    fn each<const N: usize>(
        &mut self,
        paths: &[FieldPath; N],
    ) -> Result<Components<N, Slot>, BindError> {
        let mut slots = [Slot::default(); N];
        for (slot, path) in slots.iter_mut().zip(paths) {
            *slot = self.number(path)?;
        }
        Ok(Components::Each(slots))
    }

    /// Resolves a number that some schemas do not have.
    fn optional(
        &mut self,
        OptionalField { field, optional }: &OptionalField,
    ) -> Result<Option<OptionalField<Slot>>, BindError> {
        let slot = match optional {
            true => self.number_if_there(field),
            false => Some(self.number(field)?),
        };
        Ok(slot.map(|field| OptionalField {
            field,
            optional: *optional,
        }))
    }

    /// Resolves a number, if the schema has it.
    pub fn number_if_there(&mut self, path: &FieldPath) -> Option<Slot> {
        self.if_there(path, &[Shape::Number])
    }

    /// Resolves a text, if the schema has it.
    pub fn text_if_there(&mut self, path: &FieldPath) -> Option<Slot> {
        self.if_there(path, &[Shape::Text])
    }

    /// Resolves a number or a text, if the schema has it.
    pub fn id_if_there(&mut self, path: &FieldPath) -> Option<Slot> {
        self.if_there(path, &[Shape::Number, Shape::Text])
    }

    fn if_there(&mut self, path: &FieldPath, shapes: &[Shape]) -> Option<Slot> {
        let kind = self.schema.kind_of(path).ok()?;
        let shape = shapes.iter().find(|shape| kind.is_a(**shape))?;
        Some(self.slot(path, *shape))
    }

    /// Resolves a number.
    pub fn number(&mut self, path: &FieldPath) -> Result<Slot, BindError> {
        self.field(path, Shape::Number)
    }

    /// Resolves a text.
    pub fn text(&mut self, path: &FieldPath) -> Result<Slot, BindError> {
        self.field(path, Shape::Text)
    }

    fn field(&mut self, path: &FieldPath, shape: Shape) -> Result<Slot, BindError> {
        match self.kind_of(path)? {
            Some(kind) if kind.is_a(shape) => Ok(self.slot(path, shape)),
            Some(kind) => Err(wrong_shape(path, shape.into(), kind)),
            None => Ok(Slot::default()),
        }
    }

    /// Resolves a filter.
    pub fn filter(&mut self, filter: &Filter) -> Result<Filter<Slot>, BindError> {
        let slot = self.field(&filter.field, filter.value.shape())?;
        if self.missing.is_none() {
            // The messages that satisfy it may have fields that the others do not have.
            self.schema.expect_several_types();
        }
        Ok(filter.with_field(slot))
    }

    /// Resolves a condition.
    pub fn condition(
        &mut self,
        Condition { field, test }: &Condition,
    ) -> Result<Condition<Slot>, BindError> {
        let slot = match test {
            Test::Is(_) | Test::HasBits(_) | Test::IsInteger(_) => self.number(field)?,
            Test::Says(text) | Test::Contains(text) if text.len() > FieldValue::LONGEST_TEXT => {
                return Err(BindError::LongText {
                    path: field.clone(),
                });
            }
            Test::Says(_) | Test::Contains(_) => self.text(field)?,
        };
        Ok(Condition {
            field: slot,
            test: test.clone(),
        })
    }

    /// Resolves a time.
    pub fn time(&mut self, time: &SampleTime) -> Result<SampleTime<TimeSlots>, BindError> {
        const SECONDS: [&str; 3] = ["sec", "secs", "seconds"];
        const NANOSECONDS: [&str; 5] = ["nanosec", "nsec", "nsecs", "nanos", "nanoseconds"];
        let TimeField { path, unit } = match time {
            SampleTime::LogTime => return Ok(SampleTime::LogTime),
            SampleTime::PublishTime => return Ok(SampleTime::PublishTime),
            SampleTime::Field(field) => field,
        };
        let Some(kind) = self.kind_of(path)? else {
            return Ok(SampleTime::LogTime);
        };
        if let FieldKind::Message(names) = &kind {
            let of = |known: &[&str]| names.iter().find(|name| known.contains(&name.as_str()));
            if let (Some(seconds), Some(nanoseconds)) = (of(&SECONDS), of(&NANOSECONDS)) {
                let seconds = self.number(&path.child(seconds))?;
                let nanoseconds = self.number(&path.child(nanoseconds))?;
                return Ok(SampleTime::Field(TimeSlots::SecondsAndNanoseconds([
                    seconds,
                    nanoseconds,
                ])));
            }
        }
        if !kind.is_a(Shape::Number) {
            return Err(wrong_shape(path, Expected::Time, kind));
        }
        let unit = unit.ok_or_else(|| BindError::NoUnit { path: path.clone() })?;
        let slot = self.slot(path, Shape::Number);
        Ok(SampleTime::Field(TimeSlots::Number { slot, unit }))
    }

    /// What a path leads to; `None`, and noted, if the schema does not have it.
    fn kind_of(&mut self, path: &FieldPath) -> Result<Option<FieldKind>, BindError> {
        match self.schema.kind_of(path) {
            Ok(kind) => Ok(Some(kind)),
            Err(error @ SchemaError::NoSuchField { .. }) => {
                self.missing = Some(match self.missing.take() {
                    Some(first) => first.and(Some(error)),
                    None => error,
                });
                Ok(None)
            }
            Err(other) => Err(other.into()),
        }
    }

    /// The slot of a field, which is shared by all who want the field in the same form.
    fn slot(&mut self, path: &FieldPath, shape: Shape) -> Slot {
        let path = path.clone();
        let field = Wanted { path, shape };
        let known = self.wanted.iter().position(|other| *other == field);
        known.unwrap_or_else(|| {
            self.wanted.push(field);
            self.wanted.len() - 1
        })
    }
}

fn wrong_shape(path: &FieldPath, wanted: Expected, kind: FieldKind) -> BindError {
    BindError::Schema(SchemaError::WrongShape {
        path: path.clone(),
        wanted,
        kind,
    })
}
