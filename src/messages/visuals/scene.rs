//! Things to draw in 3D: `/camera/model`, `/camera/scene` and `/camera/path`.

mod markers;
mod update;

use foxglove::messages::SceneUpdate;

use super::{
    super::{Encoding, Format, MessageDefinition, protobuf},
    to_foxglove,
};
use crate::derived::visual::Scene;

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            to_foxglove::definition::<SceneUpdate>("foxglove.SceneUpdate", None)
        }
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "visualization_msgs/msg/MarkerArray",
            include_bytes!("../../../schemas/visualization_msgs.MarkerArray.msg"),
            None,
        ),
    }
}

pub fn encode(format: &Format, time: u64, scene: &Scene, out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            protobuf::write(&update::scene_update(format, time, scene), out);
        }
        Encoding::Ros2 => markers::write(format, time, scene, out),
    }
}
