//! The camera's frames: noise, because a JPEG image or an H.264 frame does not compress any further either.

/// A frame, as compressed_image.proto describes it.
#[derive(Clone, PartialEq, prost::Message)]
pub struct CompressedImage {
    #[prost(message, optional, tag = "1")]
    timestamp: Option<prost_types::Timestamp>,
    #[prost(bytes = "vec", tag = "2")]
    data: Vec<u8>,
    #[prost(string, tag = "3")]
    format: String,
    #[prost(string, tag = "4")]
    frame_id: String,
}

impl CompressedImage {
    /// The frame with this number, from 0, taken at this time and of this size.
    pub fn new(number: u64, timestamp: prost_types::Timestamp, bytes: usize) -> Self {
        Self {
            timestamp: Some(timestamp),
            data: noise(number, bytes),
            format: "jpeg".to_owned(),
            frame_id: "camera".to_owned(),
        }
    }
}

/// So many bytes that look random, others for each seed (SplitMix64).
fn noise(seed: u64, bytes: usize) -> Vec<u8> {
    // The seeds' sequences begin 2^32 numbers apart, so that no two frames share any.
    let mut state = (seed << 32).wrapping_mul(STEP);
    let mut data = vec![0; bytes.next_multiple_of(8)];
    for word in data.chunks_exact_mut(8) {
        state = state.wrapping_add(STEP);
        let mut mixed = state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        word.copy_from_slice(&(mixed ^ (mixed >> 31)).to_le_bytes());
    }
    data.truncate(bytes);
    data
}

/// SplitMix64's step, 2^64 divided by the golden ratio.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;
