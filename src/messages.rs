//! The messages that the program writes: one file for each message type, which says how it is written in each
//! encoding.
//!
//! In protobuf and JSON they are types of the program's own, from `proto/` and `schemas/`, with the same fields.
//! In ROS 2 they are standard types, which every ROS 2 tool knows. The numbers are the same in all encodings, to
//! the last bit.

/// Version 1 of the program's own types, generated from `proto/`.
pub mod v1 {
    include!(concat!(env!("OUT_DIR"), "/flightcam.v1.rs"));
}

mod camera_orientation;
mod camera_velocity;
mod relative_rpy;

mod cdr;
mod json;
mod numbers;
mod protobuf;
mod ros2;
mod vector3_stamped;

use std::collections::BTreeMap;

use mcap::records::Channel;
use serde::{Serialize, Serializer};

use crate::derived::{Derived, Quantity, Value};
pub use ros2::LAST_SECOND;

/// How derived values are encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Encoding {
    /// Protobuf messages of `proto/`.
    Protobuf,
    /// JSON with the fields of the protobuf messages; times and durations are `sec` and `nsec`, as in
    /// Foxglove's own JSON schemas.
    Json,
    /// Standard ROS 2 messages in CDR.
    Ros2,
}

/// The wanted encoding.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum EncodingChoice {
    /// That of the telemetry, if messages can be written in it, else protobuf.
    #[default]
    Automatic,
    /// This one, whatever the log's encoding is.
    Given(Encoding),
}

/// A message type in one encoding, as a schema record defines it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MessageDefinition {
    /// The type's full name.
    pub name: &'static str,
    /// The language of the definition.
    pub encoding: &'static str,
    /// The definition, with all that it refers to.
    pub data: &'static [u8],
    /// The field that shows most at a glance, as viewers write its path.
    pub field_to_plot: &'static str,
}

/// What every message contains, whatever its type.
#[derive(Debug, Clone, Copy)]
struct Header {
    /// Nanoseconds of log time.
    time: u64,
    /// The frame that the components are expressed in.
    frame_id: &'static str,
}

/// How the derived channels of one log are written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Format {
    /// The encoding of all of them.
    pub encoding: Encoding,
    /// The metadata of each of their channel records.
    pub channel_metadata: BTreeMap<String, String>,
}

impl Encoding {
    /// All encodings.
    pub const ALL: [Encoding; 3] = [Encoding::Protobuf, Encoding::Json, Encoding::Ros2];

    /// The name in options and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Protobuf => "protobuf",
            Self::Json => "json",
            Self::Ros2 => "ros2",
        }
    }

    /// The message types that are written in it, in a line for a list of encodings.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Protobuf => "flightcam.v1.RelativeRpy, CameraOrientation and CameraVelocity",
            Self::Json => "The same fields in JSON",
            Self::Ros2 => "geometry_msgs/msg/Vector3Stamped and QuaternionStamped",
        }
    }

    /// The name in channel records.
    pub fn message_encoding(self) -> &'static str {
        match self {
            Self::Protobuf => "protobuf",
            Self::Json => "json",
            Self::Ros2 => "cdr",
        }
    }

    /// The message type that a quantity is written as.
    pub fn schema(self, quantity: Quantity) -> MessageDefinition {
        match quantity {
            Quantity::RelativeRpy => relative_rpy::definition(self),
            Quantity::Orientation => camera_orientation::definition(self),
            Quantity::CameraVelocity => camera_velocity::definition(self),
        }
    }

    /// Appends the message of a derived value to `out`.
    pub fn encode(self, derived: &Derived, out: &mut Vec<u8>) {
        let header = Header {
            time: derived.stamp.log_time,
            frame_id: derived.quantity().frame_id(),
        };
        match derived.value {
            Value::RelativeRpy { interval, rpy } => {
                relative_rpy::encode(self, header, interval, rpy, out);
            }
            Value::Orientation(r_ned_camera) => {
                camera_orientation::encode(self, header, &r_ned_camera, out);
            }
            Value::CameraVelocity(velocity) => {
                camera_velocity::encode(self, header, velocity, out);
            }
        }
    }
}

impl Serialize for Encoding {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
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
