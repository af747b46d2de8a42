//! Why fields cannot be read from a channel's messages.

use std::fmt;

use super::{
    fault::Fault,
    field::{FieldKind, Shape},
    path::{FieldPath, PathStep, written},
    schema::SUPPORTED,
};
use crate::{
    log::ReadError,
    similar,
    text::{self, Foreign, escaped},
};

/// The most field names that an error message lists.
const LISTED: usize = 40;

/// Why fields cannot be read from a channel's messages.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SchemaError {
    #[error(
        "its messages are encoded as `{message_encoding}` {}; flightcam reads {SUPPORTED}",
        match schema_encoding.is_empty() {
            true => "without a schema".to_owned(),
            false => format!("with a schema in `{schema_encoding}`"),
        }
    )]
    Encoding {
        message_encoding: Foreign,
        schema_encoding: Foreign,
    },
    #[error("its protobuf schema cannot be read: {}", escaped(.0))]
    ProtobufSchema(prost_reflect::DescriptorError),
    #[error("its protobuf schema does not define `{name}`")]
    UndefinedProtobufMessage { name: Foreign },
    #[error("its JSON schema cannot be read: {}", escaped(.0))]
    JsonSchema(serde_json::Error),
    #[error("its first messages cannot be read: {0}")]
    NotJson(Fault),
    #[error("its ROS message definition cannot be used: {0}")]
    RosDefinition(#[from] RosDefinitionError),
    #[error(
        "it has no field {}; {}{place} has {}",
        quote(missing),
        meant(missing, available),
        list(available)
    )]
    NoSuchField {
        missing: Vec<FieldPath>,
        /// The place where the first of them was looked for.
        place: Listing,
        available: Vec<Foreign>,
    },
    #[error("its field `{path}` does not exist, because `{through}` is {kind}")]
    NotThere {
        path: FieldPath,
        /// The part of the path that does exist.
        through: FieldPath,
        kind: FieldKind,
    },
    #[error(
        "its field `{path}` does not exist, because the list has {length} elements, counted from 0"
    )]
    OutOfRange { path: FieldPath, length: usize },
    #[error("its field `{path}` is not {wanted} but {kind}")]
    WrongShape {
        path: FieldPath,
        wanted: Expected,
        kind: FieldKind,
    },
    #[error("elements of the list in `{path}` are wanted both by their place and by a filter")]
    PlaceAndFilter { path: FieldPath },
    #[error("its field `{path}` is wanted both as a whole and in part")]
    Overlap { path: FieldPath },
    #[error(
        "nothing after the field `{field}` can be read, because there is a `wstring` in it, \
         which ROS 2's implementations write in different ways"
    )]
    AfterWideText { field: Foreign },
    #[error(transparent)]
    Unreadable(#[from] ReadError),
}

/// What is wrong with a ROS message definition.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RosDefinitionError {
    #[error("line {line}, `{text}`, names no field")]
    NoField { line: usize, text: Foreign },
    #[error("line {line}: `{type_name}` is not a type")]
    NotAType { line: usize, type_name: Foreign },
    #[error("line {line}: `{type_name}` has no valid array size")]
    ArraySize { line: usize, type_name: Foreign },
    #[error("it does not define `{name}`")]
    Undefined { name: Foreign },
    #[error("`{name}` contains itself")]
    Recursive { name: Foreign },
    #[error("at `{name}` messages are nested more than {limit} deep")]
    TooDeep { name: Foreign, limit: usize },
}

/// The source of the list of a message's fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Listing {
    /// The message type with this name.
    MessageType(Foreign),
    /// The channel's JSON schema.
    JsonSchema,
    /// The message with the most fields among a JSON channel's first messages.
    FirstMessages,
}

impl fmt::Display for Listing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MessageType(name) => name.fmt(f),
            Self::JsonSchema => f.write_str("its JSON schema"),
            Self::FirstMessages => {
                f.write_str("the one of its first messages with the most fields")
            }
        }
    }
}

/// What a field has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    Number,
    NumberList,
    Text,
    /// A list of numbers, or a message of coordinates.
    Vector,
    /// A number, or a message of seconds and nanoseconds.
    Time,
}

impl From<Shape> for Expected {
    fn from(shape: Shape) -> Self {
        match shape {
            Shape::Number => Self::Number,
            Shape::List => Self::NumberList,
            Shape::Text => Self::Text,
        }
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Number => "a number",
            Self::NumberList => "a list of numbers",
            Self::Text => "text",
            Self::Vector => "a list of numbers or a message with x, y, z",
            Self::Time => "a number or a message of seconds and nanoseconds",
        })
    }
}

impl SchemaError {
    /// Returns one error for all missing fields if both report missing fields; otherwise this one.
    pub fn and(mut self, other: Option<Self>) -> Self {
        if let (Self::NoSuchField { missing, .. }, Some(Self::NoSuchField { missing: more, .. })) =
            (&mut self, other)
        {
            missing.extend(more);
        }
        self
    }

    /// How many fields are missing or of the wrong type; `usize::MAX` if unknown.
    pub fn missing_fields(&self) -> usize {
        match self {
            Self::NoSuchField { missing, .. } => missing.len(),
            Self::NotThere { .. }
            | Self::OutOfRange { .. }
            | Self::WrongShape { .. }
            | Self::PlaceAndFilter { .. }
            | Self::Overlap { .. } => 1,
            _ => usize::MAX,
        }
    }

    /// Whether the fields of the messages cannot be known.
    pub fn is_opaque(&self) -> bool {
        matches!(
            self,
            Self::Encoding { .. }
                | Self::ProtobufSchema(_)
                | Self::UndefinedProtobufMessage { .. }
                | Self::JsonSchema(_)
                | Self::NotJson(_)
                | Self::RosDefinition(_)
                | Self::AfterWideText { .. }
        )
    }
}

/// Formats names in backquotes.
pub fn quote(fields: &[FieldPath]) -> String {
    let names: Vec<String> = fields.iter().map(|field| format!("`{field}`")).collect();
    names.join(", ")
}

/// Asks whether other fields were meant, if there are some with a name like that of a missing one.
fn meant(missing: &[FieldPath], available: &[Foreign]) -> String {
    let available = || available.iter().map(Foreign::as_str);
    let instead = |path: &FieldPath| -> Option<FieldPath> {
        let steps = path.steps();
        if let [PathStep::Name(name)] = steps {
            let name = *similar::names(name, available()).first()?;
            return Some(path.first(0).child(name));
        }
        // The fields are those of the message where the path ends, wherever that is.
        steps
            .iter()
            .enumerate()
            .find_map(|(depth, step)| match step {
                PathStep::Name(name) if !available().any(|available| available == name) => {
                    let name = similar::misspelt(name, available())?;
                    Some(path.first(depth).child(name))
                }
                _ => None,
            })
    };
    let mut meant: Vec<FieldPath> = missing.iter().filter_map(instead).collect();
    meant.dedup();
    match meant.is_empty() {
        true => String::new(),
        false => format!("did you mean {}? ", quote(&meant)),
    }
}

fn list(names: &[Foreign]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    // As paths have them.
    let names: Vec<Foreign> = names.iter().map(|name| written(name).into()).collect();
    let listed = text::join(&names[..names.len().min(LISTED)], ", ");
    match names.len().saturating_sub(LISTED) {
        0 => listed,
        more => format!("{listed} and {more} more"),
    }
}
