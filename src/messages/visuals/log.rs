//! Something that happened, as a line of a log: `/camera/log`.

use foxglove::messages::{Log, log::Level};

use super::{
    super::{Encoding, MessageDefinition, protobuf},
    to_foxglove,
};
use crate::derived::visual::Event;

/// The name under which lines are written.
pub const NAME: &str = "flightcam";

/// `None` in ROS 2, where the events themselves are lines of a log.
pub fn definition(encoding: Encoding) -> Option<MessageDefinition> {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            Some(to_foxglove::definition::<Log>("foxglove.Log", None))
        }
        Encoding::Ros2 => None,
    }
}

pub fn encode(time: u64, event: &Event, out: &mut Vec<u8>) {
    let message = Log {
        timestamp: Some(to_foxglove::timestamp(time)),
        level: Level::Warning.into(),
        message: event.text.clone(),
        name: NAME.to_owned(),
        file: String::new(),
        line: 0,
    };
    protobuf::write(&message, out);
}
