//! A channel's schema, whatever it is written in: which fields its messages have, and a decoder for them.

use mcap::records::Channel;

use super::{
    error::SchemaError,
    examples::Examples,
    field::{FieldKind, Wanted},
    json,
    path::FieldPath,
    protobuf, ros,
    value::{Slots, Undecodable},
};
use crate::log::contents;

/// What tells where the fields of a channel's messages lie.
#[derive(Debug)]
pub enum Schema<'a> {
    Protobuf(protobuf::Schema),
    Json(json::Schema<'a>),
    Ros(ros::Schema),
}

/// Reads wanted fields out of a channel's messages.
#[derive(Debug)]
pub enum Decoder {
    Protobuf(protobuf::Decoder),
    Json(json::Decoder),
    Ros(ros::Decoder),
}

impl<'a> Schema<'a> {
    /// Of a channel, which names this schema.
    pub fn of(
        channel: &Channel,
        schema: Option<&contents::Schema>,
        examples: &'a Examples<'a>,
    ) -> Result<Self, SchemaError> {
        let schema_encoding = schema.map_or("", |schema| schema.encoding.as_str());
        match (channel.message_encoding.as_str(), schema_encoding, schema) {
            ("protobuf", "protobuf", Some(schema)) => {
                protobuf::Schema::new(&schema.name, schema.data()).map(Self::Protobuf)
            }
            ("json", "jsonschema" | "", schema) => {
                let data = schema.map_or(&[][..], |schema| schema.data());
                json::Schema::new(data, examples, channel.id).map(Self::Json)
            }
            ("cdr", "ros2msg", Some(schema)) => {
                ros::Schema::ros2(&schema.name, schema.data()).map(Self::Ros)
            }
            ("ros1", "ros1msg", Some(schema)) => {
                ros::Schema::ros1(&schema.name, schema.data()).map(Self::Ros)
            }
            (message_encoding, schema_encoding, _) => Err(SchemaError::Encoding {
                message_encoding: message_encoding.to_owned(),
                schema_encoding: schema_encoding.to_owned(),
            }),
        }
    }

    /// What a path leads to.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        match self {
            Self::Protobuf(schema) => schema.kind_of(path),
            Self::Json(schema) => schema.kind_of(path),
            Self::Ros(schema) => schema.kind_of(path),
        }
    }

    /// A decoder that puts the n-th wanted field into slot n. All of them were found, in the wanted shape.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<Decoder, SchemaError> {
        match self {
            Self::Protobuf(schema) => schema.decoder(wanted).map(Decoder::Protobuf),
            Self::Json(schema) => schema.decoder(wanted).map(Decoder::Json),
            Self::Ros(schema) => schema.decoder(wanted).map(Decoder::Ros),
        }
    }
}

impl Decoder {
    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        match self {
            Self::Protobuf(decoder) => decoder.decode(message, slots),
            Self::Json(decoder) => decoder.decode(message, slots),
            Self::Ros(decoder) => decoder.decode(message, slots),
        }
    }
}
