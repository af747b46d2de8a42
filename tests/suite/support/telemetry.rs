//! The same flight in each encoding, in messages as large as those of real logs.

use std::{borrow::Cow, fmt};

use flightcam::{
    log::{Log, record::RawMessage},
    source::Source,
};
use serde_json::{Value, json};

use super::{
    logbook::{Logbook, protobuf_message, request},
    ros::{Field, List, Types, Wire},
};

/// What the messages are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    Protobuf,
    Json,
    Ros(Wire),
}

impl Language {
    pub const ALL: [Self; 5] = {
        let [little_endian, big_endian, ros1] = Wire::ALL;
        [
            Self::Protobuf,
            Self::Json,
            Self::Ros(little_endian),
            Self::Ros(big_endian),
            Self::Ros(ros1),
        ]
    };
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Protobuf => "protobuf",
            Self::Json => "json",
            Self::Ros(Wire::LittleEndian) => "cdr",
            Self::Ros(Wire::BigEndian) => "cdr-big-endian",
            Self::Ros(Wire::Ros1) => "ros1",
        })
    }
}

/// Whose messages they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// PX4's `VehicleAttitude` and `VehicleLocalPosition`.
    Px4,
    /// ROS's `nav_msgs/Odometry`, which has the attitude and the velocity.
    Odometry,
}

impl Kind {
    pub const ALL: [Self; 2] = [Self::Px4, Self::Odometry];

    pub fn name(self) -> &'static str {
        match self {
            Self::Px4 => "px4",
            Self::Odometry => "odometry",
        }
    }

    pub fn profile(self) -> &'static str {
        match self {
            Self::Px4 => {
                r#"
                name = "px4"
                [attitude]
                topics = ["/attitude"]
                orientation.quaternion = "q"
                convention = "frd-ned"
                reset_counter = { field = "quat_reset_counter" }
                [velocity]
                topics = ["/local_position"]
                vector = ["vx", "vy", "vz"]
                frame = "ned"
                valid = ["v_xy_valid", "v_z_valid"]
                "#
            }
            Self::Odometry => {
                r#"
                name = "odometry"
                [attitude]
                topics = ["/odometry"]
                orientation.quaternion = "pose.pose.orientation"
                convention = "flu-enu"
                [velocity]
                topics = ["/odometry"]
                vector = "twist.twist.linear"
                frame = "body-flu"
                "#
            }
        }
    }

    fn topics(self, language: Language) -> Vec<Topic> {
        match self {
            Self::Px4 => vec![
                Topic {
                    name: "/attitude",
                    message_type: "px4_msgs/VehicleAttitude",
                    types: Types::from([("px4_msgs/VehicleAttitude", VEHICLE_ATTITUDE)]),
                    message: vehicle_attitude,
                },
                Topic {
                    name: "/local_position",
                    message_type: "px4_msgs/VehicleLocalPosition",
                    types: Types::from([("px4_msgs/VehicleLocalPosition", VEHICLE_LOCAL_POSITION)]),
                    message: vehicle_local_position,
                },
            ],
            Self::Odometry => vec![Topic {
                name: "/odometry",
                message_type: "nav_msgs/Odometry",
                types: odometry_types(language),
                message: match language {
                    Language::Ros(Wire::Ros1) => odometry_of_ros1,
                    _ => odometry,
                },
            }],
        }
    }
}

struct Topic {
    name: &'static str,
    message_type: &'static str,
    types: Types,
    /// The message at that many seconds.
    message: fn(f64) -> Value,
}

/// A log of that many moments 10 ms apart, each with an attitude and a velocity.
pub fn write(kind: Kind, language: Language, moments: u64) -> Logbook {
    let mut log = Logbook::with_chunks_of(768 * 1024);
    for topic in kind.topics(language) {
        let (channel, encode): (u16, Box<dyn Fn(Value) -> Vec<u8>>) = match language {
            Language::Protobuf => {
                let definition = in_protobuf(&topic.types, topic.message_type);
                let (channel, message) = log.protobuf(topic.name, &definition);
                let encode = move |value: Value| protobuf_message(&message, &value.to_string());
                (channel, Box::new(encode))
            }
            Language::Json => (
                log.json(topic.name),
                Box::new(|value| value.to_string().into_bytes()),
            ),
            Language::Ros(wire) => {
                let text = topic.types.text(topic.message_type);
                let channel = log.ros(wire, topic.name, topic.message_type, &text);
                let types = topic.types.clone();
                let encode = move |value: Value| types.serialize(wire, topic.message_type, &value);
                (channel, Box::new(encode))
            }
        };
        for moment in 0..moments {
            let message = (topic.message)(moment as f64 * 0.01);
            log.put(channel, 1000 + 10 * moment, &encode(message));
        }
    }
    log
}

/// The telemetry of a log in memory: what reads it, and its messages.
pub struct InMemory {
    pub source: Source,
    messages: Vec<mcap::Message<'static>>,
}

impl InMemory {
    pub fn read(log: Logbook, profile: &str) -> Self {
        let (_folder, input) = log.finish();
        let bytes = std::fs::read(&input).expect("the log");
        let log = Log::open(&input).expect("a readable log");
        let messages = mcap::MessageStream::new(&bytes).expect("a log");
        Self {
            source: Source::select(&log, &request(profile)).expect("the telemetry"),
            messages: messages
                .map(|message| message.expect("a message"))
                .map(|message| mcap::Message {
                    data: Cow::Owned(message.data.into_owned()),
                    ..message
                })
                .collect(),
        }
    }

    /// What reads the messages, and these.
    pub fn parts(&mut self) -> (&mut Source, Vec<RawMessage<'_>>) {
        let raw = self.messages.iter().map(|message| RawMessage {
            channel_id: message.channel.id,
            log_time: message.log_time,
            publish_time: message.publish_time,
            payload: &message.data,
        });
        (&mut self.source, raw.collect())
    }
}

// ---- The flight: circles, a little pitched ----

fn heading(seconds: f64) -> f64 {
    0.3 * seconds
}

fn vehicle_attitude(seconds: f64) -> Value {
    let (half_yaw, half_pitch) = (heading(seconds) / 2.0, 0.05 * seconds.sin());
    let microseconds = (seconds * 1e6) as u64;
    json!({
        "timestamp": microseconds,
        "timestamp_sample": microseconds.saturating_sub(300),
        "q": [
            (half_yaw.cos() * half_pitch.cos()) as f32,
            (-half_yaw.sin() * half_pitch.sin()) as f32,
            (half_yaw.cos() * half_pitch.sin()) as f32,
            (half_yaw.sin() * half_pitch.cos()) as f32,
        ],
        "delta_q_reset": [1.0, 0.0, 0.0, 0.0],
        "quat_reset_counter": 1,
    })
}

fn vehicle_local_position(seconds: f64) -> Value {
    let field = |field: &Field, place: usize| match (field.name.as_str(), field.base.as_str()) {
        ("vx", _) => json!((8.0 * heading(seconds).cos()) as f32),
        ("vy", _) => json!((8.0 * heading(seconds).sin()) as f32),
        (_, "bool") => json!(true),
        (_, "uint8") => json!(place),
        (_, "uint64") => json!((seconds * 1e6) as u64),
        (_, "float64") => json!(47.3977419 + seconds * 1e-5),
        _ => json!((0.1 * place as f64 + seconds).sin() as f32),
    };
    let lines = VEHICLE_LOCAL_POSITION.lines().enumerate();
    let fields = lines.map(|(place, line)| {
        let known: Field = line.parse().expect("a field");
        let value = match known.list {
            List::Fixed(length) => vec![field(&known, place); length].into(),
            _ => field(&known, place),
        };
        (known.name, value)
    });
    Value::Object(fields.collect())
}

fn odometry(seconds: f64) -> Value {
    let (x, z) = (0.02 * seconds.sin(), heading(seconds) / 2.0);
    let covariance = |scale: f64| -> Vec<f64> {
        let element = |i: i32| match i % 7 {
            0 => scale * f64::from(1 + i) * (1.1 + seconds.sin()),
            _ => 0.0,
        };
        (0..36).map(element).collect()
    };
    let vector = |x: f64, y: f64, z: f64| json!({ "x": x, "y": y, "z": z });
    json!({
        "header": { "stamp": { "sec": seconds as u32, "nanosec": 250_000 }, "frame_id": "map" },
        "child_frame_id": "base_link",
        "pose": {
            "pose": {
                "position": vector(26.0 * z.sin(), 26.0 * z.cos(), 40.0),
                "orientation": {
                    "x": x * z.cos(), "y": x * z.sin(),
                    "z": z.sin() * (1.0 - x * x).sqrt(), "w": z.cos() * (1.0 - x * x).sqrt(),
                },
            },
            "covariance": covariance(1e-3),
        },
        "twist": {
            "twist": {
                "linear": vector(8.0 + 0.1 * seconds.sin(), 0.03, -0.01),
                "angular": vector(0.001, 0.002 * seconds.cos(), 0.3),
            },
            "covariance": covariance(1e-4),
        },
    })
}

fn odometry_of_ros1(seconds: f64) -> Value {
    let mut message = odometry(seconds);
    let stamp = json!({ "sec": seconds as u32, "nsec": 250_000 });
    message["header"] =
        json!({ "seq": (seconds * 100.0) as u32, "stamp": stamp, "frame_id": "map" });
    message
}

// ---- The definitions ----

/// The definition of a type in protobuf, as `Message`.
fn in_protobuf(types: &Types, name: &str) -> String {
    let short = |other: &str| match other == name {
        true => "Message".to_owned(),
        false => other.rsplit('/').next().unwrap_or(other).to_owned(),
    };
    let mut text = String::new();
    for (other, fields) in &types.0 {
        text += &format!("message {} {{\n", short(other));
        for (field, number) in fields.iter().zip(1..) {
            let kind = match field.base.as_str() {
                "uint8" => "uint32".to_owned(),
                "float32" => "float".to_owned(),
                "float64" => "double".to_owned(),
                same => short(same),
            };
            let repeated = if field.list == List::No {
                ""
            } else {
                "repeated "
            };
            text += &format!("{repeated}{kind} {} = {number};\n", field.name);
        }
        text += "}\n";
    }
    text
}

const VEHICLE_ATTITUDE: &str = "\
uint64 timestamp
uint64 timestamp_sample
float32[4] q
float32[4] delta_q_reset
uint8 quat_reset_counter";

const VEHICLE_LOCAL_POSITION: &str = "\
uint64 timestamp
uint64 timestamp_sample
bool xy_valid
bool z_valid
bool v_xy_valid
bool v_z_valid
float32 x
float32 y
float32 z
float32[2] delta_xy
uint8 xy_reset_counter
float32 delta_z
uint8 z_reset_counter
float32 vx
float32 vy
float32 vz
float32 z_deriv
float32[2] delta_vxy
uint8 vxy_reset_counter
float32 delta_vz
uint8 vz_reset_counter
float32 ax
float32 ay
float32 az
float32 heading
float32 heading_var
float32 unaided_heading
float32 delta_heading
uint8 heading_reset_counter
bool heading_good_for_control
float32 tilt_var
bool xy_global
bool z_global
uint64 ref_timestamp
float64 ref_lat
float64 ref_lon
float32 ref_alt
bool dist_bottom_valid
float32 dist_bottom
float32 dist_bottom_var
float32 delta_dist_bottom
uint8 dist_bottom_reset_counter
uint8 dist_bottom_sensor_bitfield
float32 eph
float32 epv
float32 evh
float32 evv
bool dead_reckoning
float32 vxy_max
float32 vz_max
float32 hagl_min
float32 hagl_max_z
float32 hagl_max_xy";

fn odometry_types(language: Language) -> Types {
    let mut types = Types::from([
        (
            "nav_msgs/Odometry",
            "std_msgs/Header header\nstring child_frame_id\n\
             geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist",
        ),
        (
            "std_msgs/Header",
            "builtin_interfaces/Time stamp\nstring frame_id",
        ),
        ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec"),
        (
            "geometry_msgs/PoseWithCovariance",
            "geometry_msgs/Pose pose\nfloat64[36] covariance",
        ),
        (
            "geometry_msgs/Pose",
            "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
        ),
        ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z"),
        (
            "geometry_msgs/Quaternion",
            "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
        ),
        (
            "geometry_msgs/TwistWithCovariance",
            "geometry_msgs/Twist twist\nfloat64[36] covariance",
        ),
        (
            "geometry_msgs/Twist",
            "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular",
        ),
        ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z"),
    ]);
    if language == Language::Ros(Wire::Ros1) {
        types.0.remove("builtin_interfaces/Time");
        let header = "uint32 seq\ntime stamp\nstring frame_id";
        types.0.extend(Types::from([("std_msgs/Header", header)]).0);
    }
    types
}
