//! Why a channel's messages cannot be read as a profile says.

use crate::{
    decode::{error::SchemaError, path::FieldPath, value::FieldValue},
    log::ReadError,
    text::{self, Foreign},
};

/// Why a channel's messages cannot be read as a profile says.
#[derive(Debug, thiserror::Error)]
pub enum BindError {
    #[error(transparent)]
    Schema(#[from] SchemaError),

    #[error(
        "its messages are of type `{name}`, not {}",
        text::join(wanted, " or ")
    )]
    OtherType { name: Foreign, wanted: Vec<Foreign> },

    #[error("its field `{path}` is a number, and its unit is not given: s, ms, us or ns")]
    NoUnit { path: FieldPath },

    #[error(
        "its field `{path}` is compared with a text of more than {} bytes, which are not kept",
        FieldValue::LONGEST_TEXT
    )]
    LongText { path: FieldPath },

    #[error("nothing says in which axes its quaternion `{path}` is, such as frd-ned or flu-enu")]
    NoAxes { path: FieldPath },

    #[error(
        "MAVROS writes this velocity in east, north and down, or since June 2026 up, whatever it names its frame"
    )]
    BrokenRule,
}

impl BindError {
    /// Returns one error for all missing fields if both report missing fields; otherwise this one.
    pub fn and(self, other: Option<Self>) -> Self {
        match (self, other) {
            (Self::Schema(this), Some(Self::Schema(other))) => Self::Schema(this.and(Some(other))),
            (this, _) => this,
        }
    }

    /// How many fields are missing, of the wrong type or without a unit; `usize::MAX` if unknown.
    pub fn missing_fields(&self) -> usize {
        match self {
            Self::Schema(error) => error.missing_fields(),
            Self::OtherType { .. } => usize::MAX,
            Self::NoUnit { .. }
            | Self::LongText { .. }
            | Self::NoAxes { .. }
            | Self::BrokenRule => 1,
        }
    }

    /// Whether the messages do not have this field.
    pub fn lacks(&self, field: &FieldPath) -> bool {
        matches!(self, Self::Schema(SchemaError::NoSuchField { missing, .. }) if missing.contains(field))
    }

    /// Whether the fields of the messages cannot be known.
    pub fn is_opaque(&self) -> bool {
        matches!(self, Self::Schema(error) if error.is_opaque())
    }

    /// Whether the messages are of another type, or lack what is wanted.
    pub fn is_of_schema(&self) -> bool {
        matches!(self, Self::Schema(_) | Self::OtherType { .. })
    }

    /// Whether it is not known in which axes the messages have what is wanted.
    pub fn is_of_frames(&self) -> bool {
        matches!(self, Self::NoAxes { .. } | Self::BrokenRule)
    }

    /// Whether the log could not be read.
    pub fn is_of_reading(&self) -> bool {
        matches!(self, Self::Schema(SchemaError::Unreadable(_)))
    }

    /// Returns this error, unless it is that the log could not be read.
    ///
    /// # Errors
    /// The log could not be read.
    pub fn unless_of_reading(self) -> Result<Self, ReadError> {
        match self {
            Self::Schema(SchemaError::Unreadable(error)) => Err(error),
            other => Ok(other),
        }
    }
}
