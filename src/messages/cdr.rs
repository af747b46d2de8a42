//! Plain CDR, little-endian: how ROS 2 messages are serialised.
//!
//! All of it is inlined where a message is written, so that sizes and padding are known there.

/// Writes one message.
pub struct Cdr<'a> {
    out: &'a mut Vec<u8>,
    /// Where the content begins. Alignment is counted from there.
    origin: usize,
}

impl<'a> Cdr<'a> {
    #[inline]
    pub fn begin(out: &'a mut Vec<u8>) -> Self {
        /// The representation, CDR_LE, and its options (none).
        const HEADER: [u8; 4] = [0, 1, 0, 0];
        out.extend(HEADER);
        let origin = out.len();
        Self { out, origin }
    }

    /// Writes a number, aligned to its size.
    #[inline]
    pub fn put<const SIZE: usize>(&mut self, number: [u8; SIZE]) {
        let length = self.out.len() - self.origin;
        let aligned = self.origin + length.next_multiple_of(SIZE);
        self.out.resize(aligned, 0);
        self.out.extend(number);
    }

    /// Writes several numbers.
    #[inline]
    pub fn put_doubles<const N: usize>(&mut self, numbers: [f64; N]) {
        for number in numbers {
            self.put(number.to_le_bytes());
        }
    }

    #[inline]
    pub fn put_bool(&mut self, value: bool) {
        self.put([u8::from(value)]);
    }

    /// Writes the length of a list, after which its elements come.
    #[inline]
    pub fn put_length(&mut self, length: usize) {
        self.put((length as u32).to_le_bytes());
    }

    /// Writes a string: its length, which includes a terminating 0, and its bytes.
    #[inline]
    pub fn put_string(&mut self, text: &str) {
        self.put_length(text.len() + 1);
        self.out.extend(text.as_bytes());
        self.out.push(0);
    }
}
