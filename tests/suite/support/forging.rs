//! Records whose lengths can be made to lie, and where in a log to put them.

use flightcam::log::record::{push_record, serialize};
use mcap::{
    WriteOptions,
    records::{ChunkHeader, op},
};

use super::{Parts, Shape};

/// A record, and where in its body there are lengths.
#[derive(Debug, Clone)]
pub struct Forgery {
    pub name: &'static str,
    pub opcode: u8,
    pub body: Vec<u8>,
    /// Where each length is, and how many bytes it has.
    pub lengths: Vec<(usize, usize)>,
}

impl Forgery {
    fn new(name: &'static str, opcode: u8) -> Self {
        Self {
            name,
            opcode,
            body: Vec::new(),
            lengths: Vec::new(),
        }
    }

    fn bytes(mut self, bytes: &[u8]) -> Self {
        self.body.extend_from_slice(bytes);
        self
    }

    /// After its length in four bytes.
    fn block(mut self, bytes: &[u8]) -> Self {
        self.lengths.push((self.body.len(), 4));
        let length = bytes.len() as u32;
        self.bytes(&length.to_le_bytes()).bytes(bytes)
    }

    /// A length in eight bytes.
    fn long(mut self, length: u64) -> Self {
        self.lengths.push((self.body.len(), 8));
        self.bytes(&length.to_le_bytes())
    }

    /// A map from one text to another, with the lengths in it.
    fn map(self, key: &str, value: &str) -> Self {
        let mut map = self;
        map.lengths.push((map.body.len(), 4));
        let length = (8 + key.len() + value.len()) as u32;
        map = map.bytes(&length.to_le_bytes());
        map.block(key.as_bytes()).block(value.as_bytes())
    }

    /// With the largest length in place of each of its lengths in turn.
    pub fn lies(&self) -> impl Iterator<Item = Self> {
        self.lengths.iter().map(|&(place, width)| {
            let lie = match width {
                4 => u64::from(u32::MAX),
                _ => 1 << 62,
            };
            let mut lying = self.clone();
            lying.body[place..place + width].copy_from_slice(&lie.to_le_bytes()[..width]);
            lying
        })
    }
}

/// One record of each kind, with ids that no other record has.
pub fn one_of_each() -> Vec<Forgery> {
    let id = 300u16.to_le_bytes();
    vec![
        Forgery::new("header", op::HEADER).block(b"x").block(b"y"),
        Forgery::new("footer", op::FOOTER)
            .long(0)
            .long(0)
            .bytes(&[0; 4]),
        Forgery::new("schema", op::SCHEMA)
            .bytes(&id)
            .block(b"Name")
            .block(b"jsonschema")
            .block(b"{}"),
        Forgery::new("channel", op::CHANNEL)
            .bytes(&id)
            .bytes(&[0; 2])
            .block(b"/topic")
            .block(b"json")
            .map("key", "value"),
        Forgery::new("message", op::MESSAGE).bytes(&[0; 22]),
        Forgery::new("chunk", op::CHUNK)
            .bytes(&[0; 16])
            .long(0)
            .bytes(&[0; 4])
            .block(b"zstd")
            .long(0),
        Forgery::new("message index", op::MESSAGE_INDEX)
            .bytes(&id)
            .block(&[0; 16]),
        Forgery::new("chunk index", op::CHUNK_INDEX)
            .bytes(&[0; 16])
            .long(9)
            .long(9)
            .block(&[0; 10])
            .long(9)
            .block(b"zstd")
            .long(9)
            .long(9),
        Forgery::new("attachment", op::ATTACHMENT)
            .bytes(&[0; 16])
            .block(b"name")
            .block(b"text/plain")
            .long(2)
            .bytes(b"hi\0\0\0\0"),
        Forgery::new("attachment index", op::ATTACHMENT_INDEX)
            .long(9)
            .long(9)
            .bytes(&[0; 16])
            .long(9)
            .block(b"name")
            .block(b"text/plain"),
        Forgery::new("statistics", op::STATISTICS)
            .bytes(&[0; 42])
            .block(&[0; 10]),
        Forgery::new("metadata", op::METADATA)
            .block(b"name")
            .map("key", "value"),
        // What it says is read, unlike that of others.
        Forgery::new("metadata of flightcam", op::METADATA)
            .block(b"flightcam")
            .map("key", "value"),
        Forgery::new("metadata index", op::METADATA_INDEX)
            .long(9)
            .long(9)
            .block(b"name"),
        Forgery::new("summary offset", op::SUMMARY_OFFSET)
            .bytes(&[op::SCHEMA])
            .long(9)
            .long(9),
        Forgery::new("end of the data", op::DATA_END).bytes(&[0; 4]),
    ]
}

/// Where in a log a record can be.
#[derive(Debug, Clone, Copy)]
pub enum Place {
    Data,
    Chunk,
    AfterChunk,
    Summary,
}

impl Place {
    pub const ALL: [Self; 4] = [Self::Data, Self::Chunk, Self::AfterChunk, Self::Summary];

    /// A small log of telemetry in chunks that are not compressed, with one more record.
    pub fn put(self, opcode: u8, body: &[u8]) -> Vec<u8> {
        let shape = Shape {
            messages: 10,
            ..Shape::with(|options: WriteOptions| options.compression(None))
        };
        let mut parts = Parts::of(&shape.write());
        let chunk = parts
            .data
            .iter()
            .position(|(opcode, _)| *opcode == op::CHUNK);
        let chunk = chunk.expect("a chunk");
        let record = (opcode, body.to_vec());
        match self {
            Self::Data => parts.data.insert(chunk, record),
            Self::Chunk => parts.data[chunk].1 = with_record(&parts.data[chunk].1, opcode, body),
            Self::AfterChunk => parts.data.insert(chunk + 1, record),
            Self::Summary => parts.summary.push(record),
        }
        parts.data_section_crc = 0;
        parts.join()
    }
}

/// The body of an uncompressed chunk, with one more record at its end.
pub fn with_record(chunk: &[u8], opcode: u8, body: &[u8]) -> Vec<u8> {
    let header: ChunkHeader = flightcam::log::record::parse(chunk).expect("a chunk");
    let content = &chunk[chunk.len() - header.compressed_size as usize..];
    let mut content = content.to_vec();
    push_record(&mut content, opcode, body);
    chunk_of(header, &content)
}

/// The body of an uncompressed chunk with this content.
pub fn chunk_of(header: ChunkHeader, content: &[u8]) -> Vec<u8> {
    let mut chunk = serialize(&ChunkHeader {
        uncompressed_size: content.len() as u64,
        uncompressed_crc: 0,
        compression: String::new(),
        compressed_size: content.len() as u64,
        ..header
    });
    chunk.extend_from_slice(content);
    chunk
}
