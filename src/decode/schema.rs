//! A channel's schema, in any of the encodings: which fields its messages have, and a decoder for them.

use mcap::records::Channel;

use super::{
    error::SchemaError,
    fault::Fault,
    field::{FieldKind, Wanted},
    json::{FirstMessages, JsonDecoder, JsonSchema, Proof},
    path::FieldPath,
    protobuf::{ProtobufDecoder, ProtobufSchema},
    ros::{Dialect, RosDecoder, RosSchema},
    value::{Slots, Undecodable},
};
use crate::log::contents;

/// The supported encodings, for error messages.
pub const SUPPORTED: &str =
    "protobuf, JSON, ROS 2 (cdr with ros2msg) and ROS 1 (ros1 with ros1msg)";

/// The definition of the fields that a channel's messages have.
#[derive(Debug)]
pub enum MessageSchema<'a> {
    Protobuf(ProtobufSchema),
    Json(JsonSchema<'a>),
    Ros(RosSchema),
}

/// Reads wanted fields out of a channel's messages.
#[derive(Debug)]
pub enum MessageDecoder {
    Protobuf(ProtobufDecoder),
    Json(JsonDecoder),
    Ros(RosDecoder),
}

/// The encodings of messages and schemas that can be read.
enum Supported {
    Protobuf,
    Json,
    Ros(Dialect),
}

impl Supported {
    fn of(channel: &Channel, schema: Option<&contents::SchemaRecord>) -> Option<Self> {
        let schema_encoding = schema.map_or("", |schema| schema.encoding.as_str());
        match (channel.message_encoding.as_str(), schema_encoding) {
            ("protobuf", "protobuf") => Some(Self::Protobuf),
            ("json", "jsonschema" | "") => Some(Self::Json),
            ("cdr", "ros2msg") => Some(Self::Ros(Dialect::Ros2)),
            ("ros1", "ros1msg") => Some(Self::Ros(Dialect::Ros1)),
            _ => None,
        }
    }
}

impl<'a> MessageSchema<'a> {
    /// Reads the schema of a channel, which refers to this schema record.
    pub fn of(
        channel: &Channel,
        schema: Option<&contents::SchemaRecord>,
        first_messages: &'a FirstMessages<'a>,
        proof: Proof,
    ) -> Result<Self, SchemaError> {
        match (Supported::of(channel, schema), schema) {
            (Some(Supported::Protobuf), Some(schema)) => {
                ProtobufSchema::new(&schema.name, schema.data()).map(Self::Protobuf)
            }
            (Some(Supported::Json), schema) => {
                let data = schema.map_or(&[][..], |schema| schema.data());
                JsonSchema::new(data, first_messages, channel.id, proof).map(Self::Json)
            }
            (Some(Supported::Ros(dialect)), Some(schema)) => {
                RosSchema::new(dialect, &schema.name, schema.data()).map(Self::Ros)
            }
            (_, schema) => Err(SchemaError::Encoding {
                message_encoding: channel.message_encoding.as_str().into(),
                schema_encoding: schema.map_or("", |schema| schema.encoding.as_str()).into(),
            }),
        }
    }

    /// Whether the schema of a channel is of a kind that can be read.
    pub fn is_supported(channel: &Channel, schema: Option<&contents::SchemaRecord>) -> bool {
        Supported::of(channel, schema).is_some()
    }

    /// Has fields that the first messages do not have looked for in more of them, because messages are of several types.
    pub fn expect_several_types(&self) {
        if let Self::Json(schema) = self {
            schema.expect_several_types();
        }
    }

    /// What kind of field a path leads to.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        match self {
            Self::Protobuf(schema) => schema.kind_of(path),
            Self::Json(schema) => schema.kind_of(path),
            Self::Ros(schema) => schema.kind_of(path),
        }
    }

    /// Makes a decoder that puts the n-th wanted field into slot n, and slots for all that it reads.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<(MessageDecoder, Slots), SchemaError> {
        Ok(match self {
            Self::Protobuf(schema) => {
                let (decoder, slots) = schema.decoder(wanted)?;
                (MessageDecoder::Protobuf(decoder), slots)
            }
            Self::Json(schema) => {
                let (decoder, slots) = schema.decoder(wanted)?;
                (MessageDecoder::Json(decoder), slots)
            }
            Self::Ros(schema) => {
                let (decoder, slots) = schema.decoder(wanted)?;
                (MessageDecoder::Ros(decoder), slots)
            }
        })
    }
}

impl MessageDecoder {
    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        match self {
            Self::Protobuf(decoder) => decoder.decode(message, slots),
            Self::Json(decoder) => decoder.decode(message, slots),
            Self::Ros(decoder) => decoder.decode(message, slots),
        }
    }

    /// What is wrong with a message that cannot be decoded. What is in the slots is lost.
    pub fn explain(&self, message: &[u8], slots: &mut Slots) -> Option<Fault> {
        slots.clear();
        Fault::of_bytes(message).or_else(|| match self {
            Self::Protobuf(decoder) => decoder.explain(message, slots),
            Self::Json(decoder) => decoder.explain(message, slots),
            Self::Ros(decoder) => decoder.explain(message, slots),
        })
    }
}
