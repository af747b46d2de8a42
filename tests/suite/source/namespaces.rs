//! Which of several vehicles is meant: the prefix that its topics have in common.

use flightcam::source::request::Request;
use serde_json::json;

use crate::support::{selecting::*, topics::*};

const POSE: &str = "/drone1/mavros/local_position/pose";
const VELOCITY: &str = "/drone1/mavros/local_position/velocity_local";

fn one() -> [Topic; 2] {
    [pose(POSE), twist(VELOCITY)]
}

fn two() -> Vec<Topic> {
    let pose = pose("/drone2/mavros/local_position/pose");
    let twist = twist("/drone2/mavros/local_position/velocity_local");
    [one(), [pose, twist]].concat()
}

fn plain() -> [Topic; 2] {
    let twist = twist("/mavros/local_position/velocity_local");
    [pose("/mavros/local_position/pose"), twist]
}

#[test]
fn the_only_namespace_is_chosen_automatically() {
    let source = select_with(&one(), &Request::default()).expect("a source");
    assert_eq!(used(&source), ("mavros", POSE, VELOCITY));
    assert_eq!(source.namespace(), "/drone1");

    let px4 = [
        attitude("/fleet/px4_1/fmu/out/vehicle_attitude"),
        local_position("/fleet/px4_1/fmu/out/vehicle_local_position_v1"),
    ];
    let source = select_with(&px4, &Request::default()).expect("a source");
    assert_eq!(used(&source), ("px4-ros2", px4[0].name, px4[1].name));
    assert_eq!(source.namespace(), "/fleet/px4_1");
}

#[test]
fn a_namespace_is_chosen_by_the_user_where_there_are_several_vehicles() {
    let several = "telemetry of several vehicles, in the namespaces /drone1, /drone2";
    refuses(&two(), &[], several);
    let second = "/drone2/mavros/local_position/pose";
    let velocity = "/drone2/mavros/local_position/velocity_local";
    selects(
        &two(),
        &[("--namespace", "/drone1")],
        ("mavros", POSE, VELOCITY),
    );
    selects(
        &two(),
        &[("--namespace", "/drone2")],
        ("mavros", second, velocity),
    );
}

#[test]
fn a_namespace_may_be_a_vehicles_number_within_the_topic() {
    let vehicle = |pose_topic, velocity| [pose(pose_topic), twist(velocity)];
    let three = vehicle("/ap/v3/pose/filtered", "/ap/v3/twist/filtered");
    let twelve = vehicle("/ap/v12/pose/filtered", "/ap/v12/twist/filtered");
    let both = [three.clone(), twelve].concat();
    selects(
        &three,
        &[],
        ("ardupilot-ros2", three[0].name, three[1].name),
    );
    refuses(
        &both,
        &[],
        "several vehicles, in the namespaces /ap/v12, /ap/v3",
    );
    selects(
        &both,
        &[("--namespace", "/ap/v3")],
        ("ardupilot-ros2", three[0].name, three[1].name),
    );
    let near = [
        pose("/pose/filtered"),
        pose("/ap/v/pose/filtered"),
        pose("/ap/vx/pose/filtered"),
    ];
    // What fits them is only what takes any lone pose.
    refuses(&near, &[], "fit equally well");
    for namespace in ["/pose", "/ap", "/ap/v", "/ap/vx"] {
        refuses(&near, &[("--namespace", namespace)], "no usable telemetry");
    }
}

#[test]
fn a_namespace_is_not_guessed_from_how_much_is_known_of_each_vehicle() {
    let only_pose = pose("/drone2/mavros/local_position/pose");
    let topics = [&one()[..], &[only_pose]].concat();
    refuses(
        &topics,
        &[],
        "several vehicles, in the namespaces /drone1, /drone2",
    );
    let second = ("mavros", "/drone2/mavros/local_position/pose", "");
    selects(&topics, &[("--namespace", "/drone2")], second);
}

#[test]
fn a_namespace_is_found_where_topics_do_not_begin_with_a_slash() {
    let topics = [
        pose("drone1/mavros/local_position/pose"),
        twist("drone1/mavros/local_position/velocity_local"),
        pose("drone2/mavros/local_position/pose"),
        twist("drone2/mavros/local_position/velocity_local"),
    ];
    refuses(&topics, &[], "in the namespaces drone1, drone2");
    let namespace = [("--namespace", "/drone1")];
    selects(
        &topics,
        &namespace,
        ("mavros", topics[0].name, topics[1].name),
    );
}

#[test]
fn a_namespace_may_be_empty() {
    let both = [one(), plain()].concat();
    refuses(
        &both,
        &[],
        "namespaces /, /drone1 (/ is the one without a namespace)",
    );
    let [pose, twist] = plain();
    selects(
        &both,
        &[("--namespace", "")],
        ("mavros", pose.name, twist.name),
    );
    selects(
        &both,
        &[("--namespace", "/drone1")],
        ("mavros", POSE, VELOCITY),
    );
    refuses(
        &one(),
        &[("--namespace", "")],
        "no usable telemetry … the log has none: … mavros",
    );
}

#[test]
fn a_namespace_without_topics_is_refused_with_those_that_have_some() {
    let missing =
        format!("there is no topic in the namespace /drone\ndid you mean /drone1? … {POSE}");
    refuses(&one(), &[("--namespace", "/drone")], &missing);
    refuses(
        &one(),
        &[("--namespace", "/drone"), ("--profile", "mavros")],
        &missing,
    );
}

#[test]
fn a_namespace_narrows_what_is_searched_by_type_or_fields() {
    for topics in [
        ["/a/odom", "/b/odom"].map(odometry),
        ["/a/state", "/b/state"].map(flat),
    ] {
        let [a, b] = [topics[0].name, topics[1].name];
        refuses(&topics, &[], &format!("{a} and {b} fit equally well"));
        let source = select_with(&topics, &request(&[("--namespace", "/b")])).expect("a source");
        assert_eq!(source.attitude().topic, b);
    }
}

#[test]
fn a_namespace_may_be_given_for_a_profile_that_has_none_of_its_own() {
    let topics = [
        attitude("/d/vehicle_attitude/0"),
        local_position("/d/vehicle_local_position/0"),
    ];
    let expected = ("px4-ulog", topics[0].name, topics[1].name);
    selects(&topics, &[("--namespace", "/d")], expected);
    // A topic whose name only begins like the namespace is not in it, though some topics have no slash.
    let near = [
        attitude("/dvehicle_attitude"),
        twice("/d/battery", json!({ "volts": 15 })),
    ];
    refuses(&near, &[("--namespace", "/d")], "no usable telemetry");
}

#[test]
fn a_namespace_is_not_prefixed_to_topics_that_the_user_names() {
    let gps = twice("/drone1/gps", json!({ "v": vector() }));
    let imu = twice(
        "/drone1/mavros/imu/data",
        json!({ "orientation": quaternion() }),
    );
    let more = [&one()[..], &[gps, imu]].concat();
    let given = ("--velocity", "/drone1/gps.v:ned");
    let imu = ("--attitude", "/drone1/mavros/imu/data");
    for namespace in [None, Some(("--namespace", "/drone1"))] {
        let with = |argument| namespace.into_iter().chain([argument]).collect::<Vec<_>>();
        selects(&more, &with(given), ("mavros", POSE, "/drone1/gps"));
        selects(&more, &with(imu), ("mavros", imu.1, VELOCITY));
    }
    // The other vehicle's is not taken for it.
    let vehicles = [&more[..], &two()[2..]].concat();
    selects(&vehicles, &[imu], ("mavros", imu.1, VELOCITY));
    let both = [
        ("--namespace", "/drone1"),
        ("--attitude", "/drone1/mavros/imu/data.orientation:flu-enu"),
    ];
    selects(&more, &both, ("mavros", imu.1, VELOCITY));
}
