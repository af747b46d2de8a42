//! Numbers that are the same in every encoding.

/// Turns -0 into 0: protobuf omits zeros, so their sign is lost.
pub fn without_negative_zeros<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    // Adding 0 changes a negative zero and nothing else.
    numbers.map(|number| number + 0.0)
}
