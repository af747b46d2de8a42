//! Users' own loggers, which write everything into one message, each with its own names.

use std::{collections::BTreeSet, fs};

use serde_json::{Value, json};

use super::{
    definition::Wanted,
    flight::{Angles, Flight},
    recorder::{Recorder, Schema},
    recording::Recording,
};

/// What a message has, by the paths of its fields.
type Names = [&'static str; 3];

const ATTITUDE: [Names; 5] = [
    ["roll", "pitch", "yaw"],
    ["attitude.roll", "attitude.pitch", "attitude.yaw"],
    ["orientation.roll", "orientation.pitch", "orientation.yaw"],
    ["rpy.roll", "rpy.pitch", "rpy.yaw"],
    ["euler.roll", "euler.pitch", "euler.yaw"],
];

const VELOCITY: [Names; 14] = [
    ["vx", "vy", "vz"],
    ["velocity.x", "velocity.y", "velocity.z"],
    ["velocity[0]", "velocity[1]", "velocity[2]"],
    ["v_n", "v_e", "v_d"],
    ["vn", "ve", "vd"],
    ["vel_n", "vel_e", "vel_d"],
    ["velocity_n", "velocity_e", "velocity_d"],
    ["velocity.n", "velocity.e", "velocity.d"],
    ["velocity.north", "velocity.east", "velocity.down"],
    ["velocity_north", "velocity_east", "velocity_down"],
    ["vel_x", "vel_y", "vel_z"],
    ["v_x", "v_y", "v_z"],
    ["velocity_x", "velocity_y", "velocity_z"],
    ["vel.x", "vel.y", "vel.z"],
];

const GEODETIC: [Names; 4] = [
    ["lat", "lon", "alt"],
    ["latitude", "longitude", "altitude"],
    ["gps.lat", "gps.lon", "gps.alt"],
    [
        "position.latitude",
        "position.longitude",
        "position.altitude",
    ],
];

const LOCAL: [Names; 2] = [["x", "y", "z"], ["position.x", "position.y", "position.z"]];

pub fn recordings() -> Vec<Recording> {
    let radians = |angles: Angles| angles;
    let degrees = |angles: Angles| angles.map(f64::to_degrees);
    let mut recordings = in_all_spellings("flat", radians);
    recordings.extend(in_all_spellings("flat-deg", degrees));
    recordings.push(demonstration());
    recordings
}

/// Each spelling of velocities, with all those of attitudes and positions in turn.
fn in_all_spellings(profile: &'static str, unit: fn(Angles) -> Angles) -> Vec<Recording> {
    let spelling = |(place, velocity): (usize, Names)| {
        let attitude = ATTITUDE[place % ATTITUDE.len()];
        let place = place % (GEODETIC.len() + LOCAL.len());
        let (position, is_local) = match place.checked_sub(GEODETIC.len()) {
            Some(place) => (LOCAL[place], true),
            None => (GEODETIC[place], false),
        };
        let name = format!("{}, {}, {}", attitude[0], velocity[0], position[0]);
        let write = move |flight: &Flight, log: &mut Recorder| {
            let messages = flight.attitude_times.iter().map(|&time| {
                let place = match is_local {
                    true => flight.local(time).into(),
                    false => flight.geodetic(time),
                };
                let mut message = json!({"note": "junk", "count": 7});
                put(&mut message, attitude, unit(flight.angles(time)));
                put(&mut message, velocity, flight.velocity(time).into());
                put(&mut message, position, place);
                (time, message)
            });
            log.json("/any/topic", None, messages);
        };
        let recording = Recording::new(profile, &name, Flight::in_one_message(), write);
        match is_local {
            true => recording.with_local(1e-9),
            false => recording.with_geodetic(1e-9),
        }
    };
    VELOCITY.into_iter().enumerate().map(spelling).collect()
}

/// The message of the demonstration flight.
fn demonstration() -> Recording {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/generate_flight/telemetry.proto"
    );
    let definition = fs::read_to_string(file).expect("the definition");
    let schema = Schema::protobuf(&definition, "demo.DroneState");
    let write = move |flight: &Flight, log: &mut Recorder| {
        let messages = flight.attitude_times.iter().map(|&time| {
            let wanted = Wanted::new()
                .numbers(ATTITUDE[0], flight.angles(time))
                .numbers(VELOCITY[0], flight.velocity(time).into())
                .numbers(GEODETIC[1], flight.geodetic(time));
            (time, wanted)
        });
        log.topic("/drone/state", &schema, messages);
    };
    let name = "the demonstration's message";
    Recording::new("flat", name, Flight::in_one_message(), write).with_geodetic(1e-9)
}

/// The reference: the flight in the profile `flat`. A message has an attitude or a velocity or, at equal times,
/// both.
pub fn reference(flight: &Flight) -> Vec<u8> {
    let number = json!({"type": "number"});
    let properties = ATTITUDE[0].iter().chain(&VELOCITY[0]);
    let properties: Value = properties
        .map(|&name| (name.to_owned(), number.clone()))
        .collect();
    let schema = json!({"type": "object", "properties": properties});
    let times = flight.attitude_times.iter().chain(&flight.velocity_times);
    let times: BTreeSet<u64> = times.copied().collect();
    let messages = times.into_iter().map(|time| {
        let mut message = json!({});
        if flight.attitude_times.contains(&time) {
            put(&mut message, ATTITUDE[0], flight.angles(time));
        }
        if flight.velocity_times.contains(&time) {
            put(&mut message, VELOCITY[0], flight.velocity(time).into());
        }
        (time, message)
    });
    let mut log = Recorder::new();
    log.json("/reference", Some(&schema), messages);
    log.finish()
}

/// Puts numbers where paths lead to.
fn put(message: &mut Value, paths: Names, numbers: [f64; 3]) {
    for (path, number) in paths.into_iter().zip(numbers) {
        let (outer, name) = path.rsplit_once('.').unwrap_or(("", path));
        let holder = match outer {
            "" => &mut *message,
            outer => &mut message[outer],
        };
        match name.split_once('[') {
            None => holder[name] = json!(number),
            Some((list, _)) => match &mut holder[list] {
                Value::Array(list) => list.push(json!(number)),
                list => *list = json!([number]),
            },
        }
    }
}
