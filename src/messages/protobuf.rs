//! Protobuf: the messages of `proto/`.

use prost::Message;

use super::{Schema, components, split_seconds, v1};
use crate::derived::{Derived, Quantity, Value};

/// The definition is a serialised `FileDescriptorSet` of the message's file and all that it imports.
pub(super) fn schema(quantity: Quantity) -> Schema {
    let (name, data): (_, &[u8]) = match quantity {
        Quantity::RelativeRpy => (
            "flightcam.v1.RelativeRpy",
            include_bytes!(concat!(env!("OUT_DIR"), "/relative_rpy.bin")),
        ),
        Quantity::CameraVelocity => (
            "flightcam.v1.CameraVelocity",
            include_bytes!(concat!(env!("OUT_DIR"), "/camera_velocity.bin")),
        ),
    };
    Schema {
        name,
        encoding: "protobuf",
        data,
    }
}

pub(super) fn encode(derived: &Derived, out: &mut Vec<u8>) {
    let timestamp = Some(timestamp(derived.stamp.log_time));
    let frame_id = derived.quantity().frame_id().to_owned();
    let [a, b, c] = components(&derived.value);
    let encoded = match derived.value {
        Value::RelativeRpy { interval, .. } => v1::RelativeRpy {
            timestamp,
            frame_id,
            interval: Some(duration(interval)),
            roll: a,
            pitch: b,
            yaw: c,
        }
        .encode(out),
        Value::CameraVelocity(_) => v1::CameraVelocity {
            timestamp,
            frame_id,
            x: a,
            y: b,
            z: c,
        }
        .encode(out),
    };
    encoded.expect("a vector grows as needed");
}

// Both numbers fit: they are smaller than `u64::MAX` / 1e9 and 1e9.

fn timestamp(nanoseconds: u64) -> prost_types::Timestamp {
    let (seconds, nanos) = split_seconds(nanoseconds);
    prost_types::Timestamp {
        seconds: seconds as i64,
        nanos: nanos as i32,
    }
}

fn duration(nanoseconds: u64) -> prost_types::Duration {
    let (seconds, nanos) = split_seconds(nanoseconds);
    prost_types::Duration {
        seconds: seconds as i64,
        nanos: nanos as i32,
    }
}
