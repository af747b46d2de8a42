//! What errors say of a log that lacks what was asked for: the likeliest names, what could serve, and paths that can be
//! read in two ways.

use flightcam::{
    Error,
    error::TelemetryError,
    source::{
        profile::{Profile, ProfileChoice},
        request::Request,
    },
};
use serde_json::json;

use crate::support::{folder::assert_reads, selecting::*, topics::*};

/// Many topics that are of no use, and some that are.
fn busy(useful: &[Topic]) -> Vec<Topic> {
    const NAMES: [&str; 12] = [
        "/a/battery",
        "/b/status",
        "/c/rc",
        "/d/esc",
        "/e/wind",
        "/f/log",
        "/g/vibration",
        "/h/parameters",
        "/i/mission",
        "/j/home",
        "/k/events",
        "/l/heartbeat",
    ];
    let idle = NAMES.map(|name| twice(name, json!({ "count": 1 })));
    [useful, &idle].concat()
}

fn imu(name: &'static str) -> Topic {
    let message = json!({ "orientation": quaternion(), "header": { "frame_id": "imu" } });
    twice(name, message).of_type("sensor_msgs/msg/Imu")
}

#[test]
fn a_mistyped_topic_gets_the_likeliest_ones_first() {
    let useful = [
        imu("/mavros/imu/data"),
        imu("/mavros/imu/data_raw"),
        odometry("/odom"),
    ];
    let topics = busy(&useful);
    for (wanted, meant) in [
        // A slip, case, slashes, another namespace, the end alone, a path where the topic should be, a last name.
        ("/mavros/imu/dta", "/mavros/imu/data"),
        ("/mavros/Imu/Data", "/mavros/imu/data"),
        ("mavros/imu/data", "/mavros/imu/data"),
        ("/uav1/mavros/imu/data", "/mavros/imu/data"),
        ("/imu/data", "/mavros/imu/data"),
        ("/mavros/imu/data/orientation", "/mavros/imu/data"),
        ("/vehicle/sensors/data_raw", "/mavros/imu/data_raw"),
        ("/odometry", "/odom"),
    ] {
        let argument = format!("{wanted}.orientation:flu-enu");
        let words = format!(
            "attitude does not fit: there is no message on {wanted}\ndid you mean {meant} … topics whose messages could \
             have the attitude: … {} (json, sensor_msgs/msg/Imu): orientation … the log has 12 other topics",
            useful[0].name,
        );
        refuses(&topics, &[("--attitude", &argument)], &words);
    }
    let error = refusal(&topics, &[("--attitude", "/nothing/like/it.q")]);
    assert!(!error.contains("did you mean"), "{error}");
    assert!(!error.contains("/a/battery"), "{error}");
}

#[track_caller]
fn refusal(topics: &[Topic], arguments: &[(&str, &str)]) -> String {
    let error = select_with(topics, &request(arguments));
    error.expect_err("an error").to_string()
}

#[test]
fn topics_with_the_fields_that_were_named_come_before_those_that_profiles_know() {
    let useful = [
        flat("/a_state"),
        twice("/z_state", json!({ "my_q": [1, 0, 0, 0] })),
    ];
    let words =
        "could have the attitude: … /z_state (json, no schema): my_q … /a_state … roll, pitch, yaw";
    refuses(&busy(&useful), &[("--attitude", "/state.my_q")], words);
    // Each role has candidates of its own.
    let gps = twice("/gps", json!({ "lat": 47, "lon": 8, "alt": 400 }));
    let topics = busy(&[twist("/twist"), gps]);
    refuses(
        &topics,
        &[("--velocity", "/v.x,/v.y,/v.z:ned")],
        "could have the velocity: … /twist (json, geometry_msgs/msg/TwistStamped): twist.linear\nthe log has 13",
    );
    refuses(
        &topics,
        &[("--position", "/p.x,/p.y,/p.z:ned")],
        "could have the position: … /gps (json, no schema): lat, lon, alt\nthe log has 13",
    );
}

#[test]
fn a_log_that_no_profile_fits_shows_what_could_be_an_attitude() {
    let words = "no usable telemetry … flat … could have the attitude: … /imu (json, sensor_msgs/msg/Imu): \
                 orientation\nthe log has 12 other topics";
    let error = select_with(&busy(&[imu("/imu")]), &Request::default()).expect_err("an error");
    assert_reads(&error.to_string(), words);
}

#[test]
fn a_profile_that_names_a_missing_topic_gets_the_likeliest_ones() {
    let topics = busy(&[
        imu("/mavros/imu/data"),
        twist("/mavros/local_position/velocity"),
    ]);
    let toml = "name = \"mine\"\nattitude.orientation.quaternion = \"/mavros/imu/dat.orientation\"";
    let request = Request {
        profile: ProfileChoice::Given(Box::new(Profile::parse(toml).expect("a profile"))),
        ..Request::default()
    };
    let error = select_with(&topics, &request).expect_err("an error");
    let words = "`mine` does not fit: there is no message on /mavros/imu/dat\ndid you mean /mavros/imu/data?";
    assert_reads(&error.to_string(), words);
}

#[test]
fn a_mistyped_namespace_gets_the_likeliest_ones() {
    let vehicles = [
        "/drone1/mavros/local_position/pose",
        "/drone2/mavros/local_position/pose",
    ]
    .map(pose);
    let words = "no topic in the namespace /dron1\ndid you mean /drone1";
    refuses(&busy(&vehicles), &[("--namespace", "/dron1")], words);
}

#[test]
fn a_mistyped_field_gets_the_likeliest_one_first() {
    let state = twice("/state", json!({ "Roll": 0, "pitch_deg": 0, "yaw": 0 }));
    let separator = "=".repeat(80);
    let nested = format!(
        "Pose pose\n{separator}\nMSG: nav/Pose\nfloat64[3] position\nfloat64[4] orientation\n"
    );
    let odometry = Topic {
        encoding: "cdr",
        ..twice("/odom", json!({})).with_schema("nav/msg/Odometry", "ros2msg", nested)
    };
    let topics = [state, odometry];
    for (argument, words) in [
        (
            "/state.Roll,/state.pitch,/state.yaw:degrees",
            "has no field `pitch`; did you mean `pitch_deg`? the one of",
        ),
        (
            "/state.Rol,/state.x,/state.yaw:degrees",
            "has no field `Rol`, `x`; did you mean `Roll`? the one of",
        ),
        ("/state.q", "has no field `q`; the one of"),
        (
            "/odom.pose.orientaton",
            "has no field `pose.orientaton`; did you mean `pose.orientation`? nav/Pose has position",
        ),
        (
            "/odom.pose1.orientation",
            "has no field `pose1.orientation`; did you mean `pose`?",
        ),
        ("/odom.pose.q", "has no field `pose.q`; nav/Pose has"),
    ] {
        refuses(&topics, &[("--attitude", argument)], words);
    }
}

mod dotted {
    use super::*;

    const ANGLES: &str = "/fc.state.roll,/fc.state.pitch,/fc.state.yaw:radians";

    fn nested(name: &'static str) -> Topic {
        twice(
            name,
            json!({ "state": { "roll": 0, "pitch": 0, "yaw": 0 }, "other": 1 }),
        )
    }

    fn both() -> [Topic; 2] {
        [nested("/fc"), flat("/fc.state")]
    }

    #[test]
    fn a_path_that_can_be_read_in_two_ways_is_refused_with_both() {
        refuses(
            &both(),
            &[("--attitude", ANGLES)],
            "the path of the attitude has several meanings in this log … \
             \"/fc\".state.roll,\"/fc\".state.pitch,\"/fc\".state.yaw: the fields state.roll, state.pitch, state.yaw of the \
             topic /fc … \
             \"/fc.state\".roll,\"/fc.state\".pitch,\"/fc.state\".yaw: the fields roll, pitch, yaw of the topic /fc.state",
        );
        let vectors = [
            twice("/fc", json!({ "state": { "v": vector() } })),
            twice("/fc.state", json!({ "v": vector() })),
            twice("/fc.state.v", json!({ "x": 1 })),
            flat("/flat"),
        ];
        refuses(
            &vectors,
            &[("--velocity", "/fc.state.v:ned")],
            "the velocity has several meanings … field state.v of the topic /fc … field v of the topic /fc.state … the \
             topic /fc.state.v",
        );
    }

    #[test]
    fn quotes_say_which_one_is_meant() {
        for (topic, path) in [("/fc", r#""/fc".state."#), ("/fc.state", r#""/fc.state"."#)] {
            let argument = ["roll", "pitch", "yaw"]
                .map(|angle| format!("{path}{angle}"))
                .join(",");
            let argument = format!("{argument}:radians");
            let source =
                select_with(&both(), &request(&[("--attitude", &argument)])).expect("a source");
            assert_eq!(source.attitude().topic, topic);
        }
        // In one of the paths is enough, because all are of one topic.
        let once = r#""/fc".state.roll,/fc.state.pitch,/fc.state.yaw:radians"#;
        let source = select_with(&both(), &request(&[("--attitude", once)])).expect("a source");
        assert_eq!(source.attitude().topic, "/fc");
    }

    #[test]
    fn a_path_that_can_be_read_in_one_way_is_read_so() {
        let other = twice("/fc.state", json!({ "mode": "AUTO" }));
        let source = select_with(&[nested("/fc"), other], &request(&[("--attitude", ANGLES)]));
        assert_eq!(source.expect("a source").attitude().topic, "/fc");
    }

    #[test]
    fn where_only_the_topic_with_the_dot_has_the_fields_the_error_says_how_to_write_it() {
        let words = "there is a topic /fc.state, whose name needs quotes in a path: … \
                     \"/fc.state\".roll,\"/fc.state\".pitch,\"/fc.state\".yaw: the fields roll, pitch, yaw";
        let missing = format!("attitude does not fit: there is no message on /fc\n … {words}");
        refuses(&[flat("/fc.state")], &[("--attitude", ANGLES)], &missing);
        let lacking =
            format!("attitude does not fit: /fc: it has no field `state.roll`, … {words}");
        let other = twice("/fc", json!({ "mode": "AUTO" }));
        refuses(
            &[other, flat("/fc.state")],
            &[("--attitude", ANGLES)],
            &lacking,
        );
    }

    #[test]
    fn the_error_has_the_readings_as_data() {
        let error =
            select_with(&both(), &request(&[("--attitude", ANGLES)])).expect_err("an error");
        let Error::Telemetry(TelemetryError::SeveralReadings { readings, .. }) = error else {
            panic!("{error}");
        };
        let topics: Vec<&str> = readings
            .iter()
            .map(|reading| reading.topic.as_str())
            .collect();
        assert_eq!(topics, ["/fc", "/fc.state"]);
    }
}
