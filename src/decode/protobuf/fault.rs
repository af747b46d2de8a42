//! What is wrong with a protobuf message that cannot be decoded.

use prost::encoding::{DecodeContext, WireType, decode_key, skip_field};
use prost_reflect::MessageDescriptor;

use super::decoder::{ProtobufTree, read_field, take_delimited};
use crate::decode::{
    fault::Fault,
    path::{FieldPath, PathStep},
    tree::FieldTree,
    value::Slots,
};

/// Finds what is wrong, in the way in which messages are decoded.
pub struct Finder<'a> {
    /// The whole message.
    message: &'a [u8],
    slots: &'a mut Slots,
    /// The field in which the search is.
    place: Vec<PathStep>,
}

impl<'a> Finder<'a> {
    pub fn new(message: &'a [u8], slots: &'a mut Slots) -> Self {
        Self {
            message,
            slots,
            place: Vec::new(),
        }
    }

    /// What is wrong in a message of this type, which is all or a part of the whole message.
    pub fn find(
        &mut self,
        descriptor: &MessageDescriptor,
        fields: &[(u32, ProtobufTree)],
        mut bytes: &'a [u8],
    ) -> Option<Fault> {
        while !bytes.is_empty() {
            let offset = self.offset_of(bytes);
            let Ok((number, wire_type)) = decode_key(&mut bytes) else {
                return Some(self.no_field(offset));
            };
            let Some((_, node)) = fields.iter().find(|(wanted, _)| *wanted == number) else {
                if skip_field(wire_type, number, &mut bytes, DecodeContext::default()).is_err() {
                    return Some(self.no_field(offset));
                }
                continue;
            };
            let field = descriptor.get_field(number)?;
            self.place.push(PathStep::Name(field.name().to_owned()));
            let content = bytes;
            if read_field(node, wire_type, &mut bytes, self.slots).is_err() {
                return Some(match (node, field.kind().as_message(), wire_type) {
                    (FieldTree::Message(inner), Some(descriptor), WireType::LengthDelimited) => {
                        match take_delimited(&mut { content }) {
                            Ok(part) => self.find(descriptor, inner, part)?,
                            Err(_) => self.ends_early()?,
                        }
                    }
                    _ => self.in_value(wire_type, content, offset)?,
                });
            }
            self.place.pop();
        }
        None
    }

    /// What is wrong in a value that cannot be read as its type.
    fn in_value(&self, wire_type: WireType, mut content: &[u8], offset: usize) -> Option<Fault> {
        match skip_field(wire_type, 1, &mut content, DecodeContext::default()) {
            Ok(()) => Some(Fault::OtherType {
                field: self.field()?,
                offset,
            }),
            Err(_) => self.ends_early(),
        }
    }

    fn ends_early(&self) -> Option<Fault> {
        Some(Fault::EndsEarly {
            field: self.field()?,
            length: self.message.len(),
        })
    }

    fn no_field(&self, offset: usize) -> Fault {
        Fault::NoField {
            offset,
            length: self.message.len(),
        }
    }

    fn field(&self) -> Option<FieldPath> {
        FieldPath::of_steps(self.place.clone())
    }

    /// Where a part of the message that reaches to the end of it, or of a message within it, begins.
    fn offset_of(&self, part: &[u8]) -> usize {
        part.as_ptr().addr() - self.message.as_ptr().addr()
    }
}
