//! Odometry and poses of common types.

use super::{
    definition::{self, Wanted},
    flight::{self, Flight},
    recorder::{Recorder, Schema},
    recording::Recording,
    ros::{self, Ros, ros1, ros2},
};

/// Poses alone, as motion capture has them.
pub fn poses() -> Vec<Recording> {
    let flight = || Flight::without_velocity();
    let recording = |name: &str, message: &'static str, pose: &'static [&'static str; 2]| {
        let write = move |flight: &Flight, log: &mut Recorder| {
            let schema = ros2(message);
            let messages = flight.attitude_times.iter().map(|&time| {
                let wanted = Wanted::new()
                    .text("header.frame_id", "world")
                    .xyzw(pose[0], ros::attitude(flight, time))
                    .xyz(pose[1], flight::enu(flight.local(time)));
                let wanted = match message {
                    "geometry_msgs/TransformStamped" => wanted.text("child_frame_id", "drone"),
                    _ => wanted,
                };
                (time, wanted)
            });
            log.topic("/vrpn_client_node/drone/pose", &schema, messages);
        };
        Recording::new("ros-pose", name, flight(), write).with_local(1e-9)
    };
    vec![
        recording(
            "PoseStamped",
            "geometry_msgs/PoseStamped",
            &["pose.orientation", "pose.position"],
        ),
        recording(
            "PoseWithCovarianceStamped",
            "geometry_msgs/PoseWithCovarianceStamped",
            &["pose.pose.orientation", "pose.pose.position"],
        ),
        recording(
            "TransformStamped",
            "geometry_msgs/TransformStamped",
            &["transform.rotation", "transform.translation"],
        ),
    ]
}

pub fn recordings() -> Vec<Recording> {
    let odometry = [
        ("foxglove.Odometry", protobuf("Odometry")),
        ("foxglove.Odometry in JSON", json("Odometry")),
        ("foxglove_msgs/msg/Odometry", ros2("foxglove_msgs/Odometry")),
    ];
    let poses = [
        ("foxglove.PoseInFrame", protobuf("PoseInFrame")),
        ("foxglove.PoseInFrame in JSON", json("PoseInFrame")),
        (
            "foxglove_msgs/msg/PoseInFrame",
            ros2("foxglove_msgs/PoseInFrame"),
        ),
    ];
    let odometry = odometry.map(|(name, schema)| {
        // Some leave the names of frames empty.
        let body = if name.ends_with("JSON") {
            ""
        } else {
            "base_link"
        };
        recording(name, Flight::in_one_message(), move |flight, log| {
            put(flight, log, &schema, |time| {
                let velocity = flight::flu(flight.body_velocity(time));
                pose(flight, time)
                    .text("body_frame_id", body)
                    .xyz("linear_velocity", velocity)
            });
        })
    });
    let poses = poses.map(|(name, schema)| {
        recording(name, Flight::without_velocity(), move |flight, log| {
            put(flight, log, &schema, |time| pose(flight, time));
        })
    });
    let ros = [
        (
            "nav_msgs/msg/Odometry",
            ros2 as fn(&str) -> Schema,
            ["odom", "base_link"],
        ),
        ("nav_msgs/Odometry", ros1, ["", ""]),
    ];
    let ros = ros.map(|(name, schema, frames)| {
        recording(name, Flight::in_one_message(), move |flight, log| {
            Ros {
                flight,
                log,
                schema,
                pose_frame: frames[0],
                drone_frame: frames[1],
            }
            .odometry("/any/topic");
        })
    });
    ros.into_iter().chain(odometry).chain(poses).collect()
}

fn recording(
    name: &str,
    flight: Flight,
    write: impl Fn(&Flight, &mut Recorder) + 'static,
) -> Recording {
    Recording::new("nav-msgs", name, flight, write).with_local(1e-9)
}

fn put(flight: &Flight, log: &mut Recorder, schema: &Schema, wanted: impl Fn(u64) -> Wanted) {
    let messages = flight
        .attitude_times
        .iter()
        .map(|&time| (time, wanted(time)));
    log.topic("/any/topic", schema, messages);
}

fn pose(flight: &Flight, time: u64) -> Wanted {
    Wanted::new()
        .text("frame_id", "map")
        .xyzw("pose.orientation", ros::attitude(flight, time))
        .xyz("pose.position", flight::enu(flight.local(time)))
}

fn protobuf(message: &str) -> Schema {
    let import = format!("syntax = \"proto3\"; import \"foxglove/{message}.proto\";");
    Schema::protobuf(&import, &format!("foxglove.{message}"))
}

fn json(message: &str) -> Schema {
    let text = definition::read(&format!("foxglove/{message}.json"));
    Schema::json(&text, &format!("foxglove.{message}"))
}
