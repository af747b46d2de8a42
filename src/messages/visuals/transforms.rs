//! Where frames are in their parents: `/camera/transforms` and `/camera/transforms_static`, or `/tf` and `/tf_static`.

use foxglove::messages::{FrameTransform, FrameTransforms};

use super::{
    super::{Encoding, Format, MessageDefinition, cdr::Cdr, protobuf, ros2},
    to_foxglove, to_ros2,
};
use crate::derived::visual::Transform;

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            to_foxglove::definition::<FrameTransforms>("foxglove.FrameTransforms", None)
        }
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "tf2_msgs/msg/TFMessage",
            include_bytes!("../../../schemas/tf2_msgs.TFMessage.msg"),
            None,
        ),
    }
}

pub fn encode(format: &Format, time: u64, transforms: &[Transform], out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            let frame_transform = |transform: &Transform| FrameTransform {
                timestamp: Some(to_foxglove::timestamp(time)),
                parent_frame_id: format.frame_id(transform.parent).to_owned(),
                child_frame_id: format.frame_id(transform.child).to_owned(),
                translation: Some(to_foxglove::vector(transform.pose.position)),
                rotation: Some(to_foxglove::quaternion(&transform.pose.orientation)),
            };
            let message = FrameTransforms {
                transforms: transforms.iter().map(frame_transform).collect(),
            };
            protobuf::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            cdr.put_length(transforms.len());
            for transform in transforms {
                ros2::put_header(&mut cdr, format.header(time, transform.parent));
                cdr.put_string(format.frame_id(transform.child));
                to_ros2::put_pose(&mut cdr, &transform.pose);
            }
        }
    }
}
