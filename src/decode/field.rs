//! Fields of messages: what is wanted of them, and what the schema says they are.

use std::fmt;

use super::path::FieldPath;

/// A field that is read from every message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    pub path: FieldPath,
    pub shape: Shape,
}

/// The form in which a field is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// One number. A boolean counts as 0 or 1.
    Number,
    /// A list of numbers.
    List,
    /// Text.
    Text,
}

/// What a path leads to, according to the schema.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FieldKind {
    /// A number or a boolean.
    Number,
    Text,
    /// ROS 2's `wstring`.
    WideText,
    Bytes,
    Map,
    /// A list of numbers.
    List,
    TextList,
    BytesList,
    MessageList,
    /// A message with these fields.
    Message(Vec<String>),
    /// Anything a message may contain: the schema does not say.
    Unknown,
}

impl FieldKind {
    /// Whether a field of this kind can be read in the wanted form.
    pub fn is_a(&self, shape: Shape) -> bool {
        matches!(
            (self, shape),
            (Self::Number, Shape::Number)
                | (Self::List, Shape::List)
                | (Self::Text, Shape::Text)
                | (Self::Unknown, _)
        )
    }
}

impl fmt::Display for FieldKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Number => "a single number",
            Self::Text => "text",
            Self::WideText => "a wide string",
            Self::Bytes => "bytes",
            Self::Map => "a map",
            Self::List => "a list",
            Self::TextList => "a list of strings",
            Self::BytesList => "a list of byte strings",
            Self::MessageList => "a list of messages",
            Self::Message(_) => "a message",
            Self::Unknown => "of unknown type",
        })
    }
}
