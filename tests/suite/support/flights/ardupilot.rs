//! ArduPilot's own ROS 2 interface.

use super::{
    flight::Flight,
    recorder::Recorder,
    recording::Recording,
    ros::{Ros, ros2},
};

pub fn recordings() -> Vec<Recording> {
    vec![
        recording("pose and receiver", Flight::new(), |mut log| {
            log.pose("/ap/pose/filtered")
                .world_twist("/ap/twist/filtered")
                .fix("/ap/navsat")
                .imu_in("/ap/imu/experimental/data", |frd| frd);
        })
        .with_geodetic(1e-9),
        recording("pose", with_position(), |mut log| {
            log.pose("/ap/pose/filtered")
                .world_twist("/ap/twist/filtered");
        })
        .with_local(1e-9),
        recording("pose on the globe", with_position(), |mut log| {
            log.geopose("/ap/geopose/filtered")
                .world_twist("/ap/twist/filtered");
        })
        .with_geodetic(1e-9),
    ]
}

fn recording(name: &str, flight: Flight, write: fn(Ros)) -> Recording {
    let write = move |flight: &Flight, log: &mut Recorder| {
        write(Ros {
            flight,
            log,
            schema: ros2,
            pose_frame: "base_link",
            drone_frame: "base_link",
        })
    };
    Recording::new("ardupilot-ros2", name, flight, write)
}

/// One message has the attitude and the position.
fn with_position() -> Flight {
    let flight = Flight::new();
    Flight {
        position_times: flight.attitude_times.clone(),
        ..flight
    }
}
