//! Logs of a few topics, each with a message every 20 ms.

use std::{collections::BTreeMap, io::Cursor};

use mcap::records::MessageHeader;
use serde_json::{Value, json};

/// A topic and its messages.
#[derive(Debug, Clone)]
pub struct Topic {
    pub name: &'static str,
    pub encoding: &'static str,
    pub schema: Option<Schema>,
    pub messages: Vec<Vec<u8>>,
}

/// A message type.
#[derive(Debug, Clone)]
pub struct Schema {
    pub name: &'static str,
    pub encoding: &'static str,
    pub data: Vec<u8>,
}

/// In JSON without a schema.
pub fn topic(name: &'static str, messages: impl IntoIterator<Item = Value>) -> Topic {
    let messages = messages.into_iter();
    Topic {
        name,
        encoding: "json",
        schema: None,
        messages: messages.map(|json| json.to_string().into()).collect(),
    }
}

impl Topic {
    /// With messages of a type of which only the name is known.
    pub fn of_type(self, name: &'static str) -> Self {
        self.with_schema(name, "jsonschema", "{}")
    }

    pub fn with_schema(
        self,
        name: &'static str,
        encoding: &'static str,
        data: impl Into<Vec<u8>>,
    ) -> Self {
        let data = data.into();
        Self {
            schema: Some(Schema {
                name,
                encoding,
                data,
            }),
            ..self
        }
    }
}

/// The log time of a topic's n-th message.
pub fn time(n: u32) -> u64 {
    1_000_000_000 + 20_000_000 * u64::from(n)
}

/// How much earlier than it was logged each message was published.
pub const LATENCY: u64 = 3_000_000;

/// A log of these topics, one after the other.
pub fn log(topics: &[Topic]) -> Vec<u8> {
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    for topic in topics {
        let schema_id = topic.schema.as_ref().map_or(0, |schema| {
            let Schema {
                name,
                encoding,
                data,
            } = schema;
            writer.add_schema(name, encoding, data).unwrap()
        });
        let channel_id = writer
            .add_channel(schema_id, topic.name, topic.encoding, &BTreeMap::new())
            .unwrap();
        for (sequence, message) in (0..).zip(&topic.messages) {
            let header = MessageHeader {
                channel_id,
                sequence,
                log_time: time(sequence),
                publish_time: time(sequence) - LATENCY,
            };
            let written = writer.write_to_known_channel(&header, message);
            written.unwrap();
        }
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// States of a drone that turns as it flies. A unit of its angles is that many radians.
pub fn states(count: i32, unit: f64) -> impl Iterator<Item = Value> {
    (0..count).map(move |i| {
        let t = f64::from(i) * 0.02;
        let [roll, pitch, yaw] = [0.2 * t.sin(), -0.1 * t.cos(), 0.9 * t].map(|a| a / unit);
        json!({ "roll": roll, "pitch": pitch, "yaw": yaw, "vx": 3.0 + t, "vy": -1.0, "vz": 0.2 })
    })
}

// ---- Telemetry as autopilots write it ----

pub fn twice(name: &'static str, message: Value) -> Topic {
    topic(name, [message.clone(), message])
}

pub fn quaternion() -> Value {
    json!({ "w": 1, "x": 0, "y": 0, "z": 0 })
}

pub fn vector() -> Value {
    json!({ "x": 1, "y": 0, "z": 0 })
}

/// geometry_msgs/PoseStamped
pub fn pose(name: &'static str) -> Topic {
    let pose = json!({ "orientation": quaternion(), "position": vector() });
    twice(name, json!({ "pose": pose })).of_type("geometry_msgs/msg/PoseStamped")
}

pub fn twist(name: &'static str) -> Topic {
    twice(name, json!({ "twist": { "linear": vector() } }))
        .of_type("geometry_msgs/msg/TwistStamped")
}

pub fn odometry(name: &'static str) -> Topic {
    let pose = json!({ "orientation": quaternion(), "position": vector() });
    let twist = json!({ "linear": vector() });
    let message = json!({ "pose": { "pose": pose }, "twist": { "twist": twist } });
    twice(name, message).of_type("nav_msgs/msg/Odometry")
}

/// px4_msgs/VehicleAttitude
pub fn attitude(name: &'static str) -> Topic {
    twice(name, json!({ "q": [1, 0, 0, 0] }))
}

/// px4_msgs/VehicleLocalPosition
pub fn local_position(name: &'static str) -> Topic {
    let flags = json!({ "v_xy_valid": true, "v_z_valid": true });
    let mut message = json!({ "vx": 1, "vy": 0, "vz": 0 });
    message
        .as_object_mut()
        .unwrap()
        .extend(flags.as_object().unwrap().clone());
    twice(name, message)
}

pub fn flat(name: &'static str) -> Topic {
    topic(name, states(2, 1.0))
}
