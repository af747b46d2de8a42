//! Times as all encodings write them.

/// Splits a time into whole seconds and the nanoseconds beyond them.
pub fn split_seconds(nanoseconds: u64) -> (u64, u32) {
    const SECOND: u64 = 1_000_000_000;
    (nanoseconds / SECOND, (nanoseconds % SECOND) as u32)
}
