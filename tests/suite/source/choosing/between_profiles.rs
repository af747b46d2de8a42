//! Which of several profiles, or topics that a profile fits, by what their messages hold.

use super::*;

#[test]
fn a_profile_without_a_valid_velocity_does_not_stand_beside_one_that_has_it() {
    let topics = [px4(false), mavros(true)].concat();
    let found = source(&topics, &Request::default());
    assert_eq!(found.profile.name, "mavros");
    assert_eq!(found.runners_up[0].profile, "px4-ros2");
    assert!(found.runners_up[0].attitude.is_ok());
    let [passed_over] = &found.passed_over[..] else {
        panic!("{:?}", found.passed_over);
    };
    assert_eq!(passed_over.place.profile, "px4-ros2");
    assert_eq!(passed_over.instead.profile, "mavros");

    let topics = [px4(true), mavros(false)].concat();
    assert_eq!(
        source(&topics, &Request::default()).profile.name,
        "px4-ros2"
    );
    for is_valid in [false, true] {
        let topics = [px4(is_valid), mavros(is_valid)].concat();
        refuses(&topics, &[], "several profiles fit equally well");
    }
}

#[test]
fn vehicles_and_topics_that_are_equally_good_stay_ambiguous() {
    let drone = |velocity: Topic, names: [&'static str; 2]| {
        let [pose_name, velocity_name] = names;
        let named = Topic {
            name: velocity_name,
            ..velocity
        };
        [pose(pose_name), named]
    };
    let [_, valid] = mavros(true);
    let [_, not_valid] = mavros(false);
    let one = drone(
        valid,
        [
            "/d1/mavros/local_position/pose",
            "/d1/mavros/local_position/velocity_local",
        ],
    );
    let other = drone(
        not_valid,
        [
            "/d2/mavros/local_position/pose",
            "/d2/mavros/local_position/velocity_local",
        ],
    );
    let of_two_profiles = [px4(false), one.clone()].concat();
    refuses(&of_two_profiles, &[], "several vehicles");
    refuses(&[one, other].concat(), &[], "several vehicles … /d1, /d2");
    let topics = [times(200, odometry("/odom")), times(100, odometry("/vio"))];
    refuses(&topics, &[], "/odom and /vio fit equally well");
}

/// Neither on the topics that a profile names, nor on one with the same type or fields, nor by itself.
#[test]
fn a_stray_message_of_another_publisher_does_not_beat_a_series() {
    let strays = [
        (pose(POSE), "mavros"),
        (attitude("/fmu/out/vehicle_attitude"), "px4-ros2"),
        (odometry("/vio"), "nav-msgs"),
    ];
    for (stray, profile) in strays {
        let name = stray.name;
        let topics = [times(1, stray.clone()), times(1000, odometry("/odom"))];
        let found = source(&topics, &Request::default());
        let expected = vec![(name, 1, 1, vec![])];
        assert_eq!(choice(&found, Kind::Attitude), ("/odom", expected));
        assert_eq!(found.passed_over[0].place.profile, profile);
        // Enough to be a series.
        let topics = [times(100, stray), times(9000, odometry("/odom"))];
        match profile {
            "nav-msgs" => refuses(&topics, &[], "/odom and /vio fit equally well"),
            _ => assert_eq!(source(&topics, &Request::default()).attitude().topic, name),
        }
    }
    // A series of what is not usable is none.
    let topics = [pose(POSE), times(1000, unusable(odometry("/odom")))];
    assert_eq!(source(&topics, &Request::default()).attitude().topic, POSE);
    let flat_and_stray = [times(1, odometry("/odom")), times(200, flat("/state"))];
    assert_eq!(
        source(&flat_and_stray, &Request::default())
            .attitude()
            .topic,
        "/state"
    );
}

#[test]
fn a_vehicle_with_few_messages_is_one_of_several_vehicles() {
    let topics = [
        times(1, pose("/d1/mavros/local_position/pose")),
        times(1000, pose("/d2/mavros/local_position/pose")),
    ];
    refuses(&topics, &[], "several vehicles … /d1, /d2");
}
