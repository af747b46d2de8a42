//! Fields of messages: what is wanted of them, and what a schema says that they are.

use std::fmt;

use super::path::FieldPath;

/// A field that is wanted of every message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    pub path: FieldPath,
    pub shape: Shape,
}

/// What a field is wanted as.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Shape {
    /// One number. A truth value counts as 0 or 1.
    Number,
    /// A list of numbers.
    List,
    /// Text, as its place among these words; the place of any other word is after the last.
    Word(Vec<String>),
}

/// What a schema says that a path leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FieldKind {
    /// A number or a truth value.
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
    /// Whatever a message holds: the schema does not say.
    Unknown,
}

impl FieldKind {
    /// Whether a field of this kind can be read as what is wanted.
    pub fn is_a(&self, shape: &Shape) -> bool {
        matches!(
            (self, shape),
            (Self::Number, Shape::Number)
                | (Self::List, Shape::List)
                | (Self::Text, Shape::Word(_))
                | (Self::Unknown, _)
        )
    }
}

impl fmt::Display for FieldKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Number => "a single number",
            Self::Text => "text",
            Self::WideText => "text of wide characters",
            Self::Bytes => "a string of bytes",
            Self::Map => "a map",
            Self::List => "a list",
            Self::TextList => "a list of texts",
            Self::BytesList => "a list of strings of bytes",
            Self::MessageList => "a list of messages",
            Self::Message(_) => "a message",
            Self::Unknown => "of no known kind",
        })
    }
}
