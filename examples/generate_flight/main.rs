//! Writes the log of a short survey flight of a camera drone to an MCAP file.
//!
//! ```sh
//! cargo run --example generate_flight -- flight.mcap
//! ```
//!
//! The flight takes about a minute: take-off to 40 m, four survey legs with turns between them that
//! carry the yaw through +-180 degrees both ways, a hover, the way home and the landing. Nothing in
//! it depends on the clock or on chance, so every run writes the same bytes.
//!
//! | topic             | encoding | rate               | content                        |
//! |-------------------|----------|--------------------|--------------------------------|
//! | `/drone/state`    | protobuf | 50 Hz              | `demo.DroneState`              |
//! | `/drone/battery`  | JSON     | 1 Hz               | voltage, current, percentage   |
//! | `/camera/trigger` | JSON     | every 8 m of a leg | number of the photo            |
//! | `/drone/log`      | JSON     | now and then       | `foxglove.Log`, mission phases |
//!
//! The file also has a metadata record (`vehicle`) and an attachment (`mission.json`).

mod flight;

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use clap::Parser;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, WriteOptions, Writer};
use nalgebra::Vector3;
use prost::Message as _;
use serde_json::{Value, json};

use flight::{Battery, Camera, Phase, Vehicle};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const NANOS_PER_SECOND: u64 = 1_000_000_000;
/// 2026-05-14T09:30:00Z, in nanoseconds since 1970.
const START_TIME: u64 = 1_778_751_000 * NANOS_PER_SECOND;
/// Steps of the simulation from one message to the next.
const STATE_STEPS: u64 = NANOS_PER_SECOND / 50 / flight::STEP_NANOS;
const BATTERY_STEPS: u64 = NANOS_PER_SECOND / flight::STEP_NANOS;

/// Where the drone takes off: degrees, degrees, and metres above the ellipsoid.
const HOME_LATITUDE: f64 = 47.397_742;
const HOME_LONGITUDE: f64 = 8.545_594;
const HOME_ALTITUDE: f64 = 535.3;

/// Writes the log of a short survey flight to an MCAP file.
#[derive(Parser)]
struct Arguments {
    /// The file to write; replaced if it exists.
    output: PathBuf,
}

/// The message of `/drone/state`, as telemetry.proto describes it.
#[derive(Clone, PartialEq, prost::Message)]
struct DroneState {
    #[prost(message, optional, tag = "1")]
    timestamp: Option<prost_types::Timestamp>,
    #[prost(double, tag = "2")]
    latitude: f64,
    #[prost(double, tag = "3")]
    longitude: f64,
    #[prost(double, tag = "4")]
    altitude: f64,
    #[prost(double, tag = "5")]
    roll: f64,
    #[prost(double, tag = "6")]
    pitch: f64,
    #[prost(double, tag = "7")]
    yaw: f64,
    #[prost(double, tag = "8")]
    vx: f64,
    #[prost(double, tag = "9")]
    vy: f64,
    #[prost(double, tag = "10")]
    vz: f64,
}

/// Identifiers of the channels in the file.
struct Channels {
    state: u16,
    battery: u16,
    trigger: u16,
    log: u16,
}

type LogWriter = Writer<BufWriter<File>>;
type Message = (MessageHeader, Vec<u8>);

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let file = File::create(&arguments.output)
        .map_err(|error| format!("cannot create {}: {error}", arguments.output.display()))?;
    let mission = flight::plan_mission();
    let mut writer = WriteOptions::new()
        .library("flightcam-demo")
        .compression(Some(Compression::Zstd))
        // Compressing in threads gives other bytes, and the default depends on the machine.
        .compression_threads(0)
        // Small chunks, so that even this short log has several.
        .chunk_size(Some(64 * 1024))
        .create(BufWriter::new(file))?;
    writer.write_metadata(&vehicle_metadata())?;
    writer.attach(&mission_attachment(&mission)?)?;
    let channels = add_channels(&mut writer)?;
    let messages = record_flight(&mission, &channels)?;
    write_messages(&mut writer, messages)?;
    writer.finish()?;
    writer.into_inner().flush()?;
    Ok(())
}

/// Flies the mission and returns what the drone publishes meanwhile.
fn record_flight(mission: &[Phase], channels: &Channels) -> Result<Vec<Message>> {
    let mut vehicle = Vehicle::parked(mission);
    let mut battery = Battery::charged();
    let mut camera = Camera::for_mission(mission);
    let mut messages = Vec::new();
    let mut step = 0_u64;
    for (number, phase) in (1..).zip(mission) {
        let log = log_entry(step_time(step), number, phase);
        messages.push(message(channels.log, step, serde_json::to_vec(&log)?));
        while vehicle.time() < phase.end() {
            battery.step(&vehicle, phase);
            if step.is_multiple_of(STATE_STEPS) {
                let state = drone_state(step_time(step), &vehicle).encode_to_vec();
                messages.push(message(channels.state, step, state));
            }
            if step.is_multiple_of(BATTERY_STEPS) {
                let status = serde_json::to_vec(&battery_status(&battery))?;
                messages.push(message(channels.battery, step, status));
            }
            if let Some(sequence) = camera.trigger(&vehicle) {
                let trigger = serde_json::to_vec(&json!({ "sequence": sequence }))?;
                messages.push(message(channels.trigger, step, trigger));
            }
            vehicle.step(phase);
            step += 1;
        }
    }
    Ok(messages)
}

fn step_time(step: u64) -> u64 {
    START_TIME + step * flight::STEP_NANOS
}

/// A message published at this step, and logged when it has come to the recorder.
fn message(channel_id: u16, step: u64, data: Vec<u8>) -> Message {
    // 0.3 to 4 ms: the upper bits of a product with a large odd number look random.
    let hash = (step * 4 + u64::from(channel_id)).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
    let delay = 300_000 + hash % 3_700_000;
    let publish_time = step_time(step);
    let log_time = publish_time + delay;
    (
        MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time,
        },
        data,
    )
}

fn drone_state(time: u64, vehicle: &Vehicle) -> DroneState {
    let [latitude, longitude, altitude] = geodetic(vehicle.position());
    let attitude = vehicle.attitude().map(|angle| round_to_bits(angle, 24));
    let velocity = vehicle.velocity().map(|speed| round_to_bits(speed, 20));
    let seconds = (time / NANOS_PER_SECOND) as i64;
    let nanos = (time % NANOS_PER_SECOND) as i32;
    DroneState {
        timestamp: Some(prost_types::Timestamp { seconds, nanos }),
        latitude: round_to_bits(latitude, 34),
        longitude: round_to_bits(longitude, 34),
        altitude: round_to_bits(altitude, 16),
        roll: attitude.x,
        pitch: attitude.y,
        yaw: flight::wrap_angle(attitude.z),
        vx: velocity.x,
        vy: velocity.y,
        vz: velocity.z,
    }
}

/// Latitude, longitude and altitude of a place given in NED from home.
fn geodetic(position: Vector3<f64>) -> [f64; 3] {
    const EQUATOR_RADIUS: f64 = 6_378_137.0;
    const ECCENTRICITY_SQUARED: f64 = 0.006_694_379_990_14;

    // Within a survey area, the earth's radii of curvature are as good as constant.
    let latitude = HOME_LATITUDE.to_radians();
    let flattening = 1.0 - ECCENTRICITY_SQUARED * latitude.sin().powi(2);
    let east_radius = EQUATOR_RADIUS / flattening.sqrt();
    let north_radius = east_radius * (1.0 - ECCENTRICITY_SQUARED) / flattening;
    let north_angle = position.x / (north_radius + HOME_ALTITUDE);
    let east_angle = position.y / ((east_radius + HOME_ALTITUDE) * latitude.cos());
    [
        HOME_LATITUDE + north_angle.to_degrees(),
        HOME_LONGITUDE + east_angle.to_degrees(),
        HOME_ALTITUDE - position.z,
    ]
}

/// Keeps this many binary digits after the point.
///
/// No sensor has 53 significant bits, the zeros compress well, and the last bit of a sine may
/// differ between platforms.
fn round_to_bits(value: f64, bits: i32) -> f64 {
    let scale = 2_f64.powi(bits);
    (value * scale).round() / scale
}

fn battery_status(battery: &Battery) -> Value {
    let round = |value: f64| (value * 1000.0).round() / 1000.0;
    json!({
        "voltage": round(battery.voltage()),
        "current": round(battery.current),
        "percentage": round(battery.percentage()),
    })
}

/// What the drone says when it begins the phase with this number, from 1.
fn log_entry(time: u64, number: u32, phase: &Phase) -> Value {
    const INFO: u8 = 2;
    json!({
        "timestamp": { "sec": time / NANOS_PER_SECOND, "nsec": time % NANOS_PER_SECOND },
        "level": INFO,
        "message": phase.name,
        "name": "commander",
        "file": "mission.json",
        "line": number,
    })
}

fn vehicle_metadata() -> Metadata {
    let entries = [
        ("airframe", "Quadrotor X, 3.2 kg"),
        ("autopilot", "Demo autopilot 1.4.0"),
        ("camera", "20 MP, 1 inch sensor, 8.8 mm lens"),
    ];
    let metadata = entries.map(|(key, value)| (key.to_owned(), value.to_owned()));
    Metadata {
        name: "vehicle".to_owned(),
        metadata: BTreeMap::from(metadata),
    }
}

/// The flight plan, as the drone got it ten minutes before the flight.
fn mission_attachment(mission: &[Phase]) -> Result<Attachment<'static>> {
    let phase = |phase: &Phase| json!({ "name": phase.name, "duration": phase.duration });
    let plan = json!({
        "home": [HOME_LATITUDE, HOME_LONGITUDE, HOME_ALTITUDE],
        "phases": mission.iter().map(phase).collect::<Vec<_>>(),
    });
    Ok(Attachment {
        log_time: START_TIME,
        create_time: START_TIME - 600 * NANOS_PER_SECOND,
        name: "mission.json".to_owned(),
        media_type: "application/json".to_owned(),
        data: serde_json::to_vec_pretty(&plan)?.into(),
    })
}

fn add_channels(writer: &mut LogWriter) -> Result<Channels> {
    let directory = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/generate_flight");
    let descriptors = protox::compile(["telemetry.proto"], [directory])?.encode_to_vec();
    let state_schema = writer.add_schema("demo.DroneState", "protobuf", &descriptors)?;
    Ok(Channels {
        state: writer.add_channel(state_schema, "/drone/state", "protobuf", &BTreeMap::new())?,
        battery: add_json_channel(
            writer,
            "/drone/battery",
            "demo.Battery",
            json!({
                "voltage": { "type": "number", "description": "V, under load" },
                "current": { "type": "number", "description": "A, positive while discharging" },
                "percentage": { "type": "number", "description": "Charge left, 0 to 100" },
            }),
        )?,
        trigger: add_json_channel(
            writer,
            "/camera/trigger",
            "demo.CameraTrigger",
            json!({ "sequence": { "type": "integer", "description": "Number of the photo" } }),
        )?,
        log: add_json_channel(writer, "/drone/log", "foxglove.Log", log_properties())?,
    })
}

fn add_json_channel(
    writer: &mut LogWriter,
    topic: &str,
    schema_name: &str,
    properties: Value,
) -> Result<u16> {
    let schema = json!({ "title": schema_name, "type": "object", "properties": properties });
    let schema = serde_json::to_vec(&schema)?;
    let schema_id = writer.add_schema(schema_name, "jsonschema", &schema)?;
    Ok(writer.add_channel(schema_id, topic, "json", &BTreeMap::new())?)
}

/// The fields of `foxglove.Log`, as Foxglove defines them.
fn log_properties() -> Value {
    let levels = ["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"];
    let levels = (0..)
        .zip(levels)
        .map(|(value, title)| json!({ "title": title, "const": value }));
    json!({
        "timestamp": {
            "type": "object",
            "title": "time",
            "properties": {
                "sec": { "type": "integer", "minimum": 0 },
                "nsec": { "type": "integer", "minimum": 0, "maximum": 999_999_999 },
            },
            "description": "Timestamp of log message",
        },
        "level": {
            "title": "foxglove.LogLevel",
            "description": "Log level",
            "oneOf": levels.collect::<Vec<_>>(),
        },
        "message": { "type": "string", "description": "Log message" },
        "name": { "type": "string", "description": "Process or node name" },
        "file": { "type": "string", "description": "Filename" },
        "line": { "type": "integer", "minimum": 0, "description": "Line number in the file" },
    })
}

/// Writes the messages in order of log time, counting those of each channel.
fn write_messages(writer: &mut LogWriter, mut messages: Vec<Message>) -> Result<()> {
    messages.sort_by_key(|(header, _)| header.log_time);
    let mut sequences = BTreeMap::new();
    for (mut header, data) in messages {
        let next = sequences.entry(header.channel_id).or_insert(0);
        header.sequence = *next;
        *next += 1;
        writer.write_to_known_channel(&header, &data)?;
    }
    Ok(())
}
