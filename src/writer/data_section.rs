//! The end of the data section as it grows, and what the summary will say about it.

use std::{
    collections::BTreeMap,
    io::{self, Write},
    ops::{ControlFlow, Range},
};

use crc32fast::Hasher;

use mcap::records::{
    AttachmentHeader, AttachmentIndex, ChunkIndex, DataEnd, Metadata, MetadataIndex, op,
};

use super::{chunk::Batch, copy::copy_range, error::WriteError};
use crate::log::{
    file::LogFile,
    record::{push_record, serialize},
};

/// How much is held in memory of a log whose checksum is computed while it is copied.
const PIECE: u64 = 1024 * 1024;

/// The fastest of zstd's levels, because the next ones barely compress noise-like data better.
const COMPRESSION_LEVEL: i32 = 1;

/// What was added to a data section.
#[derive(Debug, Default)]
pub struct Added {
    /// Bodies of schema records, by id.
    pub schemas: BTreeMap<u16, Vec<u8>>,
    /// Bodies of channel records, by id.
    pub channels: BTreeMap<u16, Vec<u8>>,
    /// Where the chunks are.
    pub chunk_indexes: Vec<ChunkIndex>,
    /// Where the attachments are.
    pub attachment_indexes: Vec<AttachmentIndex>,
    /// Where the Metadata records are.
    pub metadata_indexes: Vec<MetadataIndex>,
    /// Messages by channel.
    pub message_counts: BTreeMap<u16, u64>,
    /// Log times of the earliest and the latest message.
    pub times: Option<(u64, u64)>,
}

/// A data section that is continued from some position.
pub struct DataSection<W> {
    out: W,
    position: u64,
    /// The checksum of the section so far, if it is to have one.
    crc: Option<Hasher>,
    compressor: zstd::bulk::Compressor<'static>,
    /// What was added.
    pub added: Added,
}

impl<W: Write> DataSection<W> {
    /// Continues at `position`, with the checksum of what is before it.
    ///
    /// # Errors
    /// There is no memory for compressing.
    pub fn new(out: W, position: u64, crc: Option<u32>) -> io::Result<Self> {
        Ok(Self {
            out,
            position,
            crc: crc.map(Hasher::new_with_initial),
            compressor: zstd::bulk::Compressor::new(COMPRESSION_LEVEL)?,
            added: Added::default(),
        })
    }

    /// Where the next byte goes.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Writes bytes that the summary need not list.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        if let Some(crc) = &mut self.crc {
            crc.update(bytes);
        }
        self.position += bytes.len() as u64;
        Ok(())
    }

    /// Copies some of a log's bytes, and returns their checksum if the section is to have one; otherwise the kernel can
    /// copy them.
    ///
    /// # Errors
    /// Those of [`copy_range`].
    pub fn copy(
        &mut self,
        log: &LogFile,
        range: Range<u64>,
        failed: impl Fn(io::Error) -> WriteError,
        mut copied: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Option<Hasher>, WriteError> {
        let length = range.end - range.start;
        let Some(crc) = &mut self.crc else {
            copy_range(log, range, &mut self.out, failed, copied)?;
            self.position += length;
            return Ok(None);
        };
        let mut crc_of_range = Hasher::new();
        let mut piece = Vec::new();
        let mut done = range.start;
        while done < range.end {
            let step = PIECE.min(range.end - done);
            log.read_into(&mut piece, done, step)?;
            crc_of_range.update(&piece);
            self.out.write_all(&piece).map_err(&failed)?;
            done += step;
            if copied(done).is_break() {
                return Err(WriteError::Cancelled);
            }
        }
        crc.combine(&crc_of_range);
        self.position += length;
        Ok(Some(crc_of_range))
    }

    /// Makes the section have no checksum after all.
    pub fn drop_checksum(&mut self) {
        self.crc = None;
    }

    /// Writes a batch as a chunk with its message indexes, and empties it. One without messages is left out.
    pub fn write_chunk(&mut self, batch: &mut Batch) -> io::Result<()> {
        if batch.times().is_none() {
            return Ok(());
        }
        let index = self.write_gathered(batch)?;
        self.added.chunk_indexes.push(index);
        self.count(batch);
        batch.clear();
        Ok(())
    }

    /// Writes a batch of the log's own messages as a chunk with its message indexes, without counting them as added.
    pub fn write_gathered(&mut self, batch: &Batch) -> io::Result<ChunkIndex> {
        let chunk = batch.compress(self.position, &mut self.compressor)?;
        self.write(&chunk.bytes)?;
        Ok(chunk.index)
    }

    /// Writes a batch as records outside chunks, and empties it.
    pub fn write_loose(&mut self, batch: &mut Batch) -> io::Result<()> {
        self.write(batch.records())?;
        self.count(batch);
        batch.clear();
        Ok(())
    }

    /// Writes a Metadata record.
    pub fn write_metadata(&mut self, metadata: &Metadata) -> io::Result<()> {
        let mut record = Vec::new();
        push_record(&mut record, op::METADATA, &serialize(metadata));
        self.added.metadata_indexes.push(MetadataIndex {
            offset: self.position,
            length: record.len() as u64,
            name: metadata.name.clone(),
        });
        self.write(&record)
    }

    /// Writes an attachment.
    pub fn write_attachment(&mut self, header: AttachmentHeader, data: &[u8]) -> io::Result<()> {
        let mut body = serialize(&header);
        body.extend_from_slice(&(data.len() as u64).to_le_bytes());
        body.extend_from_slice(data);
        let crc = crc32fast::hash(&body);
        body.extend_from_slice(&crc.to_le_bytes());
        let mut record = Vec::new();
        push_record(&mut record, op::ATTACHMENT, &body);
        self.added.attachment_indexes.push(AttachmentIndex {
            offset: self.position,
            length: record.len() as u64,
            log_time: header.log_time,
            create_time: header.create_time,
            data_size: data.len() as u64,
            name: header.name,
            media_type: header.media_type,
        });
        self.write(&record)
    }

    /// Ends the section, and the file, with the summary that `summarise` makes for its position. Returns the file's
    /// length.
    pub fn finish(
        mut self,
        summarise: impl FnOnce(&Added, u64) -> Vec<u8>,
    ) -> io::Result<(u64, Added)> {
        let data_end = DataEnd {
            data_section_crc: self.crc.take().map_or(0, Hasher::finalize),
        };
        let mut end = Vec::new();
        push_record(&mut end, op::DATA_END, &serialize(&data_end));
        self.write(&end)?;
        let summary = summarise(&self.added, self.position);
        self.write(&summary)?;
        self.out.flush()?;
        Ok((self.position, self.added))
    }

    fn count(&mut self, batch: &Batch) {
        for (id, count) in batch.message_counts() {
            *self.added.message_counts.entry(id).or_default() += count;
        }
        if let Some((start, end)) = batch.times() {
            let (earliest, latest) = self.added.times.unwrap_or((start, end));
            self.added.times = Some((earliest.min(start), latest.max(end)));
        }
    }
}
