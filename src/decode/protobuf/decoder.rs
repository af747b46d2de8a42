//! Reading numbers and text from protobuf messages.

use prost::{
    bytes::Buf,
    encoding::{DecodeContext, WireType, decode_key, decode_varint, skip_field},
};
use prost_reflect::{FieldDescriptor, Kind, MessageDescriptor};

use super::fault::Finder;
use crate::decode::{
    fault::Fault,
    field::Shape,
    tree::{Branches, FieldTree},
    value::{FieldValue, Number, Slots, Undecodable},
};

/// Reads the wanted fields of one message type.
#[derive(Debug)]
pub struct ProtobufDecoder {
    message: MessageDescriptor,
    fields: Branches<u32, ProtobufLeaf>,
}

pub type ProtobufTree = FieldTree<u32, ProtobufLeaf>;

/// How a wanted field is read.
#[derive(Debug)]
pub struct ProtobufLeaf {
    slot: usize,
    content: LeafContent,
    is_list: bool,
    /// Whether the field can be absent, as opposed to having its default value.
    has_presence: bool,
}

#[derive(Debug)]
enum LeafContent {
    Scalar(ProtobufScalar),
    Text,
}

/// How a number is encoded.
#[derive(Debug, Clone, Copy)]
enum ProtobufScalar {
    Double,
    Float,
    Int32,
    Int64,
    Uint32,
    Uint64,
    Sint32,
    Sint64,
    Fixed32,
    Fixed64,
    Sfixed32,
    Sfixed64,
    Bool,
}

impl ProtobufDecoder {
    pub fn new(message: MessageDescriptor, fields: Branches<u32, ProtobufLeaf>) -> Self {
        Self { message, fields }
    }

    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        read_message(&self.fields, message, slots)
    }

    /// What is wrong with a message that cannot be decoded.
    pub fn explain(&self, message: &[u8], slots: &mut Slots) -> Option<Fault> {
        Finder::new(message, slots).find(&self.message, &self.fields, message)
    }
}

impl ProtobufLeaf {
    /// Reads a field or an element of it; `None` if numbers are wanted and it does not contain numbers.
    pub fn new(field: &FieldDescriptor, shape: Shape, slot: usize) -> Option<Self> {
        Some(Self {
            slot,
            content: match shape {
                Shape::Text => LeafContent::Text,
                Shape::Number | Shape::List => LeafContent::Scalar(ProtobufScalar::of(field)?),
            },
            is_list: shape == Shape::List,
            has_presence: field.supports_presence(),
        })
    }

    /// Reads a value that is not a list.
    fn read_one(
        &self,
        wire_type: WireType,
        bytes: &mut &[u8],
        slot: &mut FieldValue,
    ) -> Result<(), Undecodable> {
        match &self.content {
            LeafContent::Text if wire_type == WireType::LengthDelimited => {
                slot.set_text(take_delimited(bytes)?);
            }
            LeafContent::Scalar(scalar) if wire_type == scalar.wire_type() => {
                let number = scalar.read(bytes)?;
                match self.is_list {
                    true => slot.push(number),
                    false => slot.set(number),
                }
            }
            _ => return Err(Undecodable::Malformed),
        }
        Ok(())
    }

    fn scalar(&self) -> Option<ProtobufScalar> {
        match self.content {
            LeafContent::Scalar(scalar) => Some(scalar),
            LeafContent::Text => None,
        }
    }

    /// Sets the value that the field has if a message does not mention it.
    fn set_default(&self, slot: &mut FieldValue) {
        match &self.content {
            // A message may come in parts; later parts add to earlier ones.
            _ if slot.is_present() || self.has_presence => {}
            LeafContent::Scalar(_) if self.is_list => slot.set_empty_list(),
            LeafContent::Scalar(_) => slot.set(0.0),
            LeafContent::Text => slot.set_text(b""),
        }
    }
}

impl ProtobufScalar {
    fn of(field: &FieldDescriptor) -> Option<Self> {
        Some(match field.kind() {
            Kind::Double => Self::Double,
            Kind::Float => Self::Float,
            Kind::Int32 | Kind::Enum(_) => Self::Int32,
            Kind::Int64 => Self::Int64,
            Kind::Uint32 => Self::Uint32,
            Kind::Uint64 => Self::Uint64,
            Kind::Sint32 => Self::Sint32,
            Kind::Sint64 => Self::Sint64,
            Kind::Fixed32 => Self::Fixed32,
            Kind::Fixed64 => Self::Fixed64,
            Kind::Sfixed32 => Self::Sfixed32,
            Kind::Sfixed64 => Self::Sfixed64,
            Kind::Bool => Self::Bool,
            Kind::String | Kind::Bytes | Kind::Message(_) => return None,
        })
    }

    fn wire_type(self) -> WireType {
        match self {
            Self::Double | Self::Fixed64 | Self::Sfixed64 => WireType::SixtyFourBit,
            Self::Float | Self::Fixed32 | Self::Sfixed32 => WireType::ThirtyTwoBit,
            _ => WireType::Varint,
        }
    }

    fn read(self, bytes: &mut &[u8]) -> Result<Number, Undecodable> {
        let needed = match self.wire_type() {
            WireType::SixtyFourBit => 8,
            WireType::ThirtyTwoBit => 4,
            _ => 0,
        };
        if bytes.remaining() < needed {
            return Err(Undecodable::Malformed);
        }
        Ok(match self {
            Self::Double => bytes.get_f64_le().into(),
            Self::Float => f64::from(bytes.get_f32_le()).into(),
            Self::Fixed32 => u64::from(bytes.get_u32_le()).into(),
            Self::Fixed64 => bytes.get_u64_le().into(),
            Self::Sfixed32 => i64::from(bytes.get_i32_le()).into(),
            Self::Sfixed64 => bytes.get_i64_le().into(),
            // Negative 32-bit numbers are encoded as 64-bit ones.
            Self::Int32 => i64::from(decode_varint(bytes)? as i32).into(),
            Self::Int64 => (decode_varint(bytes)? as i64).into(),
            Self::Uint32 => u64::from(decode_varint(bytes)? as u32).into(),
            Self::Uint64 => decode_varint(bytes)?.into(),
            Self::Sint32 | Self::Sint64 => {
                let zigzag = decode_varint(bytes)?;
                ((zigzag >> 1) as i64 ^ -((zigzag & 1) as i64)).into()
            }
            Self::Bool => (decode_varint(bytes)? != 0).into(),
        })
    }
}

impl From<prost::DecodeError> for Undecodable {
    fn from(_: prost::DecodeError) -> Self {
        Self::Malformed
    }
}

fn read_message(
    fields: &[(u32, ProtobufTree)],
    mut bytes: &[u8],
    slots: &mut Slots,
) -> Result<(), Undecodable> {
    while bytes.has_remaining() {
        let (number, wire_type) = decode_key(&mut bytes)?;
        match fields.iter().find(|(wanted, _)| *wanted == number) {
            None => skip_field(wire_type, number, &mut bytes, DecodeContext::default())?,
            Some((_, node)) => read_field(node, wire_type, &mut bytes, slots)?,
        }
    }
    for (_, node) in fields {
        if let FieldTree::Leaf(leaf) = node {
            leaf.set_default(&mut slots.values[leaf.slot]);
        }
    }
    Ok(())
}

pub fn read_field(
    node: &ProtobufTree,
    wire_type: WireType,
    bytes: &mut &[u8],
    slots: &mut Slots,
) -> Result<(), Undecodable> {
    match node {
        FieldTree::Message(inner) if wire_type == WireType::LengthDelimited => {
            read_message(inner, take_delimited(bytes)?, slots)
        }
        FieldTree::Message(_) => Err(Undecodable::Malformed),
        FieldTree::Leaf(leaf) => {
            let slot = &mut slots.values[leaf.slot];
            if leaf.is_list && !slot.is_present() {
                slot.set_empty_list();
            }
            match leaf.scalar() {
                Some(scalar) if leaf.is_list && wire_type == WireType::LengthDelimited => {
                    let mut packed = take_delimited(bytes)?;
                    while packed.has_remaining() {
                        slot.push(scalar.read(&mut packed)?);
                    }
                    Ok(())
                }
                _ => leaf.read_one(wire_type, bytes, slot),
            }
        }
        FieldTree::First(first) => match wire_type {
            _ if first.picks.are_found(slots) => {
                Ok(skip_field(wire_type, 1, bytes, DecodeContext::default())?)
            }
            WireType::LengthDelimited => {
                read_message(&first.element, take_delimited(bytes)?, slots)?;
                first.picks.take(slots);
                Ok(())
            }
            _ => Err(Undecodable::Malformed),
        },
        FieldTree::List { counter, elements } => {
            read_elements(*counter, elements, wire_type, bytes, slots)
        }
    }
}

/// Reads the next element of a list that paths lead into, or all that are packed together.
fn read_elements(
    counter: usize,
    elements: &[(usize, ProtobufTree)],
    wire_type: WireType,
    bytes: &mut &[u8],
    slots: &mut Slots,
) -> Result<(), Undecodable> {
    let mut read_one = |wire_type, bytes: &mut &[u8]| {
        let index = slots.seen[counter];
        slots.seen[counter] += 1;
        match elements.iter().find(|(wanted, _)| *wanted == index) {
            Some((_, node)) => read_field(node, wire_type, bytes, slots),
            None => Ok(skip_field(wire_type, 1, bytes, DecodeContext::default())?),
        }
    };
    let scalar = elements.iter().find_map(|(_, node)| match node {
        FieldTree::Leaf(leaf) => leaf.scalar(),
        _ => None,
    });
    match scalar {
        Some(scalar) if wire_type == WireType::LengthDelimited => {
            let mut packed = take_delimited(bytes)?;
            while packed.has_remaining() {
                read_one(scalar.wire_type(), &mut packed)?;
            }
            Ok(())
        }
        _ => read_one(wire_type, bytes),
    }
}

pub fn take_delimited<'a>(bytes: &mut &'a [u8]) -> Result<&'a [u8], Undecodable> {
    let length = usize::try_from(decode_varint(bytes)?).map_err(|_| Undecodable::Malformed)?;
    let (delimited, rest) = bytes
        .split_at_checked(length)
        .ok_or(Undecodable::Malformed)?;
    *bytes = rest;
    Ok(delimited)
}
