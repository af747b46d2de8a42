//! Logs written message by message.

use std::{collections::BTreeMap, fs, io::Cursor, path::PathBuf};

use flightcam::source::{
    profile::{Profile, ProfileChoice},
    request::Request,
};
use mcap::{WriteOptions, records::MessageHeader};
use prost::Message;
use prost_reflect::{DescriptorPool, DynamicMessage, MessageDescriptor};

use super::ros::Wire;

/// A log in the making, and its folder.
pub struct Logbook {
    pub writer: mcap::Writer<Cursor<Vec<u8>>>,
    folder: tempfile::TempDir,
}

impl Logbook {
    pub fn with_chunks_of(bytes: u64) -> Self {
        Self::with_options(WriteOptions::new().chunk_size(Some(bytes)))
    }

    pub fn with_options(options: WriteOptions) -> Self {
        Self {
            writer: options.create(Cursor::new(Vec::new())).expect("a writer"),
            folder: tempfile::tempdir().expect("a temporary folder"),
        }
    }

    /// A protobuf channel whose messages are `test.Message` of the given definition.
    pub fn protobuf(&mut self, topic: &str, definition: &str) -> (u16, MessageDescriptor) {
        let file = self.folder.path().join("test.proto");
        fs::write(
            &file,
            format!("syntax = \"proto3\"; package test; {definition}"),
        )
        .expect("written");
        let descriptors = protox::compile([&file], [self.folder.path()]).expect("a valid schema");
        let bytes = descriptors.encode_to_vec();
        let pool = DescriptorPool::decode(&bytes[..]).expect("a pool");
        let schema = self
            .writer
            .add_schema("test.Message", "protobuf", &bytes)
            .expect("a schema");
        let channel = self.channel(schema, topic, "protobuf");
        (
            channel,
            pool.get_message_by_name("test.Message")
                .expect("the message"),
        )
    }

    pub fn json(&mut self, topic: &str) -> u16 {
        self.channel(0, topic, "json")
    }

    /// A channel of ROS messages of the type `pkg/msg/Type` or `pkg/Type`.
    pub fn ros(&mut self, wire: Wire, topic: &str, name: &str, definition: &str) -> u16 {
        let schema = (self.writer)
            .add_schema(name, wire.schema_encoding(), definition.as_bytes())
            .expect("a schema");
        self.channel(schema, topic, wire.message_encoding())
    }

    pub fn channel(&mut self, schema: u16, topic: &str, encoding: &str) -> u16 {
        self.writer
            .add_channel(schema, topic, encoding, &BTreeMap::new())
            .expect("a channel")
    }

    /// Writes a message; times are in milliseconds.
    pub fn put(&mut self, channel_id: u16, time: u64, payload: &[u8]) {
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time: time * 1_000_000,
            publish_time: time * 1_000_000 + 7,
        };
        self.writer
            .write_to_known_channel(&header, payload)
            .expect("a message");
    }

    /// The log as a file, and its folder.
    pub fn finish(mut self) -> (tempfile::TempDir, PathBuf) {
        self.writer.finish().expect("the log is finished");
        let input = self.folder.path().join("log.mcap");
        fs::write(&input, self.writer.into_inner().into_inner()).expect("the log is written");
        (self.folder, input)
    }
}

/// For a profile in TOML.
pub fn request(profile: &str) -> Request {
    let profile = Profile::parse(profile).expect("a profile");
    Request {
        profile: ProfileChoice::Given(Box::new(profile)),
        ..Request::default()
    }
}

/// A protobuf message, given in the JSON form of protobuf.
pub fn protobuf_message(message: &MessageDescriptor, json: &str) -> Vec<u8> {
    let json = &mut serde_json::Deserializer::from_str(json);
    DynamicMessage::deserialize(message.clone(), json)
        .expect("a message")
        .encode_to_vec()
}
