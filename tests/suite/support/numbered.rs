//! Logs of numbered messages, and the samples that must be read from them.

use std::{collections::BTreeMap, io::Cursor, iter};

use flightcam::{
    Error,
    log::Log,
    reader::Reader,
    sample::{Kind, Sample, Tallies, Velocity},
    source::Source,
};
use mcap::{
    Compression, Summary, WriteOptions,
    records::{ChunkIndex, MessageHeader},
};

use super::{
    folder::{Folder, LOG},
    logbook::request,
};

pub const PROFILE: &str = r#"
    name = "separate topics"
    [attitude]
    topics = ["/attitude"]
    orientation.euler = { roll = "zero", pitch = "zero", yaw = "yaw", unit = "radians" }
    convention = "frd-ned"
    [velocity]
    topics = ["/velocity"]
    vector = ["vx", "zero", "zero"]
    frame = "ned"
"#;

/// The start of a profile in which the time of a sample is not its log time.
pub const MEASURED: &str = r#"time = { field = { path = "measured", unit = "ns" } }"#;

/// What a message has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    Attitude,
    Velocity,
    /// A velocity without a number that is needed.
    Incomplete,
    /// Noise, which no compression shortens.
    Frame,
}

#[derive(Debug, Clone, Copy)]
pub struct Message {
    pub content: Content,
    /// Nanoseconds.
    pub time: u64,
    /// How many bytes it has besides those that it needs.
    pub padding: usize,
}

impl Content {
    pub fn channel_id(self) -> u16 {
        match self {
            Self::Attitude => 1,
            Self::Velocity | Self::Incomplete => 2,
            Self::Frame => 3,
        }
    }
}

impl Message {
    /// A time in the message itself: the later it was logged, the earlier.
    pub fn measured(&self) -> u64 {
        6000_u64.saturating_sub(self.time)
    }

    /// The content of the n-th message: its number, which distinguishes it from the others.
    pub fn payload(&self, n: usize) -> Vec<u8> {
        let name = match self.content {
            Content::Attitude => "yaw",
            Content::Velocity => "vx",
            Content::Incomplete => "vz",
            Content::Frame => return noise(self.padding, n as u64),
        };
        let number = n as f64 / 1000.0;
        let measured = self.measured();
        let padding = " ".repeat(self.padding);
        format!(r#"{{"zero":0,"measured":{measured},{padding}"{name}":{number}}}"#).into_bytes()
    }
}

pub fn noise(length: usize, seed: u64) -> Vec<u8> {
    let mut state = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let words = iter::repeat_with(|| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state.to_le_bytes()
    });
    words.flatten().take(length).collect()
}

pub fn write(options: WriteOptions, messages: &[Message]) -> Vec<u8> {
    let mut writer = options.create(Cursor::new(Vec::new())).expect("a writer");
    let schema = br#"{"properties":{"zero":{},"measured":{},"yaw":{},"vx":{}}}"#;
    let schema = writer.add_schema("Message", "jsonschema", schema);
    let schema = schema.expect("a schema");
    for (id, schema, topic, encoding) in [
        (1, schema, "/attitude", "json"),
        (2, schema, "/velocity", "json"),
        (3, 0, "/video", "h264"),
    ] {
        let added = writer.add_channel_with_id(id, schema, topic, encoding, &BTreeMap::new());
        added.expect("a channel");
    }
    for (n, message) in messages.iter().enumerate() {
        let header = MessageHeader {
            channel_id: message.content.channel_id(),
            sequence: n as u32,
            log_time: message.time,
            publish_time: message.time,
        };
        let written = writer.write_to_known_channel(&header, &message.payload(n));
        written.expect("a message");
    }
    writer.finish().expect("the log is finished");
    writer.into_inner().into_inner()
}

/// A sample's time, its kind, and the number of its message.
pub type ReadSample = (u64, Kind, usize);

pub fn describe(sample: Sample) -> ReadSample {
    let number = match sample {
        Sample::Attitude(sample) => sample.orientation.euler_angles().2,
        Sample::Velocity(sample) => match sample.velocity {
            Velocity::Ned(velocity) => velocity.x,
            Velocity::Frd(_) => panic!("the profile says NED"),
        },
        _ => panic!("only these two are read"),
    };
    (
        sample.stamp().log_time,
        sample.kind(),
        (number * 1000.0).round() as usize,
    )
}

/// The samples of messages, sorted by time, and at equal times in the order of the file.
pub fn sorted(messages: &[Message], time: impl Fn(&Message) -> u64) -> Vec<ReadSample> {
    let mut samples: Vec<ReadSample> = (messages.iter().enumerate())
        .filter_map(|(n, message)| match message.content {
            Content::Attitude => Some((time(message), Kind::Attitude, n)),
            Content::Velocity => Some((time(message), Kind::Velocity, n)),
            Content::Incomplete | Content::Frame => None,
        })
        .collect();
    samples.sort_unstable();
    samples
}

pub const LOGGED: fn(&Message) -> u64 = |message| message.time;

/// Hands a log's samples to `take` until that fails.
pub fn read_with(
    log: &[u8],
    profile: &str,
    mut take: impl FnMut(Sample, u64) -> Result<(), Error>,
) -> Result<(Source, Tallies), Error> {
    let folder = Folder::with(LOG, log);
    let log = Log::open(&folder.path(LOG))?;
    let source = Source::select(&log, &request(profile))?;
    let read =
        Reader::new(&log, source)?.for_each(|arrival| take(arrival.sample, arrival.bytes_read))?;
    Ok((read.source, read.dropped))
}

/// The samples that were read, and the error that ended the reading or its results.
pub fn read(log: &[u8], profile: &str) -> (Vec<ReadSample>, Result<(Source, Tallies), Error>) {
    let mut samples = Vec::new();
    let outcome = read_with(log, profile, |sample, _| {
        samples.push(describe(sample));
        Ok(())
    });
    (samples, outcome)
}

/// A message of each kind in turn, with frames of that length.
pub fn flight(messages: u64, frame: usize) -> Vec<Message> {
    let contents = [
        Content::Velocity,
        Content::Incomplete,
        Content::Attitude,
        Content::Frame,
    ];
    (0..messages)
        .map(|n| {
            let content = contents[n as usize % 4];
            Message {
                content,
                time: 1000 + n,
                padding: if content == Content::Frame { frame } else { 0 },
            }
        })
        .collect()
}

pub fn chunks_of(size: u64, compression: Option<Compression>) -> WriteOptions {
    WriteOptions::new()
        .chunk_size(Some(size))
        .compression(compression)
        .compression_threads(0)
}

pub fn chunk_indexes(log: &[u8]) -> Vec<ChunkIndex> {
    let summary = Summary::read(log).expect("a readable summary");
    summary.expect("a summary").chunk_indexes
}
