//! Numbers that are the same in every encoding.

/// The numbers, a zero among them without its sign: protobuf does not write a zero, so there it has none.
pub fn without_negative_zeros<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    // This changes a negative zero and nothing else.
    numbers.map(|number| number + 0.0)
}
