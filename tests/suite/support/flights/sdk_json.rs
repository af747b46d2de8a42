//! Telemetry as people write it from an SDK's values into JSON: AirSim's, MAVSDK's, and names with their units.

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::{
    flight::{Angles, Flight},
    recorder::Recorder,
    recording::Recording,
};

pub fn recordings() -> Vec<Recording> {
    let mut recordings = vec![
        airsim(
            "state",
            |kinematics| json!({ "kinematics_estimated": kinematics, "ready": true }),
        ),
        airsim("ground truth", |kinematics| kinematics),
        mavsdk("angles", true),
        mavsdk("quaternion", false),
    ];
    recordings.extend(with_units());
    recordings
}

fn airsim(name: &str, message: fn(Value) -> Value) -> Recording {
    let vector = |v: Vector3<f64>| json!({ "x_val": v.x, "y_val": v.y, "z_val": v.z });
    let write = move |flight: &Flight, log: &mut Recorder| {
        let messages = flight.attitude_times.iter().map(|&time| {
            let q = flight.attitude(time);
            let [rates, _] = flight.felt(time);
            let kinematics = json!({
                "orientation": { "w_val": q.w, "x_val": q.i, "y_val": q.j, "z_val": q.k },
                "linear_velocity": vector(flight.velocity(time)),
                "position": vector(flight.local(time)),
                "angular_velocity": vector(rates),
                "linear_acceleration": { "x_val": 7.5, "y_val": 7.5, "z_val": 7.5 },
            });
            (time, message(kinematics))
        });
        log.json("/airsim/drone_1", None, messages);
    };
    Recording::new("airsim", name, Flight::in_one_message(), write).with_local(1e-9)
}

fn angles([roll, pitch, yaw]: Angles) -> Value {
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_degrees);
    json!({ "roll_deg": roll, "pitch_deg": pitch, "yaw_deg": yaw, "timestamp_us": 7 })
}

fn velocity(v: Vector3<f64>) -> Value {
    json!({ "north_m_s": v.x, "east_m_s": v.y, "down_m_s": v.z })
}

/// With angles, a velocity alone and a place on the globe; or with a quaternion and a local place beside the velocity.
fn mavsdk(name: &str, has_angles: bool) -> Recording {
    let flight = Flight::new();
    let flight = Flight {
        position_times: flight.velocity_times.clone(),
        ..flight
    };
    let write = move |flight: &Flight, log: &mut Recorder| {
        let attitudes = flight.attitude_times.iter();
        let velocities = flight.velocity_times.iter();
        match has_angles {
            true => {
                let messages = attitudes.map(|&time| (time, angles(flight.angles(time))));
                log.json("/attitude_euler", None, messages);
                let messages = velocities.map(|&time| (time, velocity(flight.velocity(time))));
                log.json("/velocity_ned", None, messages);
                let places = flight.position_times.iter().map(|&time| {
                    let [latitude, longitude, altitude] = flight.geodetic(time);
                    let place = json!({
                        "latitude_deg": latitude, "longitude_deg": longitude, "absolute_altitude_m": altitude,
                        "relative_altitude_m": 7.5,
                    });
                    (time, place)
                });
                log.json("/position", None, places);
            }
            false => {
                let quaternion = |&time: &u64| {
                    let q = flight.attitude(time);
                    let message =
                        json!({ "w": q.w, "x": q.i, "y": q.j, "z": q.k, "timestamp_us": 7 });
                    (time, message)
                };
                // Before the first one that is known.
                let unknown = json!({ "w": 0.5, "x": 0.5, "y": 0.5, "z": 0.5, "timestamp_us": 0 });
                let unknown = flight
                    .invalid_times
                    .iter()
                    .map(|&time| (time, unknown.clone()));
                log.json(
                    "/attitude_quaternion",
                    None,
                    attitudes.map(quaternion).chain(unknown),
                );
                let messages = velocities.map(|&time| {
                    let local = flight.local(time);
                    let message = json!({
                        "velocity": velocity(flight.velocity(time)),
                        "position": { "north_m": local.x, "east_m": local.y, "down_m": local.z },
                    });
                    (time, message)
                });
                log.json("/position_velocity_ned", None, messages);
            }
        }
    };
    let recording = Recording::new("mavsdk", name, flight, write);
    match has_angles {
        true => recording.with_geodetic(1e-9),
        false => recording.with_local(1e-9),
    }
}

/// Each spelling of a velocity, with those of attitudes and positions in turn.
fn with_units() -> Vec<Recording> {
    const VELOCITIES: [&str; 4] = ["", "vn_m_s", "velocity_north_m_s", "velocity."];
    let spelling = |(place, name): (usize, &'static str)| {
        let write = move |flight: &Flight, log: &mut Recorder| {
            let messages = flight.attitude_times.iter().map(|&time| {
                let v = flight.velocity(time);
                let [latitude, longitude, altitude] = flight.geodetic(time);
                let local = flight.local(time);
                let mut message = match name {
                    "" => velocity(v),
                    "velocity." => json!({ "velocity": velocity(v) }),
                    "vn_m_s" => json!({ "vn_m_s": v.x, "ve_m_s": v.y, "vd_m_s": v.z }),
                    _ => json!({
                        "velocity_north_m_s": v.x, "velocity_east_m_s": v.y, "velocity_down_m_s": v.z,
                    }),
                };
                let radians = flight.angles(time);
                let attitude = match place % 3 {
                    0 => angles(radians),
                    1 => json!({ "roll_rad": radians[0], "pitch_rad": radians[1], "yaw_rad": radians[2] }),
                    _ => json!({ "attitude": angles(radians) }),
                };
                let position = match place % 4 {
                    0 => json!({ "latitude_deg": latitude, "longitude_deg": longitude, "altitude_m": altitude }),
                    1 => json!({ "lat_deg": latitude, "lon_deg": longitude, "alt_m": altitude }),
                    2 => json!({
                        "latitude_deg": latitude, "longitude_deg": longitude, "absolute_altitude_m": altitude,
                    }),
                    _ => json!({ "north_m": local.x, "east_m": local.y, "down_m": local.z }),
                };
                for more in [attitude, position] {
                    let fields = more.as_object().expect("an object").clone();
                    message.as_object_mut().expect("an object").extend(fields);
                }
                (time, message)
            });
            log.json("/state", None, messages);
        };
        let name = format!("{place}, {name}");
        let recording = Recording::new("flat-units", &name, Flight::in_one_message(), write);
        match place % 4 {
            3 => recording.with_local(1e-9),
            _ => recording.with_geodetic(1e-9),
        }
    };
    VELOCITIES.into_iter().enumerate().map(spelling).collect()
}
