//! Why a channel's messages cannot be read as a profile says.

use crate::{
    decode::{error::SchemaError, path::FieldPath},
    log::ReadError,
};

/// Why a channel's messages cannot be read as a profile says.
#[derive(Debug, thiserror::Error)]
pub enum BindError {
    #[error(transparent)]
    Schema(#[from] SchemaError),

    #[error("its messages are of type `{name}`, not {}", wanted.join(" or "))]
    OtherType { name: String, wanted: Vec<String> },

    #[error("its field `{path}` is a number, and its unit is not given: s, ms, us or ns")]
    NoUnit { path: FieldPath },
}

impl BindError {
    /// Both, where what is wrong is that fields are lacking; else this one.
    pub fn and(self, other: Option<Self>) -> Self {
        match (self, other) {
            (Self::Schema(this), Some(Self::Schema(other))) => Self::Schema(this.and(Some(other))),
            (this, _) => this,
        }
    }

    /// How many fields are lacking, one that is not as wanted among them; where nothing is known of the fields,
    /// more than can be.
    pub fn lacks(&self) -> usize {
        match self {
            Self::Schema(error) => error.lacks(),
            Self::OtherType { .. } => usize::MAX,
            Self::NoUnit { .. } => 1,
        }
    }

    /// Whether the fields of the messages cannot be known.
    pub fn is_opaque(&self) -> bool {
        matches!(self, Self::Schema(error) if error.is_opaque())
    }

    /// Whether the log could not be read.
    pub fn is_of_reading(&self) -> bool {
        matches!(self, Self::Schema(SchemaError::Unreadable(_)))
    }

    /// This, if the log could be read.
    ///
    /// # Errors
    /// It could not.
    pub fn unless_of_reading(self) -> Result<Self, ReadError> {
        match self {
            Self::Schema(SchemaError::Unreadable(error)) => Err(error),
            other => Ok(other),
        }
    }
}
