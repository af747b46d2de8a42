//! Small logs after public reports of people who were given wrong numbers without a word. `fixtures/cases` has them, and
//! what is right.

use std::{fs, path::PathBuf};

use crate::support::{expected::assert_as_expected, folder::Folder, *};

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/cases")).join(name)
}

/// Enriches a case's log and checks the numbers of the result. Returns what was printed.
#[track_caller]
fn gives(case: &str, arguments: &str, numbers: &str) -> String {
    let log = fs::read(fixture(&format!("{case}.mcap"))).expect("the log");
    let folder = Folder::with("input.mcap", &log);
    let arguments = format!("enrich input.mcap -o result.mcap {arguments}");
    let report = folder.writes("result.mcap", &arguments, 0);
    let csv = fs::read_to_string(fixture(numbers)).expect("the numbers");
    assert_as_expected(judge(&log, &folder.read("result.mcap"), false), &csv);
    report
}

/// Checks that a case's log is refused with these words, and that nothing is written.
#[track_caller]
fn refuses(case: &str, arguments: &str, words: &str) {
    let log = fs::read(fixture(&format!("{case}.mcap"))).expect("the log");
    let folder = Folder::with("input.mcap", log);
    folder.refuses(&format!("enrich input.mcap {arguments}"), 1, words);
}

/// AirSim's ROS wrapper (https://github.com/microsoft/AirSim/issues/4631).
#[test]
fn odometry_in_ned_that_says_so() {
    let report = gives("odom-local-ned", "--depression 30", "flight.csv");
    assert!(report.contains("header.frame_id is world_ned"), "{report}");
}

/// VINS-Fusion and its forks (https://github.com/HKUST-Aerial-Robotics/VINS-Fusion/issues/156).
#[test]
fn a_twist_in_the_world_that_says_so() {
    let report = gives("odom-twist-in-world", "--depression 30", "flight.csv");
    assert!(report.contains("child_frame_id is world"), "{report}");
}

/// A sensor without orientation (https://github.com/luxonis/depthai-ros/issues/483).
#[test]
fn an_imu_that_has_no_orientation() {
    for arguments in ["", "--attitude /mavros/imu/data.orientation:flu-enu"] {
        let arguments = format!("--depression 30 {arguments}");
        refuses(
            "imu-without-orientation",
            &arguments,
            "orientation_covariance[0] = -1",
        );
    }
}

/// A motion capture's poses (https://github.com/mavlink/mavros/issues/1214).
#[test]
fn an_attitude_of_a_ros_type_without_axes() {
    let arguments = "--depression 30 --attitude /mocap/pose.pose.orientation --velocity /mocap/twist.twist.linear:enu";
    let report = gives("ros-attitude-default-axes", arguments, "flight.csv");
    assert!(report.contains("flu-enu, the axes of its type"), "{report}");
}

/// SIYI's gimbals (https://github.com/ArduPilot/ardupilot/issues/24919).
#[test]
fn a_gimbal_whose_joints_are_yaw_roll_pitch() {
    let arguments =
        "--gimbal /gimbal.roll,/gimbal.pitch,/gimbal.yaw:degrees:heading:yaw-roll-pitch";
    gives(
        "gimbal-yaw-roll-pitch",
        arguments,
        "gimbal-yaw-roll-pitch.csv",
    );
}
