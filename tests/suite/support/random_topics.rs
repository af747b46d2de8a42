//! Logs of random topics, some of them telemetry, some only similar.

use std::{collections::BTreeMap, io::Cursor};

use mcap::{WriteOptions, records::MessageHeader};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{shapes::any_shape, topics::*};

const NAMES: [&str; 16] = [
    "/mavros/local_position/pose",
    "/mavros/local_position/velocity_local",
    "/drone1/mavros/local_position/pose",
    "/drone1/mavros/local_position/velocity_local",
    "/drone1/mavros/imu/data",
    "/fmu/out/vehicle_attitude",
    "/fmu/out/vehicle_attitude_v3",
    "/fmu/out/vehicle_local_position",
    "/vehicle_attitude/0",
    "/d/vehicle_attitude/0",
    "/ap/v1/pose/filtered",
    "/ap/v12/twist/filtered",
    "/ap/twist/filtered",
    "/odom",
    "/state",
    "/drone1/state",
];

/// What a user may ask of them, as options of the command line.
pub const REQUESTS: [&[(&str, &str)]; 15] = [
    &[],
    &[],
    &[],
    &[("--profile", "mavros")],
    &[("--profile", "flat-deg")],
    &[("--profile", "flat")],
    &[("--namespace", "/drone1")],
    &[("--namespace", "/d")],
    &[("--namespace", "")],
    &[("--attitude", "/odom")],
    &[("--attitude", "/state.roll,/state.pitch,/state.yaw:radians")],
    &[("--velocity", "/odom.twist.twist.linear:enu")],
    &[
        ("--velocity", "/state.vx,/state.vy,/state.vz:ned"),
        ("--namespace", "/drone1"),
    ],
    &[("--position", "/odom"), ("--gimbal", "/odom.q:earth")],
    &[("--velocity-from", "position")],
];

fn any_topic() -> impl Strategy<Value = Topic> {
    let types: [fn(&'static str) -> Topic; 8] = [
        pose,
        twist,
        odometry,
        attitude,
        local_position,
        flat,
        flat,
        camera,
    ];
    let message = (any::<prop::sample::Index>(), 0..12usize);
    (
        prop::sample::select(NAMES.to_vec()),
        prop::sample::select(types.to_vec()),
        prop::collection::vec(message, 0..14),
        0..6usize,
    )
        .prop_map(|(name, topic, changes, schema)| {
            let topic = topic(name);
            let usual: Value = serde_json::from_slice(&topic.messages[0]).expect("JSON");
            let messages = (changes.into_iter())
                .map(|(which, change)| changed(usual.clone(), which, change))
                .collect();
            let topic = Topic { messages, ..topic };
            match (schema, &topic.schema) {
                (0, None) => topic.with_schema("State", "jsonschema", listing(&usual, "number")),
                (1, None) => topic.with_schema("State", "jsonschema", listing(&usual, "string")),
                (2, _) => topic.with_schema("State", "jsonschema", "{ \"type\": "),
                (3, _) => topic.with_schema("nav_msgs/Odometry", "jsonschema", ""),
                _ => topic,
            }
        })
}

/// Frames that no telemetry looks like.
fn camera(name: &'static str) -> Topic {
    topic(
        name,
        [json!({ "format": "jpeg", "data": "x".repeat(1000) })],
    )
}

/// A JSON schema that lists the fields of a message.
fn listing(message: &Value, kind: &str) -> String {
    let fields = message.as_object().expect("an object").keys();
    let properties: serde_json::Map<_, _> = fields
        .map(|name| (name.clone(), json!({ "type": kind })))
        .collect();
    json!({ "properties": properties }).to_string()
}

/// A message that is not as usual: without a field, with null or a string in one, very long, or torn.
fn changed(mut message: Value, which: prop::sample::Index, change: usize) -> Vec<u8> {
    let object = message.as_object_mut().expect("an object");
    let names: Vec<String> = object.keys().cloned().collect();
    let name = which.get(&names);
    match change {
        0 => drop(object.remove(name)),
        1 => object[name] = Value::Null,
        2 => object[name] = json!("text"),
        3 => object[name] = json!("1"),
        4 => drop(object.insert("long".to_owned(), json!("x".repeat(66_000)))),
        5 => return b"{\"torn\": ".to_vec(),
        6 => object.clear(),
        _ => {}
    }
    message.to_string().into_bytes()
}

/// A log of topics whose messages come in this order.
fn interleaved(topics: &[Topic], order: &[usize], options: &WriteOptions) -> Vec<u8> {
    let options = options.clone();
    let mut writer = options.create(Cursor::new(Vec::new())).expect("a writer");
    for (id, topic) in (1..).zip(topics) {
        let schema_id = topic.schema.as_ref().map_or(0, |schema| {
            writer
                .add_schema(schema.name, schema.encoding, &schema.data)
                .expect("a schema")
        });
        writer
            .add_channel_with_id(id, schema_id, topic.name, topic.encoding, &BTreeMap::new())
            .expect("a channel");
    }
    let mut messages: Vec<_> = topics.iter().map(|topic| topic.messages.iter()).collect();
    for (n, &which) in (0..).zip(order) {
        let header = MessageHeader {
            channel_id: which as u16 + 1,
            sequence: n,
            log_time: time(n / 2),
            publish_time: 0,
        };
        let message = messages[which].next().expect("as many as there are");
        writer
            .write_to_known_channel(&header, message)
            .expect("a message");
    }
    writer.finish().expect("the log is finished");
    writer.into_inner().into_inner()
}

/// Any few topics, whole or spoilt, in a log of any shape.
pub fn any_log() -> impl Strategy<Value = Vec<u8>> {
    let topics = prop::collection::vec(any_topic(), 1..8);
    let order = topics.prop_flat_map(|topics| {
        let messages = topics.iter().enumerate();
        let order = messages.flat_map(|(which, topic)| vec![which; topic.messages.len()]);
        let order: Vec<usize> = order.collect();
        (Just(topics), Just(order).prop_shuffle(), any::<bool>())
    });
    (order, any_shape()).prop_map(|((topics, mut order, is_sorted), shape)| {
        if is_sorted {
            order.sort_unstable();
        }
        interleaved(&topics, &order, &shape.options)
    })
}
