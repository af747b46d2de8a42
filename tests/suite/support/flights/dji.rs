//! DJI's Onboard SDK in ROS 1.

use super::{
    definition::Wanted,
    flight::{self, Flight},
    recorder::Recorder,
    recording::{Recording, Reference},
    ros::{Ros, ros1},
};

pub fn recordings() -> Vec<Recording> {
    vec![
        recording("from broadcast", |mut log| {
            log.quaternion("/dji_osdk_ros/attitude");
            log.world_velocity("/dji_osdk_ros/velocity");
            log.fix("/dji_osdk_ros/gps_position");
            gimbal(&mut log, "ground_ENU", ["vector.x", "vector.y", "vector.z"]);
        })
        .with_gimbal(Reference::Earth)
        .with_geodetic(1e-9),
        recording("from subscription", |mut log| {
            log.imu("/dji_osdk_ros/imu");
            log.world_velocity("/dji_osdk_ros/velocity");
            local_position(&mut log);
            gimbal(&mut log, "", ["vector.y", "vector.x", "vector.z"]);
        })
        .with_gimbal(Reference::Earth)
        .with_local(1e-9),
    ]
}

fn recording(name: &str, write: fn(Ros)) -> Recording {
    let write = move |flight: &Flight, log: &mut Recorder| {
        write(Ros {
            flight,
            log,
            schema: ros1,
            pose_frame: "ground_ENU",
            drone_frame: "body_FLU",
        })
    };
    Recording::new("dji-osdk", name, Flight::new(), write)
}

fn local_position(log: &mut Ros) {
    let flight = log.flight;
    let message = "geometry_msgs/PointStamped";
    log.topic(
        "/dji_osdk_ros/local_position",
        message,
        &flight.position_times,
        |time| Wanted::new().xyz("point", flight::enu(flight.local(time))),
    );
}

/// Roll, pitch and yaw in degrees, in three fields.
fn gimbal(log: &mut Ros, frame_id: &str, fields: [&str; 3]) {
    let flight = log.flight;
    let message = "geometry_msgs/Vector3Stamped";
    log.topic(
        "/dji_osdk_ros/gimbal_angle",
        message,
        &flight.gimbal_times,
        |time| {
            Wanted::new()
                .numbers(fields, flight.gimbal_angles(time).map(f64::to_degrees))
                .text("header.frame_id", frame_id)
        },
    );
}
