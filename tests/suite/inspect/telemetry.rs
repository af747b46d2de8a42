//! What `inspect` finds in a log, whatever its messages and container.
//!
//! The numbers are compared with those of the official reader and of the flights themselves.

use std::fs;

use flightcam::{
    Error, Options,
    camera::{CameraError, Mount},
    geometry::DepressionAngle,
    inspect::{Planned, RoleReport},
    messages::{Encoding, EncodingChoice},
    report::CameraReport,
    sample::Kind,
    source::{
        profile::{Profile, ProfileChoice},
        request::{Request, RoleArgument},
    },
};
use serde_json::{Value, json};

use crate::support::{
    flights::{self, Recording},
    folder::assert_reads,
    inspection::*,
    topics::*,
    *,
};

/// Options that name the profile unless it is found automatically.
fn options_for(recording: &Recording) -> Options {
    let text = Profile::built_in_text(recording.profile).expect("built in");
    let profile = Profile::parse(text).expect("a profile");
    let mut request = Request::default();
    if !profile.automatic {
        request.profile = ProfileChoice::Given(Box::new(profile));
    }
    Options::new().telemetry(request)
}

#[test]
fn a_flight_has_the_same_numbers_in_every_convention() {
    for recording in flights::recordings() {
        let log = recording.log();
        let inspection = inspected_with(&log, &options_for(&recording)).expect("a log");
        println!("{}", recording.name);
        check_counts(&inspection, &log);
        let telemetry = telemetry(&inspection);
        assert_eq!(telemetry.profile.name, recording.profile);
        let follows = telemetry.camera == Some(CameraReport::Gimbal);
        assert_eq!(follows, recording.gimbal.is_some());

        let flight = &recording.flight;
        let usable = |is_there: bool, times: &[u64]| is_there.then_some(times.len() as u64);
        for (kind, expected) in [
            (Kind::Attitude, usable(true, &flight.attitude_times)),
            (
                Kind::Velocity,
                usable(!flight.velocity_times.is_empty(), &flight.velocity_times),
            ),
            (
                Kind::Gimbal,
                usable(recording.gimbal.is_some(), &flight.gimbal_times),
            ),
            (
                Kind::Position,
                usable(recording.position.is_some(), &flight.position_times),
            ),
        ] {
            let used = match &telemetry.roles[&kind] {
                RoleReport::Found(found) => {
                    assert_eq!(found.read, found.messages, "{}", recording.name);
                    assert!(found.first.is_some());
                    Some(found.tally.used)
                }
                RoleReport::Missing { .. } => None,
            };
            assert_eq!(used, expected, "{}", kind.name());
        }
        let at_most = telemetry.would_write.iter().map(|planned| planned.at_most);
        let attitudes = flight.attitude_times.len() as u64;
        let velocities = flight.velocity_times.len() as u64;
        let expected = [attitudes - 1, attitudes, velocities];
        assert!(at_most.eq(expected.into_iter().filter(|&n| n > 0)));
        assert_eq!(inspection.problem, None);
        assert!(!inspection.scanned);
    }
}

#[test]
fn real_logs_have_the_known_numbers() {
    let Some(folder) = real_logs() else { return };
    for (name, profile, attitudes, velocities, invalid) in [
        ("test_ulog", "px4-ulog", 131, 66, 0),
        ("test_ulog.ros2", "px4-ros2", 131, 66, 0),
        ("sample_px4_events", "px4-ulog", 622, 313, 98),
        ("sample_log_small", "px4-ulog", 1298, 636, 636),
    ] {
        let log = fs::read(folder.join(format!("{name}.mcap"))).expect("the log");
        let inspection = inspected(&log);
        check_counts(&inspection, &log);
        let telemetry = telemetry(&inspection);
        assert_eq!(telemetry.profile.name, profile);
        let [attitude, velocity] =
            [Kind::Attitude, Kind::Velocity].map(|kind| found(&inspection, kind));
        assert_eq!(
            (attitude.messages, attitude.tally.used),
            (attitudes, attitudes)
        );
        assert_eq!(
            (velocity.messages, velocity.tally.used),
            (velocities, velocities - invalid)
        );
        assert_eq!(velocity.share_invalid, invalid as f64 / velocities as f64);
        let at_most = telemetry.would_write.iter().map(|planned| planned.at_most);
        let expected = [attitudes - 1, attitudes, velocities - invalid];
        assert!(at_most.eq(expected.into_iter().filter(|&count| count > 0)));
        assert_eq!(
            telemetry.would_not_write.len(),
            usize::from(invalid == velocities)
        );
        assert_eq!(inspection.problem, None);
    }
}

#[test]
fn the_planned_encoding_is_the_one_that_enrich_chooses() {
    let encodings = [
        (
            Encoding::Protobuf,
            "protobuf",
            "flightcam.v1.CameraVelocity",
        ),
        (Encoding::Json, "json", "flightcam.v1.CameraVelocity"),
        (Encoding::Ros2, "cdr", "geometry_msgs/msg/Vector3Stamped"),
    ];
    let given = EncodingChoice::Given;
    for (profile, automatic) in [
        ("px4-ulog", Encoding::Protobuf),
        ("px4-ros2", Encoding::Ros2),
        ("dji-osdk", Encoding::Protobuf),
        ("flat", Encoding::Json),
    ] {
        let log = flights::recording_for(profile).log();
        let choices = encodings.map(|(encoding, ..)| (given(encoding), encoding));
        for (choice, expected) in choices
            .into_iter()
            .chain([(EncodingChoice::Automatic, automatic)])
        {
            let options = options().encoding(choice);
            let inspection = inspected_with(&log, &options).expect("a log");
            let (_, encoding, schema) = encodings[expected as usize];
            let Planned {
                topic,
                schema: s,
                encoding: e,
                at_most,
                ..
            } = telemetry(&inspection).would_write[2];
            assert_eq!((topic, s, e), ("/camera/velocity", schema, encoding));
            let (_, report) = enrich_bytes_with(&log, &options).expect("a result");
            assert_eq!(report.encoding.name, expected);
            assert!(report.written[2].messages <= at_most);
        }
    }
}

#[test]
fn the_camera_is_as_given_or_follows_the_gimbal_or_is_unknown() {
    let [with_gimbal, without] =
        ["px4-ros2", "flat"].map(|profile| flights::recording_for(profile).log());
    let camera = |log: &[u8], depression: Option<f64>, mount: Option<[f64; 3]>| {
        let options = Options::new()
            .depression(depression.map(|angle| DepressionAngle::from_degrees(angle).unwrap()))
            .mount(mount.map(|[roll, pitch, yaw]| Mount::from_degrees(roll, pitch, yaw).unwrap()));
        inspected_with(log, &options).map(|inspection| telemetry(&inspection).camera)
    };
    let stabilised = |depression_deg, yaw_offset_deg| {
        Some(CameraReport::Stabilised {
            depression_deg,
            yaw_offset_deg,
        })
    };
    for log in [&with_gimbal, &without] {
        let mount_deg = [10.0, -30.0, 5.0];
        let fixed = Some(CameraReport::Fixed { mount_deg });
        assert_eq!(
            camera(log, Some(30.0), None).unwrap(),
            stabilised(30.0, 0.0)
        );
        assert_eq!(
            camera(log, Some(30.0), Some([0.0, 0.0, 90.0])).unwrap(),
            stabilised(30.0, 90.0)
        );
        assert_eq!(camera(log, None, Some(mount_deg)).unwrap(), fixed);
        let contradiction = camera(log, Some(30.0), Some(mount_deg)).unwrap_err();
        assert!(matches!(
            contradiction,
            Error::Camera(CameraError::TiltedMount)
        ));
    }
    assert_eq!(
        camera(&with_gimbal, None, None).unwrap(),
        Some(CameraReport::Gimbal)
    );
    assert_eq!(camera(&without, None, None).unwrap(), None);
}

/// Readings of which one lacks a number.
fn states_without(count: i32, field: &'static str, whole: i32) -> impl Iterator<Item = Value> {
    (0..).zip(states(count, 1.0)).map(move |(n, mut state)| {
        if n >= whole {
            state[field] = Value::Null;
        }
        state
    })
}

#[test]
fn what_cannot_be_derived_is_reported_as_by_enrich() {
    for (states, planned, missing) in [
        (
            states_without(5, "vx", 0),
            [4, 5],
            "one usable velocity sample is needed, and /state has 0 of 5 usable, 5 without a field",
        ),
        (
            states_without(5, "yaw", 1),
            [1, 5],
            "two usable attitude samples are needed, and /state has 1 of 5 usable, 4 without",
        ),
    ] {
        let inspection = inspected(&log(&[topic("/state", states)]));
        let telemetry = telemetry(&inspection);
        let at_most = telemetry.would_write.iter().map(|planned| planned.at_most);
        assert!(at_most.eq(planned));
        assert_reads(&telemetry.would_not_write[0].reason.to_string(), missing);
        assert_eq!(inspection.problem, None);
    }
    let inspection = inspected(&log(&[topic("/state", states_without(5, "yaw", 0))]));
    assert!(telemetry(&inspection).would_write.is_empty());
    let problem = inspection.problem.expect("there is nothing to write");
    let words = "nothing can be derived … /camera/relative_rpy: at least two usable attitude samples are needed … \
                 /camera/orientation: at least one usable attitude sample is needed, and /state has 0 of 5 usable … \
                 /camera/velocity: at least one usable attitude sample is needed, and /state has 0 of 5 usable";
    assert_reads(&problem.to_string(), words);
}

#[test]
fn a_gimbal_without_a_usable_angle_cannot_be_followed() {
    let gimbal = topic("/gimbal", [json!({ "pitch": null })]);
    let log = log(&[topic("/state", states(5, 1.0)), gimbal]);
    let mut request = Request::default();
    let pitch = RoleArgument::parse(Kind::Gimbal, "/gimbal.pitch:degrees").expect("a gimbal");
    request.roles.insert(Kind::Gimbal, pitch);
    let options = Options::new().telemetry(request);
    let problem = inspected_with(&log, &options).expect("a log").problem;
    let words = "/camera/velocity: at least one usable gimbal sample is needed, and /gimbal has 0 of 1 usable";
    assert_reads(&problem.expect("nothing to follow").to_string(), words);
    let options = options.depression(DepressionAngle::from_degrees(30.0).unwrap());
    let inspection = inspected_with(&log, &options).expect("a log");
    assert_eq!(inspection.problem, None);
    assert_eq!(telemetry(&inspection).would_write.len(), 3);
}
