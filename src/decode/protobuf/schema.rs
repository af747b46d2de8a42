//! What a protobuf schema says about a channel's messages.

use prost_reflect::{DescriptorPool, FieldDescriptor, Kind, MessageDescriptor};

use super::decoder::{ProtobufDecoder, ProtobufLeaf};
use crate::decode::{
    error::{Listing, SchemaError},
    field::{FieldKind, Wanted},
    path::FieldPath,
    resolve::{Node, resolve},
    tree::tree,
    value::Slots,
};

/// A message type and the types that it is made of.
#[derive(Debug)]
pub struct ProtobufSchema {
    message: MessageDescriptor,
}

impl ProtobufSchema {
    /// Finds a message type by its full name in a serialised `FileDescriptorSet`.
    pub fn new(name: &str, descriptors: &[u8]) -> Result<Self, SchemaError> {
        let pool = DescriptorPool::decode(descriptors).map_err(SchemaError::ProtobufSchema)?;
        let message = pool.get_message_by_name(name);
        let undefined = || SchemaError::UndefinedProtobufMessage { name: name.into() };
        Ok(Self {
            message: message.ok_or_else(undefined)?,
        })
    }

    /// What a path leads to.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        Ok(resolve(self.root(), path)?.node.kind())
    }

    /// Makes a decoder that puts the n-th wanted field into slot n.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<(ProtobufDecoder, Slots), SchemaError> {
        let (fields, slots) = tree(&self.root(), wanted, |node, shape, slot| match node {
            ProtobufNode::Message(_) => None,
            ProtobufNode::Field(field) | ProtobufNode::Element(field) => {
                ProtobufLeaf::new(field, shape, slot)
            }
        })?;
        Ok((ProtobufDecoder::new(self.message.clone(), fields), slots))
    }

    fn root(&self) -> ProtobufNode {
        ProtobufNode::Message(self.message.clone())
    }
}

#[derive(Debug, Clone)]
enum ProtobufNode {
    /// The whole message.
    Message(MessageDescriptor),
    /// A field, which may be a list.
    Field(FieldDescriptor),
    /// An element of a field that is a list.
    Element(FieldDescriptor),
}

impl ProtobufNode {
    /// The message type, if this is a message.
    fn message(&self) -> Option<MessageDescriptor> {
        match self {
            Self::Message(message) => Some(message.clone()),
            Self::Field(field) if field.is_list() || field.is_map() => None,
            Self::Field(field) | Self::Element(field) => field.kind().as_message().cloned(),
        }
    }
}

impl Node for ProtobufNode {
    /// The field's number.
    type Name = u32;

    fn kind(&self) -> FieldKind {
        let (field, is_list) = match self {
            Self::Message(message) => return FieldKind::Message(names(message)),
            Self::Field(field) => (field, field.is_list()),
            Self::Element(field) => (field, false),
        };
        match (field.kind(), is_list) {
            _ if field.is_map() => FieldKind::Map,
            (Kind::Message(_), true) => FieldKind::MessageList,
            (Kind::Message(inner), false) => FieldKind::Message(names(&inner)),
            (Kind::String, true) => FieldKind::TextList,
            (Kind::String, false) => FieldKind::Text,
            (Kind::Bytes, true) => FieldKind::BytesList,
            (Kind::Bytes, false) => FieldKind::Bytes,
            (_, true) => FieldKind::List,
            (_, false) => FieldKind::Number,
        }
    }

    fn fields(&self) -> Option<(Listing, Vec<String>)> {
        let message = self.message()?;
        let listing = Listing::MessageType(message.full_name().into());
        Some((listing, names(&message)))
    }

    fn field(&self, name: &str) -> Option<(u32, Self)> {
        let field = self.message()?.get_field_by_name(name)?;
        Some((field.number(), Self::Field(field)))
    }

    fn element(&self, _: usize) -> Option<Self> {
        match self {
            Self::Field(field) if field.is_list() => Some(Self::Element(field.clone())),
            _ => None,
        }
    }
}

fn names(message: &MessageDescriptor) -> Vec<String> {
    let fields = message.fields();
    fields.map(|field| field.name().to_owned()).collect()
}
