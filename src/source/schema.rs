//! A channel's schema, whatever it is written in: which fields its messages have, and a decoder for them.

use mcap::records::Channel;

use super::{
    examples::Examples,
    field::{self, Branches, FieldKind, Key, Overlap, Slots, Undecodable, Wanted},
    json,
    path::FieldPath,
    protobuf, ros,
};
use crate::{error::Error, log::Log};

/// How many fields a complaint lists at most.
const LISTED: usize = 40;

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

/// Why a channel's messages cannot be read as a profile says.
#[derive(Debug, thiserror::Error)]
pub enum Unresolved {
    #[error(
        "its messages are encoded as `{message_encoding}` with schema encoding `{schema_encoding}`; \
         flightcam reads protobuf, JSON, ROS 2 (cdr with ros2msg) and ROS 1 (ros1 with ros1msg)"
    )]
    Encoding {
        message_encoding: String,
        schema_encoding: String,
    },
    #[error("{problem}")]
    Schema { problem: String },
    #[error("it has no field {}; {place} has {}", quote(lacking), list(available))]
    NoSuchField {
        lacking: Vec<FieldPath>,
        /// The message, or what else was searched for the first of them.
        place: String,
        available: Vec<String>,
    },
    #[error("its field `{path}` does not exist, because `{through}` is {kind}")]
    NotThere {
        path: FieldPath,
        /// Where the path leads through.
        through: String,
        kind: &'static str,
    },
    #[error(
        "its field `{path}` does not exist, because the list has {length} elements, counted from 0"
    )]
    OutOfRange { path: FieldPath, length: usize },
    #[error("its messages are of type `{name}`, not {}", wanted.join(" or "))]
    OtherType { name: String, wanted: Vec<String> },
    #[error("its field `{path}` is not {wanted} but {kind}")]
    WrongShape {
        path: FieldPath,
        wanted: &'static str,
        kind: &'static str,
    },
    #[error("its field `{path}` is wanted both as a whole and in part")]
    Overlap { path: FieldPath },
    #[error(transparent)]
    Unreadable(#[from] Error),
}

impl<'a> Schema<'a> {
    /// Of a channel.
    pub fn of(
        log: &'a Log,
        examples: &'a Examples<'a>,
        channel: &Channel,
    ) -> Result<Self, Unresolved> {
        let schema = log.contents.schema_of(channel);
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
            (message_encoding, schema_encoding, _) => Err(Unresolved::Encoding {
                message_encoding: message_encoding.to_owned(),
                schema_encoding: schema_encoding.to_owned(),
            }),
        }
    }

    /// What a path leads to.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, Unresolved> {
        match self {
            Self::Protobuf(schema) => schema.kind_of(path),
            Self::Json(schema) => schema.kind_of(path),
            Self::Ros(schema) => schema.kind_of(path),
        }
    }

    /// A decoder that puts the n-th wanted field into slot n. All of them were found, in the wanted shape.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<Decoder, Unresolved> {
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

/// The tree of wanted fields, each a path, the keys that lead there, and what is to be done there: the branches
/// of its root.
pub fn tree<Name: PartialEq + Clone, Leaf>(
    wanted: Vec<(&FieldPath, Vec<Key<Name>>, Leaf)>,
) -> Result<Branches<Name, Leaf>, Unresolved> {
    let mut root = Vec::new();
    let mut lists = 0;
    for (path, keys, leaf) in wanted {
        let path = path.clone();
        field::insert(&mut root, &keys, leaf, &mut lists)
            .map_err(|Overlap| Unresolved::Overlap { path })?;
    }
    Ok(root)
}

/// Names in backquotes.
pub fn quote(fields: &[FieldPath]) -> String {
    let names: Vec<String> = fields.iter().map(|field| format!("`{field}`")).collect();
    names.join(", ")
}

impl Unresolved {
    /// Both, where what is wrong is that fields are lacking; else this one.
    pub fn and(mut self, other: Option<Self>) -> Self {
        if let (Self::NoSuchField { lacking, .. }, Some(Self::NoSuchField { lacking: more, .. })) =
            (&mut self, other)
        {
            lacking.extend(more);
        }
        self
    }

    /// How many fields are lacking; where something else is wrong, more than can be.
    pub fn lacks(&self) -> usize {
        match self {
            Self::NoSuchField { lacking, .. } => lacking.len(),
            _ => usize::MAX,
        }
    }
}

fn list(names: &[String]) -> String {
    let listed = names[..names.len().min(LISTED)].join(", ");
    match names.len().saturating_sub(LISTED) {
        0 => listed,
        more => format!("{listed} and {more} more"),
    }
}
