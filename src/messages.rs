//! The messages that the program writes: how it says each derived quantity, in each encoding.
//!
//! In protobuf and JSON they are types of the program's own, from `proto/` and `schemas/`, with the same
//! fields. ROS 2 has `geometry_msgs/msg/Vector3Stamped`, which every ROS 2 tool knows. The numbers are the same
//! in all of them, to the last bit.

/// Version 1 of the program's own types, generated from `proto/`.
pub mod v1 {
    include!(concat!(env!("OUT_DIR"), "/flightcam.v1.rs"));
}

mod json;
mod protobuf;
mod ros2;

use std::collections::BTreeMap;

use mcap::records::Channel;
use serde::Serialize;

use crate::derived::{Derived, Quantity, Value};
pub use ros2::LAST_SECOND;

/// In which of the languages that MCAP knows derived values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// Protobuf messages of `proto/`.
    Protobuf,
    /// JSON with the fields of the protobuf messages; times and durations are `sec` and `nsec`, as in
    /// Foxglove's own JSON schemas.
    Json,
    /// `geometry_msgs/msg/Vector3Stamped` in CDR. It has no place for the interval of a relative rotation; roll,
    /// pitch and yaw are its x, y and z.
    Ros2,
}

/// Which encoding is wanted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum EncodingChoice {
    /// That of the telemetry, if messages can be written in it, else protobuf.
    #[default]
    Automatic,
    /// This one, whatever the log is written in.
    Given(Encoding),
}

/// A message type, as a schema record says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schema {
    /// The type's full name.
    pub name: &'static str,
    /// In which language the type is defined.
    pub encoding: &'static str,
    /// The definition, with all that it refers to.
    pub data: &'static [u8],
}

/// How the derived channels of one log are written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Format {
    /// The encoding of all of them.
    pub encoding: Encoding,
    /// What each of their channel records says besides.
    pub channel_metadata: BTreeMap<String, String>,
}

impl Encoding {
    /// All of them.
    pub const ALL: [Encoding; 3] = [Encoding::Protobuf, Encoding::Json, Encoding::Ros2];

    /// What the user calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Protobuf => "protobuf",
            Self::Json => "json",
            Self::Ros2 => "ros2",
        }
    }

    /// What a channel record calls it.
    pub fn message_encoding(self) -> &'static str {
        match self {
            Self::Protobuf => "protobuf",
            Self::Json => "json",
            Self::Ros2 => "cdr",
        }
    }

    /// The message type that a quantity is written as.
    pub fn schema(self, quantity: Quantity) -> Schema {
        match self {
            Self::Protobuf => protobuf::schema(quantity),
            Self::Json => json::schema(quantity),
            Self::Ros2 => ros2::SCHEMA,
        }
    }

    /// Appends the message of a derived value to `out`.
    pub fn encode(self, derived: &Derived, out: &mut Vec<u8>) {
        match self {
            Self::Protobuf => protobuf::encode(derived, out),
            Self::Json => json::encode(derived, out),
            Self::Ros2 => ros2::encode(derived, out),
        }
    }
}

impl Format {
    /// The format for a log whose telemetry has this channel.
    pub fn choose(choice: EncodingChoice, telemetry: &Channel) -> Self {
        let encoding = match choice {
            EncodingChoice::Given(encoding) => encoding,
            EncodingChoice::Automatic => Encoding::ALL
                .into_iter()
                .find(|encoding| encoding.message_encoding() == telemetry.message_encoding)
                .unwrap_or(Encoding::Protobuf),
        };
        Self {
            encoding,
            channel_metadata: match encoding {
                Encoding::Protobuf | Encoding::Json => BTreeMap::new(),
                Encoding::Ros2 => ros2::channel_metadata(telemetry),
            },
        }
    }
}

/// The components of a value. A zero among them has no sign, because in protobuf it has none.
fn components(value: &Value) -> [f64; 3] {
    let components = match *value {
        Value::RelativeRpy { rpy, .. } => [rpy.roll, rpy.pitch, rpy.yaw],
        Value::CameraVelocity(velocity) => velocity.into(),
    };
    // This changes a negative zero and nothing else.
    components.map(|component| component + 0.0)
}

/// Whole seconds and the nanoseconds beyond them.
fn split_seconds(nanoseconds: u64) -> (u64, u32) {
    const SECOND: u64 = 1_000_000_000;
    (nanoseconds / SECOND, (nanoseconds % SECOND) as u32)
}
