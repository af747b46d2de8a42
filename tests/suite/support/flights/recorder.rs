//! A log in the making.

use std::{fs, io::Cursor};

use mcap::{WriteOptions, Writer, records::MessageHeader};
use prost_reflect::{DescriptorPool, prost::Message as _};
use serde_json::Value;

use super::{
    definition::{self, Field, Wanted},
    encode::{self, Layout},
};

/// A message type as a log has it.
#[derive(Debug, Clone)]
pub struct Schema {
    pub name: String,
    pub encoding: &'static str,
    pub data: Vec<u8>,
    pub layout: Layout,
    pub fields: Vec<Field>,
}

impl Schema {
    /// `FOLDER/package/Name.msg` as ROS 2 records it.
    pub fn ros2(folder: &str, message: &str) -> Self {
        let (fields, text) = definition::ros(folder, message);
        Self {
            name: message.replace('/', "/msg/"),
            encoding: "ros2msg",
            data: text.into_bytes(),
            layout: Layout::Cdr { big_endian: false },
            fields,
        }
    }

    /// `FOLDER/package/Name.msg` as ROS 1 records it.
    pub fn ros1(folder: &str, message: &str) -> Self {
        let (fields, text) = definition::ros(folder, message);
        Self {
            name: message.to_owned(),
            encoding: "ros1msg",
            data: text.into_bytes(),
            layout: Layout::Ros1,
            fields,
        }
    }

    /// A message in the text of a `.proto` file, which may import those of `definitions/foxglove`.
    pub fn protobuf(text: &str, message: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("definition.proto");
        fs::write(&file, text).expect("written");
        let imported = definition::path("foxglove");
        let includes = [folder.path(), &imported];
        let descriptors = protox::compile([&file], includes).expect("a valid definition");
        let data = descriptors.encode_to_vec();
        let pool = DescriptorPool::decode(&data[..]).expect("a pool");
        let descriptor = pool.get_message_by_name(message).expect("the message");
        Self {
            name: message.to_owned(),
            encoding: "protobuf",
            data,
            layout: Layout::Protobuf { packed: true },
            fields: definition::protobuf(&descriptor),
        }
    }

    /// A message in the text of a JSON schema.
    pub fn json(text: &str, message: &str) -> Self {
        let schema = serde_json::from_str(text).expect("JSON");
        Self {
            name: message.to_owned(),
            encoding: "jsonschema",
            data: text.as_bytes().to_vec(),
            layout: Layout::Json,
            fields: definition::json(&schema),
        }
    }

    /// The same in big-endian CDR.
    pub fn big_endian(self) -> Self {
        let layout = Layout::Cdr { big_endian: true };
        Self { layout, ..self }
    }
}

/// A log, written topic after topic, as converters do.
pub struct Recorder {
    writer: Writer<Cursor<Vec<u8>>>,
    /// What is written on a topic goes onto another.
    rename: Box<dyn Fn(&str) -> String>,
    topics: Vec<String>,
}

impl Recorder {
    pub fn new() -> Self {
        let options = WriteOptions::new().chunk_size(Some(16 * 1024));
        Self {
            writer: options.create(Cursor::new(Vec::new())).expect("a writer"),
            rename: Box::new(str::to_owned),
            topics: Vec::new(),
        }
    }

    /// From now on, what is written on a topic goes onto another.
    pub fn rename(&mut self, rename: impl Fn(&str) -> String + 'static) {
        self.rename = Box::new(rename);
    }

    /// Writes all messages of a topic.
    pub fn topic(
        &mut self,
        topic: &str,
        schema: &Schema,
        messages: impl IntoIterator<Item = (u64, Wanted)>,
    ) {
        let topic = (self.rename)(topic);
        let encode = |(place, (time, wanted))| {
            let content = encode::fill(&schema.fields, wanted, place);
            (time, schema.layout.encode(&content))
        };
        let messages: Vec<(u64, Vec<u8>)> = messages.into_iter().enumerate().map(encode).collect();
        let schema_id = self
            .writer
            .add_schema(&schema.name, schema.encoding, &schema.data);
        let schema_id = schema_id.expect("a schema");
        self.put(
            schema_id,
            &topic,
            schema.layout.message_encoding(),
            messages,
        );
    }

    /// Writes all messages of a topic as JSON, with a JSON schema or without.
    pub fn json(
        &mut self,
        topic: &str,
        schema: Option<&Value>,
        messages: impl IntoIterator<Item = (u64, Value)>,
    ) {
        let topic = (self.rename)(topic);
        let schema_id = schema.map_or(0, |schema| {
            let data = schema.to_string().into_bytes();
            let schema_id = self.writer.add_schema("Reference", "jsonschema", &data);
            schema_id.expect("a schema")
        });
        let messages = messages.into_iter();
        let messages = messages.map(|(time, message)| (time, message.to_string().into_bytes()));
        self.put(schema_id, &topic, "json", messages.collect());
    }

    /// The topics that were written.
    pub fn topics(&self) -> &[String] {
        &self.topics
    }

    fn put(&mut self, schema_id: u16, topic: &str, encoding: &str, messages: Vec<(u64, Vec<u8>)>) {
        let metadata = Default::default();
        let channel = self
            .writer
            .add_channel(schema_id, topic, encoding, &metadata);
        let channel_id = channel.expect("a channel");
        self.topics.push(topic.to_owned());
        for (sequence, (time, payload)) in (0..).zip(messages) {
            let header = MessageHeader {
                channel_id,
                sequence,
                log_time: time,
                publish_time: time,
            };
            self.writer
                .write_to_known_channel(&header, &payload)
                .expect("a message");
        }
    }

    pub fn finish(mut self) -> Vec<u8> {
        self.writer.finish().expect("the log is finished");
        self.writer.into_inner().into_inner()
    }
}
