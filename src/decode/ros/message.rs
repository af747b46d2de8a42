//! Message types, as their definitions say.

use std::sync::Arc;

use super::{
    layout::{Extent, Length, Skip},
    wire::{Dialect, Scalar},
};
use crate::decode::field::FieldKind;

/// A message type.
#[derive(Debug)]
pub struct Message {
    /// As definitions refer to it: `pkg/Type`.
    pub name: String,
    /// In the order in which they are sent.
    pub fields: Vec<Field>,
    /// How to step over one; `None` where it has a wide text.
    pub extent: Option<Extent>,
    /// How many messages there are within each other, this one included.
    pub height: usize,
}

/// A field of a message.
#[derive(Debug)]
pub struct Field {
    pub name: String,
    pub value: Type,
}

/// What a field holds: one element or a list.
#[derive(Debug, Clone)]
pub struct Type {
    pub element: Element,
    pub list: Option<Length>,
}

#[derive(Debug, Clone)]
pub enum Element {
    Number(Scalar),
    Text,
    /// ROS 2's `wstring`. What of it is sent is told differently by the standard and by each implementation,
    /// two or four bytes a character (<https://github.com/ros2/rmw_cyclonedds/issues/43>), so it cannot be
    /// read, nor can what lies behind it.
    WideText,
    Message(Arc<Message>),
}

impl Message {
    pub fn new(name: String, fields: Vec<Field>, dialect: Dialect) -> Self {
        let mut skips = Some(Vec::new());
        let mut height = 1;
        for field in &fields {
            match (field.value.skip(dialect), &mut skips) {
                (Some(skip), Some(skips)) => skip.append_to(skips),
                _ => skips = None,
            }
            if let Element::Message(inner) = &field.value.element {
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

    pub fn field_names(&self) -> Vec<String> {
        self.fields.iter().map(|field| field.name.clone()).collect()
    }
}

impl From<Element> for Type {
    fn from(element: Element) -> Self {
        Self {
            element,
            list: None,
        }
    }
}

impl Type {
    pub fn kind(&self) -> FieldKind {
        match (&self.element, self.list) {
            (Element::Number(_), None) => FieldKind::Number,
            (Element::Number(_), Some(_)) => FieldKind::List,
            (Element::Text, None) => FieldKind::Text,
            (Element::WideText, None) => FieldKind::Other("text of wide characters"),
            (Element::Text | Element::WideText, Some(_)) => FieldKind::Other("a list of texts"),
            (Element::Message(message), None) => FieldKind::Message(message.field_names()),
            (Element::Message(_), Some(_)) => FieldKind::Other("a list of messages"),
        }
    }

    /// How to step over a value; `None` where it may have a wide text.
    pub fn skip(&self, dialect: Dialect) -> Option<Skip> {
        let length = self.list.unwrap_or(Length::Fixed(1));
        Some(Skip::elements(length, self.element.extent(dialect)?))
    }
}

impl Element {
    pub fn extent(&self, dialect: Dialect) -> Option<Extent> {
        let bytes = |size| Extent::from([Skip::Fixed(dialect.layout(size))]);
        match self {
            Self::Number(scalar) => Some(bytes(scalar.size())),
            Self::Text => Some(Extent::from([Skip::elements(Length::Sent, bytes(1))])),
            Self::WideText => None,
            Self::Message(message) => message.extent.clone(),
        }
    }
}
