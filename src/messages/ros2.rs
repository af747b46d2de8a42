//! ROS 2: `geometry_msgs/msg/Vector3Stamped` in CDR.

use std::collections::BTreeMap;

use mcap::records::Channel;

use super::{Schema, components, split_seconds};
use crate::derived::Derived;

/// The definitions are those of ROS 2's `common_interfaces` and `rcl_interfaces`, joined as rosbag2 does.
pub(super) const SCHEMA: Schema = Schema {
    name: "geometry_msgs/msg/Vector3Stamped",
    encoding: "ros2msg",
    data: include_bytes!("../../schemas/geometry_msgs.Vector3Stamped.msg"),
};

/// The last second since 1970 that `builtin_interfaces/Time` can say, in January 2038. The stamp of a message
/// later than that is the last nanosecond of it; its log time is right all the same.
pub const LAST_SECOND: u64 = i32::MAX as u64;

/// The metadata that MCAP's ROS 2 profile asks of a channel: with which qualities of service it is played
/// back. It is the telemetry's, so that who receives that receives this; if it has none, ROS 2's default.
pub(super) fn channel_metadata(telemetry: &Channel) -> BTreeMap<String, String> {
    const QOS: &str = "offered_qos_profiles";
    let qos = telemetry.metadata.get(QOS).cloned().unwrap_or_default();
    BTreeMap::from([(QOS.to_owned(), qos)])
}

pub(super) fn encode(derived: &Derived, out: &mut Vec<u8>) {
    let (seconds, nanoseconds) = match split_seconds(derived.stamp.log_time) {
        (seconds, _) if seconds > LAST_SECOND => (LAST_SECOND, 999_999_999),
        time => time,
    };
    let mut cdr = Cdr::begin(out);
    cdr.put((seconds as i32).to_le_bytes());
    cdr.put(nanoseconds.to_le_bytes());
    cdr.put_string(derived.quantity().frame_id());
    for component in components(&derived.value) {
        cdr.put(component.to_le_bytes());
    }
}

/// Writes plain CDR, little-endian.
struct Cdr<'a> {
    out: &'a mut Vec<u8>,
    /// Where the content begins. Alignment counts from there.
    origin: usize,
}

impl<'a> Cdr<'a> {
    fn begin(out: &'a mut Vec<u8>) -> Self {
        /// The representation, CDR_LE, and its options, of which there are none.
        const HEADER: [u8; 4] = [0, 1, 0, 0];
        out.extend(HEADER);
        let origin = out.len();
        Self { out, origin }
    }

    /// A number, aligned to its size.
    fn put<const SIZE: usize>(&mut self, number: [u8; SIZE]) {
        let length = self.out.len() - self.origin;
        let aligned = self.origin + length.next_multiple_of(SIZE);
        self.out.resize(aligned, 0);
        self.out.extend(number);
    }

    /// A string with its length before it and a 0 behind it, which the length includes.
    fn put_string(&mut self, text: &str) {
        self.put((text.len() as u32 + 1).to_le_bytes());
        self.out.extend(text.as_bytes());
        self.out.push(0);
    }
}
