//! Where the camera is: `/camera/pose`.

use foxglove::messages::PoseInFrame;

use super::{
    super::{Encoding, Format, MessageDefinition, cdr::Cdr, protobuf, ros2},
    to_foxglove, to_ros2,
};
use crate::derived::visual::{Frame, Pose};

const FIELD_TO_PLOT: Option<&str> = Some("pose.position.z");

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            to_foxglove::definition::<PoseInFrame>("foxglove.PoseInFrame", FIELD_TO_PLOT)
        }
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "geometry_msgs/msg/PoseStamped",
            include_bytes!("../../../schemas/geometry_msgs.PoseStamped.msg"),
            FIELD_TO_PLOT,
        ),
    }
}

pub fn encode(format: &Format, time: u64, pose: &Pose, out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            let message = PoseInFrame {
                timestamp: Some(to_foxglove::timestamp(time)),
                frame_id: format.frame_id(Frame::Map).to_owned(),
                pose: Some(to_foxglove::pose(pose)),
            };
            protobuf::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_header(&mut cdr, format.header(time, Frame::Map));
            to_ros2::put_pose(&mut cdr, pose);
        }
    }
}
