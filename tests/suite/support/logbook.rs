//! Logs written message by message, enriched or read for their samples.

use std::{collections::BTreeMap, fs, io::Cursor, path::PathBuf};

use flightcam::{
    Error, Options, Report,
    enrich::enrich,
    geometry::DepressionAngle,
    log::Log,
    reader::Reader,
    sample::{Kind, Sample, Tallies, Tally, Velocity},
    source::{
        Source,
        profile::{Profile, ProfileChoice},
        request::Request,
    },
    unwatched,
};
use mcap::{WriteOptions, records::MessageHeader};
use prost::Message;
use prost_reflect::{DescriptorPool, DynamicMessage, MessageDescriptor};

use super::{DERIVED, Read, message::Said, ros::Wire, stream};

/// Velocities, and why how many others are dropped; or why none can be had.
pub type Found = Result<(Vec<[f64; 3]>, Vec<(&'static str, u64)>), String>;

/// A log in the making, and the folder that it is read in.
pub struct Logbook {
    pub writer: mcap::Writer<Cursor<Vec<u8>>>,
    folder: tempfile::TempDir,
}

impl Logbook {
    pub fn new() -> Self {
        Self::with_chunks_of(256)
    }

    pub fn with_chunks_of(bytes: u64) -> Self {
        let options = WriteOptions::new().chunk_size(Some(bytes));
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

    /// Writes flat JSON telemetry: a yaw in radians, and a velocity to the north.
    pub fn put_flat(&mut self, channel_id: u16, time: u64, yaw: &str, vx: &str) {
        let json = format!(r#"{{"roll":0,"pitch":0,"yaw":{yaw},"vx":{vx},"vy":0,"vz":0}}"#);
        self.put(channel_id, time, json.as_bytes());
    }

    /// Enriches the log with the camera at the horizon, where the rotation's yaw is the drone's own.
    pub fn enrich(self, profile: Option<&str>) -> Result<(Vec<Read>, Report), Error> {
        let (folder, input) = self.finish();
        let output = folder.path().join("result.mcap");
        let mut options = Options::new(DepressionAngle::from_degrees(0.0).expect("0°"));
        if let Some(profile) = profile {
            options.telemetry = request(profile);
        }
        let report = enrich(&input, &output, &options, &mut unwatched)?;
        let result = fs::read(output).expect("the result");
        let derived = stream(&result, false).into_iter();
        Ok((
            derived
                .filter(|message| DERIVED.contains(&message.topic.as_str()))
                .collect(),
            report,
        ))
    }

    /// The samples that a profile finds in the log, in time order, and what it drops.
    pub fn samples(self, profile: &str) -> Result<(Vec<Sample>, Tallies), Error> {
        let (_folder, input) = self.finish();
        let log = Log::open(&input)?;
        let source = Source::select(&log, &request(profile))?;
        let mut samples = Vec::new();
        let (_, dropped) = Reader::new(&log, source).for_each(|sample, _| {
            samples.push(sample);
            Ok::<_, Error>(())
        })?;
        Ok((samples, dropped))
    }

    /// The velocities that a profile finds in the log, in NED.
    pub fn velocities(self, profile: &str) -> Found {
        let (samples, tallies) = self.samples(profile).map_err(|error| error.to_string())?;
        let velocities = samples.iter().filter_map(|sample| match sample {
            Sample::Velocity(sample) => match sample.velocity {
                Velocity::Ned(velocity) => Some(velocity.into()),
                Velocity::Frd(_) => panic!("the profile says NED"),
            },
            _ => None,
        });
        Ok((velocities.collect(), dropped(&tallies[Kind::Velocity])))
    }

    /// The log as a file, and the folder that it lies in.
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

/// Of the messages of a topic, the times in milliseconds, and one of the numbers.
fn numbers(derived: &[Read], topic: &str, which: usize) -> Vec<(u64, f64)> {
    let of_topic = derived.iter().filter(|message| message.topic == topic);
    of_topic
        .map(|message| {
            let number = Said::by(message).numbers[which];
            // Away the last digits, which are geometry's subject.
            (message.log_time / 1_000_000, (number * 1e9).round() / 1e9)
        })
        .collect()
}

pub fn yaws(derived: &[Read]) -> Vec<(u64, f64)> {
    numbers(derived, "/camera/relative_rpy", 2)
}

pub fn forwards(derived: &[Read]) -> Vec<(u64, f64)> {
    numbers(derived, "/camera/velocity", 0)
}

pub fn dropped(tally: &Tally) -> Vec<(&'static str, u64)> {
    tally
        .dropped
        .iter()
        .map(|(reason, count)| (reason.name(), *count))
        .collect()
}
