//! Fields of messages: what is wanted of them, and what a schema says that they are.

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
    /// Text, as its place among these words; another word's place is behind the last.
    Word(Vec<String>),
}

impl Shape {
    /// As a complaint names it.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::List => "a list of numbers",
            Self::Word(_) => "text",
        }
    }
}

/// What a schema says that a path leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FieldKind {
    /// A number or a truth value.
    Number,
    /// Text.
    Text,
    /// A list of numbers.
    List,
    /// A message with these fields.
    Message(Vec<String>),
    /// Something else, as a complaint names it.
    Other(&'static str),
    /// Whatever a message holds: the schema does not say.
    Unknown,
}

impl FieldKind {
    /// As a complaint names it.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Number => "a single number",
            Self::Text => "text",
            Self::List => "a list",
            Self::Message(_) => "a message",
            Self::Other(what) => what,
            Self::Unknown => "of no known kind",
        }
    }

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
