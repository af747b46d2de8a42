//! Logs of the same messages in many shapes: the usual one, random ones, awkward ones.

use std::{borrow::Cow, collections::BTreeMap, io::Cursor};

use flightcam::log::record::serialize;
use mcap::{
    Attachment, Compression, WriteOptions,
    records::{MessageHeader, Metadata, op},
};
use proptest::prelude::*;

use super::Parts;

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

/// A chunked and indexed log with some messages outside its chunks, after them.
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

/// Any way to write a log that the official writer knows.
pub fn any_shape() -> impl Strategy<Value = Shape> {
    let flags = prop::collection::vec(any::<bool>(), 12);
    let compression =
        prop::sample::select(vec![None, Some(Compression::Zstd), Some(Compression::Lz4)]);
    let ids = prop::sample::select(vec![[1, 2], [0, 1], [65535, 7], [65534, 65535], [9, 0]]);
    let schema_id = prop::sample::select(vec![1, 2, 65535]);
    (flags, compression, 200..20_000u64, ids, schema_id).prop_map(
        |(flags, compression, chunk_size, channel_ids, schema_id)| Shape {
            options: WriteOptions::new()
                .compression_threads(0)
                .compression(compression)
                .chunk_size(Some(chunk_size))
                // Logs without chunks are rarer than one in two.
                .use_chunks(flags[0] || flags[1])
                .emit_message_indexes(flags[2])
                .emit_chunk_indexes(flags[3])
                .emit_statistics(flags[4])
                .emit_summary_offsets(flags[5])
                .repeat_channels(flags[6])
                .repeat_schemas(flags[6])
                .calculate_chunk_crcs(flags[7])
                // Without the chunks' checksums mcap 0.26 writes a wrong one for the data section.
                .calculate_data_section_crc(flags[7] && flags[8])
                .calculate_summary_section_crc(flags[9])
                .emit_attachment_indexes(flags[2])
                .emit_metadata_indexes(flags[4]),
            topic_after_topic: flags[10],
            attachment_and_metadata: flags[11],
            channel_ids,
            schema_id,
            ..Shape::default()
        },
    )
}

/// A log whose summary says the same many times. What replaces it says it once, so that the file gets shorter.
pub fn with_repeated_schemas() -> Vec<u8> {
    let mut parts = Parts::of(&Shape::default().write());
    let schema = parts
        .summary
        .iter()
        .find(|(opcode, _)| *opcode == op::SCHEMA);
    let schema = schema.expect("a schema").clone();
    parts.summary.extend(std::iter::repeat_n(schema, 2000));
    parts.join()
}

/// A log as left by a recorder that reserved more space than it came to use.
pub fn with_zeros_at_the_end() -> Vec<u8> {
    let log = Shape::default().write();
    let mut torn = log[..log.len() * 9 / 10].to_vec();
    torn.resize(log.len() + 3_000_000, 0);
    torn
}

/// A log so long that what is derived from it fills several chunks.
pub fn long_log() -> Vec<u8> {
    let shape = Shape::with(|options| options.chunk_size(Some(1024 * 1024)));
    Shape {
        messages: 5000,
        ..shape
    }
    .write()
}
