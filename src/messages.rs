//! The messages that the program writes: one file for each message type, which says how it is written in each
//! encoding.
//!
//! In protobuf and JSON they are types of the program's own, from `proto/` and `schemas/`, with the same fields.
//! In ROS 2 they are standard types, which every ROS 2 tool knows. The numbers are the same in all encodings, to
//! the last bit. What viewers are shown has types that they know: see `visuals`.

/// Version 1 of the program's own types, generated from `proto/`.
pub mod v1 {
    include!(concat!(env!("OUT_DIR"), "/flightcam.v1.rs"));
}

mod camera_orientation;
mod camera_velocity;
mod relative_rpy;
mod visuals;

mod cdr;
mod json;
mod numbers;
mod protobuf;
mod ros2;
mod topic;
mod vector3_stamped;

use std::collections::BTreeMap;

use mcap::records::Channel;
use serde::{Serialize, Serializer};

use crate::derived::{
    Derived, Quantity, Value,
    visual::{Frame, VisualTopic},
};
pub use ros2::LAST_SECOND;
pub use topic::{Message, Topic};

/// The key in a channel's metadata by which it is known as the program's own. Its value is the version.
pub const OWN_CHANNEL: &str = "flightcam";

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
    /// How messages are encoded.
    pub message_encoding: &'static str,
    /// The language of the definition.
    pub encoding: &'static str,
    /// The definition, with all that it refers to.
    pub data: &'static [u8],
    /// The field that shows most at a glance, as viewers write its path; `None` if nothing of it can be plotted.
    pub field_to_plot: Option<&'static str>,
}

impl MessageDefinition {
    fn new(
        encoding: Encoding,
        name: &'static str,
        data: &'static [u8],
        field_to_plot: Option<&'static str>,
    ) -> Self {
        Self {
            name,
            message_encoding: encoding.message_encoding(),
            encoding: encoding.schema_encoding(),
            data,
            field_to_plot,
        }
    }
}

/// What every message contains, whatever its type.
#[derive(Debug, Clone, Copy)]
struct Header {
    /// Nanoseconds of log time.
    time: u64,
    /// The frame that the components are expressed in.
    frame_id: &'static str,
}

/// How the new channels of one log are written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Format {
    /// The encoding of the camera's motion. What viewers are shown has types that viewers know: Foxglove's in protobuf,
    /// unless the encoding is ROS 2.
    pub encoding: Encoding,
    /// The quality-of-service settings of the telemetry, as rosbag2 writes them; empty if it has none. In ROS 2, those of
    /// the camera's motion, too.
    pub quality_of_service: String,
    /// Whether the log has transforms of its own. Viewers merge all transforms of a log, so the names of frames then get
    /// a prefix.
    pub has_transforms: bool,
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

    /// The name in schema records. In protobuf, a definition is a serialised `FileDescriptorSet` of the message's file and
    /// all that it imports.
    fn schema_encoding(self) -> &'static str {
        match self {
            Self::Protobuf => "protobuf",
            Self::Json => "jsonschema",
            Self::Ros2 => "ros2msg",
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

/// The type of the messages on a topic, in a log whose camera motion has this encoding; `None` if they are not written.
pub fn definition(encoding: Encoding, topic: Topic) -> Option<MessageDefinition> {
    match topic {
        Topic::Derived(quantity) => Some(encoding.schema(quantity)),
        Topic::Visual(topic) => visuals::definition(encoding, topic),
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
            quality_of_service: ros2::quality_of_service(telemetry),
            has_transforms: false,
        }
    }

    /// The same for a log that has transforms of its own, or has none.
    #[must_use]
    pub fn beside_transforms(self, has_transforms: bool) -> Self {
        Self {
            has_transforms,
            ..self
        }
    }

    /// The topic that a message is on.
    pub fn topic(&self, message: &Message) -> Topic {
        let visual = match message {
            Message::Derived(derived) => return Topic::Derived(derived.quantity()),
            Message::Shown(shown) => shown.visual.topic(),
        };
        let is_tf = self.encoding == Encoding::Ros2 && !self.has_transforms;
        Topic::Visual(match visual {
            VisualTopic::Transforms if is_tf => VisualTopic::Tf,
            VisualTopic::StaticTransforms if is_tf => VisualTopic::TfStatic,
            visual => visual,
        })
    }

    /// Whether messages on a topic for viewers are written to it.
    pub fn writes(&self, topic: VisualTopic) -> bool {
        let is_tf = self.encoding == Encoding::Ros2 && !self.has_transforms;
        match topic {
            VisualTopic::Tf | VisualTopic::TfStatic => is_tf,
            VisualTopic::Transforms | VisualTopic::StaticTransforms => !is_tf,
            topic => self.definition(Topic::Visual(topic)).is_some(),
        }
    }

    /// The type of the messages on a topic; `None` if its messages are not written in this format.
    pub fn definition(&self, topic: Topic) -> Option<MessageDefinition> {
        definition(self.encoding, topic)
    }

    /// The metadata of a topic's channel record. By the program's version in it, the channel is known as one of its own
    /// where the log's Metadata record is lost.
    pub fn channel_metadata(&self, topic: Topic) -> BTreeMap<String, String> {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let mut metadata = BTreeMap::from([(OWN_CHANNEL.to_owned(), version)]);
        if self.encoding == Encoding::Ros2 {
            let settings = match topic {
                Topic::Derived(_) => &self.quality_of_service,
                Topic::Visual(topic) if topic.is_written_once() => ros2::KEPT_FOR_LATE_SUBSCRIBERS,
                Topic::Visual(_) => ros2::DEFAULT,
            };
            metadata.insert(ros2::QUALITY_OF_SERVICE.to_owned(), settings.to_owned());
        }
        metadata
    }

    /// Appends a message to `out`. Its topic has a [definition](Self::definition).
    pub fn encode(&self, message: &Message, out: &mut Vec<u8>) {
        match message {
            Message::Derived(derived) => self.encoding.encode(derived, out),
            Message::Shown(shown) => visuals::encode(self, shown, out),
        }
    }

    /// The header of a message for viewers.
    fn header(&self, time: u64, frame: Frame) -> Header {
        let frame_id = self.frame_id(frame);
        Header { time, frame_id }
    }

    /// A frame's name in messages for viewers.
    pub fn frame_id(&self, frame: Frame) -> &'static str {
        match (self.has_transforms, frame) {
            (false, frame) => frame.name(),
            (true, Frame::Map) => "flightcam/map",
            (true, Frame::Ned) => "flightcam/ned",
            (true, Frame::Drone) => "flightcam/drone",
            (true, Frame::DroneEnu) => "flightcam/drone_enu",
            (true, Frame::Camera) => "flightcam/camera",
            (true, Frame::CameraOptical) => "flightcam/camera_optical",
        }
    }
}
