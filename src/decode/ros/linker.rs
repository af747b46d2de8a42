//! Definitions → message types, in which every reference to another type is that type.

use std::{collections::HashMap, sync::Arc};

use super::{
    definition::{self, FieldDefinition},
    message::{RosElement, RosField, RosMessage, RosType},
    wire::{Dialect, RosScalar},
};
use crate::decode::error::RosDefinitionError;

/// Maximum nesting depth; ROS's own packages reach seven.
const MAX_HEIGHT: usize = 64;

/// What a definition may refer to without defining it.
const BUILT_IN_ROS2: &str = "\
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
===
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
";
const BUILT_IN_ROS1: &str = "\
MSG: time
uint32 sec
uint32 nsec
===
MSG: duration
int32 sec
int32 nsec
";

/// Links the message type with this name from the text of its definition.
pub fn link(
    dialect: Dialect,
    name: &str,
    text: &str,
) -> Result<Arc<RosMessage>, RosDefinitionError> {
    let written = definition::parse(text)?;
    let built_in = definition::parse(match dialect {
        Dialect::Ros1 => BUILT_IN_ROS1,
        Dialect::Ros2 => BUILT_IN_ROS2,
    })?;
    let named = written.iter().chain(&built_in);
    let named = named.filter_map(|definition| Some((definition.name?, definition)));
    let own = written.first().filter(|own| own.name.is_none());
    let mut definitions: HashMap<String, &[FieldDefinition]> = HashMap::new();
    // If a name is defined twice, the first wins. The text's own type comes last: some texts define it by name too, and
    // begin with nothing.
    for (name, definition) in named.chain(own.map(|own| (name, own))) {
        let definition = definition.fields.as_slice();
        definitions.entry(full_name(name)).or_insert(definition);
    }
    let mut linker = Linker {
        dialect,
        definitions,
        messages: HashMap::new(),
    };
    linker.message(&full_name(name), 1)
}

/// Shortens `pkg/msg/Type` to `pkg/Type`.
fn full_name(name: &str) -> String {
    match (name.split_once('/'), name.rsplit_once('/')) {
        (Some((package, _)), Some((_, message))) => format!("{package}/{message}"),
        _ => name.to_owned(),
    }
}

struct Linker<'a> {
    dialect: Dialect,
    definitions: HashMap<String, &'a [FieldDefinition<'a>]>,
    /// The messages linked so far; `None` while what one refers to is being linked.
    messages: HashMap<String, Option<Arc<RosMessage>>>,
}

impl Linker<'_> {
    /// Links a message that is nested in `depth` - 1 others.
    fn message(&mut self, name: &str, depth: usize) -> Result<Arc<RosMessage>, RosDefinitionError> {
        let owned = || name.to_owned();
        match self.messages.get(name) {
            Some(Some(message)) => return Ok(Arc::clone(message)),
            Some(None) => return Err(RosDefinitionError::Recursive { name: name.into() }),
            None => {}
        }
        let too_deep = || RosDefinitionError::TooDeep {
            name: name.into(),
            limit: MAX_HEIGHT,
        };
        if depth > MAX_HEIGHT {
            return Err(too_deep());
        }
        let undefined = || RosDefinitionError::Undefined { name: name.into() };
        let definition = *self.definitions.get(name).ok_or_else(undefined)?;
        self.messages.insert(owned(), None);
        let mut fields = Vec::new();
        for field in definition {
            fields.push(self.field(field, name, depth)?);
        }
        if fields.is_empty() && self.dialect == Dialect::Ros2 {
            fields.push(padding());
        }
        let message = Arc::new(RosMessage::new(owned(), fields, self.dialect));
        // The depth does not count the nesting within messages that were linked before.
        if message.height > MAX_HEIGHT {
            return Err(too_deep());
        }
        self.messages.insert(owned(), Some(Arc::clone(&message)));
        Ok(message)
    }

    /// Links a field of the message with this name, which is nested in `depth` - 1 others.
    fn field(
        &mut self,
        field: &FieldDefinition,
        within: &str,
        depth: usize,
    ) -> Result<RosField, RosDefinitionError> {
        let element = match built_in(field.base, self.dialect) {
            Some(element) => element,
            None => {
                let name = self.resolve(within, field.base);
                RosElement::Message(self.message(&name, depth + 1)?)
            }
        };
        Ok(RosField {
            name: field.name.to_owned(),
            value: RosType {
                element,
                list: field.list,
            },
        })
    }

    /// The full name of a message that another message refers to.
    fn resolve(&self, within: &str, reference: &str) -> String {
        if reference.contains('/') {
            return full_name(reference);
        }
        match within.split_once('/') {
            _ if self.definitions.contains_key(reference) => reference.to_owned(),
            // <https://wiki.ros.org/msg>: "Header" is short for `std_msgs/Header` in any package.
            _ if reference == "Header" && self.dialect == Dialect::Ros1 => {
                "std_msgs/Header".to_owned()
            }
            Some((package, _)) => format!("{package}/{reference}"),
            None => reference.to_owned(),
        }
    }
}

/// What ROS 2 sends for a message without fields, since C has no empty structs.
fn padding() -> RosField {
    RosField {
        name: "structure_needs_at_least_one_member".to_owned(),
        value: RosElement::Number(RosScalar::Uint8).into(),
    }
}

/// The type with this name, if it is not a message.
fn built_in(name: &str, dialect: Dialect) -> Option<RosElement> {
    Some(RosElement::Number(match (name, dialect) {
        ("string", _) => return Some(RosElement::Text),
        ("wstring", _) => return Some(RosElement::WideText),
        ("bool", _) => RosScalar::Bool,
        ("byte", Dialect::Ros1) | ("int8", _) => RosScalar::Int8,
        ("byte" | "char" | "uint8", _) => RosScalar::Uint8,
        ("int16", _) => RosScalar::Int16,
        ("int32", _) => RosScalar::Int32,
        ("int64", _) => RosScalar::Int64,
        ("uint16", _) => RosScalar::Uint16,
        ("uint32", _) => RosScalar::Uint32,
        ("uint64", _) => RosScalar::Uint64,
        ("float32", _) => RosScalar::Float32,
        ("float64", _) => RosScalar::Float64,
        _ => return None,
    }))
}
