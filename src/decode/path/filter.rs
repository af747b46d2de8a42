//! Which of several messages, or of the elements of a list.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

use super::{FieldPath, quoted};
use crate::{
    decode::{
        field::Shape,
        value::{FieldValue, Number},
    },
    text::escaped,
};

/// What a message, or an element of a list, must satisfy: `device_id==1`. `F` stands for a field: its path in a path or
/// a profile, its slot in a decoder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Filter<F = FieldPath> {
    /// The field.
    pub field: F,
    /// How it is compared.
    pub comparison: Comparison,
    /// With what it is compared.
    pub value: Literal,
}

/// How two values are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// They must be equal. A field that is missing is equal to nothing.
    Equal,
    /// They must not be equal.
    Unequal,
}

/// A value in a filter.
#[derive(Debug, Clone, PartialEq)]
pub enum Literal {
    /// A number, which is finite.
    Number(Number),
    /// A text of at most 256 bytes.
    Text(String),
    /// True or false, which are the numbers 1 and 0.
    Truth(bool),
}

// No number in it is NaN.
impl Eq for Literal {}

impl Literal {
    /// The value of a field; `None` if it is missing, a list, or a number that is not finite.
    pub(crate) fn of(value: &FieldValue) -> Option<Self> {
        let text = |text| Self::Text(String::from_utf8_lossy(text).into_owned());
        let number = value.exact().filter(|number| number.to_f64().is_finite());
        number.map(Self::Number).or_else(|| value.text().map(text))
    }

    /// In which form a field is wanted that is compared with it.
    pub(crate) fn shape(&self) -> Shape {
        match self {
            Self::Number(_) | Self::Truth(_) => Shape::Number,
            Self::Text(_) => Shape::Text,
        }
    }

    /// Whether a field has this value.
    pub(crate) fn equals(&self, value: &FieldValue) -> bool {
        match self {
            Self::Number(number) => value.exact().is_some_and(|other| number.equals(other)),
            Self::Truth(truth) => {
                let number = Number::from(*truth);
                value.exact().is_some_and(|other| number.equals(other))
            }
            Self::Text(text) => value.text() == Some(text.as_bytes()),
        }
    }
}

impl Filter<usize> {
    /// Whether the values of a message's fields satisfy it.
    pub(crate) fn holds(&self, values: &[FieldValue]) -> bool {
        let is_equal = self.value.equals(&values[self.field]);
        is_equal == (self.comparison == Comparison::Equal)
    }
}

impl<F> Filter<F> {
    /// The same for the field in another form.
    pub(crate) fn with_field<G>(&self, field: G) -> Filter<G> {
        Filter {
            field,
            comparison: self.comparison,
            value: self.value.clone(),
        }
    }
}

impl From<Filter> for String {
    fn from(filter: Filter) -> Self {
        let comparison = match filter.comparison {
            Comparison::Equal => "==",
            Comparison::Unequal => "!=",
        };
        format!(
            "{}{comparison}{}",
            Self::from(filter.field),
            filter.value.written()
        )
    }
}

impl Literal {
    /// The value as a filter has it.
    fn written(&self) -> String {
        match self {
            Self::Number(Number::Real(number)) => format!("{number:?}"),
            Self::Number(Number::Signed(number)) => number.to_string(),
            Self::Number(Number::Unsigned(number)) => number.to_string(),
            Self::Text(text) => quoted(text),
            Self::Truth(truth) => truth.to_string(),
        }
    }
}

impl fmt::Display for Filter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        escaped(String::from(self.clone())).fmt(f)
    }
}

impl fmt::Display for Literal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        escaped(self.written()).fmt(f)
    }
}

impl Serialize for Filter {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&String::from(self.clone()))
    }
}

impl<'de> Deserialize<'de> for Filter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(D::Error::custom)
    }
}

impl Serialize for Literal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Number(Number::Real(number)) => serializer.serialize_f64(number),
            Self::Number(Number::Signed(number)) => serializer.serialize_i64(number),
            Self::Number(Number::Unsigned(number)) => serializer.serialize_u64(number),
            Self::Text(ref text) => serializer.serialize_str(text),
            Self::Truth(truth) => serializer.serialize_bool(truth),
        }
    }
}
