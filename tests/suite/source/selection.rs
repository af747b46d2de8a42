//! Which telemetry of a log is used: which profile, and which topics; and the error where that is not clear.

use flightcam::{
    log::Log,
    sample::Kind,
    source::{
        Source,
        profile::{Profile, ProfileChoice},
        request::Request,
    },
};
use serde_json::json;

use crate::support::{folder::*, selecting::*, topics::*};

fn own(toml: &str) -> Request {
    let profile = Profile::parse(toml).expect("a profile");
    Request {
        profile: ProfileChoice::Given(Box::new(profile)),
        ..Request::default()
    }
}

mod between_profiles {
    use super::*;

    fn mavros() -> [Topic; 2] {
        let velocity = twist("/mavros/local_position/velocity_local");
        [pose("/mavros/local_position/pose"), velocity]
    }

    fn px4() -> [Topic; 2] {
        [
            attitude("/fmu/out/vehicle_attitude"),
            local_position("/fmu/out/vehicle_local_position"),
        ]
    }

    #[test]
    fn profiles_that_fit_equally_well_are_refused_with_how_to_choose() {
        let both = [mavros(), px4()].concat();
        let words = "several profiles fit equally well … \
                     px4-ros2: /fmu/out/vehicle_attitude … mavros: /mavros/local_position/pose";
        refuses(&both, &[], words);
        let [pose, twist] = mavros();
        selects(
            &both,
            &[("--profile", "mavros")],
            ("mavros", pose.name, twist.name),
        );
        let [attitude, position] = px4();
        selects(
            &both,
            &[("--profile", "px4-ros2")],
            ("px4-ros2", attitude.name, position.name),
        );
    }

    #[test]
    fn a_profile_with_a_velocity_precedes_one_without() {
        let [px4, _] = px4();
        let [pose, twist] = mavros();
        let (pose_name, twist_name) = (pose.name, twist.name);
        let both = [px4, pose, twist];
        selects(&both, &[], ("mavros", pose_name, twist_name));
        let source = select_with(&both, &Request::default()).expect("a source");
        let runner_up = &source.runners_up[0];
        assert_eq!(runner_up.profile, "px4-ros2");
        let attitude = runner_up
            .attitude
            .as_ref()
            .expect("it fits, if not as well");
        assert_eq!(attitude.to_string(), "/fmu/out/vehicle_attitude has q");
    }

    #[test]
    fn a_profile_that_names_topics_precedes_one_with_types_and_that_one_with_fields() {
        let [px4_attitude, px4_velocity] = px4();
        let px4 = ("px4-ros2", px4_attitude.name, px4_velocity.name);
        let topics = [
            px4_attitude,
            px4_velocity,
            odometry("/odom"),
            flat("/state"),
        ];
        selects(&topics, &[], px4);
        selects(&topics[1..], &[], ("nav-msgs", "/odom", "/odom"));
        selects(&topics[3..], &[], ("flat", "/state", "/state"));
    }

    #[test]
    fn profiles_that_were_tried_are_listed_best_first() {
        let [px4, _] = px4();
        let folder = Folder::with(LOG, log(&[px4, odometry("/odom"), flat("/state")]));
        let opened = Log::open(&folder.path(LOG)).expect("a log");
        let source = Source::compare(&opened, &Request::default()).expect("a source");
        // A topic whose name says that it is the vehicle's precedes one that may be anything's, velocity or not.
        assert_eq!(source.profile.name, "px4-ros2");
        let tried = source
            .runners_up
            .iter()
            .map(|tried| (tried.profile.as_str(), tried.attitude.is_ok()));
        let tried: Vec<(&str, bool)> = tried.collect();
        assert_eq!(tried[..2], [("nav-msgs", true), ("flat", true)]);
        assert!(tried[2..].iter().all(|(_, fits)| !fits));
    }
}

#[test]
fn several_topics_of_a_type_are_refused_with_how_to_choose() {
    let topics = ["/odom", "/vio"].map(odometry);
    refuses(&topics, &[], "/odom and /vio fit equally well");
    for topic in ["/odom", "/vio"] {
        selects(
            &topics,
            &[("--attitude", topic)],
            ("nav-msgs", topic, topic),
        );
    }
}

#[test]
fn a_type_without_a_velocity_is_used_without_one() {
    let pose = json!({ "orientation": quaternion(), "position": vector() });
    let pose = twice("/pose", json!({ "pose": pose })).of_type("foxglove.PoseInFrame");
    let source = select_with(&[pose], &Request::default()).expect("a source");
    assert_eq!(used(&source), ("nav-msgs", "/pose", ""));
    let missing = source.why_missing(Kind::Velocity).expect("none");
    assert_eq!(missing.to_string(), "the messages on /pose have none");
    assert_eq!(
        source.role(Kind::Position).expect("a position").topic,
        "/pose"
    );
}

#[test]
fn a_topic_without_messages_does_not_count() {
    let silent = Topic {
        messages: Vec::new(),
        ..odometry("/vio")
    };
    selects(
        &[odometry("/odom"), silent.clone()],
        &[],
        ("nav-msgs", "/odom", "/odom"),
    );
    refuses(
        &[silent],
        &[("--attitude", "/vio")],
        "attitude … no message on /vio … the log has no messages",
    );
}

#[test]
fn the_highest_version_of_a_topic_is_used_whatever_its_spelling() {
    let topics = [
        "/fmu/out/vehicle_attitude",
        "/fmu/out/vehicle_attitude_v2",
        "/fmu/out/vehicle_attitude_v10",
        "/fmu/out/vehicle_attitude_v9",
    ]
    .map(attitude);
    selects(&topics, &[], ("px4-ros2", topics[2].name, ""));
    selects(&topics[..2], &[], ("px4-ros2", topics[1].name, ""));
    selects(&topics[..1], &[], ("px4-ros2", topics[0].name, ""));
    for name in [
        "/fmu/out/vehicle_attitude_v",
        "/fmu/out/vehicle_attitude_vx",
        "/fmu/out/vehicle_attitude_v1x",
        "/fmu/out/vehicle_attitude_v+1",
    ] {
        refuses(&[attitude(name)], &[], "no usable telemetry");
    }
}

mod alternatives {
    use super::*;

    #[test]
    fn the_first_alternative_whose_fields_the_schema_has_is_used() {
        let profile = own(r#"
            name = "mine"
            attitude = [
                { topics = ["/a"], orientation.quaternion = "rotation", convention = "frd-ned" },
                { topics = ["/a"], orientation.euler = { roll = "r", pitch = "p", yaw = "y", unit = "degrees" } },
                { topics = ["/b"], orientation.quaternion = "q", convention = "frd-ned" },
            ]"#);
        let angles = twice("/a", json!({ "r": 1, "p": 2, "y": 3 }));
        let nothing = twice("/a", json!({ "x": 1 }));
        let topic = |topics: &[Topic]| {
            select_with(topics, &profile).map(|source| source.attitude().to_string())
        };
        assert_eq!(
            topic(&[angles, attitude("/b")]).expect("a source"),
            "/a has r, p, y"
        );
        assert_eq!(
            topic(&[nothing.clone(), attitude("/b")]).expect("a source"),
            "/b has q"
        );
        let error = topic(&[nothing]).expect_err("an error").to_string();
        assert_reads(
            &error,
            "profile `mine` does not fit: /a: it has no field `rotation`; … has x",
        );
    }

    /// What the first one looked at must not be read: here it would not decode.
    #[test]
    fn an_alternative_that_does_not_fit_leaves_no_trace() {
        let profile = own(r#"
            name = "mine"
            attitude = [
                { topics = ["/a"], orientation.quaternion = ["q[0]", "q[1]", "q[2]", "mode"], convention = "frd-ned" },
                { topics = ["/a"], orientation.quaternion = ["w", "x", "lost", "mode"], convention = "frd-ned" },
                { topics = ["/a"], orientation.quaternion = "q", convention = "frd-ned" },
            ]"#);
        let message = json!({ "q": [1, 0, 0, 0], "mode": "AUTO", "w": 1, "x": 0 });
        let source = select_with(&[twice("/a", message)], &profile).expect("a source");
        assert_eq!(source.attitude().to_string(), "/a has q");
    }

    #[test]
    fn a_topic_that_lacks_the_velocity_does_not_hide_one_that_has_it() {
        let profile = own(r#"
            name = "mine"
            attitude.orientation.quaternion = "q"
            attitude.convention = "frd-ned"
            velocity = { vector = "v", frame = "ned" }"#);
        let whole = twice("/b", json!({ "q": [1, 0, 0, 0], "v": [1, 0, 0] }));
        let source = select_with(&[attitude("/a"), whole], &profile).expect("a source");
        assert_eq!(used(&source), ("mine", "/b", "/b"));
        let error = select_with(&[attitude("/a")], &profile).expect_err("no velocity");
        assert_reads(
            &error.to_string(),
            "`mine` does not fit: /a: it has no field `v`",
        );
    }
}

mod what_the_user_gives {
    use super::*;

    #[test]
    fn what_the_user_gives_replaces_what_the_profile_says() {
        let gps = twice(
            "/gps",
            json!({ "v": vector(), "p": vector(), "q": quaternion() }),
        );
        let topics = [flat("/state"), gps];
        selects(
            &topics,
            &[("--velocity", "/gps.v:ned")],
            ("flat", "/state", "/gps"),
        );
        let more = [
            ("--gimbal", "/gps.q:earth:frd-ned"),
            ("--position", "/gps.p:enu"),
        ];
        let source = select_with(&topics, &request(&more)).expect("a source");
        for kind in [Kind::Gimbal, Kind::Position] {
            assert_eq!(source.role(kind).expect("a role").topic, "/gps");
        }
    }

    #[test]
    fn a_given_topic_that_is_missing_is_an_error_that_names_the_role() {
        for (role, missing, lacking) in [
            ("--attitude", "/imu.q:frd-ned", "/state.q:frd-ned"),
            ("--velocity", "/imu.q:ned", "/state.q:ned"),
            ("--gimbal", "/imu.q:earth", "/state.q:earth"),
            ("--position", "/imu.q:ned", "/state.q:ned"),
        ] {
            let topics = [flat("/state")];
            let words = format!(
                "{} does not fit: there is no message on /imu … /state",
                &role[2..]
            );
            refuses(&topics, &[(role, missing)], &words);
            refuses(&topics, &[(role, "/imu")], &words);
            let role_name = &role[2..];
            let words = format!(
                "{role_name} does not fit: /state: it has no field `q`; … has pitch, roll, vx"
            );
            refuses(&topics, &[(role, lacking)], &words);
            refuses(&topics, &[(role, lacking), ("--profile", "flat")], &words);
        }
    }

    #[test]
    fn a_topic_alone_needs_a_profile_that_says_how_to_read_it() {
        let topics = [flat("/state")];
        let words = "only a topic was given for the gimbal";
        refuses(
            &topics,
            &[("--gimbal", "/state"), ("--profile", "flat")],
            words,
        );
        let angles = ("--attitude", "/state.roll,/state.pitch,/state.yaw:radians");
        refuses(&topics, &[angles, ("--gimbal", "/state")], words);
    }
}
