//! Messages as readers return them, and derived ones decoded from any encoding.

use std::collections::BTreeMap;

use flightcam::messages::v1;
use mcap::records::MessageHeader;
use prost::Message;
use prost_types::Timestamp;
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
    /// Of a relative rotation roll, pitch, yaw; of a velocity x, y, z; of an orientation the quaternion's x, y, z, w and,
    /// but in ROS 2, roll, pitch, yaw.
    pub numbers: Vec<f64>,
}

impl DerivedMessage {
    pub fn decode(message: &ReadMessage) -> Self {
        let payload = &message.payload[..];
        let topic = message.topic.as_str();
        let (stamp, frame_id, interval, numbers) = match (message.encoding.as_str(), topic) {
            ("protobuf", "/camera/relative_rpy") => {
                let decoded = v1::RelativeRpy::decode(payload).expect("a RelativeRpy");
                let interval = decoded.interval.expect("an interval");
                let interval = nanoseconds(interval.seconds as u64, interval.nanos as u64);
                let numbers = vec![decoded.roll, decoded.pitch, decoded.yaw];
                let stamp = protobuf_stamp(decoded.timestamp);
                (stamp, decoded.frame_id, Some(interval), numbers)
            }
            ("protobuf", "/camera/orientation") => {
                let decoded = v1::CameraOrientation::decode(payload).expect("a CameraOrientation");
                let q = decoded.quaternion.expect("a quaternion");
                let angles = [decoded.roll, decoded.pitch, decoded.yaw];
                let numbers = [&[q.x, q.y, q.z, q.w][..], &angles].concat();
                let stamp = protobuf_stamp(decoded.timestamp);
                (stamp, decoded.frame_id, None, numbers)
            }
            ("protobuf", "/camera/velocity") => {
                let decoded = v1::CameraVelocity::decode(payload).expect("a CameraVelocity");
                let numbers = vec![decoded.x, decoded.y, decoded.z];
                let stamp = protobuf_stamp(decoded.timestamp);
                (stamp, decoded.frame_id, None, numbers)
            }
            ("json", topic) => json(payload, topic),
            ("cdr", "/camera/orientation") => cdr(payload, 4),
            ("cdr", _) => cdr(payload, 3),
            (encoding, topic) => panic!("{topic} is encoded as {encoding}"),
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

    /// The numbers of a message that has three.
    #[track_caller]
    pub fn triple(&self) -> [f64; 3] {
        let numbers = self.numbers[..].try_into();
        numbers.unwrap_or_else(|_| panic!("three numbers in {self:?}"))
    }
}

fn nanoseconds(seconds: u64, beyond: u64) -> u64 {
    assert!(beyond < 1_000_000_000);
    seconds * 1_000_000_000 + beyond
}

fn protobuf_stamp(timestamp: Option<Timestamp>) -> u64 {
    let timestamp = timestamp.expect("a timestamp");
    nanoseconds(timestamp.seconds as u64, timestamp.nanos as u64)
}

type Decoded = (u64, String, Option<u64>, Vec<f64>);

fn json(payload: &[u8], topic: &str) -> Decoded {
    let mut decoded: BTreeMap<String, Value> = serde_json::from_slice(payload).expect("JSON");
    let mut take = |name: &str| decoded.remove(name).unwrap_or_else(|| panic!("no {name}"));
    let time = |time: Value| {
        assert_eq!(time.as_object().expect("an object").len(), 2);
        let part = |name: &str| time[name].as_u64().expect("a whole number");
        nanoseconds(part("sec"), part("nsec"))
    };
    let number = |number: &Value| number.as_f64().expect("a number");
    let stamp = time(take("timestamp"));
    let frame_id = take("frame_id").as_str().expect("a string").to_owned();
    let interval = (topic == "/camera/relative_rpy").then(|| time(take("interval")));
    let mut numbers = Vec::new();
    if topic == "/camera/orientation" {
        let quaternion = take("quaternion");
        assert_eq!(quaternion.as_object().expect("an object").len(), 4);
        numbers.extend(["x", "y", "z", "w"].map(|name| number(&quaternion[name])));
    }
    let names = match topic {
        "/camera/velocity" => ["x", "y", "z"],
        _ => ["roll", "pitch", "yaw"],
    };
    numbers.extend(names.map(|name| number(&take(name))));
    assert!(decoded.is_empty(), "nothing else: {decoded:?}");
    (stamp, frame_id, interval, numbers)
}

/// Reads a `geometry_msgs/msg/Vector3Stamped` of three numbers, or a `QuaternionStamped` of four, offset by offset.
fn cdr(payload: &[u8], count: usize) -> Decoded {
    let (header, content) = payload.split_first_chunk().expect("a header");
    assert_eq!(header, &[0, 1, 0, 0], "CDR, little-endian");
    let word = |at: usize| u32::from_le_bytes(content[at..at + 4].try_into().expect("4 bytes"));
    assert!(word(0) <= i32::MAX as u32);
    let stamp = nanoseconds(word(0).into(), word(4).into());
    let end = 12 + word(8) as usize;
    let (end_mark, frame_id) = content[12..end].split_last().expect("a 0 at least");
    assert_eq!(*end_mark, 0);
    let first = end.div_ceil(8) * 8;
    assert!(content[end..first].iter().all(|&padding| padding == 0));
    let (numbers, rest) = content[first..].as_chunks();
    assert_eq!((numbers.len(), rest.len()), (count, 0));
    let numbers = numbers.iter().map(|&bytes| f64::from_le_bytes(bytes));
    let frame_id = String::from_utf8(frame_id.to_vec()).expect("UTF-8");
    (stamp, frame_id, None, numbers.collect())
}
