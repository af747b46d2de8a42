//! The drone's velocity over ground in the axes of the camera: `/camera/velocity`.

use nalgebra::Vector3;
use serde::Serialize;

use super::{
    Encoding, Header, MessageDefinition, json, numbers::without_negative_zeros, protobuf, v1,
    vector3_stamped,
};

const NAME: &str = "flightcam.v1.CameraVelocity";

/// The velocity along the optical axis.
const FIELD_TO_PLOT: Option<&str> = Some("x");

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!(concat!(env!("OUT_DIR"), "/camera_velocity.bin")),
            FIELD_TO_PLOT,
        ),
        Encoding::Json => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!("../../schemas/flightcam.v1.CameraVelocity.json"),
            FIELD_TO_PLOT,
        ),
        Encoding::Ros2 => vector3_stamped::definition("vector.x"),
    }
}

pub fn encode(encoding: Encoding, header: Header, velocity: Vector3<f64>, out: &mut Vec<u8>) {
    let [x, y, z] = without_negative_zeros(velocity.into());
    match encoding {
        Encoding::Protobuf => {
            let message = v1::CameraVelocity {
                timestamp: Some(protobuf::timestamp(header.time)),
                frame_id: header.frame_id.to_owned(),
                x,
                y,
                z,
            };
            protobuf::write(&message, out);
        }
        Encoding::Json => {
            let message = JsonMessage {
                timestamp: json::Time::new(header.time),
                frame_id: header.frame_id,
                x,
                y,
                z,
            };
            json::write(&message, out);
        }
        Encoding::Ros2 => vector3_stamped::write(header, [x, y, z], out),
    }
}

#[derive(Serialize)]
struct JsonMessage {
    timestamp: json::Time,
    frame_id: &'static str,
    x: f64,
    y: f64,
    z: f64,
}
