//! MAVLink messages as JSON, in the forms in which tools write them.

use serde_json::{Value, json};

use super::{
    flight::Flight,
    recorder::Recorder,
    recording::{Recording, Reference},
};

/// In which form a message is written.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    /// pymavlink's `to_dict`.
    Dict,
    /// mavlink2rest's, which names the flags.
    Rest,
    /// mavlink2rest's until October 2025, which has their number in a message.
    OldRest,
    /// That of `mavlogdump.py --format json`.
    Dump,
}

/// Which messages have what.
#[derive(Debug, Clone, Copy)]
struct Messages {
    attitude: &'static str,
    velocity: &'static str,
    gimbal: Gimbal,
}

#[derive(Debug, Clone, Copy)]
enum Gimbal {
    /// The number of a device's flags, their names, and what they mean.
    Device(u64, &'static str, Reference),
    Orientation,
    Status,
}

const MESSAGES: [Messages; 6] = [
    Messages {
        attitude: "ATTITUDE",
        velocity: "LOCAL_POSITION_NED",
        gimbal: Gimbal::Device(
            // The yaw is locked, and told from the nose all the same.
            12 | 16 | 32,
            "GIMBAL_DEVICE_FLAGS_YAW_LOCK | GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME",
            Reference::Heading,
        ),
    },
    Messages {
        attitude: "ATTITUDE_QUATERNION",
        velocity: "GLOBAL_POSITION_INT",
        gimbal: Gimbal::Device(
            12 | 64,
            "GIMBAL_DEVICE_FLAGS_ROLL_LOCK | GIMBAL_DEVICE_FLAGS_YAW_IN_EARTH_FRAME",
            Reference::Earth,
        ),
    },
    Messages {
        attitude: "ATTITUDE",
        velocity: "GLOBAL_POSITION_INT",
        gimbal: Gimbal::Device(
            12 | 16,
            "GIMBAL_DEVICE_FLAGS_YAW_LOCK | GIMBAL_DEVICE_FLAGS_ROLL_LOCK",
            Reference::Earth,
        ),
    },
    Messages {
        attitude: "ATTITUDE",
        velocity: "LOCAL_POSITION_NED",
        gimbal: Gimbal::Device(12, "GIMBAL_DEVICE_FLAGS_ROLL_LOCK", Reference::Heading),
    },
    Messages {
        attitude: "ATTITUDE",
        velocity: "LOCAL_POSITION_NED",
        gimbal: Gimbal::Orientation,
    },
    Messages {
        attitude: "ATTITUDE_QUATERNION",
        velocity: "LOCAL_POSITION_NED",
        gimbal: Gimbal::Status,
    },
];

pub fn recordings() -> Vec<Recording> {
    let forms_of = |messages: &Messages| match messages.gimbal {
        // They have the flags in different ways.
        Gimbal::Device(..) => vec![Form::Dict, Form::Rest, Form::OldRest],
        Gimbal::Orientation => vec![Form::Dump],
        Gimbal::Status => vec![Form::Dump, Form::Rest],
    };
    let in_forms = |messages: &Messages| {
        let forms = forms_of(messages).into_iter();
        forms.map(|form| (form, *messages)).collect::<Vec<_>>()
    };
    let all = MESSAGES.iter().flat_map(in_forms);
    all.flat_map(|(form, messages)| {
        [false, true].map(|is_stream| recording(form, messages, is_stream))
    })
    .collect()
}

fn recording(form: Form, messages: Messages, is_stream: bool) -> Recording {
    let profile = match is_stream {
        true => "mavlink-stream",
        false => "mavlink",
    };
    let Messages {
        attitude,
        velocity,
        gimbal,
    } = messages;
    let name = format!("{form:?}, {attitude}, {velocity}, {gimbal:?}");
    let flight = Flight::new();
    let flight = Flight {
        position_times: flight.velocity_times.clone(),
        ..flight
    };
    let write = move |flight: &Flight, log: &mut Recorder| {
        let mut all = self::messages(flight, messages);
        let written = |(time, name, fields): (u64, &str, Value)| (time, form.write(name, fields));
        match is_stream {
            true => {
                all.sort_by_key(|(time, ..)| *time);
                log.json("/telemetry", None, all.into_iter().map(written));
            }
            false => {
                let mut names: Vec<&str> = all.iter().map(|(_, name, _)| *name).collect();
                names.sort_unstable();
                names.dedup();
                for name in names {
                    let of_type = all.iter().filter(|one| one.1 == name).cloned();
                    log.json(&form.topic(name), None, of_type.map(written));
                }
            }
        }
    };
    let recording = Recording::new(profile, &name, flight, write);
    let recording = match velocity {
        "LOCAL_POSITION_NED" => recording.with_local(1e-9),
        _ => recording.with_geodetic(1e-9),
    };
    recording.with_heights(1e-9).with_gimbal(match gimbal {
        Gimbal::Device(_, _, reference) => reference,
        Gimbal::Orientation | Gimbal::Status => Reference::Heading,
    })
}

impl Form {
    /// The topic of a message type.
    fn topic(self, name: &str) -> String {
        match self {
            Self::Dict => format!("/{name}"),
            Self::Rest | Self::OldRest => format!("mavlink/1/1/{name}"),
            Self::Dump => name.to_owned(),
        }
    }

    fn write(self, name: &str, mut fields: Value) -> Value {
        match self {
            Self::Dict => {
                fields["mavpackettype"] = name.into();
                fields
            }
            Self::Rest | Self::OldRest => {
                fields["type"] = name.into();
                if let Some(names) = fields.get("flag_names").cloned() {
                    fields["flags"] = match self {
                        Self::OldRest => json!({ "bits": fields["flags"] }),
                        _ => names,
                    };
                }
                json!({
                    "header": { "system_id": 1, "component_id": 1, "sequence": 7 }, "message": fields,
                })
            }
            Self::Dump => json!({
                "meta": { "type": name, "timestamp": 7.5, "srcSystem": 1, "srcComponent": 1 }, "data": fields,
            }),
        }
    }
}

/// All messages, among others that have fields of the same names.
fn messages(flight: &Flight, messages: Messages) -> Vec<(u64, &'static str, Value)> {
    let mut all = Vec::new();
    for &time in &flight.attitude_times {
        let [roll, pitch, yaw] = flight.angles(time);
        let q = flight.attitude(time);
        let [rates, force] = flight.felt(time);
        let fields = match messages.attitude {
            "ATTITUDE" => json!({ "roll": roll, "pitch": pitch, "yaw": yaw }),
            _ => json!({ "q1": q.w, "q2": q.i, "q3": q.j, "q4": q.k }),
        };
        let mut fields = fields;
        fields["rollspeed"] = json!(rates.x);
        fields["pitchspeed"] = json!(rates.y);
        fields["yawspeed"] = json!(rates.z);
        all.push((time, messages.attitude, fields));
        let felt = json!({ "xacc": force.x, "yacc": force.y, "zacc": force.z });
        all.push((time, "HIGHRES_IMU", felt));
    }
    for &time in &flight.velocity_times {
        let velocity = flight.velocity(time);
        let fields = match messages.velocity {
            "LOCAL_POSITION_NED" => {
                let local = flight.local(time);
                json!({
                    "x": local.x, "y": local.y, "z": local.z, "vx": velocity.x, "vy": velocity.y, "vz": velocity.z,
                })
            }
            _ => {
                let [latitude, longitude, altitude] = flight.geodetic(time);
                json!({
                    "lat": latitude * 1e7, "lon": longitude * 1e7, "alt": altitude * 1000.0, "relative_alt": 7,
                    "vx": velocity.x * 100.0, "vy": velocity.y * 100.0, "vz": velocity.z * 100.0, "hdg": 7,
                })
            }
        };
        all.push((time, messages.velocity, fields));
        all.push((
            time,
            "ALTITUDE",
            json!({ "bottom_clearance": flight.height(time) }),
        ));
        let second =
            json!({ "roll": 1.5, "pitch": 1.25, "yaw": 1.0, "altitude": 7.5, "lat": 7, "lng": 7 });
        all.push((time, "AHRS2", second));
        let hud =
            json!({ "airspeed": 7.5, "groundspeed": 7.5, "heading": 7, "alt": 7.5, "climb": 7.5 });
        all.push((time, "VFR_HUD", hud));
    }
    for &time in &flight.gimbal_times {
        let q = flight.gimbal(time);
        let [roll, pitch, yaw] = flight.gimbal_angles(time).map(f64::to_degrees);
        let (name, fields) = match messages.gimbal {
            Gimbal::Device(flags, names, _) => (
                "GIMBAL_DEVICE_ATTITUDE_STATUS",
                json!({ "q": [q.w, q.i, q.j, q.k], "flags": flags, "flag_names": names }),
            ),
            Gimbal::Orientation => (
                "MOUNT_ORIENTATION",
                json!({ "roll": roll, "pitch": pitch, "yaw": yaw, "yaw_absolute": 7.5 }),
            ),
            Gimbal::Status => (
                "MOUNT_STATUS",
                json!({
                    "pointing_a": pitch * 100.0, "pointing_b": roll * 100.0, "pointing_c": yaw * 100.0,
                }),
            ),
        };
        all.push((time, name, fields));
    }
    all
}
