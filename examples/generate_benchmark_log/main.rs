//! Writes a log for benchmarks to an MCAP file: any number of telemetry samples, and camera frames of any size.
//!
//! ```sh
//! cargo run --release --example generate_benchmark_log -- camera.mcap
//! cargo run --release --example generate_benchmark_log -- telemetry.mcap --seconds 3600 --frame-bytes 0
//! ```
//!
//! | topic           | encoding | content                                                       |
//! |-----------------|----------|---------------------------------------------------------------|
//! | `/drone/state`  | protobuf | `benchmark.DroneState`: attitude, velocity, position in one   |
//! | `/camera/image` | protobuf | `foxglove.CompressedImage`, with noise for an image           |
//!
//! Nothing depends on the clock or on chance, so the same arguments give the same bytes. Messages are written as
//! they are made, so only the disk limits the size.

mod camera;
mod flight;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::sync::Arc;

use clap::{Parser, ValueEnum, value_parser};
use mcap::{Channel, Message, Schema, WriteOptions, Writer};
use prost::Message as _;

use camera::CompressedImage;
use flight::DroneState;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const NANOS_PER_SECOND: u64 = 1_000_000_000;
/// 2026-05-14T09:30:00Z, in nanoseconds since 1970.
const START_TIME: u64 = 1_778_751_000 * NANOS_PER_SECOND;
/// From a message's publication to its arrival at the recorder, in nanoseconds.
const DELAY: u64 = 1_500_000;

/// Writes a log for benchmarks to an MCAP file.
#[derive(Parser)]
struct Arguments {
    /// The file to write; replaced if it exists.
    output: PathBuf,

    /// Length of the flight.
    #[arg(long, default_value_t = 300)]
    seconds: u32,

    /// Telemetry samples per second.
    #[arg(long, value_name = "HZ", default_value_t = 100, value_parser = value_parser!(u32).range(1..))]
    rate: u32,

    /// Camera frames per second.
    #[arg(long, value_name = "HZ", default_value_t = 30, value_parser = value_parser!(u32).range(1..))]
    frame_rate: u32,

    /// Bytes of each camera frame; 0 for a log without a camera.
    #[arg(long, value_name = "BYTES", default_value_t = 110_000)]
    frame_bytes: u32,

    /// How chunks are compressed.
    #[arg(long, value_enum, default_value = "zstd")]
    compression: Compression,

    /// Bytes of a chunk before compression.
    #[arg(long, value_name = "BYTES", default_value_t = 4 * 1024 * 1024)]
    chunk_bytes: u64,
}

#[derive(Clone, Copy, ValueEnum)]
enum Compression {
    None,
    Zstd,
    Lz4,
}

impl From<Compression> for Option<mcap::Compression> {
    fn from(compression: Compression) -> Self {
        match compression {
            Compression::None => None,
            Compression::Zstd => Some(mcap::Compression::Zstd),
            Compression::Lz4 => Some(mcap::Compression::Lz4),
        }
    }
}

/// One of the moments at which a channel has a message.
struct Moment {
    /// From 0 in each channel.
    number: u64,
    /// Nanoseconds since the start of the flight.
    time: u64,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let file = File::create(&arguments.output)
        .map_err(|error| format!("cannot create {}: {error}", arguments.output.display()))?;
    let mut writer = WriteOptions::new()
        .library("flightcam-benchmark")
        .compression(arguments.compression.into())
        // Compressing in threads gives other bytes, and the default depends on the machine.
        .compression_threads(0)
        .chunk_size(Some(arguments.chunk_bytes))
        .create(BufWriter::new(file))?;
    write_messages(&mut writer, &arguments)?;
    writer.finish()?;
    writer.into_inner().flush()?;
    Ok(())
}

/// Writes samples and frames in the order of their times.
fn write_messages(writer: &mut Writer<BufWriter<File>>, arguments: &Arguments) -> Result<()> {
    let frame_bytes = arguments.frame_bytes as usize;
    let filmed = if frame_bytes > 0 {
        arguments.seconds
    } else {
        0
    };
    let mut samples = moments(arguments.seconds, arguments.rate).peekable();
    let mut frames = moments(filmed, arguments.frame_rate).peekable();
    let state = channel(
        1,
        "/drone/state",
        "benchmark.DroneState",
        "drone_state.proto",
    )?;
    let image = channel(
        2,
        "/camera/image",
        "foxglove.CompressedImage",
        "compressed_image.proto",
    )?;
    let mut write = |channel: &Arc<Channel<'static>>, moment: &Moment, payload: &[u8]| {
        let publish_time = START_TIME + moment.time;
        writer.write(&Message {
            channel: Arc::clone(channel),
            sequence: moment.number as u32,
            log_time: publish_time + DELAY,
            publish_time,
            data: Cow::Borrowed(payload),
        })
    };
    loop {
        let is_next = |frame: &Moment| samples.peek().is_none_or(|sample| frame.time < sample.time);
        if let Some(frame) = frames.next_if(is_next) {
            let content = CompressedImage::new(frame.number, timestamp(frame.time), frame_bytes);
            write(&image, &frame, &content.encode_to_vec())?;
        } else if let Some(sample) = samples.next() {
            let content = DroneState::at(sample.time as f64 / NANOS_PER_SECOND as f64);
            write(&state, &sample, &content.encode_to_vec())?;
        } else {
            return Ok(());
        }
    }
}

/// So many moments in each of so many seconds.
fn moments(seconds: u32, rate: u32) -> impl Iterator<Item = Moment> {
    let rate = u64::from(rate);
    (0..u64::from(seconds) * rate).map(move |number| Moment {
        number,
        // Exact, and without overflow: whole seconds and the rest each by themselves.
        time: number / rate * NANOS_PER_SECOND + number % rate * NANOS_PER_SECOND / rate,
    })
}

fn timestamp(time: u64) -> prost_types::Timestamp {
    let time = START_TIME + time;
    prost_types::Timestamp {
        seconds: (time / NANOS_PER_SECOND) as i64,
        nanos: (time % NANOS_PER_SECOND) as i32,
    }
}

/// A channel, and a schema of the same id, which the writer adds with the first message.
fn channel(id: u16, topic: &str, message: &str, file: &str) -> Result<Arc<Channel<'static>>> {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/generate_benchmark_log"
    );
    let schema = Schema {
        id,
        name: message.to_owned(),
        encoding: "protobuf".to_owned(),
        data: protox::compile([file], [folder])?.encode_to_vec().into(),
    };
    Ok(Arc::new(Channel {
        id,
        topic: topic.to_owned(),
        schema: Some(Arc::new(schema)),
        message_encoding: "protobuf".to_owned(),
        metadata: BTreeMap::new(),
    }))
}
