//! What ROS 2 messages have in common, whatever their type.

use std::collections::BTreeMap;

use mcap::records::Channel;

use super::{Header, cdr::Cdr, numbers::split_seconds};

pub const SCHEMA_ENCODING: &str = "ros2msg";

/// The last second since 1970 that fits in `builtin_interfaces/Time`, in January 2038. The stamp of a later message is
/// clamped to the last nanosecond of it; its log time is still right.
pub const LAST_SECOND: u64 = i32::MAX as u64;

/// Writes a `std_msgs/Header`.
#[inline]
pub fn put_header(cdr: &mut Cdr, header: Header) {
    let (seconds, nanoseconds) = match split_seconds(header.time) {
        (seconds, _) if seconds > LAST_SECOND => (LAST_SECOND, 999_999_999),
        time => time,
    };
    cdr.put((seconds as i32).to_le_bytes());
    cdr.put(nanoseconds.to_le_bytes());
    cdr.put_string(header.frame_id);
}

/// The channel metadata that MCAP's ROS 2 profile requires: the quality-of-service settings for playback. They are the
/// telemetry's, so that a node that receives one receives the other; if it has none, they are ROS 2's default.
pub fn channel_metadata(telemetry: &Channel) -> BTreeMap<String, String> {
    const QOS: &str = "offered_qos_profiles";
    let qos = telemetry.metadata.get(QOS).cloned().unwrap_or_default();
    BTreeMap::from([(QOS.to_owned(), qos)])
}
