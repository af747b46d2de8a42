//! ROS messages: ROS 2's (CDR, with `ros2msg` definitions) and ROS 1's (`ros1` with `ros1msg`).
//!
//! Neither encoding names its fields: a value comes after all those before it. So the wanted fields are resolved
//! against the channel's schema once, into a program that says what to step over and what to read. A message is then
//! read straight from its bytes, without building it, and only as far as the last wanted field. A message that breaks
//! off after that field is read like a whole one.
//!
//! text → [`definition`] → [`linker`] → [`message`] types, whose values' sizes are in [`layout`] → [`decoder`], which
//! runs over the bytes in [`wire`].
//!
//! Definitions: <https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html> and
//! <https://wiki.ros.org/msg>; how MCAP joins several into one text:
//! <https://mcap.dev/spec/registry#ros2msg>.

mod decoder;
mod definition;
mod layout;
mod linker;
mod message;
mod wire;

use std::sync::Arc;

use super::{
    error::SchemaError,
    fault::Fault,
    field::{FieldKind, Wanted},
    path::FieldPath,
    resolve::{Node, resolve},
    tree::{FieldTree, tree},
    value::{Slots, Undecodable},
};
use decoder::{Op, Program};
use message::{RosElement, RosMessage, RosType};
use wire::Cursor;

pub use wire::Dialect;

/// A message type and those within it.
#[derive(Debug)]
pub struct RosSchema {
    dialect: Dialect,
    message: Arc<RosMessage>,
}

/// Reads the wanted fields of one message type.
#[derive(Debug)]
pub struct RosDecoder {
    dialect: Dialect,
    program: Program,
    /// The wanted fields, in the order of their slots.
    fields: Vec<FieldPath>,
}

impl RosSchema {
    /// Reads the definition of a type whose name is `pkg/Type` or `pkg/msg/Type`.
    pub fn new(dialect: Dialect, name: &str, definition: &[u8]) -> Result<Self, SchemaError> {
        let text = String::from_utf8_lossy(definition);
        let message = linker::link(dialect, name, &text)?;
        Ok(Self { dialect, message })
    }

    /// What a path leads to.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        Ok(resolve(self.root(), path)?.node.kind())
    }

    /// Makes a decoder that puts the n-th wanted field into slot n.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<(RosDecoder, Slots), SchemaError> {
        let root = self.root();
        let (fields, slots) = tree(&root, wanted, Op::read)?;
        let fields = FieldTree::Message(fields);
        let decoder = RosDecoder {
            dialect: self.dialect,
            program: Program::new(&root, fields, self.dialect)?,
            fields: wanted.iter().map(|field| field.path.clone()).collect(),
        };
        Ok((decoder, slots))
    }

    fn root(&self) -> RosType {
        RosElement::Message(Arc::clone(&self.message)).into()
    }
}

impl RosDecoder {
    /// Reads a message's wanted fields into their slots, which must be cleared. If a list is too short to contain a
    /// wanted element, its slot stays empty.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        let mut cursor = Cursor::new(self.dialect, message)?;
        self.program.run(&mut cursor, slots)
    }

    /// What is wrong with a message that cannot be decoded.
    pub fn explain(&self, message: &[u8], slots: &mut Slots) -> Option<Fault> {
        let length = message.len();
        let mut cursor = match Cursor::new(self.dialect, message) {
            Ok(cursor) => cursor,
            Err(Undecodable::Xcdr2) => return Some(Fault::Xcdr2),
            Err(Undecodable::ParameterList) => return Some(Fault::ParameterList),
            Err(Undecodable::Malformed) => {
                return Some(match message {
                    &[high, low, _, _, ..] => Fault::Encapsulation([high, low]),
                    _ => Fault::NoEncapsulation { length },
                });
            }
        };
        let slot = self.program.first_unreadable(&mut cursor, slots)?;
        Some(Fault::EndsEarly {
            field: self.fields.get(slot)?.clone(),
            length,
        })
    }
}
