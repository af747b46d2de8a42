//! Numbers and times as all encodings write them.

use std::ops::Add;

/// Turns -0 into 0: protobuf omits zeros, so their sign is lost.
pub fn without_negative_zeros<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    numbers.map(without_negative_zero)
}

/// The same of one number, of either size.
pub fn without_negative_zero<F: Add<Output = F> + Default>(number: F) -> F {
    // Adding 0 changes a negative zero and nothing else.
    number + F::default()
}

/// Splits a time into whole seconds and the nanoseconds beyond them.
pub fn split_seconds(nanoseconds: u64) -> (u64, u32) {
    const SECOND: u64 = 1_000_000_000;
    (nanoseconds / SECOND, (nanoseconds % SECOND) as u32)
}
