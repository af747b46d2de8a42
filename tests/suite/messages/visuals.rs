//! What viewers are shown, in each encoding: of which types it is, and that these say what was to be shown.

mod allocations;
mod channels;
mod contents;
mod definitions;
mod scenes;

use flightcam::{
    derived::visual::{Shown, Visual},
    messages::{Encoding, Format},
};
use serde_json::{Value, json};

use crate::support::shown_reading::{read, topic_and_type};

/// 2 s and 3 ns.
const TIME: u64 = 2_000_000_003;

fn format(encoding: Encoding) -> Format {
    Format {
        encoding,
        quality_of_service: String::new(),
        has_transforms: false,
    }
}

fn shown(visual: Visual) -> Shown {
    Shown { time: TIME, visual }
}

/// What is shown, read from Foxglove's types and from those of ROS 2.
fn read_both(visual: Visual) -> [Value; 2] {
    let shown = shown(visual);
    let [protobuf, json, ros2] = Encoding::ALL.map(|encoding| read(&format(encoding), &shown));
    assert_same(&json, &protobuf);
    [protobuf, ros2]
}

/// Zeros must have the same sign, too.
fn assert_same(found: &Value, expected: &Value) {
    assert_eq!(found, expected);
    assert_eq!(found.to_string(), expected.to_string());
}

// ---- What is expected of them ----

const PROTOBUF_TIME: &str = "1970-01-01T00:00:02.000000003Z";

fn header(frame_id: &str) -> Value {
    json!({ "stamp": { "sec": 2, "nanosec": 3 }, "frame_id": frame_id })
}

fn vector([x, y, z]: [f64; 3]) -> Value {
    json!({ "x": x, "y": y, "z": z })
}

fn quaternion([x, y, z, w]: [f64; 4]) -> Value {
    json!({ "x": x, "y": y, "z": z, "w": w })
}

fn not_turned() -> Value {
    quaternion([0.0, 0.0, 0.0, 1.0])
}

/// [`shown::pose`](crate::support::shown::pose).
fn pose() -> Value {
    json!({
        "position": vector([1.5, -2.5, 30.25]),
        "orientation": quaternion([-0.5, 0.5, -0.5, 0.5]),
    })
}

fn pose_at(position: [f64; 3]) -> Value {
    json!({ "position": vector(position), "orientation": not_turned() })
}
