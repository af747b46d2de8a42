//! The fields of a vector or a quaternion.

use std::{fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{Error, IntoDeserializer, SeqAccess, Visitor, value::SeqAccessDeserializer},
};

use crate::decode::path::FieldPath;

/// One field that is a list of numbers or a message with `x`, `y`, `z` (and `w`), or a field for each component.
#[derive(Debug, Clone, PartialEq)]
pub enum Components<const N: usize, F = FieldPath> {
    /// All in one.
    Together(F),
    /// Each by itself.
    Each([F; N]),
}

/// A number of fields that components do not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{given} fields were given; it takes one or {wanted}")]
pub struct WrongCount {
    /// How many there are.
    pub given: usize,
    /// How many components there are.
    pub wanted: usize,
}

impl<const N: usize, F> Components<N, F> {
    /// Of one field, or of as many as there are components.
    ///
    /// # Errors
    /// There are more or fewer.
    pub fn of(fields: Vec<F>) -> Result<Self, WrongCount> {
        match <[F; 1]>::try_from(fields) {
            Ok([field]) => Ok(Self::Together(field)),
            Err(fields) => fields
                .try_into()
                .map(Self::Each)
                .map_err(|fields| WrongCount {
                    given: fields.len(),
                    wanted: N,
                }),
        }
    }

    /// The fields.
    pub fn fields(&self) -> Vec<&F> {
        match self {
            Self::Together(field) => vec![field],
            Self::Each(fields) => fields.iter().collect(),
        }
    }
}

impl<const N: usize, F: Serialize> Serialize for Components<N, F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Together(field) => field.serialize(serializer),
            Self::Each(fields) => fields.as_slice().serialize(serializer),
        }
    }
}

impl<'de, const N: usize, F: Deserialize<'de>> Deserialize<'de> for Components<N, F> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OneOrEach(PhantomData))
    }
}

/// Not an untagged enum, whose errors would not say what is wrong with a path.
struct OneOrEach<const N: usize, F>(PhantomData<F>);

impl<'de, const N: usize, F: Deserialize<'de>> Visitor<'de> for OneOrEach<N, F> {
    type Value = Components<N, F>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a field or a list of fields")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        F::deserialize(text.into_deserializer()).map(Components::Together)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, fields: A) -> Result<Self::Value, A::Error> {
        let fields = Vec::deserialize(SeqAccessDeserializer::new(fields))?;
        Components::of(fields).map_err(A::Error::custom)
    }
}
