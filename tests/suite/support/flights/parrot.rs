//! Parrot's metadata of videos, as its own tools write it in JSON, and a bridge to ROS 2.

use nalgebra::{UnitQuaternion, Vector3};
use serde_json::{Value, json};

use super::{
    definition::Wanted,
    flight::{Flight, flu},
    recorder::Recorder,
    recording::{Recording, Reference},
    ros::{Ros, ros2},
};

pub fn recordings() -> Vec<Recording> {
    let mut recordings = vec![
        metadata("Olympe 7", |flight, time| modern(flight, time, true)),
        metadata("Olympe 7, above the ellipsoid", |flight, time| {
            modern(flight, time, false)
        }),
        metadata("version 3", |flight, time| old(flight, time, true)),
        metadata(
            "vmeta-extract",
            |flight, time| json!({ "metadata": modern(flight, time, true) }),
        ),
        metadata(
            "vmeta-extract, version 3",
            |flight, time| json!({ "metadata": old(flight, time, false) }),
        ),
    ];
    let positions = metadata("without a place on the globe", |flight, time| {
        let mut message = modern(flight, time, true);
        message["drone"]
            .as_object_mut()
            .expect("an object")
            .remove("location");
        message
    });
    recordings = recordings
        .into_iter()
        .map(|one| one.with_geodetic(1e-9))
        .collect();
    recordings.push(positions.with_local(1e-9));
    recordings.push(bridge("on the globe", true).with_geodetic(1e-9));
    recordings.push(bridge("local", false).with_local(1e-9));
    recordings
}

fn metadata(name: &str, message: fn(&Flight, u64) -> Value) -> Recording {
    let flight = Flight::in_one_message();
    let flight = Flight {
        gimbal_times: flight.attitude_times.clone(),
        ..flight
    };
    let write = move |flight: &Flight, log: &mut Recorder| {
        let times = flight.attitude_times.iter();
        log.json(
            "/video",
            None,
            times.map(|&time| (time, message(flight, time))),
        );
    };
    Recording::new("parrot-vmeta", name, flight, write)
        .with_gimbal(Reference::Earth)
        .with_heights(1e-9)
}

fn wxyz(q: UnitQuaternion<f64>) -> Value {
    json!({ "w": q.w, "x": q.i, "y": q.j, "z": q.k })
}

fn ned(vector: Vector3<f64>) -> Value {
    json!({ "north": vector.x, "east": vector.y, "down": vector.z })
}

fn place(flight: &Flight, time: u64, is_above_sea: bool) -> Value {
    let [latitude, longitude, altitude] = flight.geodetic(time);
    match is_above_sea {
        true => {
            json!({ "latitude": latitude, "longitude": longitude, "altitude_egm96amsl": altitude })
        }
        false => {
            json!({ "latitude": latitude, "longitude": longitude, "altitude_wgs84ellipsoid": altitude })
        }
    }
}

fn modern(flight: &Flight, time: u64, is_above_sea: bool) -> Value {
    json!({
        "drone": {
            "quat": wxyz(flight.attitude(time)), "speed": ned(flight.velocity(time)),
            "location": place(flight, time, is_above_sea), "position": ned(flight.local(time)),
            "ground_distance": flight.height(time),
        },
        "camera": { "quat": wxyz(flight.gimbal(time)), "base_quat": { "w": 1, "x": 0, "y": 0, "z": 0 } },
    })
}

fn old(flight: &Flight, time: u64, is_above_sea: bool) -> Value {
    json!({
        "drone_quat": wxyz(flight.attitude(time)), "speed": ned(flight.velocity(time)),
        "frame_quat": wxyz(flight.gimbal(time)), "location": place(flight, time, is_above_sea),
        "ground_distance": flight.height(time), "frame_base_quat": { "w": 1, "x": 0, "y": 0, "z": 0 },
    })
}

fn bridge(name: &str, is_on_globe: bool) -> Recording {
    let write = move |flight: &Flight, log: &mut Recorder| {
        let mut log = Ros {
            flight,
            log,
            schema: ros2,
            pose_frame: "/world",
            drone_frame: "/body",
        };
        // Half a turn about x on both sides.
        let quaternion = |q: UnitQuaternion<f64>| {
            Wanted::new()
                .text("header.frame_id", "/world")
                .numbers(
                    ["quaternion.w", "quaternion.x", "quaternion.y"],
                    [q.w, q.i, -q.j],
                )
                .number("quaternion.z", -q.k)
        };
        let message = "geometry_msgs/QuaternionStamped";
        log.topic("/drone/attitude", message, &flight.attitude_times, |time| {
            quaternion(flight.attitude(time))
        });
        log.topic("/gimbal/attitude", message, &flight.gimbal_times, |time| {
            quaternion(flight.gimbal(time))
        });
        let message = "geometry_msgs/Vector3Stamped";
        log.topic("/drone/speed", message, &flight.velocity_times, |time| {
            Wanted::new()
                .text("header.frame_id", "/body")
                .xyz("vector", flu(flight.body_velocity(time)))
        });
        match is_on_globe {
            true => {
                log.fix("/drone/gps/location");
            }
            false => {
                let message = "geometry_msgs/PointStamped";
                log.topic("/drone/position", message, &flight.position_times, |time| {
                    let local = flight.local(time);
                    Wanted::new().xyz("point", Vector3::new(local.x, -local.y, -local.z))
                });
            }
        }
    };
    Recording::new("parrot-anafi-ros", name, Flight::new(), write).with_gimbal(Reference::Earth)
}
