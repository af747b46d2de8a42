//! Numbers out of ROS messages: ROS 2's (CDR, with `ros2msg` definitions) and ROS 1's (`ros1` with `ros1msg`).
//!
//! Neither encoding names its fields: a value lies behind all those before it. So the wanted fields are resolved
//! against the channel's schema once, into a program that says what to step over and what to read; a message is
//! then read straight from its bytes, without building it, and only as far as the last wanted field. A message
//! that breaks off behind that field is read like a whole one.
//!
//! Definitions: <https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html> and
//! <https://wiki.ros.org/msg>; how MCAP joins several into one text:
//! <https://mcap.dev/spec/registry#ros2msg>.

mod definition;
mod layout;
mod message;
mod program;
mod wire;

use std::sync::Arc;

use super::{
    error::SchemaError,
    field::{FieldKind, Wanted},
    path::{FieldPath, PathStep},
    tree::{FieldTree, Key, tree},
    value::{Slots, Undecodable},
};
use layout::Length;
use message::{Element, Message, Type};
use program::{Op, Program};
use wire::{Cursor, Dialect};

/// A message type and those within it.
#[derive(Debug)]
pub struct Schema {
    dialect: Dialect,
    message: Arc<Message>,
}

/// Reads the wanted fields of one message type.
#[derive(Debug)]
pub struct Decoder {
    dialect: Dialect,
    program: Program,
}

impl Schema {
    /// Of ROS 2: a type's name, `pkg/msg/Type` or `pkg/Type`, and its `ros2msg` definition.
    pub fn ros2(name: &str, definition: &[u8]) -> Result<Self, SchemaError> {
        Self::new(Dialect::Ros2, name, definition)
    }

    /// Of ROS 1: a type's name, `pkg/Type`, and its `ros1msg` definition.
    pub fn ros1(name: &str, definition: &[u8]) -> Result<Self, SchemaError> {
        Self::new(Dialect::Ros1, name, definition)
    }

    fn new(dialect: Dialect, name: &str, definition: &[u8]) -> Result<Self, SchemaError> {
        let message = definition::parse(dialect, name, definition)?;
        Ok(Self { dialect, message })
    }

    /// What a path leads to.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        Ok(self.find(path)?.kind())
    }

    /// Resolves fields. The value of the n-th field goes to slot n.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<Decoder, SchemaError> {
        let mut leaves = Vec::new();
        for (slot, Wanted { path, shape }) in wanted.iter().enumerate() {
            let found = self.find(path)?;
            let read = Op::read(&found, shape, slot).ok_or_else(|| SchemaError::WrongShape {
                path: path.clone(),
                wanted: shape.describe(),
                kind: found.kind().describe(),
            })?;
            leaves.push((path, path.steps().iter().map(Key::from).collect(), read));
        }
        let fields = FieldTree::Message(tree(leaves)?);
        Ok(Decoder {
            dialect: self.dialect,
            program: Program::new(&self.message, fields, self.dialect)?,
        })
    }

    fn find(&self, path: &FieldPath) -> Result<Type, SchemaError> {
        let mut found = Type::from(Element::Message(Arc::clone(&self.message)));
        let mut through = String::new();
        for step in path.steps() {
            found = match (step, found.list, &found.element) {
                (PathStep::Name(name), None, Element::Message(message)) => {
                    let field = message.fields.iter().find(|field| field.name == *name);
                    let field = field.ok_or_else(|| SchemaError::NoSuchField {
                        lacking: vec![path.clone()],
                        place: message.name.clone(),
                        available: message.field_names(),
                    })?;
                    field.value.clone()
                }
                (&PathStep::Index(index), Some(Length::Fixed(length)), _) if index >= length => {
                    return Err(SchemaError::OutOfRange {
                        path: path.clone(),
                        length,
                    });
                }
                (PathStep::Index(_), Some(_), element) => Type::from(element.clone()),
                _ => {
                    return Err(SchemaError::NotThere {
                        path: path.clone(),
                        through,
                        kind: found.kind().describe(),
                    });
                }
            };
            through += &match step {
                PathStep::Name(name) if through.is_empty() => name.clone(),
                PathStep::Name(name) => format!(".{name}"),
                PathStep::Index(index) => format!("[{index}]"),
            };
        }
        Ok(found)
    }
}

impl Decoder {
    /// Reads a message's wanted fields into their slots, which must be cleared. An element that a list is too
    /// short to have leaves its slot empty.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        let mut cursor = Cursor::new(self.dialect, message)?;
        self.program.run(&mut cursor, &mut slots.values)
    }
}
