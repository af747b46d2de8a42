//! What all pictures cover on the ground: `/camera/footprint`.

use foxglove::messages::GeoJson;

use super::{
    super::{Encoding, Format, MessageDefinition, cdr::Cdr, protobuf},
    to_foxglove,
};
use crate::derived::visual::Footprint;

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            to_foxglove::definition::<GeoJson>("foxglove.GeoJSON", None)
        }
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "foxglove_msgs/msg/GeoJSON",
            include_bytes!("../../../schemas/foxglove_msgs.GeoJSON.msg"),
            None,
        ),
    }
}

pub fn encode(format: &Format, footprint: &Footprint, out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            let message = GeoJson {
                geojson: footprint.geojson.clone(),
            };
            protobuf::write(&message, out);
        }
        Encoding::Ros2 => Cdr::begin(out).put_string(&footprint.geojson),
    }
}
