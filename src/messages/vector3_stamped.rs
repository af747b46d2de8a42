//! ROS 2's `geometry_msgs/msg/Vector3Stamped`: three numbers, a time and a frame.

use super::{Encoding, Header, MessageDefinition, cdr::Cdr, ros2};

/// The definitions are those of ROS 2's `common_interfaces` and `rcl_interfaces`, joined as rosbag2 does.
pub fn definition(field_to_plot: &'static str) -> MessageDefinition {
    MessageDefinition::new(
        Encoding::Ros2,
        "geometry_msgs/msg/Vector3Stamped",
        include_bytes!("../../schemas/geometry_msgs.Vector3Stamped.msg"),
        Some(field_to_plot),
    )
}

#[inline]
pub fn write(header: Header, vector: [f64; 3], out: &mut Vec<u8>) {
    let mut cdr = Cdr::begin(out);
    ros2::put_header(&mut cdr, header);
    for component in vector {
        cdr.put(component.to_le_bytes());
    }
}
