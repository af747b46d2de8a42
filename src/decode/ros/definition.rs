//! Message types out of the text of their definitions.

use std::{collections::HashMap, sync::Arc};

use re_ros_msg::{
    MessageSchema, is_schema_separator,
    message_spec::{ArraySize, BuiltInType, ComplexType, MessageSpecification, Type as SpecType},
};

use super::{
    layout::Length,
    message::{RosElement, RosField, RosMessage, RosType},
    wire::{Dialect, RosScalar},
};
use crate::decode::error::RosDefinitionError;

/// How many messages may lie within each other. Those of ROS's own packages are at most seven.
const MAX_HEIGHT: usize = 64;

/// What a definition may refer to without holding it.
const BUILT_IN_ROS2: &str = "
===
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
===
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
";
const BUILT_IN_ROS1: &str = "
===
MSG: time
uint32 sec
uint32 nsec
===
MSG: duration
int32 sec
int32 nsec
";

/// The message type of that name, from its definition and those that follow it.
pub fn parse(
    dialect: Dialect,
    name: &str,
    definition: &[u8],
) -> Result<Arc<RosMessage>, RosDefinitionError> {
    let text = String::from_utf8_lossy(definition);
    let built_in = match dialect {
        Dialect::Ros1 => BUILT_IN_ROS1,
        Dialect::Ros2 => BUILT_IN_ROS2,
    };
    let plain = without_values(&text)? + built_in;
    let schema =
        MessageSchema::parse(name, &plain).map_err(|error| unusable(format!("{error:#}")))?;
    let mut specs = HashMap::new();
    // Where a definition comes twice, the first one counts, and those of the text come before the built-in ones.
    for spec in schema.dependencies.into_iter().chain([schema.spec]) {
        specs.entry(full_name(&spec.name)).or_insert(spec);
    }
    let mut definitions = Definitions {
        dialect,
        specs: &specs,
        messages: HashMap::new(),
    };
    definitions.message(&full_name(name), 1)
}

/// A definition with nothing but types and names. Constants and default values are never sent, and some that
/// ROS allows, or that hostile logs hold, would be too much for the parser.
fn without_values(text: &str) -> Result<String, RosDefinitionError> {
    let mut plain = String::new();
    for (line, number) in text.trim_start_matches('\u{feff}').lines().zip(1..) {
        let code = line.split('#').next().unwrap_or_default().trim();
        if is_schema_separator(code) {
            plain += "===\n";
        } else if let Some(name) = code.strip_prefix("MSG:") {
            // The empty line stands in for a message's fields.
            plain += &format!("MSG: {}\n\n", name.trim());
        } else if let Some((type_name, rest)) = code.split_once(char::is_whitespace) {
            let rest = rest.trim_start();
            let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let (name, rest) = rest.split_at(rest.find(|c| !is_part(c)).unwrap_or(rest.len()));
            if name.is_empty() || !(rest.is_empty() || rest.starts_with([' ', '\t', '='])) {
                return Err(RosDefinitionError::NoField {
                    line: number,
                    text: code.to_owned(),
                });
            }
            if !rest.trim_start().starts_with('=') {
                plain += &format!("{type_name} {name}\n");
            }
        } else if !code.is_empty() {
            return Err(RosDefinitionError::NoField {
                line: number,
                text: code.to_owned(),
            });
        }
    }
    Ok(plain)
}

/// `pkg/msg/Type` is `pkg/Type`.
fn full_name(name: &str) -> String {
    match (name.split_once('/'), name.rsplit_once('/')) {
        (Some((package, _)), Some((_, message))) => format!("{package}/{message}"),
        _ => name.to_owned(),
    }
}

fn unusable(problem: String) -> RosDefinitionError {
    RosDefinitionError::Unparsed { problem }
}

struct Definitions<'a> {
    dialect: Dialect,
    specs: &'a HashMap<String, MessageSpecification>,
    /// What became of them so far.
    messages: HashMap<String, Arc<RosMessage>>,
}

impl Definitions<'_> {
    /// A message that lies within `depth` - 1 others.
    fn message(&mut self, name: &str, depth: usize) -> Result<Arc<RosMessage>, RosDefinitionError> {
        if let Some(message) = self.messages.get(name) {
            return Ok(Arc::clone(message));
        }
        let too_deep = || RosDefinitionError::TooDeep {
            name: name.to_owned(),
            limit: MAX_HEIGHT,
        };
        if depth > MAX_HEIGHT {
            return Err(too_deep());
        }
        let undefined = || RosDefinitionError::Undefined {
            name: name.to_owned(),
        };
        let spec = self.specs.get(name).ok_or_else(undefined)?;
        let mut fields = Vec::new();
        for field in &spec.fields {
            // The parser adds it to empty messages, as ROS 2 does on the wire.
            let is_padding = field.name == "structure_needs_at_least_one_member";
            if is_padding && self.dialect == Dialect::Ros1 {
                continue;
            }
            let (element, list) = match &field.ty {
                SpecType::Array { ty, size } => (&**ty, Some(length(size))),
                single => (single, None),
            };
            let element = match element {
                SpecType::BuiltIn(built_in) => self.built_in(built_in),
                SpecType::Complex(reference) => {
                    let name = self.resolve(name, reference);
                    RosElement::Message(self.message(&name, depth + 1)?)
                }
                SpecType::Array { .. } => return Err(unusable("a list holds lists".to_owned())),
            };
            fields.push(RosField {
                name: field.name.clone(),
                value: RosType { element, list },
            });
        }
        let message = Arc::new(RosMessage::new(name.to_owned(), fields, self.dialect));
        if message.height > MAX_HEIGHT {
            return Err(too_deep());
        }
        self.messages.insert(name.to_owned(), Arc::clone(&message));
        Ok(message)
    }

    /// The full name of a message that another message refers to.
    fn resolve(&self, within: &str, reference: &ComplexType) -> String {
        match reference {
            ComplexType::Absolute { package, name } => full_name(&format!("{package}/{name}")),
            ComplexType::Relative { name } if self.specs.contains_key(name) => name.clone(),
            ComplexType::Relative { name } => match within.split_once('/') {
                // <https://wiki.ros.org/msg>: "Header" is short for it in any package.
                _ if name == "Header" && self.dialect == Dialect::Ros1 => {
                    "std_msgs/Header".to_owned()
                }
                Some((package, _)) => format!("{package}/{name}"),
                None => name.clone(),
            },
        }
    }

    fn built_in(&self, built_in: &BuiltInType) -> RosElement {
        RosElement::Number(match (built_in, self.dialect) {
            (BuiltInType::String(_), _) => return RosElement::Text,
            (BuiltInType::WString(_), _) => return RosElement::WideText,
            (BuiltInType::Bool, _) => RosScalar::Bool,
            (BuiltInType::Byte, Dialect::Ros1) | (BuiltInType::Int8, _) => RosScalar::Int8,
            (BuiltInType::Byte | BuiltInType::Char | BuiltInType::UInt8, _) => RosScalar::Uint8,
            (BuiltInType::Int16, _) => RosScalar::Int16,
            (BuiltInType::Int32, _) => RosScalar::Int32,
            (BuiltInType::Int64, _) => RosScalar::Int64,
            (BuiltInType::UInt16, _) => RosScalar::Uint16,
            (BuiltInType::UInt32, _) => RosScalar::Uint32,
            (BuiltInType::UInt64, _) => RosScalar::Uint64,
            (BuiltInType::Float32, _) => RosScalar::Float32,
            (BuiltInType::Float64, _) => RosScalar::Float64,
        })
    }
}

/// A bounded list is written like one without bound.
fn length(size: &ArraySize) -> Length {
    match size {
        ArraySize::Fixed(length) => Length::Fixed(*length),
        ArraySize::Bounded(_) | ArraySize::Unbounded => Length::Sent,
    }
}
