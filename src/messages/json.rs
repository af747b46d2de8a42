//! What the JSON messages of `schemas/` have in common.

use serde::Serialize;

use super::numbers::split_seconds;

/// Writes a message. Its numbers have enough digits to be read back exactly.
pub fn write(message: &impl Serialize, out: &mut Vec<u8>) {
    serde_json::to_writer(out, message).expect("a vector grows as needed");
}

/// A time or a duration, in Foxglove's convention.
#[derive(Serialize)]
pub struct Time {
    sec: u64,
    nsec: u32,
}

impl Time {
    pub fn new(nanoseconds: u64) -> Self {
        let (sec, nsec) = split_seconds(nanoseconds);
        Self { sec, nsec }
    }
}
