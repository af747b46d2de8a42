//! Message types and what they are made of.

use std::sync::Arc;

use super::{
    layout::{Extent, Length, Skip},
    wire::{Dialect, RosScalar},
};
use crate::decode::{error::Listing, field::FieldKind, resolve::Node};

/// A message type.
#[derive(Debug)]
pub struct RosMessage {
    /// The name by which definitions refer to it: `pkg/Type`.
    pub name: String,
    /// Its fields, in the order in which they are sent.
    pub fields: Vec<RosField>,
    /// How to skip one; `None` if it contains a wide string.
    pub extent: Option<Extent>,
    /// How many messages are nested within each other, including this one.
    pub height: usize,
}

/// A field of a message.
#[derive(Debug)]
pub struct RosField {
    pub name: String,
    pub value: RosType,
}

/// What a field holds: one element or a list.
#[derive(Debug, Clone)]
pub struct RosType {
    pub element: RosElement,
    pub list: Option<Length>,
}

#[derive(Debug, Clone)]
pub enum RosElement {
    Number(RosScalar),
    Text,
    /// ROS 2's `wstring`. The standard and the implementations disagree on whether a character is sent as two or four
    /// bytes (<https://github.com/ros2/rmw_cyclonedds/issues/43>), so neither it nor what comes after it can be read.
    WideText,
    Message(Arc<RosMessage>),
}

impl RosMessage {
    pub fn new(name: String, fields: Vec<RosField>, dialect: Dialect) -> Self {
        let mut skips = Some(Vec::new());
        let mut height = 1;
        for field in &fields {
            match (field.value.skip(dialect), &mut skips) {
                (Some(skip), Some(skips)) => skip.append_to(skips),
                _ => skips = None,
            }
            if let RosElement::Message(inner) = &field.value.element {
                height = height.max(inner.height + 1);
            }
        }
        Self {
            name,
            fields,
            extent: skips.map(Extent::from),
            height,
        }
    }

    fn field_names(&self) -> Vec<String> {
        self.fields.iter().map(|field| field.name.clone()).collect()
    }
}

impl From<RosElement> for RosType {
    fn from(element: RosElement) -> Self {
        Self {
            element,
            list: None,
        }
    }
}

impl RosType {
    /// The message type, if this is a single message.
    fn message(&self) -> Option<&RosMessage> {
        match (&self.element, self.list) {
            (RosElement::Message(message), None) => Some(message),
            _ => None,
        }
    }

    /// How to skip a value; `None` if it may contain a wide string.
    pub fn skip(&self, dialect: Dialect) -> Option<Skip> {
        let length = self.list.unwrap_or(Length::Fixed(1));
        Some(Skip::elements(length, self.element.extent(dialect)?))
    }
}

impl Node for RosType {
    /// The field's place in its message.
    type Name = usize;

    fn kind(&self) -> FieldKind {
        match (&self.element, self.list) {
            (RosElement::Number(_), None) => FieldKind::Number,
            (RosElement::Number(_), Some(_)) => FieldKind::List,
            (RosElement::Text, None) => FieldKind::Text,
            (RosElement::WideText, None) => FieldKind::WideText,
            (RosElement::Text | RosElement::WideText, Some(_)) => FieldKind::TextList,
            (RosElement::Message(message), None) => FieldKind::Message(message.field_names()),
            (RosElement::Message(_), Some(_)) => FieldKind::MessageList,
        }
    }

    fn fields(&self) -> Option<(Listing, Vec<String>)> {
        let message = self.message()?;
        let listing = Listing::MessageType((&message.name).into());
        Some((listing, message.field_names()))
    }

    fn field(&self, name: &str) -> Option<(usize, Self)> {
        let fields = &self.message()?.fields;
        let place = fields.iter().position(|field| field.name == name)?;
        Some((place, fields[place].value.clone()))
    }

    fn element(&self, index: usize) -> Option<Self> {
        match self.list? {
            Length::Fixed(length) if index >= length => None,
            _ => Some(self.element.clone().into()),
        }
    }

    fn length(&self) -> Option<usize> {
        match self.list? {
            Length::Fixed(length) => Some(length),
            Length::Sent => None,
        }
    }
}

impl RosElement {
    pub fn extent(&self, dialect: Dialect) -> Option<Extent> {
        let bytes = |size| Extent::from([Skip::Fixed(dialect.padded_size(size))]);
        match self {
            Self::Number(scalar) => Some(bytes(scalar.size())),
            Self::Text => Some(Extent::from([Skip::elements(Length::Sent, bytes(1))])),
            Self::WideText => None,
            Self::Message(message) => message.extent.clone(),
        }
    }
}
