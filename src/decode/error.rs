//! Why a channel's messages cannot be read as a profile says, in words for the user.

use super::path::FieldPath;
use crate::error::Error;

/// How many fields a complaint lists at most.
const LISTED: usize = 40;

/// Why a channel's messages cannot be read as a profile says.
#[derive(Debug, thiserror::Error)]
pub enum SchemaError {
    #[error(
        "its messages are encoded as `{message_encoding}` {}; \
         flightcam reads protobuf, JSON, ROS 2 (cdr with ros2msg) and ROS 1 (ros1 with ros1msg)",
        match schema_encoding.as_str() {
            "" => "without a schema".to_owned(),
            encoding => format!("with a schema in `{encoding}`"),
        }
    )]
    Encoding {
        message_encoding: String,
        schema_encoding: String,
    },
    #[error("{problem}")]
    Schema { problem: String },
    #[error("it has no field {}; {place} has {}", quote(lacking), list(available))]
    NoSuchField {
        lacking: Vec<FieldPath>,
        /// The message, or what else was searched for the first of them.
        place: String,
        available: Vec<String>,
    },
    #[error("its field `{path}` does not exist, because `{through}` is {kind}")]
    NotThere {
        path: FieldPath,
        /// Where the path leads through.
        through: String,
        kind: &'static str,
    },
    #[error(
        "its field `{path}` does not exist, because the list has {length} elements, counted from 0"
    )]
    OutOfRange { path: FieldPath, length: usize },
    #[error("its messages are of type `{name}`, not {}", wanted.join(" or "))]
    OtherType { name: String, wanted: Vec<String> },
    #[error("its field `{path}` is not {wanted} but {kind}")]
    WrongShape {
        path: FieldPath,
        wanted: &'static str,
        kind: &'static str,
    },
    #[error("its field `{path}` is a number, and its unit is not told: s, ms, us or ns")]
    NoUnit { path: FieldPath },
    #[error("its field `{path}` is wanted both as a whole and in part")]
    Overlap { path: FieldPath },
    #[error(transparent)]
    Unreadable(#[from] Error),
}

/// Names in backquotes.
pub fn quote(fields: &[FieldPath]) -> String {
    let names: Vec<String> = fields.iter().map(|field| format!("`{field}`")).collect();
    names.join(", ")
}

impl SchemaError {
    /// Both, where what is wrong is that fields are lacking; else this one.
    pub fn and(mut self, other: Option<Self>) -> Self {
        if let (Self::NoSuchField { lacking, .. }, Some(Self::NoSuchField { lacking: more, .. })) =
            (&mut self, other)
        {
            lacking.extend(more);
        }
        self
    }

    /// How many fields are lacking, one that is not as wanted among them; where nothing is known of the fields,
    /// more than can be.
    pub fn lacks(&self) -> usize {
        match self {
            Self::NoSuchField { lacking, .. } => lacking.len(),
            Self::NotThere { .. }
            | Self::OutOfRange { .. }
            | Self::WrongShape { .. }
            | Self::NoUnit { .. }
            | Self::Overlap { .. } => 1,
            Self::Encoding { .. }
            | Self::Schema { .. }
            | Self::OtherType { .. }
            | Self::Unreadable(_) => usize::MAX,
        }
    }

    /// Whether the fields of the messages cannot be known.
    pub fn is_opaque(&self) -> bool {
        matches!(self, Self::Encoding { .. } | Self::Schema { .. })
    }
}

fn list(names: &[String]) -> String {
    let listed = names[..names.len().min(LISTED)].join(", ");
    match names.len().saturating_sub(LISTED) {
        0 => listed,
        more => format!("{listed} and {more} more"),
    }
}
