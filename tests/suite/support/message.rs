//! Messages as readers return them, and derived ones decoded from any encoding.

use std::collections::BTreeMap;

use flightcam::messages::v1;
use mcap::records::MessageHeader;
use prost::Message;
use serde_json::Value;

/// A message as any reader returns it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct ReadMessage {
    pub topic: String,
    /// The message encoding of its channel.
    pub encoding: String,
    pub log_time: u64,
    pub publish_time: u64,
    pub sequence: u32,
    pub payload: Vec<u8>,
}

impl ReadMessage {
    pub fn new(topic: &str, encoding: &str, header: &MessageHeader, payload: &[u8]) -> Self {
        Self {
            topic: topic.to_owned(),
            encoding: encoding.to_owned(),
            log_time: header.log_time,
            publish_time: header.publish_time,
            sequence: header.sequence,
            payload: payload.to_vec(),
        }
    }
}

/// A derived message, decoded from whichever encoding it is in.
#[derive(Debug, Clone, PartialEq)]
pub struct DerivedMessage {
    pub topic: String,
    pub log_time: u64,
    /// The time in the message itself, in nanoseconds.
    pub stamp: u64,
    pub frame_id: String,
    /// Nanoseconds; only a relative rotation has one, and not in ROS 2.
    pub interval: Option<u64>,
    /// Roll, pitch, yaw, or x, y, z.
    pub numbers: [f64; 3],
}

impl DerivedMessage {
    pub fn decode(message: &ReadMessage) -> Self {
        let is_velocity = message.topic == "/camera/velocity";
        let payload = &message.payload[..];
        let (stamp, frame_id, interval, numbers) = match (message.encoding.as_str(), is_velocity) {
            ("protobuf", true) => {
                let decoded = v1::CameraVelocity::decode(payload).expect("a CameraVelocity");
                let stamp = decoded.timestamp.expect("a timestamp");
                let stamp = nanoseconds(stamp.seconds as u64, stamp.nanos as u64);
                (
                    stamp,
                    decoded.frame_id,
                    None,
                    [decoded.x, decoded.y, decoded.z],
                )
            }
            ("protobuf", false) => {
                let decoded = v1::RelativeRpy::decode(payload).expect("a RelativeRpy");
                let stamp = decoded.timestamp.expect("a timestamp");
                let stamp = nanoseconds(stamp.seconds as u64, stamp.nanos as u64);
                let interval = decoded.interval.expect("an interval");
                let interval = nanoseconds(interval.seconds as u64, interval.nanos as u64);
                let numbers = [decoded.roll, decoded.pitch, decoded.yaw];
                (stamp, decoded.frame_id, Some(interval), numbers)
            }
            ("json", _) => json(payload, is_velocity),
            ("cdr", _) => cdr(payload),
            (encoding, _) => panic!("{} is encoded as {encoding}", message.topic),
        };
        Self {
            topic: message.topic.clone(),
            log_time: message.log_time,
            stamp,
            frame_id,
            interval,
            numbers,
        }
    }
}

fn nanoseconds(seconds: u64, beyond: u64) -> u64 {
    assert!(beyond < 1_000_000_000);
    seconds * 1_000_000_000 + beyond
}

type Decoded = (u64, String, Option<u64>, [f64; 3]);

fn json(payload: &[u8], is_velocity: bool) -> Decoded {
    let mut decoded: BTreeMap<String, Value> = serde_json::from_slice(payload).expect("JSON");
    let mut take = |name: &str| decoded.remove(name).unwrap_or_else(|| panic!("no {name}"));
    let time = |time: Value| {
        assert_eq!(time.as_object().expect("an object").len(), 2);
        let part = |name: &str| time[name].as_u64().expect("a whole number");
        nanoseconds(part("sec"), part("nsec"))
    };
    let stamp = time(take("timestamp"));
    let frame_id = take("frame_id").as_str().expect("a string").to_owned();
    let interval = (!is_velocity).then(|| time(take("interval")));
    let names = match is_velocity {
        true => ["x", "y", "z"],
        false => ["roll", "pitch", "yaw"],
    };
    let numbers = names.map(|name| take(name).as_f64().expect("a number"));
    assert!(decoded.is_empty(), "nothing else: {decoded:?}");
    (stamp, frame_id, interval, numbers)
}

/// Reads a `geometry_msgs/msg/Vector3Stamped`, offset by offset.
fn cdr(payload: &[u8]) -> Decoded {
    let (header, content) = payload.split_first_chunk().expect("a header");
    assert_eq!(header, &[0, 1, 0, 0], "CDR, little-endian");
    let word = |at: usize| u32::from_le_bytes(content[at..at + 4].try_into().expect("4 bytes"));
    assert!(word(0) <= i32::MAX as u32);
    let stamp = nanoseconds(word(0).into(), word(4).into());
    let end = 12 + word(8) as usize;
    let (end_mark, frame_id) = content[12..end].split_last().expect("a 0 at least");
    assert_eq!(*end_mark, 0);
    let vector = end.div_ceil(8) * 8;
    assert!(content[end..vector].iter().all(|&padding| padding == 0));
    assert_eq!(content.len(), vector + 24);
    let numbers = [0, 8, 16].map(|offset| {
        let at = vector + offset;
        f64::from_le_bytes(content[at..at + 8].try_into().expect("8 bytes"))
    });
    let frame_id = String::from_utf8(frame_id.to_vec()).expect("UTF-8");
    (stamp, frame_id, None, numbers)
}
