//! Resolving a profile's fields against the schema of one channel.

use super::{
    binding::{BoundComponents, BoundCondition, BoundOrientation, BoundTest, BoundTime, Slot},
    profile::{
        Components, Condition, Euler, Quaternion, Test, TimeSource, convention::QuaternionOrder,
    },
};
use crate::decode::{
    error::{Expected, Listing, SchemaError},
    field::{FieldKind, Shape, Wanted},
    path::FieldPath,
    schema::MessageSchema,
};

/// Resolves fields against the schema of one channel, and collects them for its decoder.
#[derive(Debug)]
pub struct Binder<'a> {
    schema: &'a MessageSchema<'a>,
    /// The fields that were resolved, in the order of their slots.
    pub wanted: Vec<Wanted>,
    /// The fields that the schema lacks. They are told all at once.
    lacking: Option<Lacking>,
}

#[derive(Debug)]
struct Lacking {
    fields: Vec<FieldPath>,
    place: Listing,
    available: Vec<String>,
}

impl<'a> Binder<'a> {
    /// With nothing resolved yet.
    pub fn new(schema: &'a MessageSchema<'a>) -> Self {
        Self {
            schema,
            wanted: Vec::new(),
            lacking: None,
        }
    }

    /// Does what `resolve` does, all or nothing: where the schema lacks fields or something else is wrong,
    /// nothing stays wanted.
    ///
    /// # Errors
    /// Those of `resolve`, or all the fields that are lacking.
    pub fn attempt<T>(
        &mut self,
        resolve: impl FnOnce(&mut Self) -> Result<T, SchemaError>,
    ) -> Result<T, SchemaError> {
        let already_wanted = self.wanted.len();
        let resolved = resolve(self);
        let resolved = match (resolved, self.lacking.take()) {
            (Ok(_), Some(lacking)) => Err(SchemaError::NoSuchField {
                lacking: lacking.fields,
                place: lacking.place,
                available: lacking.available,
            }),
            (resolved, _) => resolved,
        };
        if resolved.is_err() {
            self.wanted.truncate(already_wanted);
        }
        resolved
    }

    /// Resolves a number.
    pub fn number(&mut self, path: &FieldPath) -> Result<Slot, SchemaError> {
        match self.kind_of(path)? {
            Some(kind) if kind.is_a(&Shape::Number) => Ok(self.slot(path, Shape::Number)),
            Some(kind) => Err(wrong_shape(path, Expected::Number, kind)),
            None => Ok(Slot::default()),
        }
    }

    /// Resolves a vector or a quaternion, the members of a message by these names.
    pub fn components<const N: usize>(
        &mut self,
        components: &Components<N>,
        names: [&str; N],
    ) -> Result<BoundComponents<N>, SchemaError> {
        match components {
            Components::Each(paths) => self.each(paths.each_ref()),
            Components::Together(path) => match self.kind_of(path)? {
                Some(FieldKind::List | FieldKind::Unknown) => {
                    Ok(BoundComponents::List(self.slot(path, Shape::List)))
                }
                Some(FieldKind::Message(_)) => {
                    let paths = names.map(|name| path.child(name));
                    self.each(paths.each_ref())
                }
                Some(kind) => Err(wrong_shape(path, Expected::Vector, kind)),
                None => Ok(BoundComponents::List(Slot::default())),
            },
        }
    }

    /// Resolves some numbers.
    pub fn each<const N: usize>(
        &mut self,
        paths: [&FieldPath; N],
    ) -> Result<BoundComponents<N>, SchemaError> {
        let mut slots = [Slot::default(); N];
        for (slot, path) in slots.iter_mut().zip(paths) {
            *slot = self.number(path)?;
        }
        Ok(BoundComponents::Each(slots))
    }

    /// Resolves a quaternion.
    pub fn quaternion(&mut self, quaternion: &Quaternion) -> Result<BoundOrientation, SchemaError> {
        let Quaternion { fields, order } = quaternion;
        let components = self.components(fields, ["w", "x", "y", "z"])?;
        // The members of a message were just named in this order.
        let by_name = matches!(
            (fields, &components),
            (Components::Together(_), BoundComponents::Each(_))
        );
        Ok(BoundOrientation::Quaternion {
            components,
            order: match by_name {
                true => QuaternionOrder::Wxyz,
                false => *order,
            },
        })
    }

    /// Resolves Euler angles.
    pub fn euler(&mut self, euler: &Euler) -> Result<BoundOrientation, SchemaError> {
        Ok(BoundOrientation::Euler {
            rpy: self.each([&euler.roll, &euler.pitch, &euler.yaw])?,
            unit: euler.unit,
        })
    }

    /// Resolves a condition.
    pub fn condition(&mut self, condition: &Condition) -> Result<BoundCondition, SchemaError> {
        let path = &condition.field;
        Ok(match &condition.test {
            Test::Is(number) => BoundCondition {
                slot: self.number(path)?,
                test: BoundTest::Is(*number),
            },
            Test::HasBits(bits) => BoundCondition {
                slot: self.number(path)?,
                test: BoundTest::HasBits(*bits),
            },
            Test::Says(text) => {
                let (slot, place) = match self.kind_of(path)? {
                    Some(FieldKind::Text | FieldKind::Unknown) => self.word(path, text),
                    Some(kind) => return Err(wrong_shape(path, Expected::Text, kind)),
                    None => Default::default(),
                };
                BoundCondition {
                    slot,
                    test: BoundTest::Is(place as i64),
                }
            }
        })
    }

    /// Resolves a time.
    pub fn time(&mut self, source: &TimeSource) -> Result<BoundTime, SchemaError> {
        const SECONDS: [&str; 3] = ["sec", "secs", "seconds"];
        const NANOSECONDS: [&str; 5] = ["nanosec", "nsec", "nsecs", "nanos", "nanoseconds"];
        let (path, unit) = match source {
            TimeSource::LogTime => return Ok(BoundTime::LogTime),
            TimeSource::PublishTime => return Ok(BoundTime::PublishTime),
            TimeSource::Field { path, unit } => (path, *unit),
        };
        let kind = self.kind_of(path)?;
        if let Some(FieldKind::Message(names)) = &kind {
            let of = |known: &[&str]| names.iter().find(|name| known.contains(&name.as_str()));
            if let (Some(seconds), Some(nanoseconds)) = (of(&SECONDS), of(&NANOSECONDS)) {
                let seconds = self.number(&path.child(seconds))?;
                let nanoseconds = self.number(&path.child(nanoseconds))?;
                return Ok(BoundTime::SecondsAndNanoseconds([seconds, nanoseconds]));
            }
        }
        match kind {
            Some(kind) if !kind.is_a(&Shape::Number) => {
                Err(wrong_shape(path, Expected::Time, kind))
            }
            None => Ok(BoundTime::LogTime),
            Some(_) => match unit {
                Some(unit) => Ok(BoundTime::Number {
                    slot: self.slot(path, Shape::Number),
                    unit,
                }),
                None => Err(SchemaError::NoUnit { path: path.clone() }),
            },
        }
    }

    /// Whether the schema has a number there.
    pub fn has(&self, path: &FieldPath) -> bool {
        (self.schema.kind_of(path)).is_ok_and(|kind| kind.is_a(&Shape::Number))
    }

    /// What a path leads to; `None`, and noted, where the schema lacks it.
    fn kind_of(&mut self, path: &FieldPath) -> Result<Option<FieldKind>, SchemaError> {
        match self.schema.kind_of(path) {
            Ok(kind) => Ok(Some(kind)),
            Err(SchemaError::NoSuchField {
                lacking,
                place,
                available,
            }) => {
                let all = self.lacking.get_or_insert(Lacking {
                    fields: Vec::new(),
                    place,
                    available,
                });
                all.fields.extend(lacking);
                Ok(None)
            }
            Err(other) => Err(other),
        }
    }

    /// The slot of a field, which is the same for all who want the field in one shape.
    fn slot(&mut self, path: &FieldPath, shape: Shape) -> Slot {
        let path = path.clone();
        let field = Wanted { path, shape };
        let known = self.wanted.iter().position(|other| *other == field);
        known.unwrap_or_else(|| {
            self.wanted.push(field);
            self.wanted.len() - 1
        })
    }

    /// The slot of a text, and the place of a word among those that it is compared with.
    fn word(&mut self, path: &FieldPath, word: &str) -> (Slot, usize) {
        let of_path = |field: &Wanted| field.path == *path && matches!(field.shape, Shape::Word(_));
        let slot = match self.wanted.iter().position(of_path) {
            Some(slot) => slot,
            None => self.slot(path, Shape::Word(Vec::new())),
        };
        let Shape::Word(words) = &mut self.wanted[slot].shape else {
            unreachable!("the slot is that of a text");
        };
        let known = words.iter().position(|other| other == word);
        let place = known.unwrap_or_else(|| {
            words.push(word.to_owned());
            words.len() - 1
        });
        (slot, place)
    }
}

fn wrong_shape(path: &FieldPath, wanted: Expected, kind: FieldKind) -> SchemaError {
    SchemaError::WrongShape {
        path: path.clone(),
        wanted,
        kind,
    }
}
