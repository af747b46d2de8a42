//! Numbers in the units that people read: `/camera/display`.

use serde::Serialize;

use super::super::{
    Encoding, Format, MessageDefinition, cdr::Cdr, json, numbers::without_negative_zero, protobuf,
    ros2, v1,
};
use crate::derived::visual::{Display, Frame};

const NAME: &str = "flightcam.v1.CameraDisplay";

/// It has no steps.
const FIELD_TO_PLOT: Option<&str> = Some("heading_unwrapped");

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!(concat!(env!("OUT_DIR"), "/camera_display.bin")),
            FIELD_TO_PLOT,
        ),
        Encoding::Json => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!("../../../schemas/flightcam.v1.CameraDisplay.json"),
            FIELD_TO_PLOT,
        ),
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "flightcam_msgs/msg/CameraDisplay",
            include_bytes!("../../../schemas/flightcam_msgs.CameraDisplay.msg"),
            FIELD_TO_PLOT,
        ),
    }
}

/// A number that is not known is absent in protobuf and JSON, and NaN in ROS 2, where every field has a value.
pub fn encode(format: &Format, time: u64, display: &Display, out: &mut Vec<u8>) {
    let numbers = Numbers::new(display);
    match format.encoding {
        Encoding::Protobuf => protobuf::write(&numbers.into_message(time), out),
        Encoding::Json => {
            let timestamp = json::Time::new(time);
            json::write(&JsonMessage { timestamp, numbers }, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_header(&mut cdr, format.header(time, Frame::Camera));
            numbers.put(&mut cdr);
        }
    }
}

#[derive(Serialize)]
struct JsonMessage {
    timestamp: json::Time,
    #[serde(flatten)]
    numbers: Numbers,
}

/// The fields of a message, without negative zeros.
#[derive(Serialize)]
struct Numbers {
    heading: f32,
    heading_unwrapped: f32,
    tilt: f32,
    roll: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    roll_rate: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pitch_rate: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    yaw_rate: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ground_speed: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    climb: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<f32>,
}

impl Numbers {
    fn new(display: &Display) -> Self {
        let rate = |axis: usize| {
            let rates = display.rates?;
            Some(without_negative_zero(rates[axis]))
        };
        Self {
            heading: without_negative_zero(display.heading),
            heading_unwrapped: without_negative_zero(display.heading_unwrapped),
            tilt: without_negative_zero(display.tilt),
            roll: without_negative_zero(display.roll),
            roll_rate: rate(0),
            pitch_rate: rate(1),
            yaw_rate: rate(2),
            speed: display.speed.map(without_negative_zero),
            ground_speed: display.ground_speed.map(without_negative_zero),
            climb: display.climb.map(without_negative_zero),
            height: display.height.map(without_negative_zero),
        }
    }

    fn into_message(self, time: u64) -> v1::CameraDisplay {
        v1::CameraDisplay {
            timestamp: Some(protobuf::timestamp(time)),
            heading: self.heading,
            heading_unwrapped: self.heading_unwrapped,
            tilt: self.tilt,
            roll: self.roll,
            roll_rate: self.roll_rate,
            pitch_rate: self.pitch_rate,
            yaw_rate: self.yaw_rate,
            speed: self.speed,
            ground_speed: self.ground_speed,
            climb: self.climb,
            height: self.height,
        }
    }

    fn put(self, cdr: &mut Cdr) {
        for number in [self.heading, self.heading_unwrapped, self.tilt, self.roll] {
            cdr.put(number.to_le_bytes());
        }
        for number in [
            self.roll_rate,
            self.pitch_rate,
            self.yaw_rate,
            self.speed,
            self.ground_speed,
            self.climb,
            self.height,
        ] {
            cdr.put(number.unwrap_or(f32::NAN).to_le_bytes());
        }
    }
}
