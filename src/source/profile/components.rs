//! The fields of a vector or a quaternion.

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeOwned, Error},
};
use toml::Value;

use crate::decode::path::FieldPath;

/// One field that is a list of numbers or a message with `x`, `y`, `z` (and `w`), or a field for each component.
#[derive(Debug, Clone, PartialEq)]
pub enum Components<const N: usize, F = FieldPath> {
    /// All components in one field.
    Together(F),
    /// A field for each component.
    Each([F; N]),
}

/// A number of fields that does not fit the number of components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{given} fields were given; expected one or {wanted}")]
pub struct WrongCount {
    /// How many fields were given.
    pub given: usize,
    /// How many components there are.
    pub wanted: usize,
}

impl<const N: usize, F> Components<N, F> {
    /// Takes one field, or as many as there are components.
    ///
    /// # Errors
    /// There is neither one field nor one for each component.
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

impl<'de, const N: usize, F: DeserializeOwned> Deserialize<'de> for Components<N, F> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Not an untagged enum, whose errors would not say what is wrong with a path.
        let fields = match Value::deserialize(deserializer)? {
            Value::Array(fields) => fields,
            field @ Value::String(_) => vec![field],
            _ => return Err(D::Error::custom("wanted a field or a list of fields")),
        };
        let fields: Result<Vec<F>, _> = fields.into_iter().map(Value::try_into).collect();
        Self::of(fields.map_err(D::Error::custom)?).map_err(D::Error::custom)
    }
}
