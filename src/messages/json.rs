//! JSON: the fields of the protobuf messages, with JSON Schemas from `schemas/`.

use serde::Serialize;

use super::{Schema, components, split_seconds};
use crate::derived::{Derived, Quantity, Value};

pub(super) fn schema(quantity: Quantity) -> Schema {
    let (name, data): (_, &[u8]) = match quantity {
        Quantity::RelativeRpy => (
            "flightcam.v1.RelativeRpy",
            include_bytes!("../../schemas/flightcam.v1.RelativeRpy.json"),
        ),
        Quantity::CameraVelocity => (
            "flightcam.v1.CameraVelocity",
            include_bytes!("../../schemas/flightcam.v1.CameraVelocity.json"),
        ),
    };
    Schema {
        name,
        encoding: "jsonschema",
        data,
    }
}

#[derive(Serialize)]
struct Message {
    timestamp: Time,
    frame_id: &'static str,
    #[serde(flatten)]
    content: Content,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Content {
    RelativeRpy {
        interval: Time,
        roll: f64,
        pitch: f64,
        yaw: f64,
    },
    CameraVelocity {
        x: f64,
        y: f64,
        z: f64,
    },
}

/// A time or a duration, in Foxglove's convention.
#[derive(Serialize)]
struct Time {
    sec: u64,
    nsec: u32,
}

impl Time {
    fn new(nanoseconds: u64) -> Self {
        let (sec, nsec) = split_seconds(nanoseconds);
        Self { sec, nsec }
    }
}

/// Numbers are written with as many digits as it takes to read the same number again.
pub(super) fn encode(derived: &Derived, out: &mut Vec<u8>) {
    let [a, b, c] = components(&derived.value);
    let message = Message {
        timestamp: Time::new(derived.stamp.log_time),
        frame_id: derived.quantity().frame_id(),
        content: match derived.value {
            Value::RelativeRpy { interval, .. } => Content::RelativeRpy {
                interval: Time::new(interval),
                roll: a,
                pitch: b,
                yaw: c,
            },
            Value::CameraVelocity(_) => Content::CameraVelocity { x: a, y: b, z: c },
        },
    };
    serde_json::to_writer(out, &message).expect("a vector grows as needed");
}
