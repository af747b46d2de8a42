//! The times of a kind of sample.

/// Fewer samples than this may well have the same time.
const ENOUGH: u64 = 10;

/// The times of the samples of one kind.
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    count: u64,
    first: u64,
    differs: bool,
}

impl Times {
    /// Takes the time of the next sample.
    #[inline]
    pub fn push(&mut self, time: u64) {
        if self.count == 0 {
            self.first = time;
        }
        self.differs |= time != self.first;
        self.count += 1;
    }

    /// How many samples there are, if all are at one time although they are many.
    pub fn all_at_one_time(&self) -> Option<u64> {
        (self.count >= ENOUGH && !self.differs).then_some(self.count)
    }
}
