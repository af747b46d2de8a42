//! Whether everything that is shown is known: `/camera/state`.

use serde::Serialize;

use super::super::{Encoding, Format, MessageDefinition, cdr::Cdr, json, protobuf, ros2, v1};
use crate::derived::visual::{Frame, State};

const NAME: &str = "flightcam.v1.CameraState";

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!(concat!(env!("OUT_DIR"), "/camera_state.bin")),
            None,
        ),
        Encoding::Json => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!("../../../schemas/flightcam.v1.CameraState.json"),
            None,
        ),
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "flightcam_msgs/msg/CameraState",
            include_bytes!("../../../schemas/flightcam_msgs.CameraState.msg"),
            None,
        ),
    }
}

pub fn encode(format: &Format, time: u64, state: State, out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf => {
            let message = v1::CameraState {
                timestamp: Some(protobuf::timestamp(time)),
                state: state.name.to_owned(),
            };
            protobuf::write(&message, out);
        }
        Encoding::Json => {
            let message = JsonMessage {
                timestamp: json::Time::new(time),
                state: state.name,
            };
            json::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_header(&mut cdr, format.header(time, Frame::Camera));
            cdr.put_string(state.name);
        }
    }
}

#[derive(Serialize)]
struct JsonMessage {
    timestamp: json::Time,
    state: &'static str,
}
