//! The messages that the program defines, generated from `proto/`, and their schemas.

/// Version 1 of the messages.
pub mod v1 {
    include!(concat!(env!("OUT_DIR"), "/flightcam.v1.rs"));
}

use crate::derived::Quantity;

/// A protobuf message type, as a channel names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schema {
    /// The message's full name.
    pub name: &'static str,
    /// A serialised `FileDescriptorSet` of the message's file and all that it imports.
    pub descriptors: &'static [u8],
}

/// The message type that a quantity is written as.
pub fn schema(quantity: Quantity) -> Schema {
    match quantity {
        Quantity::RelativeRpy => Schema {
            name: "flightcam.v1.RelativeRpy",
            descriptors: include_bytes!(concat!(env!("OUT_DIR"), "/relative_rpy.bin")),
        },
        Quantity::CameraVelocity => Schema {
            name: "flightcam.v1.CameraVelocity",
            descriptors: include_bytes!(concat!(env!("OUT_DIR"), "/camera_velocity.bin")),
        },
    }
}
