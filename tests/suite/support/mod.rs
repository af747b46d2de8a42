//! What the tests share: logs of any shape, and a judge of results that is made of the official reader.

pub mod flights;
pub mod folder;
pub mod help;
pub mod inspection;
pub mod layout;
pub mod logbook;
pub mod markdown;
pub mod message;
pub mod numbered;
pub mod piping;
pub mod random_topics;
pub mod rewriting;
pub mod ros;
pub mod selecting;
pub mod shapes;
pub mod small_disk;
pub mod small_logs;
pub mod telemetry;
pub mod topics;

pub use message::Read;

use std::{
    borrow::Cow,
    collections::BTreeMap,
    fs,
    io::Cursor,
    path::{Path, PathBuf},
};

use flightcam::{
    Error, Options, Report,
    enrich::enrich,
    geometry::DepressionAngle,
    log::record::{Records, push_record, serialize},
    messages::v1::OriginalTail,
};
use mcap::{
    Attachment, Summary, WriteOptions,
    records::{Footer, MessageHeader, Metadata, Record, Statistics, op},
    sans_io::{
        IndexedReadEvent, IndexedReader, LinearReadEvent, LinearReader, LinearReaderOptions,
    },
};
use prost::Message as _;
use sha2::{Digest, Sha256};

/// A file of this repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The folder of real logs; `None`, with a word on why, where there is none.
pub fn real_logs() -> Option<PathBuf> {
    let folder = match std::env::var_os("FLIGHTCAM_REAL_LOGS") {
        Some(folder) => PathBuf::from(folder),
        None => repository("../shared/real-logs"),
    };
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!(
        "skipped: no real logs in {}; name their folder in FLIGHTCAM_REAL_LOGS",
        folder.display()
    );
    None
}

/// 30° below the horizon, all else by default.
pub fn options() -> Options {
    options_at(30.0)
}

/// Another angle below the horizon, all else by default.
pub fn options_at(degrees: f64) -> Options {
    Options::new().depression(DepressionAngle::from_degrees(degrees).expect("it is in range"))
}

/// Enriches a log that lies in memory; gives the result's bytes and the report.
pub fn enrich_bytes(log: &[u8]) -> Result<(Vec<u8>, Report), Error> {
    enrich_bytes_with(log, &options())
}

pub fn enrich_bytes_with(log: &[u8], options: &Options) -> Result<(Vec<u8>, Report), Error> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let input = folder.path().join("log.mcap");
    let output = folder.path().join("result.mcap");
    fs::write(&input, log).expect("the log is written");
    let report = enrich(&input, &output, options)?;
    Ok((fs::read(output).expect("the result is read"), report))
}

// ---- Logs of any shape ----

pub const TELEMETRY: &str = "/drone/state";

/// How a log is written. Its messages are always the same: telemetry samples at 50 Hz, each with a message of
/// another topic.
#[derive(Debug, Clone)]
pub struct Shape {
    pub options: WriteOptions,
    /// The other topic first, then the telemetry, as converters do that go through topic after topic.
    pub topic_after_topic: bool,
    pub attachment_and_metadata: bool,
    pub channel_ids: [u16; 2],
    /// The telemetry's; 0 for none.
    pub schema_id: u16,
    /// How many telemetry samples.
    pub messages: u64,
}

pub const MESSAGES: u64 = 200;

impl Default for Shape {
    fn default() -> Self {
        Self {
            options: WriteOptions::new()
                .chunk_size(Some(4096))
                .compression_threads(0),
            topic_after_topic: false,
            attachment_and_metadata: false,
            channel_ids: [1, 2],
            schema_id: 1,
            messages: MESSAGES,
        }
    }
}

impl Shape {
    pub fn with(options: impl FnOnce(WriteOptions) -> WriteOptions) -> Self {
        let shape = Self::default();
        Self {
            options: options(shape.options.clone()),
            ..shape
        }
    }

    pub fn write(&self) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let mut writer = self.options.clone().create(&mut file).expect("a writer");
        let schema = br#"{"type":"object","properties":{"roll":{},"pitch":{},"yaw":{},"vx":{},"vy":{},"vz":{}}}"#;
        if self.schema_id != 0 {
            writer
                .add_schema_with_id(self.schema_id, "State", "jsonschema", schema)
                .expect("a schema");
        }
        let [telemetry, other] = self.channel_ids;
        for (id, schema, topic) in [(telemetry, self.schema_id, TELEMETRY), (other, 0, "/other")] {
            writer
                .add_channel_with_id(id, schema, topic, "json", &BTreeMap::new())
                .expect("a channel");
        }
        if self.attachment_and_metadata {
            let attachment = Attachment {
                log_time: 1,
                create_time: 2,
                name: "notes.txt".into(),
                media_type: "text/plain".into(),
                data: Cow::Borrowed(b"windy"),
            };
            writer.attach(&attachment).expect("an attachment");
            let metadata = Metadata {
                name: "vehicle".into(),
                metadata: BTreeMap::from([("airframe".into(), "quad".into())]),
            };
            writer.write_metadata(&metadata).expect("a metadata record");
        }
        let mut put = |channel_id, i: u64, payload: &[u8]| {
            let time = 1_000_000_000 + i * 20_000_000;
            let header = MessageHeader {
                channel_id,
                sequence: i as u32,
                log_time: time,
                publish_time: time - 1,
            };
            writer
                .write_to_known_channel(&header, payload)
                .expect("a message");
        };
        let passes: &[&[u16]] = match self.topic_after_topic {
            true => &[&[other], &[telemetry]],
            false => &[&[telemetry, other]],
        };
        for pass in passes {
            for i in 0..self.messages {
                for &channel in *pass {
                    match channel == telemetry {
                        true => put(channel, i, state(i).as_bytes()),
                        false => put(channel, i, format!("{{\"i\":{i}}}").as_bytes()),
                    }
                }
            }
        }
        writer.finish().expect("the log is finished");
        drop(writer);
        file.into_inner()
    }
}

/// The telemetry of [`Shape`] logs: a drone that circles.
fn state(i: u64) -> String {
    let turn = i as f64 * 0.05;
    serde_json::json!({
        "roll": 0.2, "pitch": -0.1 * turn.sin(), "yaw": (turn + 1.0).sin().atan2(turn.cos()),
        "vx": 5.0 * turn.cos(), "vy": 5.0 * turn.sin(), "vz": 0.1,
    })
    .to_string()
}

/// A chunked and indexed log with some messages of its own behind the chunks, outside any.
pub fn mixed_log() -> Vec<u8> {
    let mut parts = Parts::of(&Shape::default().write());
    for i in 0..3 {
        let mut body = serialize(&MessageHeader {
            channel_id: 2,
            sequence: 1000 + i,
            log_time: 1_000_000_000,
            publish_time: 0,
        });
        body.extend_from_slice(b"{}");
        parts.data.push((op::MESSAGE, body));
    }
    parts.data_section_crc = 0;
    parts.join()
}

// ---- Taking logs apart and putting them together ----

/// A log as its records: what is before DataEnd, and what lies in the summary (without its offsets).
pub struct Parts {
    pub data: Vec<(u8, Vec<u8>)>,
    pub data_section_crc: u32,
    pub summary: Vec<(u8, Vec<u8>)>,
}

impl Parts {
    /// The records of a log that has no closing magic.
    pub fn records(log: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
        let records = Records::new(&log[mcap::MAGIC.len()..]);
        records
            .map(|record| record.expect("a whole record"))
            .map(|record| (record.opcode, record.body))
    }

    pub fn of(log: &[u8]) -> Self {
        let mut parts = Self {
            data: Vec::new(),
            data_section_crc: 0,
            summary: Vec::new(),
        };
        let mut in_data = true;
        for (opcode, body) in Self::records(&log[..log.len() - mcap::MAGIC.len()]) {
            let kept = (opcode, body.to_vec());
            match opcode {
                op::DATA_END => {
                    in_data = false;
                    parts.data_section_crc = u32::from_le_bytes(body.try_into().expect("a CRC"));
                }
                op::FOOTER | op::SUMMARY_OFFSET => {}
                _ if in_data => parts.data.push(kept),
                _ => parts.summary.push(kept),
            }
        }
        parts
    }

    /// The log again. Checksums of what may have been changed are left out.
    pub fn join(&self) -> Vec<u8> {
        let mut log = mcap::MAGIC.to_vec();
        for (opcode, body) in &self.data {
            push_record(&mut log, *opcode, body);
        }
        push_record(&mut log, op::DATA_END, &self.data_section_crc.to_le_bytes());
        let summary_start = match self.summary.is_empty() {
            true => 0,
            false => log.len() as u64,
        };
        for (opcode, body) in &self.summary {
            push_record(&mut log, *opcode, body);
        }
        let footer = Footer {
            summary_start,
            ..Footer::default()
        };
        push_record(&mut log, op::FOOTER, &serialize(&footer));
        log.extend_from_slice(mcap::MAGIC);
        log
    }
}

/// A log up to the end of its last whole record.
pub fn whole_records(log: &[u8]) -> &[u8] {
    let magic = mcap::MAGIC.len().min(log.len());
    let torn = Records::new(&log[magic..]).find_map(Result::err);
    &log[..torn.map_or(log.len(), |torn| magic + torn.offset)]
}

// ---- The judge ----

/// The topics that enriching adds.
pub const DERIVED: [&str; 2] = ["/camera/relative_rpy", "/camera/velocity"];

/// Every message in the order of the file, read as a stream, with all checksums checked.
pub fn stream(log: &[u8], torn: bool) -> Vec<Read> {
    let mut channels = BTreeMap::new();
    let mut messages = Vec::new();
    each_record(log, torn, |record| match record {
        Record::Channel(channel) => {
            channels.insert(channel.id, (channel.topic, channel.message_encoding));
        }
        Record::Message { header, data } => {
            let (topic, encoding) = &channels[&header.channel_id];
            messages.push(Read::new(topic, encoding, &header, &data));
        }
        _ => {}
    });
    messages
}

/// Every record, those inside chunks included.
pub fn each_record(log: &[u8], torn: bool, mut take: impl FnMut(Record)) {
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_check_finishes_after_end_magic(true),
    );
    let mut rest = log;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let (head, tail) = rest.split_at(wanted.min(rest.len()));
                reader.insert(head.len()).copy_from_slice(head);
                reader.notify_read(head.len());
                rest = tail;
            }
            Ok(LinearReadEvent::Record { data, opcode }) => {
                take(mcap::parse_record(opcode, data).expect("a record that parses"));
            }
            Err(_) if torn => return,
            Err(error) => panic!("the official reader refuses the log: {error}"),
        }
    }
}

/// Every message in time order, read through the index.
pub fn indexed(log: &[u8]) -> Vec<Read> {
    let summary = Summary::read(log)
        .expect("a readable summary")
        .expect("a summary");
    let mut reader = IndexedReader::new(&summary).expect("an index");
    let mut messages = Vec::new();
    while let Some(event) = reader.next_event() {
        match event.expect("a readable log") {
            IndexedReadEvent::ReadChunkRequest { offset, length } => {
                let chunk = &log[offset as usize..][..length];
                reader
                    .insert_chunk_record_data(offset, chunk)
                    .expect("a readable chunk");
            }
            IndexedReadEvent::Message { header, data } => {
                let channel = &summary.channels[&header.channel_id];
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                messages.push(Read::new(topic, encoding, &header, data));
            }
        }
    }
    messages
}

/// Statistics counted over the data section.
pub fn recount(log: &[u8]) -> Statistics {
    let mut count = Statistics::default();
    let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
    let mut times: Option<(u64, u64)> = None;
    let mut ended = false;
    each_record(log, false, |record| match record {
        Record::DataEnd(_) => ended = true,
        _ if ended => {}
        Record::Schema { header, .. } => {
            schemas.insert(header.id, ());
        }
        Record::Channel(channel) => {
            channels.insert(channel.id, ());
        }
        Record::Message { header, .. } => {
            count.message_count += 1;
            *count
                .channel_message_counts
                .entry(header.channel_id)
                .or_default() += 1;
            let (start, end) = times.unwrap_or((header.log_time, header.log_time));
            times = Some((start.min(header.log_time), end.max(header.log_time)));
        }
        Record::Attachment { .. } => count.attachment_count += 1,
        Record::Metadata(_) => count.metadata_count += 1,
        _ => {}
    });
    count.schema_count = schemas.len() as u16;
    count.channel_count = channels.len() as u32;
    (count.message_start_time, count.message_end_time) = times.unwrap_or_default();
    count.chunk_count = Parts::of(log)
        .data
        .iter()
        .filter(|(opcode, _)| *opcode == op::CHUNK)
        .count() as u32;
    count
}

/// What a result carries of the original's end.
pub fn original_tail(result: &[u8]) -> OriginalTail {
    let summary = Summary::read(result)
        .expect("a readable summary")
        .expect("a summary");
    let index = summary
        .attachment_indexes
        .iter()
        .find(|index| index.name == "flightcam/original_tail")
        .expect("the attachment");
    let attachment = mcap::read::attachment(result, index).expect("a readable attachment");
    OriginalTail::decode(&attachment.data[..]).expect("an OriginalTail")
}

/// Checks all that a result promises, whatever the log's shape; gives the derived messages.
pub fn judge(log: &[u8], result: &[u8], torn: bool) -> Vec<Read> {
    let tail = original_tail(result);
    let data_end = tail.data_end as usize;
    assert!(
        result[..data_end] == log[..data_end],
        "the original bytes are unchanged"
    );

    let restored_tail = zstd::decode_all(&tail.tail_zstd[..]).expect("a zstd frame");
    assert_eq!(restored_tail.len() as u64, tail.tail_length);
    let restored = [&result[..data_end], &restored_tail].concat();
    assert!(
        restored == log,
        "the original can be given back byte for byte"
    );
    let hashed = data_end.min(64 * 1024);
    assert_eq!(tail.head_sha256, Sha256::digest(&log[..hashed]).to_vec());
    assert_eq!(
        tail.foot_sha256,
        Sha256::digest(&log[data_end - hashed..data_end]).to_vec()
    );
    assert_eq!(tail.tail_sha256, Sha256::digest(&restored_tail).to_vec());

    // What a torn chunk may still tell is in the original's end, not among the records.
    let original = stream(&log[..if torn { data_end } else { log.len() }], torn);
    let all = stream(result, false);
    let (derived, kept): (Vec<Read>, Vec<Read>) = all
        .iter()
        .cloned()
        .partition(|message| DERIVED.contains(&message.topic.as_str()));
    assert!(
        kept == original,
        "every original message is there, in its order"
    );
    assert!(derived.is_sorted_by_key(|message| message.log_time));
    for topic in DERIVED {
        let of_topic = derived.iter().filter(|message| message.topic == topic);
        assert!(
            of_topic
                .map(|message| message.sequence)
                .eq(0..count(&derived, topic))
        );
    }

    let summary = Summary::read(result)
        .expect("a readable summary")
        .expect("a summary");
    assert_eq!(summary.stats.as_ref(), Some(&recount(result)));
    let loose = Parts::of(result)
        .data
        .iter()
        .any(|(opcode, _)| *opcode == op::MESSAGE);
    assert_eq!(
        summary.chunk_indexes.is_empty(),
        loose,
        "an index, unless it would hide messages outside chunks"
    );
    if !loose {
        check_index_leads_to(all, result);
    }
    derived
}

fn count(messages: &[Read], topic: &str) -> u32 {
    messages
        .iter()
        .filter(|message| message.topic == topic)
        .count() as u32
}

/// The derived messages of the messages that every [`Shape`] has.
pub fn expected_of_any_shape() -> Vec<Read> {
    let log = Shape::default().write();
    let (result, _) = enrich_bytes(&log).expect("a log of the usual shape");
    judge(&log, &result, false)
}

/// Checks that the index of a log leads to all of its messages, in the order of their times.
#[track_caller]
pub fn check_index_leads_to(mut all: Vec<Read>, log: &[u8]) {
    let mut by_index = indexed(log);
    assert!(by_index.is_sorted_by_key(|message| message.log_time));
    by_index.sort();
    all.sort();
    assert!(by_index == all, "the index leads to every message");
}
