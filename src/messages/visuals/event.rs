//! Something that happened: `/camera/events`.

use foxglove::messages;

use super::{
    super::{Encoding, Format, MessageDefinition, cdr::Cdr, protobuf, ros2},
    log, to_foxglove,
};
use crate::derived::visual::Event;

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            to_foxglove::definition::<messages::Event>("foxglove.Event", None)
        }
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "rcl_interfaces/msg/Log",
            include_bytes!("../../../schemas/rcl_interfaces.Log.msg"),
            None,
        ),
    }
}

/// ROS 2 has no type for events, so there it is a line of a log, without its kind and its end.
pub fn encode(format: &Format, time: u64, event: &Event, out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            let message = messages::Event {
                start_time: Some(to_foxglove::timestamp(time)),
                end_time: Some(to_foxglove::timestamp(event.end)),
                metadata: vec![
                    to_foxglove::key_value("kind", event.kind),
                    to_foxglove::key_value("text", &event.text),
                ],
            };
            protobuf::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_stamp(&mut cdr, time);
            cdr.put(WARN.to_le_bytes());
            cdr.put_string(log::NAME);
            cdr.put_string(&event.text);
            // The file, the function and the line that wrote it.
            cdr.put_string("");
            cdr.put_string("");
            cdr.put(0_u32.to_le_bytes());
        }
    }
}

/// A constant of `rcl_interfaces/Log`.
const WARN: u8 = 30;
