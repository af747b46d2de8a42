//! Which telemetry of a log is used: which profile, which vehicle, which topic; and what the user is told where
//! that is not clear.

mod common;

use common::{folder::*, topics::*};
use flightcam::{
    Error,
    log::Log,
    sample::Kind,
    source::{
        Source,
        profile::{Profile, ProfileChoice},
        request::Request,
    },
};
use serde_json::json;

/// A request, told as on the command line.
fn request(arguments: &[(&str, &str)]) -> Request {
    let mut request = Request::default();
    for &(option, value) in arguments {
        match option {
            "--profile" => {
                let profile = Profile::load(value).expect("a built-in profile");
                request.profile = ProfileChoice::Given(Box::new(profile));
            }
            "--namespace" => request.namespace = Some(value.to_owned()),
            "--attitude" => request.attitude = Some(value.parse().expect("an attitude")),
            "--velocity" => request.velocity = Some(value.parse().expect("a velocity")),
            "--gimbal" => request.gimbal = Some(value.parse().expect("a gimbal")),
            "--position" => request.position = Some(value.parse().expect("a position")),
            _ => panic!("no option {option}"),
        }
    }
    request
}

fn own(toml: &str) -> Request {
    let profile = Profile::parse(toml).expect("a profile");
    Request {
        profile: ProfileChoice::Given(Box::new(profile)),
        ..Request::default()
    }
}

fn select_with(topics: &[Topic], request: &Request) -> Result<Source, Error> {
    let folder = Folder::with(LOG, log(topics));
    Source::select(&Log::open(&folder.path(LOG))?, request)
}

/// What is used: the profile, and the topics of attitude and velocity.
fn used(source: &Source) -> (&str, &str, &str) {
    let topic = |kind| source.role(kind).map_or("", |role| role.topic.as_str());
    let profile = source.profile.name.as_str();
    (profile, topic(Kind::Attitude), topic(Kind::Velocity))
}

#[track_caller]
fn selects(topics: &[Topic], arguments: &[(&str, &str)], expected: (&str, &str, &str)) {
    match select_with(topics, &request(arguments)) {
        Ok(source) => assert_eq!(used(&source), expected, "with {arguments:?}"),
        Err(error) => panic!("with {arguments:?}: {error}"),
    }
}

#[track_caller]
fn refuses(topics: &[Topic], arguments: &[(&str, &str)], words: &str) {
    let error = select_with(topics, &request(arguments)).expect_err("an error");
    assert_reads(&error.to_string(), words);
}

mod a_namespace {
    use super::*;

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
    fn is_found_by_itself_where_there_is_only_one() {
        let source = select_with(&one(), &Request::default()).expect("a source");
        assert_eq!(used(&source), ("mavros", POSE, VELOCITY));
        assert_eq!(source.namespace, "/drone1");

        let px4 = [
            attitude("/fleet/px4_1/fmu/out/vehicle_attitude"),
            local_position("/fleet/px4_1/fmu/out/vehicle_local_position_v1"),
        ];
        let source = select_with(&px4, &Request::default()).expect("a source");
        assert_eq!(used(&source), ("px4-ros2", px4[0].name, px4[1].name));
        assert_eq!(source.namespace, "/fleet/px4_1");
    }

    #[test]
    fn is_chosen_by_the_user_where_there_are_several_vehicles() {
        let several = "telemetry of several vehicles, in the namespaces /drone1, /drone2; choose … --namespace /drone1";
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
    fn may_be_none() {
        let both = [one(), plain()].concat();
        refuses(
            &both,
            &[],
            "namespaces /, /drone1; … --namespace / (/ is the one without a namespace)",
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
            "no usable telemetry … mavros: there is no message on /mavros/",
        );
    }

    #[test]
    fn that_no_topic_is_in_is_told_with_those_that_there_are() {
        let missing =
            format!("there is no topic in the namespace /drone … topics of the log: … {POSE}");
        refuses(&one(), &[("--namespace", "/drone")], &missing);
        refuses(
            &one(),
            &[("--namespace", "/drone"), ("--profile", "mavros")],
            &missing,
        );
    }

    #[test]
    fn narrows_what_is_searched_by_type_or_fields() {
        for topics in [
            ["/a/odom", "/b/odom"].map(odometry),
            ["/a/state", "/b/state"].map(flat),
        ] {
            let [a, b] = [topics[0].name, topics[1].name];
            refuses(&topics, &[], &format!("{a} and {b} fit equally well"));
            let source =
                select_with(&topics, &request(&[("--namespace", "/b")])).expect("a source");
            assert_eq!(source.attitude().topic, b);
        }
    }

    #[test]
    fn may_be_given_for_a_profile_that_has_none_of_its_own() {
        let topics = [
            attitude("/d/vehicle_attitude/0"),
            local_position("/d/vehicle_local_position/0"),
        ];
        let expected = ("px4-ulog", topics[0].name, topics[1].name);
        selects(&topics, &[("--namespace", "/d")], expected);
    }

    #[test]
    fn is_not_put_before_topics_that_the_user_tells() {
        let gps = twice("/drone1/gps", json!({ "v": vector() }));
        let imu = twice(
            "/drone1/mavros/imu/data",
            json!({ "orientation": quaternion() }),
        );
        let more = [&one()[..], &[gps, imu]].concat();
        let told = ("--velocity", "/drone1/gps.v:ned");
        let imu = ("--attitude", "/drone1/mavros/imu/data");
        for namespace in [None, Some(("--namespace", "/drone1"))] {
            let with = |argument| namespace.into_iter().chain([argument]).collect::<Vec<_>>();
            selects(&more, &with(told), ("mavros", POSE, "/drone1/gps"));
            selects(&more, &with(imu), ("mavros", imu.1, VELOCITY));
        }
        let both = [
            ("--namespace", "/drone1"),
            ("--attitude", "/drone1/mavros/imu/data.orientation:flu-enu"),
        ];
        selects(&more, &both, ("command line", imu.1, ""));
    }
}

mod of_profiles {
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
    fn that_fit_equally_well_the_user_chooses_one() {
        let both = [mavros(), px4()].concat();
        let words = "several profiles fit equally well; choose one, for instance with --profile px4-ros2 … \
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
    fn one_that_finds_a_velocity_goes_before_one_that_does_not() {
        let [px4, _] = px4();
        let both = [px4, flat("/state")];
        selects(&both, &[], ("flat", "/state", "/state"));
        let source = select_with(&both, &Request::default()).expect("a source");
        let runner_up = &source.runners_up[0];
        assert_eq!(runner_up.profile, "px4-ros2");
        assert!(runner_up.fits, "if not as well");
        assert_eq!(runner_up.reason, "/fmu/out/vehicle_attitude has q");
    }

    #[test]
    fn one_that_names_topics_goes_before_a_type_and_a_type_before_fields() {
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
    fn that_were_tried_are_told_the_better_ones_first() {
        let [px4, _] = px4();
        let folder = Folder::with(LOG, log(&[px4, odometry("/odom"), flat("/state")]));
        let opened = Log::open(&folder.path(LOG)).expect("a log");
        let source = Source::compare(&opened, &Request::default()).expect("a source");
        assert_eq!(used(&source), ("nav-msgs", "/odom", "/odom"));
        let tried = source
            .runners_up
            .iter()
            .map(|tried| (tried.profile.as_str(), tried.fits));
        let tried: Vec<(&str, bool)> = tried.collect();
        let unfit = ["px4-ulog", "mavros", "ardupilot-ros2", "dji-osdk"].map(|name| (name, false));
        assert_eq!(
            tried,
            [&[("flat", true), ("px4-ros2", true)][..], &unfit].concat()
        );
    }
}

#[test]
fn of_several_topics_of_a_type_the_user_chooses_one() {
    let topics = ["/odom", "/vio"].map(odometry);
    refuses(
        &topics,
        &[],
        "/odom and /vio fit equally well; choose one, for instance with --attitude /odom",
    );
    for topic in ["/odom", "/vio"] {
        selects(
            &topics,
            &[("--attitude", topic)],
            ("nav-msgs", topic, topic),
        );
    }
}

#[test]
fn a_topic_without_messages_is_none() {
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
        "--attitude … no message on /vio … the log has no messages",
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

mod of_alternatives {
    use super::*;

    #[test]
    fn the_first_for_which_the_schema_has_the_fields_is_used() {
        let profile = own(r#"
            name = "mine"
            attitude = [
                { topics = ["/a"], orientation.quaternion = "rotation" },
                { topics = ["/a"], orientation.euler = { roll = "r", pitch = "p", yaw = "y", unit = "degrees" } },
                { topics = ["/b"], orientation.quaternion = "q" },
            ]"#);
        let angles = twice("/a", json!({ "r": 1, "p": 2, "y": 3 }));
        let nothing = twice("/a", json!({ "x": 1 }));
        let topic = |topics: &[Topic]| {
            select_with(topics, &profile).map(|source| source.attitude().reason())
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

    /// What the first looked at must not be read: here it would not decode.
    #[test]
    fn one_that_does_not_fit_leaves_nothing_behind() {
        let profile = own(r#"
            name = "mine"
            attitude = [
                { topics = ["/a"], orientation.quaternion = ["q[0]", "q[1]", "q[2]", "mode"] },
                { topics = ["/a"], orientation.quaternion = ["w", "x", "lost", "mode"] },
                { topics = ["/a"], orientation.quaternion = "q" },
            ]"#);
        let message = json!({ "q": [1, 0, 0, 0], "mode": "AUTO", "w": 1, "x": 0 });
        let source = select_with(&[twice("/a", message)], &profile).expect("a source");
        assert_eq!(source.attitude().reason(), "/a has q");
    }

    #[test]
    fn a_topic_that_lacks_the_velocity_does_not_hide_one_that_has_it() {
        let profile = own(r#"
            name = "mine"
            attitude.orientation.quaternion = "q"
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

mod what_is_told {
    use super::*;

    #[test]
    fn replaces_what_the_profile_says() {
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
        let more = [("--gimbal", "/gps.q:earth"), ("--position", "/gps.p:enu")];
        let source = select_with(&topics, &request(&more)).expect("a source");
        for kind in [Kind::Gimbal, Kind::Position] {
            assert_eq!(source.role(kind).expect("a role").topic, "/gps");
        }
        let angles = "/state.roll,/state.pitch,/state.yaw:radians";
        selects(
            &topics,
            &[("--attitude", angles)],
            ("command line", "/state", ""),
        );
    }

    #[test]
    fn and_is_not_there_is_an_error_that_names_the_option() {
        for (role, missing, lacking) in [
            ("--attitude", "/imu.q", "/state.q"),
            ("--velocity", "/imu.q:ned", "/state.q:ned"),
            ("--gimbal", "/imu.q:earth", "/state.q:earth"),
            ("--position", "/imu.q:ned", "/state.q:ned"),
        ] {
            let topics = [flat("/state")];
            let words = format!(
                "{role} does not fit: there is no message on /imu … topics of the log: … /state"
            );
            refuses(&topics, &[(role, missing)], &words);
            refuses(&topics, &[(role, "/imu")], &words);
            let words =
                format!("{role} does not fit: /state: it has no field `q`; … has pitch, roll, vx");
            refuses(&topics, &[(role, lacking)], &words);
            refuses(&topics, &[(role, lacking), ("--profile", "flat")], &words);
        }
    }

    #[test]
    fn of_a_topic_alone_needs_a_profile_that_says_how_to_read_it() {
        let topics = [flat("/state")];
        let words = "it has no gimbal; give --gimbal fields, not only a topic";
        refuses(
            &topics,
            &[("--gimbal", "/state"), ("--profile", "flat")],
            words,
        );
        let angles = ("--attitude", "/state.roll,/state.pitch,/state.yaw:radians");
        let words = "it has no velocity; give --velocity fields, not only a topic";
        refuses(&topics, &[angles, ("--velocity", "/state")], words);
    }
}
