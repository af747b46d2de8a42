//! How many bytes values take, for skipping them.

use std::sync::Arc;

/// The length of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Length {
    /// Given in the definition.
    Fixed(usize),
    /// Sent in every message, before the elements.
    Sent,
}

/// How many bytes a value of fixed size takes, including the padding before it, indexed by start offset
/// modulo 8, because nothing is aligned to more than eight bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PaddedSize([usize; 8]);

impl PaddedSize {
    const NOTHING: Self = Self([0; 8]);

    /// The size of a number.
    pub fn of_number(size: usize, alignment: usize) -> Self {
        Self(std::array::from_fn(|at| {
            at.next_multiple_of(alignment) - at + size
        }))
    }

    /// The size of a value that starts at this offset.
    pub fn at(self, at: usize) -> usize {
        self.0[at % self.0.len()]
    }

    /// The size of a value followed by another. Saturates on overflow.
    fn then(self, next: Self) -> Self {
        Self(std::array::from_fn(|at| {
            let size = self.0[at];
            size.saturating_add(next.at(at.wrapping_add(size)))
        }))
    }

    /// The size of `count` such values in a row, computed in as many steps as the count has bits.
    pub fn repeat(self, count: usize) -> Self {
        let [size, ..] = self.0;
        if self == Self([size; 8]) {
            return Self([size.saturating_mul(count); 8]);
        }
        let (mut all, mut power, mut rest) = (Self::NOTHING, self, count);
        while rest > 0 {
            if rest % 2 == 1 {
                all = all.then(power);
            }
            power = power.then(power);
            rest /= 2;
        }
        all
    }
}

/// A stretch of a message to skip.
#[derive(Debug, Clone)]
pub enum Skip {
    /// Values of fixed size.
    Fixed(PaddedSize),
    /// A list, or a message that has one.
    Elements { length: Length, element: Extent },
}

/// The steps that it takes to skip a value, as few as possible: one for a value of fixed size, or none if it takes no
/// bytes. Types share them, so that they take no more memory than the definition, however deeply types nest.
pub type Extent = Arc<[Skip]>;

impl Skip {
    /// Skips a list of fixed or varying length.
    pub fn elements(length: Length, element: Extent) -> Self {
        match (length, &*element) {
            (Length::Fixed(0), _) | (Length::Fixed(_), []) => Self::Fixed(PaddedSize::NOTHING),
            (Length::Fixed(1), [skip]) => skip.clone(),
            (Length::Fixed(count), [Self::Fixed(size)]) => Self::Fixed(size.repeat(count)),
            _ => Self::Elements { length, element },
        }
    }

    /// Appends this to others, merging it with a last one of fixed size if possible.
    pub fn append_to(self, skips: &mut Vec<Self>) {
        match (skips.last_mut(), self) {
            (Some(Self::Fixed(last)), Self::Fixed(size)) => *last = last.then(size),
            (_, skip) => skips.push(skip),
        }
    }
}
