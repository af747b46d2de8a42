//! What ROS 2 messages have in common, whatever their type.

use mcap::records::Channel;

use super::{Header, cdr::Cdr, numbers::split_seconds};

/// The last second since 1970 that fits in `builtin_interfaces/Time`, in January 2038. The stamp of a later message is
/// clamped to the last nanosecond of it; its log time is still right.
pub const LAST_SECOND: u64 = i32::MAX as u64;

/// The key of the quality-of-service settings for playback in channel metadata. MCAP's ROS 2 profile requires it.
pub const QUALITY_OF_SERVICE: &str = "offered_qos_profiles";

/// The default settings: reliable and volatile. What viewers are shown has them, whatever the telemetry has, because
/// tf2 and rviz receive nothing from a publisher that is only best effort.
///
/// Source: <https://github.com/ros2/geometry2/blob/1b005c65/tf2_ros/include/tf2_ros/qos.hpp>
pub const DEFAULT: &str = "";

/// The settings of what is written once: reliable and transient local, so that a node that subscribes later in a
/// playback still receives it. The values are numbers, as up to version 8 of rosbag2's metadata, because all versions
/// of rosbag2 read them.
///
/// Source: <https://github.com/ros2/rosbag2/blob/25304dd3/rosbag2_storage/src/rosbag2_storage/qos.cpp>
pub const KEPT_FOR_LATE_SUBSCRIBERS: &str = "\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: 1
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false";

/// Writes a `std_msgs/Header`.
#[inline]
pub fn put_header(cdr: &mut Cdr, header: Header) {
    put_stamp(cdr, header.time);
    cdr.put_string(header.frame_id);
}

/// Writes a `builtin_interfaces/Time`.
#[inline]
pub fn put_stamp(cdr: &mut Cdr, time: u64) {
    let (seconds, nanoseconds) = match split_seconds(time) {
        (seconds, _) if seconds > LAST_SECOND => (LAST_SECOND, 999_999_999),
        time => time,
    };
    cdr.put((seconds as i32).to_le_bytes());
    cdr.put(nanoseconds.to_le_bytes());
}

/// The settings of the telemetry, so that a node that receives it receives the camera's motion, too.
pub fn quality_of_service(telemetry: &Channel) -> String {
    let settings = telemetry.metadata.get(QUALITY_OF_SERVICE);
    settings.cloned().unwrap_or_else(|| DEFAULT.to_owned())
}
