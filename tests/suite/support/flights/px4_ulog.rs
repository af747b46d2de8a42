//! PX4's own logs, as each converter makes them MCAP.

use super::{
    definition::{self, Count, Field, Kind, Number},
    encode::Layout,
    flight::Flight,
    px4::Px4,
    recorder::{Recorder, Schema},
    recording::{Recording, Reference},
};

pub fn recordings() -> Vec<Recording> {
    vec![
        recording("Foxglove's Python converter", |flight, log| {
            let mut log = converted(flight, log, |name| format!("/{name}"), python);
            log.vehicle_attitude("1.17").vehicle_local_position("1.17");
            log.gimbal("1.17", 32).vehicle_global_position("1.17");
            log.sensor_combined("1.17");
        })
        .with_gimbal(Reference::Heading)
        .with_geodetic(FLOAT_METRES),
        recording("Foxglove's Python converter, older PX4", |flight, log| {
            let mut log = converted(flight, log, |name| format!("/{name}"), python);
            log.vehicle_attitude("1.14").vehicle_local_position("1.14");
            log.gimbal("1.14", 0).vehicle_gps_position_1_14();
        })
        .with_gimbal(Reference::Heading)
        .with_geodetic(MILLIMETRE),
        recording("Foxglove's TypeScript converter", |flight, log| {
            let mut log = converted(flight, log, str::to_owned, typescript);
            log.vehicle_attitude("1.15").vehicle_local_position("1.15");
            log.gimbal("1.15", 64).vehicle_global_position_1_15();
        })
        .with_gimbal(Reference::Earth)
        .with_geodetic(FLOAT_METRES),
        recording("mcap convert", |flight, log| {
            let mut log = converted(flight, log, |name| format!("{name}/0"), mcap_convert);
            log.vehicle_attitude("1.17").vehicle_local_position("1.17");
            log.gimbal("1.17", 16).vehicle_gps_position("1.17");
            log.filtered_imu("1.17");
        })
        .with_gimbal(Reference::Earth)
        .with_geodetic(1e-9),
        recording("pyulog", |flight, log| {
            let mut log = converted(flight, log, |name| format!("/px4/{name}"), ulog2ros2bag);
            log.vehicle_attitude("1.17")
                .vehicle_local_position("1.17")
                .gimbal("1.17", 32 | 16);
        })
        .with_gimbal(Reference::Heading)
        .with_local(FLOAT_METRES),
        recording("JSON", |flight, log| {
            let mut log = converted(flight, log, str::to_owned, json);
            log.vehicle_attitude("1.17").vehicle_local_position("1.17");
        })
        .with_local(FLOAT_METRES),
    ]
}

/// What float32 leaves of an altitude of 500 m.
const FLOAT_METRES: f64 = 1e-4;
const MILLIMETRE: f64 = 1e-3;

/// What float32 leaves of a height of 60 m.
const HEIGHTS: f64 = 1e-5;

fn recording(name: &str, write: impl Fn(&Flight, &mut Recorder) + 'static) -> Recording {
    Recording::new("px4-ulog", name, Flight::new(), write)
        .with_floats()
        .with_heights(HEIGHTS)
}

fn converted<'a>(
    flight: &'a Flight,
    log: &'a mut Recorder,
    topic: fn(&str) -> String,
    schema: fn(&str, &str, &str) -> Schema,
) -> Px4<'a> {
    Px4 {
        flight,
        log,
        topic,
        schema,
    }
}

/// <https://github.com/foxglove/mcap/blob/95d06735/python/examples/ulog2mcap/convert.py>
fn python(release: &str, message: &str, name: &str) -> Schema {
    let mut fields = uorb_fields(release, message);
    fields.retain(|field| field.name != "timestamp");
    let message = protobuf_message(name, "", &fields);
    let text = format!("syntax = \"proto3\"; package ulog; {message}");
    Schema::protobuf(&text, &format!("ulog.{name}"))
}

/// <https://github.com/foxglove/mcap/blob/95d06735/typescript/examples/ulog2mcap/scripts/convertULogFileToMCAP.ts>
fn typescript(release: &str, message: &str, name: &str) -> Schema {
    let message = protobuf_message(name, "required", &uorb_fields(release, message));
    let schema = Schema::protobuf(&format!("syntax = \"proto2\"; {message}"), name);
    Schema {
        layout: Layout::Protobuf { packed: false },
        ..schema
    }
}

/// <https://github.com/foxglove/mcap/pull/1751>
fn mcap_convert(release: &str, message: &str, name: &str) -> Schema {
    let message = protobuf_message(name, "", &uorb_fields(release, message));
    let text = format!("syntax = \"proto3\"; package px4; {message}");
    Schema::protobuf(&text, &format!("px4.{name}"))
}

/// <https://github.com/PX4/pyulog/blob/3cf17793/pyulog/ulog2ros2bag.py>
fn ulog2ros2bag(release: &str, message: &str, _name: &str) -> Schema {
    Schema::ros2(&format!("px4_{release}"), &format!("px4_msgs/{message}"))
}

fn json(release: &str, message: &str, name: &str) -> Schema {
    let properties = uorb_fields(release, message).into_iter().map(|field| {
        let number = match field.kind {
            Kind::Number(Number::F32 | Number::F64) => serde_json::json!({"type": "number"}),
            _ => serde_json::json!({"type": "integer"}),
        };
        let schema = match field.count {
            Count::One => number,
            _ => serde_json::json!({"type": "array", "items": number}),
        };
        (field.name, schema)
    });
    let properties: serde_json::Map<_, _> = properties.collect();
    let schema = serde_json::json!({"type": "object", "properties": properties});
    Schema::json(&schema.to_string(), name)
}

fn uorb_fields(release: &str, message: &str) -> Vec<Field> {
    definition::ros(&format!("px4_{release}"), &format!("px4_msgs/{message}")).0
}

fn protobuf_message(name: &str, label: &str, fields: &[Field]) -> String {
    let fields = (1..).zip(fields).map(|(number, field)| {
        let kind = match field.kind {
            Kind::Number(Number::Bool) => "bool",
            Kind::Number(Number::I8 | Number::I16 | Number::I32) => "int32",
            Kind::Number(Number::U8 | Number::U16 | Number::U32) => "uint32",
            Kind::Number(Number::I64) => "int64",
            Kind::Number(Number::U64) => "uint64",
            Kind::Number(Number::F32) => "float",
            Kind::Number(Number::F64) => "double",
            Kind::Text | Kind::Message(_) => panic!("uORB has numbers"),
        };
        let label = match field.count {
            Count::One => label,
            _ => "repeated",
        };
        format!("{label} {kind} {} = {number};", field.name)
    });
    format!("message {name} {{ {} }}", fields.collect::<String>())
}
