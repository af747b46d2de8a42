//! What messages say about their frames is heeded, whatever the recorder.

use flightcam::{
    sample::{DropReason, Kind},
    source::{Because, request::Request},
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::{
    profiles::comparison::{Expectation, read, request},
    support::{
        flights::{
            Recording,
            definition::Wanted,
            flight::{self, Flight},
            recorder::{Recorder, Schema},
            ros::{ros1, ros2},
        },
        folder::Folder,
        selecting::request as arguments,
    },
};

/// In which axes a recorder writes.
#[derive(Clone, Copy)]
struct Habits {
    attitude: fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>,
    /// The velocity, out of the one in NED and the one in FRD.
    velocity: fn(Vector3<f64>, Vector3<f64>) -> Vector3<f64>,
    position: fn(Vector3<f64>) -> Vector3<f64>,
}

fn same<T>(value: T) -> T {
    value
}

/// North, east, down as north, west, up; front, right, down as front, left, up.
fn half_a_turn(v: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.x, -v.y, -v.z)
}

fn flu_in_nwu(q: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    flight::flu_in_flu(q)
}

const ROS: Habits = Habits {
    attitude: flight::flu_in_enu,
    velocity: |_, frd| half_a_turn(frd),
    position: flight::enu,
};
const ROS_IN_WORLD: Habits = Habits {
    velocity: |ned, _| flight::enu(ned),
    ..ROS
};
const NED: Habits = Habits {
    attitude: same,
    velocity: |ned, _| ned,
    position: same,
};
const NED_IN_BODY: Habits = Habits {
    velocity: |_, frd| frd,
    ..NED
};
const NWU: Habits = Habits {
    attitude: flu_in_nwu,
    position: half_a_turn,
    ..ROS
};
const NWU_IN_WORLD: Habits = Habits {
    velocity: |ned, _| half_a_turn(ned),
    ..NWU
};

/// Odometry whose frames are named so.
fn odometry(schema: fn(&str) -> Schema, frames: [&'static str; 2], habits: Habits) -> Recording {
    let name = format!("{frames:?}");
    Recording::new(
        "nav-msgs",
        &name,
        Flight::in_one_message(),
        move |flight, log| {
            let messages = flight.attitude_times.iter().map(|&time| {
                let velocity = (habits.velocity)(flight.velocity(time), flight.body_velocity(time));
                let wanted = Wanted::new()
                    .text("header.frame_id", frames[0])
                    .text("child_frame_id", frames[1])
                    .xyzw(
                        "pose.pose.orientation",
                        (habits.attitude)(flight.attitude(time)),
                    )
                    .xyz("pose.pose.position", (habits.position)(flight.local(time)))
                    .xyz("twist.twist.linear", velocity);
                (time, wanted)
            });
            log.topic("/odom", &schema("nav_msgs/Odometry"), messages);
        },
    )
    .with_local(1e-9)
}

#[track_caller]
fn is_understood(recording: &Recording, request: &Request) {
    let readings = read(&recording.log(), request).expect("telemetry");
    Expectation::of(recording).check(&recording.name, &readings.samples);
}

#[test]
fn odometry_is_read_in_the_axes_that_its_frames_name() {
    for (frames, habits) in [
        // ROS's own names.
        (["odom", "base_link"], ROS),
        (["map", "uav1/base_link"], ROS),
        (["uav1/map", "uav1"], ROS),
        (["", ""], ROS),
        (["map_enu", "base_link_flu"], ROS),
        // VINS-Fusion, OpenVINS: equal names.
        (["world", "world"], ROS_IN_WORLD),
        (["global", "global"], ROS_IN_WORLD),
        (["odom", "odom"], ROS_IN_WORLD),
        // A twist in a frame of the world with another name.
        (["map", "odom"], ROS_IN_WORLD),
        // AirSim.
        (["world_ned", "drone_1/odom_local_ned"], NED),
        (["world_enu", "drone_1/odom_local_enu"], ROS_IN_WORLD),
        (["world_ned", "world_ned"], NED),
        (["WORLD_NED", "WORLD_NED"], NED),
        // MAVROS.
        (["odom_ned", "base_link_frd"], NED_IN_BODY),
        (["map_ned", "base_link_frd"], NED_IN_BODY),
        (["mapNed", "bodyFrd"], NED_IN_BODY),
        (["mapned", "bodyfrd"], NED_IN_BODY),
        // One of the two names tells of both.
        (["odom_ned", "base_link"], NED_IN_BODY),
        (["local_frd", "body"], NED_IN_BODY),
        (["world_nwu", "base_link"], NWU),
        (["world_nwu", "world_nwu"], NWU_IN_WORLD),
        // Words that have such letters in them.
        (["aligned_map", "trained_body"], ROS),
        (["menu", "influence_link"], ROS),
    ] {
        for schema in [ros1, ros2] {
            is_understood(&odometry(schema, frames, habits), &request(None));
        }
    }
}

/// Poses and twists on topics of their own, whose frames are named so.
fn stamped(frames: [&'static str; 2], habits: Habits) -> Recording {
    let name = format!("{frames:?}");
    Recording::new("command line", &name, Flight::new(), move |flight, log| {
        let poses = flight.attitude_times.iter().map(|&time| {
            let wanted = Wanted::new()
                .text("header.frame_id", frames[0])
                .xyzw("pose.orientation", (habits.attitude)(flight.attitude(time)));
            (time, wanted)
        });
        log.topic("/pose", &ros2("geometry_msgs/PoseStamped"), poses);
        let twists = flight.velocity_times.iter().map(|&time| {
            let velocity = (habits.velocity)(flight.velocity(time), flight.body_velocity(time));
            let wanted = Wanted::new()
                .text("header.frame_id", frames[1])
                .xyz("twist.linear", velocity);
            (time, wanted)
        });
        log.topic("/twist", &ros2("geometry_msgs/TwistStamped"), twists);
    })
}

#[test]
fn a_quaternion_without_axes_is_read_as_its_type_and_its_frame_say() {
    for (frame, habits, axes) in [
        ("map", ROS_IN_WORLD, "enu"),
        ("mocap", ROS_IN_WORLD, "enu"),
        ("world_ned", NED, "ned"),
        ("map_nwu", NWU_IN_WORLD, "nwu"),
    ] {
        let recording = stamped([frame, frame], habits);
        let velocity = format!("/twist.twist.linear:{axes}");
        let given = arguments(&[
            ("--attitude", "/pose.pose.orientation"),
            ("--velocity", &velocity),
        ]);
        is_understood(&recording, &given);
    }
}

#[test]
fn axes_that_are_given_are_used_whatever_the_frames_are_called() {
    let recording = stamped(["base_link", "map"], NED_IN_BODY);
    let given = arguments(&[
        ("--attitude", "/pose.pose.orientation:frd-ned"),
        ("--velocity", "/twist.twist.linear:body-frd"),
    ]);
    is_understood(&recording, &given);
}

#[test]
fn any_axes_can_be_given() {
    let recording = stamped(
        ["", ""],
        Habits {
            attitude: flu_in_nwu,
            velocity: |ned, _| Vector3::new(ned.x, ned.y, -ned.z),
            position: same,
        },
    );
    let given = arguments(&[
        ("--attitude", "/pose.pose.orientation:flu-nwu"),
        ("--velocity", "/twist.twist.linear:neu"),
    ]);
    is_understood(&recording, &given);
    let recording = stamped(
        ["", ""],
        Habits {
            velocity: |_, frd| Vector3::new(-frd.y, -frd.x, frd.z),
            ..NED
        },
    );
    let given = arguments(&[
        ("--attitude", "/pose.pose.orientation:frd-ned"),
        ("--velocity", "/twist.twist.linear:body-lbd"),
    ]);
    is_understood(&recording, &given);
}

/// How many samples of a kind are dropped for a reason.
fn dropped(log: &[u8], request: &Request, kind: Kind, reason: DropReason) -> u64 {
    let readings = read(log, request).expect("telemetry");
    let dropped = &readings.dropped[kind].dropped;
    dropped.get(&reason).copied().unwrap_or_default()
}

#[test]
fn an_orientation_whose_frame_is_the_drones_or_the_planets_is_no_attitude() {
    for (frame, reason) in [
        ("base_link", DropReason::OwnFrame),
        ("uav1/base_link_frd", DropReason::OwnFrame),
        ("body", DropReason::OwnFrame),
        ("fcu", DropReason::OwnFrame),
        ("imu_link", DropReason::OwnFrame),
        ("earth", DropReason::UnknownFrame),
        ("ecef", DropReason::UnknownFrame),
    ] {
        let recording = stamped([frame, "map"], ROS);
        let given = arguments(&[("--attitude", "/pose.pose.orientation")]);
        let count = recording.flight.attitude_times.len() as u64;
        let dropped = dropped(&recording.log(), &given, Kind::Attitude, reason);
        assert_eq!(dropped, count, "{frame}");
    }
}

#[test]
fn a_drones_frame_alone_does_not_tell_the_worlds() {
    let recording = odometry(ros2, ["odom", "base_link_frd"], NED_IN_BODY);
    let count = recording.flight.attitude_times.len() as u64;
    let log = recording.log();
    let unknown = DropReason::UnknownFrame;
    assert_eq!(
        dropped(&log, &request(None), Kind::Attitude, unknown),
        count
    );
}

#[test]
fn frames_that_contradict_a_recorders_profile_are_refused() {
    let recording = Recording::new(
        "mavros",
        "in NED",
        Flight::new(),
        |flight, log: &mut Recorder| {
            let poses = flight.attitude_times.iter().map(|&time| {
                let wanted = Wanted::new()
                    .text("header.frame_id", "map_ned")
                    .xyzw("pose.orientation", flight.attitude(time));
                (time, wanted)
            });
            let schema = ros2("geometry_msgs/PoseStamped");
            log.topic("/mavros/local_position/pose", &schema, poses);
        },
    );
    let count = recording.flight.attitude_times.len() as u64;
    let other = DropReason::OtherFrame;
    let log = recording.log();
    assert_eq!(dropped(&log, &request(None), Kind::Attitude, other), count);
}

#[test]
fn an_imu_without_an_orientation_has_no_attitude() {
    for (covariance, is_valid) in [(-1.0, false), (0.0, true), (0.01, true)] {
        for schema in [ros1, ros2] {
            let recording = Recording::new("mavros", "", Flight::new(), move |flight, log| {
                let messages = flight.attitude_times.iter().map(|&time| {
                    let wanted = Wanted::new()
                        .text("header.frame_id", "base_link")
                        .xyzw("orientation", flight::flu_in_enu(flight.attitude(time)))
                        .number("orientation_covariance[0]", covariance);
                    (time, wanted)
                });
                log.topic("/mavros/imu/data", &schema("sensor_msgs/Imu"), messages);
            });
            let count = recording.flight.attitude_times.len() as u64;
            let log = recording.log();
            let no_orientation = DropReason::NoOrientation;
            let named = arguments(&[("--attitude", "/mavros/imu/data.orientation:flu-enu")]);
            for request in [request(None), named] {
                let dropped = dropped(&log, &request, Kind::Attitude, no_orientation);
                assert_eq!(dropped, if is_valid { 0 } else { count });
            }
        }
    }
}

#[test]
fn the_report_says_which_axes_were_taken_and_why() {
    let of = |recording: &Recording, given: &Request| {
        let folder = Folder::with("log.mcap", recording.log());
        let log = flightcam::log::Log::open(&folder.path("log.mcap")).expect("a log");
        let source = flightcam::source::Source::select(&log, given).expect("telemetry");
        let reader = flightcam::reader::Reader::new(&log, source).expect("a log");
        let read = reader
            .for_each(|_| Ok::<_, flightcam::log::ReadError>(()))
            .expect("samples");
        let [read_as] = &read.source.read_as(Kind::Attitude)[..] else {
            panic!("one way of reading");
        };
        (read_as.because, read_as.frames.len())
    };
    let pose =
        |words: &str| arguments(&[("--attitude", &format!("/pose.pose.orientation{words}"))]);
    let cases = [
        (
            odometry(ros2, ["odom", "base_link"], ROS),
            request(None),
            (Because::Profile, 0),
        ),
        (
            odometry(ros2, ["odom_ned", "base_link_frd"], NED),
            request(None),
            (Because::FrameNames, 2),
        ),
        (stamped(["map", "map"], ROS), pose(""), (Because::Type, 0)),
        (
            stamped(["map_ned", "map"], NED),
            pose(""),
            (Because::FrameNames, 1),
        ),
        (
            stamped(["map", "map"], ROS),
            pose(":flu-enu"),
            (Because::Given, 0),
        ),
        (
            stamped(["map_ned", "map"], ROS),
            pose(":flu-enu"),
            (Because::Given, 1),
        ),
    ];
    for (recording, given, expected) in cases {
        assert_eq!(of(&recording, &given), expected, "{}", recording.name);
    }
}
