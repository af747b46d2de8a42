//! Appending to a log: copy, new messages, provenance, the original's end, summary.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::{self, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write},
};

use mcap::{
    Attachment, Compression, WriteOptions,
    records::{ChunkIndex, DataEnd, Header, MessageHeader, op},
};

use super::{
    destination::{Destination, Pending},
    provenance,
    region::{Region, Seal},
    summary, tail,
};
use crate::{
    derived::{Derived, Quantity},
    error::Error,
    log::{
        Log, SegmentReader,
        contents::SegmentKind,
        record::{push_record, serialize},
    },
    messages::{Format, Schema},
};

/// Bytes of a new chunk before compression: so few that a viewer that seeks loads little.
const CHUNK_SIZE: u64 = 1024 * 1024;

/// How much is copied between two reports of progress.
const COPY_STEP: u64 = 64 * 1024 * 1024;

type Output = BufWriter<File>;

/// Writes a log with new channels.
pub struct Appender<'a> {
    log: &'a Log,
    format: Format,
    output: Pending,
    writer: mcap::Writer<Region<Output>>,
    seal: Seal,
    /// The chunk indexes of chunks that had no message indexes until now, by the chunks' offsets.
    reindexed: BTreeMap<u64, ChunkIndex>,
    channels: BTreeMap<Quantity, NewChannel>,
    times: (u64, u64),
    /// The ids of the new channels' schemas, by name.
    schemas: BTreeMap<&'static str, u16>,
    /// The ids that are in use, the new ones included.
    schema_ids: BTreeSet<u16>,
    channel_ids: BTreeSet<u16>,
    payload: Vec<u8>,
}

struct NewChannel {
    id: u16,
    messages: u64,
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Appended {
    /// Messages by quantity. One without messages has no channel.
    pub messages: BTreeMap<Quantity, u64>,
    /// Log times of the earliest and the latest message; the earliest is later than the latest if there is none.
    pub times: (u64, u64),
    /// Bytes taken over from the log as they were.
    pub copied: u64,
    /// Bytes behind them.
    pub appended: u64,
}

impl<'a> Appender<'a> {
    /// Starts the output with a copy of the log's data section. The new messages will be in the `format`;
    /// `progress` is told of each stretch of bytes copied.
    ///
    /// # Errors
    /// The output cannot be created or written, or the log cannot be read.
    pub fn begin(
        log: &'a Log,
        destination: &Destination,
        format: Format,
        progress: impl FnMut(u64),
    ) -> Result<Self, Error> {
        let write_error = |source| destination.write_error(source);
        let metadata = log.file.handle().metadata();
        let permissions = metadata.map_err(write_error)?.permissions();
        let output = destination.create(permissions)?;
        copy(log, output.file(), progress).map_err(write_error)?;

        let file = output.file().try_clone().map_err(write_error)?;
        let mut region = Region::new(BufWriter::new(file), log.data_end, log.data_crc);
        let reindexed = write_missing_indexes(log, &mut region, write_error)?;
        let (region, seal) = region.sealable(preamble());
        let writer = WriteOptions::new()
            .profile("")
            .library("")
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .chunk_size(Some(CHUNK_SIZE))
            // A chunk index would hide the messages that lie outside chunks.
            .use_chunks(!log.contents.has_loose_messages())
            // Seeking would lead to the end of a file that is not the writer's.
            .disable_seeking(true)
            .emit_summary_records(false)
            .emit_summary_offsets(false)
            .emit_attachment_indexes(true)
            .emit_metadata_indexes(true)
            .create(region)
            .map_err(|error| append_error(destination, error))?;
        Ok(Self {
            log,
            format,
            output,
            writer,
            seal,
            reindexed,
            channels: BTreeMap::new(),
            times: (u64::MAX, 0),
            schemas: BTreeMap::new(),
            schema_ids: log.contents.schema_ids(),
            channel_ids: log.contents.channel_ids(),
            payload: Vec::new(),
        })
    }

    /// Appends one message, and before the first of a topic its channel.
    ///
    /// # Errors
    /// The output cannot be written, or the log has no id left for a channel.
    pub fn write(&mut self, derived: &Derived) -> Result<(), Error> {
        let quantity = derived.quantity();
        let channel = match self.channels.get_mut(&quantity) {
            Some(channel) => channel,
            None => {
                let channel = self.add_channel(quantity)?;
                self.channels.entry(quantity).or_insert(channel)
            }
        };
        let header = MessageHeader {
            channel_id: channel.id,
            // Sequence numbers wrap around, which takes a year of messages at 100 Hz.
            sequence: channel.messages as u32,
            log_time: derived.stamp.log_time,
            publish_time: derived.stamp.publish_time,
        };
        channel.messages += 1;
        let (earliest, latest) = self.times;
        self.times = (earliest.min(header.log_time), latest.max(header.log_time));
        self.payload.clear();
        let encoding = self.format.encoding;
        encoding.encode(derived, &mut self.payload);
        self.writer
            .write_to_known_channel(&header, &self.payload)
            .map_err(|error| append_error(self.output.destination(), error))
    }

    /// Completes the output, with `facts` on how its messages were made, and gives it its name.
    ///
    /// # Errors
    /// The output cannot be written, or something has come to be there meanwhile.
    pub fn finish(mut self, facts: BTreeMap<String, String>) -> Result<Appended, Error> {
        let log = self.log;
        let destination = self.output.destination();
        let write_error = |source| destination.write_error(source);
        let failed = |error| append_error(destination, error);

        let record = provenance::record(self.channels.keys().copied(), facts);
        self.writer.write_metadata(&record).map_err(failed)?;
        // An attachment has a time; the original's end belongs to the end of its messages.
        let log_time = log.contents.statistics.message_end_time;
        let attachment = Attachment {
            log_time,
            create_time: log_time,
            name: tail::NAME.to_owned(),
            media_type: tail::MEDIA_TYPE.to_owned(),
            data: Cow::Owned(tail::encode(log)?),
        };
        self.writer.attach(&attachment).map_err(failed)?;
        self.writer.flush().map_err(failed)?;
        self.seal.close();
        let appended = self.writer.finish().map_err(failed)?;

        let region = self.writer.into_inner();
        let position = region.position();
        let (crc, mut out) = region.into_parts();
        let mut end = Vec::new();
        let data_end = DataEnd {
            data_section_crc: crc.unwrap_or(0),
        };
        push_record(&mut end, op::DATA_END, &serialize(&data_end));
        let summary_start = position + end.len() as u64;
        end.extend(summary::encode(
            &log.contents,
            &appended,
            self.reindexed,
            summary_start,
        ));
        out.write_all(&end).map_err(write_error)?;
        out.flush().map_err(write_error)?;
        self.output.commit()?;
        Ok(Appended {
            messages: (self.channels.iter())
                .map(|(&quantity, channel)| (quantity, channel.messages))
                .collect(),
            times: self.times,
            copied: log.data_end,
            appended: position + end.len() as u64 - log.data_end,
        })
    }

    fn add_channel(&mut self, quantity: Quantity) -> Result<NewChannel, Error> {
        let encoding = self.format.encoding;
        let schema = encoding.schema(quantity);
        let schema_id = self.schema_id(&schema)?;
        let id = take_free_id(&mut self.channel_ids, 0);
        let id = id.ok_or_else(|| no_free_id(self.log, "channel"))?;
        self.writer
            .add_schema_with_id(schema_id, schema.name, schema.encoding, schema.data)
            .and_then(|_| {
                self.writer.add_channel_with_id(
                    id,
                    schema_id,
                    quantity.topic(),
                    encoding.message_encoding(),
                    &self.format.channel_metadata,
                )
            })
            .map_err(|error| append_error(self.output.destination(), error))?;
        Ok(NewChannel { id, messages: 0 })
    }

    /// The id of a new channel's schema: the one that the log, or another new channel, has for the same
    /// schema, else a free one.
    fn schema_id(&mut self, schema: &Schema) -> Result<u16, Error> {
        if let Some(&id) = self.schemas.get(schema.name) {
            return Ok(id);
        }
        let mut present = self.log.contents.definitions.schemas.values();
        let same = present.find(|present| {
            (
                present.name.as_str(),
                present.encoding.as_str(),
                present.data(),
            ) == (schema.name, schema.encoding, schema.data)
        });
        let id = match same {
            Some(same) => Some(same.id),
            // The schema id 0 means "no schema".
            None => take_free_id(&mut self.schema_ids, 1),
        };
        let id = id.ok_or_else(|| no_free_id(self.log, "schema"))?;
        self.schemas.insert(schema.name, id);
        Ok(id)
    }
}

/// What the official writer starts its file with.
fn preamble() -> Vec<u8> {
    let header = Header {
        profile: String::new(),
        library: String::new(),
    };
    let mut preamble = mcap::MAGIC.to_vec();
    push_record(&mut preamble, op::HEADER, &serialize(&header));
    preamble
}

fn append_error(destination: &Destination, error: mcap::McapError) -> Error {
    match error {
        mcap::McapError::Io(source) => destination.write_error(source),
        source => Error::Append {
            path: destination.path().into(),
            source,
        },
    }
}

fn no_free_id(log: &Log, what: &'static str) -> Error {
    Error::NoFreeId {
        path: log.file.path().into(),
        what,
    }
}

/// Uses the id above the largest in use, else the lowest free one from `lowest` on.
fn take_free_id(used: &mut BTreeSet<u16>, lowest: u16) -> Option<u16> {
    let id = match used.last() {
        None => Some(lowest),
        Some(largest) => largest
            .checked_add(1)
            .or_else(|| (lowest..=u16::MAX).find(|id| !used.contains(id))),
    }?;
    used.insert(id);
    Some(id)
}

/// Copies the log's data section to the start of the output. Between files the system copies without the
/// bytes passing through this program, where it can.
fn copy(log: &Log, output: &File, mut progress: impl FnMut(u64)) -> io::Result<()> {
    let mut input = log.file.handle();
    let mut output = output;
    input.seek(SeekFrom::Start(0))?;
    let mut left = log.data_end;
    while left > 0 {
        let copied = io::copy(&mut input.take(left.min(COPY_STEP)), &mut output)?;
        if copied == 0 {
            return Err(io::Error::new(
                ErrorKind::UnexpectedEof,
                "the log has become shorter while it was copied",
            ));
        }
        progress(copied);
        left -= copied;
    }
    Ok(())
}

/// Writes the message indexes that the log's chunks lack, without which a seeking reader refuses a chunk.
/// Gives the chunk indexes that point to them.
fn write_missing_indexes(
    log: &Log,
    region: &mut Region<Output>,
    write_error: impl Fn(io::Error) -> Error,
) -> Result<BTreeMap<u64, ChunkIndex>, Error> {
    let mut reindexed = BTreeMap::new();
    if log.contents.has_loose_messages() {
        return Ok(reindexed);
    }
    let mut reader = SegmentReader::new(log);
    for segment in &log.contents.segments {
        if let SegmentKind::Chunk {
            index,
            is_indexed: false,
        } = &segment.kind
        {
            let indexes = reader.message_indexes(segment)?;
            let mut bytes = Vec::new();
            let position = region.position();
            let chunk = summary::encode_message_indexes(index, &indexes, position, &mut bytes);
            region.write_all(&bytes).map_err(&write_error)?;
            reindexed.insert(segment.offset, chunk);
        }
    }
    Ok(reindexed)
}
