//! Numbers out of protobuf messages of any schema.
//!
//! The wanted fields are resolved against the channel's schema once; a message is then read straight from
//! its bytes by field numbers (<https://protobuf.dev/programming-guides/encoding/>), without building it.

use prost::{
    bytes::Buf,
    encoding::{DecodeContext, WireType, decode_key, decode_varint, skip_field},
};
use prost_reflect::{DescriptorPool, FieldDescriptor, Kind, MessageDescriptor};

use super::{
    error::SchemaError,
    field::{FieldKind, Shape, Wanted},
    path::{FieldPath, PathStep},
    tree::{Branches, FieldTree, Key, tree},
    value::{FieldValue, Number, Slots, Undecodable},
};

/// A message type, with those that it is made of.
#[derive(Debug)]
pub struct Schema {
    message: MessageDescriptor,
}

/// Reads the wanted fields of one message type.
#[derive(Debug)]
pub struct Decoder {
    fields: Branches<u32, Leaf>,
}

type Tree = FieldTree<u32, Leaf>;

#[derive(Debug, Clone)]
struct Leaf {
    slot: usize,
    content: Content,
    is_list: bool,
    /// Whether a message can leave the field out, as opposed to having its default.
    has_presence: bool,
}

#[derive(Debug, Clone)]
enum Content {
    Scalar(Scalar),
    /// Text, wanted as its place among these words.
    Text(Vec<String>),
}

#[derive(Debug, Clone, Copy)]
enum Scalar {
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

/// Where a path leads.
struct Target {
    /// The last field that the path names.
    field: FieldDescriptor,
    /// Whether the path goes on to an element of that field's list.
    is_element: bool,
    keys: Vec<Key<u32>>,
}

impl Schema {
    /// Of a serialised `FileDescriptorSet` and a message's full name.
    pub fn new(name: &str, descriptors: &[u8]) -> Result<Self, SchemaError> {
        let unreadable = |problem: String| SchemaError::Schema { problem };
        let pool = DescriptorPool::decode(descriptors)
            .map_err(|error| unreadable(format!("its protobuf schema cannot be read: {error}")))?;
        let message = pool
            .get_message_by_name(name)
            .ok_or_else(|| unreadable(format!("its protobuf schema does not define `{name}`")))?;
        Ok(Self { message })
    }

    /// What a path leads to.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        self.resolve(path).map(|target| target.kind())
    }

    /// A decoder that puts the n-th wanted field into slot n.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<Decoder, SchemaError> {
        let mut leaves = Vec::new();
        for (slot, Wanted { path, shape }) in wanted.iter().enumerate() {
            let Target { field, keys, .. } = self.resolve(path)?;
            let content = match shape {
                Shape::Word(words) => Content::Text(words.clone()),
                Shape::Number | Shape::List => {
                    Content::Scalar(Scalar::of(&field).expect("the field has numbers"))
                }
            };
            let leaf = Leaf {
                slot,
                content,
                is_list: *shape == Shape::List,
                has_presence: field.supports_presence(),
            };
            leaves.push((path, keys, leaf));
        }
        Ok(Decoder {
            fields: tree(leaves)?,
        })
    }

    fn resolve(&self, path: &FieldPath) -> Result<Target, SchemaError> {
        let mut target: Option<Target> = None;
        for step in path.steps() {
            let is_not = |target: &Target| SchemaError::NotThere {
                path: path.clone(),
                through: target.field.name().to_owned(),
                kind: target.kind().describe(),
            };
            target = Some(match (step, target) {
                (PathStep::Name(name), within) => {
                    let (message, mut keys) = match within {
                        None => (self.message.clone(), Vec::new()),
                        Some(target) => match target.message() {
                            Some(message) => (message, target.keys),
                            None => return Err(is_not(&target)),
                        },
                    };
                    let field = message.get_field_by_name(name);
                    let field = field.ok_or_else(|| SchemaError::NoSuchField {
                        lacking: vec![path.clone()],
                        place: message.full_name().to_owned(),
                        available: names(&message),
                    })?;
                    keys.push(Key::Name(field.number()));
                    Target {
                        field,
                        is_element: false,
                        keys,
                    }
                }
                (PathStep::Index(index), Some(mut target)) if target.is_list() => {
                    target.keys.push(Key::Index(*index));
                    target.is_element = true;
                    target
                }
                (PathStep::Index(_), Some(target)) => return Err(is_not(&target)),
                (PathStep::Index(_), None) => unreachable!("a path starts with a name"),
            });
        }
        Ok(target.expect("a path starts with a name"))
    }
}

impl Target {
    fn is_list(&self) -> bool {
        self.field.is_list() && !self.is_element
    }

    /// The message that a path may go on into.
    fn message(&self) -> Option<MessageDescriptor> {
        match self.field.kind() {
            Kind::Message(inner) if !self.is_list() && !self.field.is_map() => Some(inner),
            _ => None,
        }
    }

    fn kind(&self) -> FieldKind {
        let is_number = Scalar::of(&self.field).is_some();
        match self.field.kind() {
            _ if self.field.is_map() => FieldKind::Other("a map"),
            _ if self.is_list() && is_number => FieldKind::List,
            _ if self.is_list() => FieldKind::Other("a list, but not of numbers"),
            _ if is_number => FieldKind::Number,
            Kind::String => FieldKind::Text,
            Kind::Message(inner) => FieldKind::Message(names(&inner)),
            _ => FieldKind::Other("a string of bytes"),
        }
    }
}

fn names(message: &MessageDescriptor) -> Vec<String> {
    message
        .fields()
        .map(|field| field.name().to_owned())
        .collect()
}

impl Decoder {
    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        read_message(&self.fields, message, slots)
    }
}

impl Leaf {
    /// Reads a value that is not a list.
    fn read_one(
        &self,
        wire_type: WireType,
        bytes: &mut &[u8],
        slot: &mut FieldValue,
    ) -> Result<(), Undecodable> {
        match &self.content {
            Content::Text(words) if wire_type == WireType::LengthDelimited => {
                slot.set_word(words, take_delimited(bytes)?);
            }
            Content::Scalar(scalar) if wire_type == scalar.wire_type() => {
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

    fn scalar(&self) -> Option<Scalar> {
        match self.content {
            Content::Scalar(scalar) => Some(scalar),
            Content::Text(_) => None,
        }
    }

    /// Sets what the field has where a message does not mention it.
    fn set_default(&self, slot: &mut FieldValue) {
        match &self.content {
            // A message may come in parts, of which the later ones add to the earlier.
            _ if slot.is_present() || self.has_presence => {}
            Content::Scalar(_) if self.is_list => slot.set_empty_list(),
            Content::Scalar(_) => slot.set(0.0),
            Content::Text(words) => slot.set_word(words, b""),
        }
    }
}

impl Scalar {
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
            // Negative 32-bit numbers are written as 64-bit ones.
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
    fields: &[(u32, Tree)],
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

fn read_field(
    node: &Tree,
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
        FieldTree::List { counter, elements } => {
            read_elements(*counter, elements, wire_type, bytes, slots)
        }
    }
}

/// Reads the next element of a list that paths lead into, or all that are packed together.
fn read_elements(
    counter: usize,
    elements: &[(usize, Tree)],
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

fn take_delimited<'a>(bytes: &mut &'a [u8]) -> Result<&'a [u8], Undecodable> {
    let length = usize::try_from(decode_varint(bytes)?).map_err(|_| Undecodable::Malformed)?;
    let (delimited, rest) = bytes
        .split_at_checked(length)
        .ok_or(Undecodable::Malformed)?;
    *bytes = rest;
    Ok(delimited)
}
