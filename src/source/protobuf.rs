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
    Unresolved,
    field::{FieldPath, FieldTree, FieldValue, Node, Shape, Undecodable, Wanted},
};

/// Reads the wanted fields of one message type.
#[derive(Debug)]
pub struct Decoder {
    fields: FieldTree<u32, Leaf>,
}

#[derive(Debug, Clone, Copy)]
struct Leaf {
    slot: usize,
    scalar: Scalar,
    is_list: bool,
    /// Whether a message can leave the field out, as opposed to having its default.
    has_presence: bool,
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

impl Decoder {
    /// Resolves fields against a schema: a serialised `FileDescriptorSet` and a message's full name. The
    /// value of the n-th field goes to slot n.
    pub fn new(schema_name: &str, schema: &[u8], wanted: &[Wanted]) -> Result<Self, Unresolved> {
        let unreadable = |problem: String| Unresolved::Schema { problem };
        let pool = DescriptorPool::decode(schema)
            .map_err(|error| unreadable(format!("its protobuf schema cannot be read: {error}")))?;
        let message = pool.get_message_by_name(schema_name).ok_or_else(|| {
            unreadable(format!(
                "its protobuf schema does not define `{schema_name}`"
            ))
        })?;
        let mut fields = FieldTree::new();
        let mut all_lacking: Option<Unresolved> = None;
        for (slot, wanted) in wanted.iter().enumerate() {
            match (resolve(&message, &wanted.path), &mut all_lacking) {
                (Ok(chain), _) => {
                    let last = chain.last().expect("a path has at least one name");
                    let numbers: Vec<u32> = chain.iter().map(FieldDescriptor::number).collect();
                    fields.insert(&numbers, Leaf::new(slot, last, wanted)?);
                }
                // All of them are told at once.
                (
                    Err(Unresolved::NoSuchField { lacking: more, .. }),
                    Some(Unresolved::NoSuchField { lacking, .. }),
                ) => lacking.extend(more),
                (Err(first @ Unresolved::NoSuchField { .. }), none) => *none = Some(first),
                (Err(other), _) => return Err(other),
            }
        }
        all_lacking.map_or(Ok(Self { fields }), Err)
    }

    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut [FieldValue]) -> Result<(), Undecodable> {
        read_message(&self.fields, message, slots)
    }
}

fn resolve(
    message: &MessageDescriptor,
    path: &FieldPath,
) -> Result<Vec<FieldDescriptor>, Unresolved> {
    let mut within = Some(message.clone());
    let mut chain: Vec<FieldDescriptor> = Vec::new();
    for name in path.names() {
        let Some(parent) = within else {
            return Err(Unresolved::NotAMessage {
                path: path.clone(),
                name: chain
                    .last()
                    .map_or_else(String::new, |f| f.name().to_owned()),
            });
        };
        let field = parent
            .get_field_by_name(name)
            .ok_or_else(|| Unresolved::NoSuchField {
                lacking: vec![path.clone()],
                place: parent.full_name().to_owned(),
                available: parent.fields().map(|f| f.name().to_owned()).collect(),
            })?;
        within = match field.kind() {
            Kind::Message(inner) if !field.is_list() && !field.is_map() => Some(inner),
            _ => None,
        };
        chain.push(field);
    }
    Ok(chain)
}

impl Leaf {
    fn new(slot: usize, field: &FieldDescriptor, wanted: &Wanted) -> Result<Self, Unresolved> {
        let wrong = |kind| Unresolved::WrongShape {
            path: wanted.path.clone(),
            wanted: match wanted.shape {
                Shape::Number => "a number",
                Shape::List => "a list of numbers",
            },
            kind,
        };
        let scalar = Scalar::of(field).ok_or_else(|| {
            wrong(match field.kind() {
                _ if field.is_map() => "map",
                Kind::String => "string",
                Kind::Bytes => "string of bytes",
                _ => "message",
            })
        })?;
        match (wanted.shape, field.is_list()) {
            (Shape::Number, true) => return Err(wrong("list")),
            (Shape::List, false) => return Err(wrong("single number")),
            (Shape::Number, false) | (Shape::List, true) => {}
        }
        Ok(Self {
            slot,
            scalar,
            is_list: field.is_list(),
            has_presence: field.supports_presence(),
        })
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

    fn read(self, bytes: &mut &[u8]) -> Result<f64, Undecodable> {
        let needed = match self.wire_type() {
            WireType::SixtyFourBit => 8,
            WireType::ThirtyTwoBit => 4,
            _ => 0,
        };
        if bytes.remaining() < needed {
            return Err(Undecodable);
        }
        Ok(match self {
            Self::Double => bytes.get_f64_le(),
            Self::Float => bytes.get_f32_le().into(),
            Self::Fixed32 => bytes.get_u32_le().into(),
            Self::Fixed64 => bytes.get_u64_le() as f64,
            Self::Sfixed32 => bytes.get_i32_le().into(),
            Self::Sfixed64 => bytes.get_i64_le() as f64,
            // Negative 32-bit numbers are written as 64-bit ones.
            Self::Int32 => f64::from(decode_varint(bytes)? as i32),
            Self::Int64 => decode_varint(bytes)? as i64 as f64,
            Self::Uint32 => f64::from(decode_varint(bytes)? as u32),
            Self::Uint64 => decode_varint(bytes)? as f64,
            Self::Sint32 | Self::Sint64 => {
                let zigzag = decode_varint(bytes)?;
                ((zigzag >> 1) as i64 ^ -((zigzag & 1) as i64)) as f64
            }
            Self::Bool => f64::from(u8::from(decode_varint(bytes)? != 0)),
        })
    }
}

fn read_message(
    fields: &FieldTree<u32, Leaf>,
    mut bytes: &[u8],
    slots: &mut [FieldValue],
) -> Result<(), Undecodable> {
    for (_, node) in &fields.branches {
        if let Node::Leaf(leaf) = node {
            let slot = &mut slots[leaf.slot];
            // A message may come in parts, of which the later ones add to the earlier.
            if slot.is_present() {
                continue;
            } else if leaf.is_list {
                slot.set_empty_list();
            } else if !leaf.has_presence {
                slot.set(0.0);
            }
        }
    }
    while bytes.has_remaining() {
        let (number, wire_type) = decode_key(&mut bytes)?;
        match fields.get(&number) {
            None => skip_field(wire_type, number, &mut bytes, DecodeContext::default())?,
            Some(Node::Message(inner)) if wire_type == WireType::LengthDelimited => {
                read_message(inner, take_delimited(&mut bytes)?, slots)?;
            }
            Some(Node::Message(_)) => return Err(Undecodable),
            Some(Node::Leaf(leaf)) => {
                let slot = &mut slots[leaf.slot];
                if leaf.is_list && wire_type == WireType::LengthDelimited {
                    let mut packed = take_delimited(&mut bytes)?;
                    while packed.has_remaining() {
                        slot.push(leaf.scalar.read(&mut packed)?);
                    }
                } else if wire_type != leaf.scalar.wire_type() {
                    return Err(Undecodable);
                } else if leaf.is_list {
                    slot.push(leaf.scalar.read(&mut bytes)?);
                } else {
                    slot.set(leaf.scalar.read(&mut bytes)?);
                }
            }
        }
    }
    Ok(())
}

fn take_delimited<'a>(bytes: &mut &'a [u8]) -> Result<&'a [u8], Undecodable> {
    let length = usize::try_from(decode_varint(bytes)?).map_err(|_| Undecodable)?;
    let (delimited, rest) = bytes.split_at_checked(length).ok_or(Undecodable)?;
    *bytes = rest;
    Ok(delimited)
}
