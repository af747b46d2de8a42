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

/// A logger that writes degrees.
#[test]
fn degrees_read_as_radians() {
    let words = "cannot be radians … if they are degrees, use --profile flat-deg";
    refuses("degrees-read-as-radians", "--depression 30", words);
    let angles = "--depression 30 --attitude /telemetry.roll,/telemetry.pitch,/telemetry.yaw";
    let words =
        "cannot be radians … if they are degrees, put :degrees after the fields of --attitude";
    refuses(
        "degrees-read-as-radians",
        &format!("{angles}:radians"),
        words,
    );
    for arguments in [
        "--depression 30 --profile flat-deg",
        &format!("{angles}:degrees"),
    ] {
        gives("degrees-read-as-radians", arguments, "flight.csv");
    }
}

/// A Python logger's JSON (https://github.com/RobotWebTools/rosbridge_suite/issues/916).
#[test]
fn nan_in_a_field_that_nobody_needs() {
    gives("json-nan-elsewhere", "--depression 30", "flight.csv");
}

/// A user who means the topic with the dot.
#[test]
fn a_dotted_topic_beside_one_without_the_dot() {
    let arguments = |topic: &str| {
        format!(
            "--depression 30 --attitude {topic}.roll,{topic}.pitch,{topic}.yaw:radians \
             --velocity \"/fc.state\".vx,\"/fc.state\".vy,\"/fc.state\".vz:ned"
        )
    };
    let words = "\"/fc\".state.roll … \"/fc.state\".roll";
    refuses("dotted-topic-shadow", &arguments("/fc.state"), words);
    gives(
        "dotted-topic-shadow",
        &arguments("\"/fc.state\""),
        "flight.csv",
    );
}

/// Users who record nothing but transforms (https://github.com/MichaelGrupp/evo/issues/221).
#[test]
fn transforms_in_lists_whose_order_changes() {
    let path = |element: &str| {
        format!("--depression 30 --attitude /tf.transforms{element}.transform.rotation:flu-enu")
    };
    let named = path("[:]{child_frame_id==\"base_link\"}");
    gives("tf-is-all-there-is", &named, "tf-is-all-there-is.csv");
    let words = "several sources write to /tf: its `transforms[0].child_frame_id` is";
    refuses("tf-is-all-there-is", &path("[0]"), words);
}

/// A recorder whose clock is set during the flight (https://github.com/introlab/rtabmap_ros/issues/1333).
#[test]
fn a_clock_that_is_set_back() {
    let log = fs::read(fixture("clock-steps-back.mcap")).expect("the log");
    let csv = fs::read_to_string(fixture("clock-steps-back.csv")).expect("the numbers");
    for layout in ["append", "interleaved"] {
        let folder = Folder::with("input.mcap", &log);
        let arguments =
            format!("enrich input.mcap -o result.mcap --depression 30 --layout {layout}");
        let report = folder.writes("result.mcap", &arguments, 0);
        assert!(report.contains("time goes back by 2.970 s"), "{report}");
        // The times of the result go back as those of the log do.
        let mut messages = stream(&folder.read("result.mcap"), false);
        messages.retain(|message| DERIVED.contains(&message.topic.as_str()));
        assert_as_expected(messages, &csv);
    }
}

/// Two gimbals on one topic, and nothing in the messages that tells them apart
/// (https://github.com/mavlink/mavros/issues/2004).
#[test]
fn two_gimbals_that_nothing_tells_apart() {
    let words = "the gimbal jumps to and fro by up to 57°, 239 times in 239 steps, as where several sources \
         write to one topic, and no field is known that tells them apart … --trust goes on regardless";
    refuses("dual-gimbal-mavros", "", words);
    let log = fs::read(fixture("dual-gimbal-mavros.mcap")).expect("the log");
    let folder = Folder::with("input.mcap", log);
    folder.writes("result.mcap", "enrich input.mcap -o result.mcap --trust", 0);
}
