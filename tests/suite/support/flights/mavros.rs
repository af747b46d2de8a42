//! MAVROS.

use super::{
    definition::Wanted,
    flight::Flight,
    recorder::{Recorder, Schema},
    recording::{Recording, Reference},
    ros::{Ros, ros1, ros2, ros2_big_endian},
};

pub fn recordings() -> Vec<Recording> {
    vec![
        recording("local position", ros2, Flight::new(), |mut log| {
            log.pose("/mavros/local_position/pose");
            log.world_twist("/mavros/local_position/velocity_local");
            log.fix("/mavros/global_position/global");
            gimbal(&mut log, 32);
            altitude(&mut log);
        })
        .with_gimbal(Reference::Heading)
        .with_geodetic(1e-9)
        .with_heights(1e-5),
        recording(
            "IMU and body velocity in ROS 1",
            ros1,
            Flight::new(),
            |mut log| {
                log.imu("/mavros/imu/data");
                log.body_twist("/mavros/local_position/velocity_body");
                log.fix("/mavros/global_position/global");
                altitude(&mut log);
            },
        )
        .with_geodetic(1e-9)
        .with_heights(1e-5),
        recording("odometry", ros2, Flight::in_one_message(), |mut log| {
            log.odometry("/mavros/local_position/odom");
            gimbal(&mut log, 64);
        })
        .with_gimbal(Reference::Earth)
        .with_local(1e-9),
        recording(
            "odometry in ROS 1",
            ros1,
            Flight::in_one_message(),
            |mut log| {
                log.odometry("/mavros/local_position/odom");
            },
        )
        .with_local(1e-9),
        recording(
            "pose, big-endian",
            ros2_big_endian,
            pose_with_position(),
            |mut log| {
                log.pose("/mavros/local_position/pose");
                log.body_twist("/mavros/local_position/velocity_body");
                gimbal(&mut log, 16);
            },
        )
        .with_gimbal(Reference::Earth)
        .with_local(1e-9),
        recording(
            "everything at once",
            ros2,
            Flight::in_one_message(),
            |mut log| {
                log.pose("/mavros/local_position/pose")
                    .imu("/mavros/imu/data");
                log.odometry("/mavros/local_position/odom");
                log.world_twist("/mavros/local_position/velocity_local");
                log.body_twist("/mavros/local_position/velocity_body");
                gimbal(&mut log, 0);
            },
        )
        .with_gimbal(Reference::Heading)
        .with_local(1e-9),
    ]
}

fn recording(name: &str, schema: fn(&str) -> Schema, flight: Flight, write: fn(Ros)) -> Recording {
    let write = move |flight: &Flight, log: &mut Recorder| {
        write(Ros {
            flight,
            log,
            schema,
            pose_frame: "map",
            drone_frame: "base_link",
        })
    };
    Recording::new("mavros", name, flight, write)
}

fn pose_with_position() -> Flight {
    let flight = Flight::new();
    Flight {
        position_times: flight.attitude_times.clone(),
        ..flight
    }
}

/// Heights at the times of positions, in float32, and in between what stands for none.
fn altitude(log: &mut Ros) {
    let flight = log.flight;
    let mut times = [&flight.position_times[..], &flight.invalid_times[..]].concat();
    times.sort_unstable();
    let message = "mavros_msgs/Altitude";
    log.topic("/mavros/altitude", message, &times, |time| {
        let clearance = match (flight.position_times.contains(&time), time / 10_000_000 % 2) {
            (true, _) => flight.height(time),
            (false, 0) => f64::NAN,
            (false, _) => -1.0,
        };
        Wanted::new().number("bottom_clearance", clearance)
    });
}

/// MAVLink's attitude as it is: FRD, from the horizon.
fn gimbal(log: &mut Ros, flags: u16) {
    let flight = log.flight;
    let topic = "/mavros/gimbal_control/device/attitude_status";
    let message = "mavros_msgs/GimbalDeviceAttitudeStatus";
    log.topic(topic, message, &flight.gimbal_times, |time| {
        Wanted::new()
            .xyzw("q", flight.gimbal(time))
            .number("flags", f64::from(flags))
    });
}
