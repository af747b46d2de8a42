//! How the camera turned between two attitude samples: `/camera/relative_rpy`.

use serde::Serialize;

use super::{
    Encoding, Header, MessageDefinition, json, numbers::without_negative_zeros, protobuf, v1,
    vector3_stamped,
};
use crate::geometry::RollPitchYaw;

const NAME: &str = "flightcam.v1.RelativeRpy";

/// Cameras turn mostly in yaw.
const FIELD_TO_PLOT: Option<&str> = Some("yaw");

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!(concat!(env!("OUT_DIR"), "/relative_rpy.bin")),
            FIELD_TO_PLOT,
        ),
        Encoding::Json => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!("../../schemas/flightcam.v1.RelativeRpy.json"),
            FIELD_TO_PLOT,
        ),
        Encoding::Ros2 => vector3_stamped::definition("vector.z"),
    }
}

/// In ROS 2 roll, pitch and yaw are x, y and z of a vector, and there is no place for the interval.
pub fn encode(
    encoding: Encoding,
    header: Header,
    interval: u64,
    rpy: RollPitchYaw,
    out: &mut Vec<u8>,
) {
    let [roll, pitch, yaw] = without_negative_zeros([rpy.roll, rpy.pitch, rpy.yaw]);
    match encoding {
        Encoding::Protobuf => {
            let message = v1::RelativeRpy {
                timestamp: Some(protobuf::timestamp(header.time)),
                frame_id: header.frame_id.to_owned(),
                interval: Some(protobuf::duration(interval)),
                roll,
                pitch,
                yaw,
            };
            protobuf::write(&message, out);
        }
        Encoding::Json => {
            let message = JsonMessage {
                timestamp: json::Time::new(header.time),
                frame_id: header.frame_id,
                interval: json::Time::new(interval),
                roll,
                pitch,
                yaw,
            };
            json::write(&message, out);
        }
        Encoding::Ros2 => vector3_stamped::write(header, [roll, pitch, yaw], out),
    }
}

#[derive(Serialize)]
struct JsonMessage {
    timestamp: json::Time,
    frame_id: &'static str,
    interval: json::Time,
    roll: f64,
    pitch: f64,
    yaw: f64,
}
