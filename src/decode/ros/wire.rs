//! The bytes of a message, read from front to back.
//!
//! CDR as ROS 2 writes it is XCDR version 1: four bytes that name the encoding, then the values, every number
//! aligned to its own size, counted from after these four bytes (OMG DDS-XTypes 1.3, sections 7.4.1 and 7.6.2.1,
//! <https://www.omg.org/spec/DDS-XTypes/1.3/PDF>). ROS 1 puts values one after the other, little-endian
//! (<https://wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes>).

use super::layout::{Length, PaddedSize, Skip};
use crate::decode::value::{Number, Undecodable};

/// The version of ROS whose encoding the messages use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    Ros1,
    Ros2,
}

impl Dialect {
    /// The padded size of a number of this many bytes.
    pub fn padded_size(self, size: usize) -> PaddedSize {
        PaddedSize::of_number(size, if self == Self::Ros2 { size } else { 1 })
    }
}

/// How a number is encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RosScalar {
    Bool,
    Int8,
    Int16,
    Int32,
    Int64,
    Uint8,
    Uint16,
    Uint32,
    Uint64,
    Float32,
    Float64,
}

impl RosScalar {
    /// The size in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::Bool | Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float32 => 4,
            Self::Int64 | Self::Uint64 | Self::Float64 => 8,
        }
    }
}

/// A position in a message.
#[derive(Debug)]
pub struct Cursor<'a> {
    dialect: Dialect,
    big_endian: bool,
    /// The message after its header, if it has one. Alignment is counted from here.
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// Starts at the first value of a message.
    pub fn new(dialect: Dialect, message: &'a [u8]) -> Result<Self, Undecodable> {
        let (big_endian, bytes) = match (dialect, message) {
            (Dialect::Ros1, bytes) => (false, bytes),
            // The last two bytes of the four are options that do not matter here.
            (Dialect::Ros2, &[high, low, _, _, ref bytes @ ..]) => {
                (is_big_endian(u16::from_be_bytes([high, low]))?, bytes)
            }
            (Dialect::Ros2, _) => return Err(Undecodable::Malformed),
        };
        Ok(Self {
            dialect,
            big_endian,
            bytes,
            at: 0,
        })
    }

    pub fn number(&mut self, scalar: RosScalar) -> Result<Number, Undecodable> {
        Ok(match scalar {
            RosScalar::Bool => (self.take::<1>()? != [0]).into(),
            RosScalar::Int8 => i64::from(i8::from_le_bytes(self.take()?)).into(),
            RosScalar::Int16 => i64::from(i16::from_le_bytes(self.take()?)).into(),
            RosScalar::Int32 => i64::from(i32::from_le_bytes(self.take()?)).into(),
            RosScalar::Int64 => i64::from_le_bytes(self.take()?).into(),
            RosScalar::Uint8 => u64::from(u8::from_le_bytes(self.take()?)).into(),
            RosScalar::Uint16 => u64::from(u16::from_le_bytes(self.take()?)).into(),
            RosScalar::Uint32 => u64::from(u32::from_le_bytes(self.take()?)).into(),
            RosScalar::Uint64 => u64::from_le_bytes(self.take()?).into(),
            RosScalar::Float32 => f64::from(f32::from_le_bytes(self.take()?)).into(),
            RosScalar::Float64 => f64::from_le_bytes(self.take()?).into(),
        })
    }

    /// Reads a string, without the NUL that ends it in CDR.
    pub fn text(&mut self) -> Result<&'a [u8], Undecodable> {
        let length = self.length(Length::Sent)?;
        let start = self.at;
        self.advance(length)?;
        let text = &self.bytes[start..self.at];
        Ok(match self.dialect {
            Dialect::Ros1 => text,
            Dialect::Ros2 => text.strip_suffix(&[0]).unwrap_or(text),
        })
    }

    /// Returns the number of elements of a list, which is read if it is sent.
    pub fn length(&mut self, length: Length) -> Result<usize, Undecodable> {
        Ok(match length {
            Length::Fixed(length) => length,
            Length::Sent => u32::from_le_bytes(self.take()?) as usize,
        })
    }

    pub fn skip(&mut self, skips: &[Skip]) -> Result<(), Undecodable> {
        for skip in skips {
            match skip {
                Skip::Fixed(size) => self.advance(size.at(self.at))?,
                Skip::Elements { length, element } => {
                    let count = self.length(*length)?;
                    self.skip_elements(element, count)?;
                }
            }
        }
        Ok(())
    }

    pub fn skip_elements(&mut self, element: &[Skip], count: usize) -> Result<(), Undecodable> {
        match element {
            [] => Ok(()),
            [Skip::Fixed(size)] => self.advance(size.repeat(count).at(self.at)),
            // Each takes at least the four bytes of a length, so however many are claimed, the bytes end the loop.
            varying => (0..count).try_for_each(|_| self.skip(varying)),
        }
    }

    fn advance(&mut self, size: usize) -> Result<(), Undecodable> {
        let end = self.at.checked_add(size);
        let end = end.filter(|end| *end <= self.bytes.len());
        self.at = end.ok_or(Undecodable::Malformed)?;
        Ok(())
    }

    /// Reads a number's bytes, least significant first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Undecodable> {
        let start = match self.dialect {
            Dialect::Ros1 => self.at,
            Dialect::Ros2 => self.at.next_multiple_of(N),
        };
        let bytes = self.bytes.get(start..).and_then(<[u8]>::first_chunk);
        let mut bytes: [u8; N] = *bytes.ok_or(Undecodable::Malformed)?;
        self.at = start + N;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

/// Whether a representation identifier means big-endian (DDS-XTypes 1.3, section 7.6.2.1.2; identifiers from 0x10 on
/// are from section 7.4.3.4).
fn is_big_endian(identifier: u16) -> Result<bool, Undecodable> {
    match identifier {
        0x00 => Ok(true),
        0x01 => Ok(false),
        0x02 | 0x03 => Err(Undecodable::ParameterList),
        0x06..=0x0b | 0x10..=0x15 => Err(Undecodable::Xcdr2),
        _ => Err(Undecodable::Malformed),
    }
}
