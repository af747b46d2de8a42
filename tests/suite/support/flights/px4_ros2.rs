//! PX4 over its ROS 2 bridge.

use super::{
    flight::Flight,
    px4::{Px4, VelocityFrame::*},
    recorder::{Recorder, Schema},
    recording::{Recording, Reference},
};

pub fn recordings() -> Vec<Recording> {
    let float_metres = 1e-4;
    let millimetre = 1e-3;
    vec![
        recording("attitude and local position", Flight::new(), |mut log| {
            log.vehicle_attitude("1.17").vehicle_local_position("1.17");
            log.gimbal("1.17", 32).vehicle_global_position("1.17");
            log.sensor_combined("1.17");
        })
        .with_gimbal(Reference::Heading)
        .with_geodetic(float_metres)
        .with_heights(HEIGHTS),
        recording("big-endian", Flight::new(), |log| {
            let mut log = Px4 {
                schema: big_endian,
                ..log
            };
            log.vehicle_attitude("1.17").vehicle_local_position("1.17");
            log.gimbal("1.17", 64).vehicle_gps_position("1.17");
        })
        .with_gimbal(Reference::Earth)
        .with_geodetic(1e-9)
        .with_heights(HEIGHTS),
        recording("odometry in NED", Flight::in_one_message(), |mut log| {
            log.vehicle_odometry("1.17", |_| Ned).gimbal("1.17", 16);
        })
        .with_gimbal(Reference::Earth)
        .with_local(float_metres),
        recording(
            "odometry in body FRD",
            in_one_message_with_gps(),
            |mut log| {
                log.vehicle_odometry("1.14", |_| BodyFrd);
                log.gimbal("1.14", 32 | 16).vehicle_gps_position_1_14();
            },
        )
        .with_gimbal(Reference::Heading)
        .with_geodetic(millimetre),
        recording(
            "odometry in NED and in body FRD",
            in_one_message_with_gps(),
            |mut log| {
                log.vehicle_odometry("1.17", |place| if place % 3 == 0 { Ned } else { BodyFrd });
                log.gimbal("1.17", 0).vehicle_global_position_1_15();
            },
        )
        .with_gimbal(Reference::Heading)
        .with_geodetic(float_metres),
        recording(
            "attitude, and velocity of the odometry",
            Flight::in_one_message(),
            |mut log| {
                log.vehicle_attitude("1.17")
                    .vehicle_odometry("1.17", |_| BodyFrd);
            },
        )
        .with_local(float_metres),
        legacy("1.13", Flight::new(), |mut log| {
            log.vehicle_attitude("1.13")
                .vehicle_local_position("1.13")
                .gimbal("1.13", 0);
        })
        .with_gimbal(Reference::Heading)
        .with_local(float_metres)
        .with_heights(HEIGHTS),
        legacy(
            "1.13, odometry in NED",
            Flight::in_one_message(),
            |mut log| {
                log.vehicle_odometry_1_13(|_| Ned);
            },
        )
        .with_local(float_metres),
        legacy(
            "1.13, odometry in body FRD",
            Flight::in_one_message(),
            |mut log| {
                log.vehicle_odometry_1_13(|_| BodyFrd);
            },
        )
        .with_local(float_metres),
    ]
}

/// What float32 leaves of a height of 60 m.
const HEIGHTS: f64 = 1e-5;

/// One message has the attitude and the velocity, another the position.
fn in_one_message_with_gps() -> Flight {
    Flight {
        position_times: Flight::new().position_times,
        ..Flight::in_one_message()
    }
}

fn recording(name: &str, flight: Flight, write: fn(Px4)) -> Recording {
    bridged(name, flight, versioned_topic, write)
}

/// Over the bridge that PX4 had before 1.14.
fn legacy(name: &str, flight: Flight, write: fn(Px4)) -> Recording {
    bridged(name, flight, |name| format!("/fmu/{name}/out"), write)
}

fn bridged(name: &str, flight: Flight, topic: fn(&str) -> String, write: fn(Px4)) -> Recording {
    let write = move |flight: &Flight, log: &mut Recorder| {
        write(Px4 {
            flight,
            log,
            topic,
            schema: px4_msgs,
        });
    };
    Recording::new("px4-ros2", name, flight, write).with_floats()
}

/// As PX4 1.17 names it, where the local position alone has a version.
fn versioned_topic(name: &str) -> String {
    match name {
        "vehicle_local_position" => "/fmu/out/vehicle_local_position_v1".to_owned(),
        _ => format!("/fmu/out/{name}"),
    }
}

fn px4_msgs(release: &str, message: &str, _name: &str) -> Schema {
    Schema::ros2(&format!("px4_{release}"), &format!("px4_msgs/{message}"))
}

fn big_endian(release: &str, message: &str, name: &str) -> Schema {
    px4_msgs(release, message, name).big_endian()
}
