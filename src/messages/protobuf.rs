//! What the protobuf messages of `proto/` have in common.

use prost::Message;

use super::numbers::split_seconds;

pub fn write(message: &impl Message, out: &mut Vec<u8>) {
    message.encode(out).expect("a vector grows as needed");
}

// Both numbers fit: they are smaller than `u64::MAX` / 1e9 and 1e9.

pub fn timestamp(nanoseconds: u64) -> prost_types::Timestamp {
    let (seconds, nanos) = split_seconds(nanoseconds);
    prost_types::Timestamp {
        seconds: seconds as i64,
        nanos: nanos as i32,
    }
}

pub fn duration(nanoseconds: u64) -> prost_types::Duration {
    let (seconds, nanos) = split_seconds(nanoseconds);
    prost_types::Duration {
        seconds: seconds as i64,
        nanos: nanos as i32,
    }
}
