//! Records as MCAP frames them: an opcode, a length, a body (<https://mcap.dev/spec#records>).

mod fields;

use std::io::Cursor;

use binrw::{BinRead, BinWrite, binread};
use mcap::records::AttachmentHeader;

pub(super) use fields::TEXT_ENTRY;
pub use fields::{Field, Fields, Unreadable};

/// Bytes before a record's body: its opcode and its length.
pub const FRAME_LENGTH: usize = 1 + 8;

/// The longest body of a record that is held in memory, and the longest content of a chunk. Recorders write chunks of a
/// few megabytes, and no drone sends a message that long. It is short enough that what a few threads hold of a log that
/// lies about its lengths fits in 2 GB.
pub const MAX_RECORD: u64 = 256 * 1024 * 1024;

/// Bytes of a message record's body before the payload.
pub(super) const MESSAGE_HEADER_LENGTH: usize = 2 + 4 + 8 + 8;

/// One record, still in the buffer that it was read into.
#[derive(Debug, Clone, Copy)]
pub struct RawRecord<'a> {
    /// What kind of record it is ([`mcap::records::op`]).
    pub opcode: u8,
    /// Where the record starts in its buffer.
    pub offset: usize,
    /// The bytes after its opcode and length.
    pub body: &'a [u8],
}

/// A record whose length runs past the end of what holds it, or no whole opcode and length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a record breaks off")]
pub struct Torn {
    /// Where it starts in its buffer.
    pub offset: usize,
}

/// The records that follow one another in a buffer.
#[derive(Debug, Clone)]
pub struct Records<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Records<'a> {
    /// Iterates over a buffer that starts with a record.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0 }
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = Result<RawRecord<'a>, Torn>;

    fn next(&mut self) -> Option<Self::Item> {
        let offset = self.position;
        let rest = &self.bytes[offset..];
        if rest.is_empty() {
            return None;
        }
        let record = split_frame(rest).and_then(|(opcode, length)| {
            let end = FRAME_LENGTH.checked_add(usize::try_from(length).ok()?)?;
            let body = rest.get(FRAME_LENGTH..end)?;
            Some(RawRecord {
                opcode,
                offset,
                body,
            })
        });
        // Where the records after a torn one start is not known.
        self.position = record.map_or(self.bytes.len(), |record| {
            offset + FRAME_LENGTH + record.body.len()
        });
        Some(record.ok_or(Torn { offset }))
    }
}

/// The opcode and the length that a record starts with.
pub fn split_frame(bytes: &[u8]) -> Option<(u8, u64)> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, _) = rest.split_first_chunk()?;
    Some((opcode, u64::from_le_bytes(*length)))
}

/// A message, its payload still in the buffer that it was read into.
#[derive(Debug, Clone, Copy)]
pub struct RawMessage<'a> {
    /// The channel that it belongs to.
    pub channel_id: u16,
    /// Nanoseconds; when it was recorded.
    pub log_time: u64,
    /// Nanoseconds; when it was published.
    pub publish_time: u64,
    /// The message itself, in the channel's encoding.
    pub payload: &'a [u8],
}

impl<'a> RawMessage<'a> {
    /// Reads the body of a message record; `None` if it is shorter than its header.
    pub fn parse(body: &'a [u8]) -> Option<Self> {
        let (header, payload) = body.split_at_checked(MESSAGE_HEADER_LENGTH)?;
        let header: mcap::records::MessageHeader = parse(header).ok()?;
        Some(Self {
            channel_id: header.channel_id,
            log_time: header.log_time,
            publish_time: header.publish_time,
            payload,
        })
    }
}

/// A record and the body that it was read from. A later version of the format may append fields to a
/// record; writing the body again keeps them.
#[derive(Debug, Clone)]
pub struct Raw<T> {
    /// The record that the bytes encode.
    pub record: T,
    /// The bytes, without opcode and length.
    pub body: Vec<u8>,
}

impl<T> Raw<T>
where
    T: Fields + for<'a> BinRead<Args<'a> = ()> + for<'a> BinWrite<Args<'a> = ()>,
{
    /// Reads a record's body.
    ///
    /// # Errors
    /// Those of [`parse`].
    pub fn parse(body: &[u8]) -> Result<Self, Unreadable> {
        Ok(Self {
            record: parse(body)?,
            body: body.to_vec(),
        })
    }

    /// Wraps a record that is not in the log yet.
    pub fn new(record: T) -> Self {
        let body = serialize(&record);
        Self { record, body }
    }

    /// Changes the record. What a later version of the format appended stays.
    pub fn change(&mut self, change: impl FnOnce(&mut T)) {
        let known = fields::end(T::FIELDS, &self.body).unwrap_or(self.body.len());
        let appended = self.body.split_off(known);
        change(&mut self.record);
        self.body = serialize(&self.record);
        self.body.extend(appended);
    }
}

/// The fields of an attachment before its content.
#[binread]
#[derive(Debug)]
#[br(little)]
pub(crate) struct AttachmentStart {
    /// What it is.
    pub header: AttachmentHeader,
    /// Bytes of its content.
    pub data_size: u64,
}

/// The first field of a Metadata record.
#[binread]
#[derive(Debug)]
#[br(little)]
pub(crate) struct MetadataStart {
    #[br(temp)]
    length: u32,
    /// Its name.
    #[br(count = length, try_map = String::from_utf8)]
    pub name: String,
}

/// What a message index says before its entries.
#[binread]
#[derive(Debug)]
#[br(little)]
pub(crate) struct MessageIndexStart {
    /// The channel.
    pub channel_id: u16,
    /// Bytes of its entries.
    pub length: u32,
}

/// Reads a record's body, after checking each length in it against the bytes that are there.
///
/// # Errors
/// A length is wrong, or a text is not UTF-8.
pub fn parse<T: Fields + for<'a> BinRead<Args<'a> = ()>>(body: &[u8]) -> Result<T, Unreadable> {
    split(body).map(|(record, _)| record)
}

/// Reads a record's body like [`parse`], and returns the bytes after its fields as well.
///
/// # Errors
/// Those of [`parse`].
pub(crate) fn split<T: Fields + for<'a> BinRead<Args<'a> = ()>>(
    body: &[u8],
) -> Result<(T, &[u8]), Unreadable> {
    let (fields, rest) = body.split_at(fields::end(T::FIELDS, body)?);
    Ok((T::read_le(&mut Cursor::new(fields))?, rest))
}

/// Serialises a record's body, ready to be framed.
pub fn serialize<T: for<'a> BinWrite<Args<'a> = ()>>(record: &T) -> Vec<u8> {
    let mut body = Vec::new();
    serialize_into(&mut body, record);
    body
}

/// Serialises a record's body into an empty buffer.
pub(crate) fn serialize_into<T: for<'a> BinWrite<Args<'a> = ()>>(body: &mut Vec<u8>, record: &T) {
    record
        .write_le(&mut Cursor::new(body))
        .expect("writing to memory does not fail");
}

/// Appends a whole record to `out`.
pub fn push_record(out: &mut Vec<u8>, opcode: u8, body: &[u8]) {
    out.push(opcode);
    out.extend_from_slice(&(body.len() as u64).to_le_bytes());
    out.extend_from_slice(body);
}
