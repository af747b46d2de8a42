//! The fields of each kind of record, to check the lengths in its body before any of them is believed.
//!
//! The parsers of `mcap` allocate as much as a length says before they notice that there is less. A record type without
//! a row in this table cannot be [parsed](super::parse).

use mcap::records::{
    AttachmentHeader, AttachmentIndex, Channel, ChunkHeader, ChunkIndex, DataEnd, Footer, Header,
    MessageHeader, MessageIndex, Metadata, MetadataIndex, SchemaHeader, Statistics,
};

use super::{AttachmentStart, MAX_RECORD, MessageIndexStart, MetadataStart};

/// A field of a record, or several, as far as it takes to find the next one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// Numbers: that many bytes.
    Fixed(u64),
    /// A text after its length.
    Text,
    /// A map from texts to texts, after its length in bytes.
    TextMap,
    /// A list or a map after its length in bytes, with entries of that many bytes each.
    Entries(u64),
}

/// A record type whose fields are known.
pub trait Fields {
    /// Its fields in their order.
    const FIELDS: &'static [Field];
}

/// Why a record's body cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Unreadable {
    /// It is shorter than its fields.
    #[error("it breaks off: its fields take {needed} bytes at least")]
    BreaksOff {
        /// Bytes up to the end of the first field that is not there, or of its length.
        needed: u64,
    },
    /// A map does not end where its length says.
    #[error("a map in it does not have the length that it should have")]
    WrongLength,
    /// A map would take more memory than any record may.
    #[error("a map in it has too many entries")]
    TooManyEntries,
    /// What is there is not what there should be.
    #[error(transparent)]
    Content(#[from] binrw::Error),
}

use Field::{Entries, Fixed, Text, TextMap};

/// The rows of the table.
macro_rules! fields {
    ($($record:ty: $fields:expr;)*) => {
        $(impl Fields for $record {
            const FIELDS: &'static [Field] = &$fields;
        })*
    };
}

fields! {
    Header: [Text, Text];
    Footer: [Fixed(8 + 8 + 4)];
    SchemaHeader: [Fixed(2), Text, Text];
    Channel: [Fixed(2 + 2), Text, Text, TextMap];
    MessageHeader: [Fixed(2 + 4 + 8 + 8)];
    ChunkHeader: [Fixed(8 + 8 + 8 + 4), Text, Fixed(8)];
    MessageIndexStart: [Fixed(2 + 4)];
    MessageIndex: [Fixed(2), Entries(8 + 8)];
    ChunkIndex: [Fixed(8 + 8 + 8 + 8), Entries(2 + 8), Fixed(8), Text, Fixed(8 + 8)];
    AttachmentHeader: [Fixed(8 + 8), Text, Text];
    AttachmentStart: [Fixed(8 + 8), Text, Text, Fixed(8)];
    AttachmentIndex: [Fixed(8 + 8 + 8 + 8 + 8), Text, Text];
    Statistics: [Fixed(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8), Entries(2 + 8)];
    Metadata: [Text, TextMap];
    MetadataStart: [Text];
    MetadataIndex: [Fixed(8 + 8), Text];
    DataEnd: [Fixed(4)];
}

/// About as much memory as an entry of a map of texts takes besides its texts.
pub(in crate::log) const TEXT_ENTRY: u64 = 128;

/// Checks every length in a body against the bytes that are there. Returns where the fields end.
///
/// # Errors
/// A length is wrong.
pub(super) fn end(fields: &[Field], body: &[u8]) -> Result<usize, Unreadable> {
    let mut walk = Walk { body, position: 0 };
    for field in fields {
        match *field {
            Fixed(length) => walk.skip(length)?,
            Text => walk.skip_text()?,
            TextMap => walk.skip_text_map()?,
            Entries(entry) => {
                let length = walk.length()?;
                if !length.is_multiple_of(entry) {
                    return Err(Unreadable::WrongLength);
                }
                walk.skip(length)?;
            }
        }
    }
    Ok(walk.position)
}

/// A position in a body, never beyond its end.
struct Walk<'a> {
    body: &'a [u8],
    position: usize,
}

impl Walk<'_> {
    fn skip(&mut self, length: u64) -> Result<(), Unreadable> {
        let needed = self.position as u64 + length;
        if needed > self.body.len() as u64 {
            return Err(Unreadable::BreaksOff { needed });
        }
        self.position = needed as usize;
        Ok(())
    }

    /// Reads the length that a text or a map starts with.
    fn length(&mut self) -> Result<u64, Unreadable> {
        let start = self.position;
        self.skip(4)?;
        let mut length = [0; 4];
        length.copy_from_slice(&self.body[start..self.position]);
        Ok(u32::from_le_bytes(length).into())
    }

    fn skip_text(&mut self) -> Result<(), Unreadable> {
        let length = self.length()?;
        self.skip(length)
    }

    fn skip_text_map(&mut self) -> Result<(), Unreadable> {
        let length = self.length()?;
        let start = self.position;
        self.skip(length)?;
        let mut map = Walk {
            body: &self.body[..self.position],
            position: start,
        };
        let mut entries = 0;
        while map.position < self.position {
            let entry = map.skip_text().and_then(|()| map.skip_text());
            entry.map_err(|_| Unreadable::WrongLength)?;
            entries += 1;
        }
        match entries * TEXT_ENTRY {
            0..=MAX_RECORD => Ok(()),
            _ => Err(Unreadable::TooManyEntries),
        }
    }
}
