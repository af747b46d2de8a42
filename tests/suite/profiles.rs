//! Every built-in profile understands the flights that its publisher records: what follows for the camera is what
//! follows from the same flight in the profile `flat`. And a profile with a convention error does not.

pub mod comparison;

use std::{
    collections::{BTreeMap, BTreeSet},
    f64::consts::{FRAC_PI_2, FRAC_PI_6, PI},
};

use comparison::{
    Expectation, Motion,
    mutation::{Mutation, mutations, unsaid_conventions},
    read, request, stabilised,
};
use flightcam::{
    camera::Camera,
    sample::{DropReason, Kind, Sample},
    source::{
        profile::Profile,
        request::{Request, RoleArgument},
    },
};
use nalgebra::{Quaternion, UnitQuaternion};

use crate::support::flights::{
    Recording,
    flight::{self, Flight},
    recorder::Recorder,
    recording::Reference,
    recording_for, recordings, recordings_for,
};

/// The profile that a recording is read with: the one chosen automatically, or else one that never is.
fn given(recording: &Recording) -> Option<Profile> {
    let profile = built_in(recording.profile);
    (!profile.automatic).then_some(profile)
}

fn built_in(name: &str) -> Profile {
    Profile::parse(text_of(name)).expect("a profile")
}

fn text_of(name: &str) -> &'static str {
    Profile::built_in_text(name).expect("built in")
}

#[test]
fn a_flight_yields_the_same_in_every_profile_as_in_flat() {
    for recording in recordings() {
        let name = &recording.name;
        let readings = read(&recording.log(), &request(given(&recording)))
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(readings.profile, recording.profile, "{name}");
        Expectation::of(&recording).check(name, &readings.samples);
    }
}

/// The conventions that flights are written with are what the publishers compute, not only what they document.
#[test]
fn attitudes_in_enu_are_those_of_mavros_and_ardupilot() {
    let rpy = UnitQuaternion::<f64>::from_euler_angles;
    for &time in &Flight::new().attitude_times {
        let attitude = flight::quaternion(flight::attitude(time));
        let in_enu = flight::flu_in_enu(attitude);
        // NED_ENU_Q * q * AIRCRAFT_BASELINK_Q
        // (https://github.com/mavlink/mavros/blob/f8f462dd/mavros/src/lib/ftf_frame_conversions.cpp#L28).
        let mavros = rpy(PI, 0.0, FRAC_PI_2) * attitude * rpy(PI, 0.0, 0.0);
        assert!(mavros.angle_to(&in_enu) < 1e-7);
        // "NED to ENU transformation", and then "Z axis 90 degree rotation"
        // (https://github.com/ArduPilot/ardupilot/blob/003e46bb/libraries/AP_DDS/AP_DDS_Client.cpp).
        let swapped = Quaternion::new(attitude.w, attitude.j, attitude.i, -attitude.k);
        let ardupilot = UnitQuaternion::new_normalize(swapped) * rpy(0.0, 0.0, FRAC_PI_2);
        assert!(ardupilot.angle_to(&in_enu) < 1e-7);
    }
}

/// Reads the flights of a profile with each convention error that the profile could have. Each must show.
fn check_that_errors_show(profile: &str) {
    let flights: Vec<_> = recordings_for(profile)
        .map(|recording| {
            let recording = recording.flying(Flight::beginning);
            let log = recording.log();
            let right = read(&log, &request(Some(built_in(profile)))).expect("it fits");
            let expectation = Expectation::of(&recording);
            expectation.check(&recording.name, &right.samples);
            (expectation, log, right.samples)
        })
        .collect();
    let is_missed = |wrong: &Mutation| {
        let wrong = request(Some(Profile::parse(&wrong.profile).expect("a profile")));
        flights.iter().any(|(expectation, log, right)| {
            let samples = read(log, &wrong).expect("it fits still").samples;
            samples != *right && expectation.is_missed(&samples)
        })
    };
    let errors = mutations(text_of(profile));
    let unnoticed: Vec<&str> = (errors.iter())
        .filter(|error| !is_missed(error))
        .map(|error| error.name.as_str())
        .collect();
    assert!(unnoticed.is_empty(), "{unnoticed:#?}");
    println!(
        "{profile}: {} errors in {} flights",
        errors.len(),
        flights.len()
    );
}

/// A test of each built-in profile, so that they run side by side.
macro_rules! check_that_errors_show {
    ($($test:ident: $profile:literal,)*) => {
        const CHECKED: &[&str] = &[$($profile),*];
        $(
            #[test]
            fn $test() {
                check_that_errors_show($profile);
            }
        )*
    };
}

check_that_errors_show! {
    a_convention_error_in_px4_ulog_shows: "px4-ulog",
    a_convention_error_in_px4_ros2_shows: "px4-ros2",
    a_convention_error_in_mavros_shows: "mavros",
    a_convention_error_in_mavlink_shows: "mavlink",
    a_convention_error_in_mavlink_stream_shows: "mavlink-stream",
    a_convention_error_in_ardupilot_ros2_shows: "ardupilot-ros2",
    a_convention_error_in_ardupilot_dataflash_shows: "ardupilot-dataflash",
    a_convention_error_in_dji_osdk_shows: "dji-osdk",
    a_convention_error_in_dji_osdk_3_2_shows: "dji-osdk-3.2",
    a_convention_error_in_dji_psdk_ros2_shows: "dji-psdk-ros2",
    a_convention_error_in_dji_flight_record_shows: "dji-flight-record",
    a_convention_error_in_dji_srt_shows: "dji-srt",
    a_convention_error_in_parrot_vmeta_shows: "parrot-vmeta",
    a_convention_error_in_parrot_anafi_ros_shows: "parrot-anafi-ros",
    a_convention_error_in_nav_msgs_shows: "nav-msgs",
    a_convention_error_in_airsim_shows: "airsim",
    a_convention_error_in_mavsdk_shows: "mavsdk",
    a_convention_error_in_ros_pose_shows: "ros-pose",
    a_convention_error_in_flat_units_shows: "flat-units",
    a_convention_error_in_flat_shows: "flat",
    a_convention_error_in_flat_deg_shows: "flat-deg",
}

#[test]
fn every_profile_is_checked_for_errors_in_all_of_its_conventions() {
    let profiles = Profile::built_in();
    let names: Vec<&str> = profiles
        .iter()
        .map(|profile| profile.name.as_str())
        .collect();
    assert_eq!(names, CHECKED);
    for name in names {
        let unsaid = unsaid_conventions(text_of(name));
        assert!(
            unsaid.is_empty(),
            "{name} leaves to defaults, where no error is tried: {unsaid:?}"
        );
    }
}

#[test]
fn every_topic_that_a_profile_lists_is_found() {
    for profile in Profile::built_in() {
        let recordings: Vec<Recording> = recordings_for(&profile.name).collect();
        for list in topic_lists(&profile) {
            let topics: Vec<String> = (list.iter())
                // All topics of a vehicle have its number; that is a test of its own.
                .filter(|topic| !topic.contains("{vehicle}"))
                .map(|topic| topic.replace("{n}", "1"))
                .collect();
            let is_listed = |topic: &String| topics.contains(topic);
            let recording = recordings
                .iter()
                .find(|recording| recording.topics().iter().any(is_listed))
                .unwrap_or_else(|| panic!("no flight has one of {topics:?}"));
            let expectation = Expectation::of(recording);
            for topic in &topics {
                let (topics, instead) = (topics.clone(), topic.clone());
                let mut log = Recorder::new();
                log.rename(
                    move |topic| match topics.iter().any(|listed| listed == topic) {
                        true => instead.clone(),
                        false => topic.to_owned(),
                    },
                );
                recording.write(&mut log);
                let readings = read(&log.finish(), &request(None)).expect("it fits");
                assert_eq!(readings.profile, profile.name);
                let name = format!("{} on {topic}", recording.name);
                expectation.check(&name, &readings.samples);
            }
        }
    }
}

/// The topics of each alternative of each role, where it names any.
fn topic_lists(profile: &Profile) -> BTreeSet<&Vec<String>> {
    (Kind::ALL
        .iter()
        .flat_map(|&kind| profile.alternatives(kind)))
    .map(|alternative| &alternative.location.topics)
    .filter(|topics| !topics.is_empty())
    .collect()
}

/// The flight with gaps.
fn thinned(flight: Flight) -> Flight {
    flight.only(|time| time / 100_000_000 % 2 == 0)
}

#[test]
fn vehicles_in_namespaces_are_distinguished() {
    let profiles = Profile::built_in().into_iter();
    for profile in profiles.filter(|profile| profile.namespaced) {
        let flight = || recording_for(&profile.name);
        let vehicles = [
            ("", flight()),
            ("/drone1", flight().flying(Flight::beginning)),
            ("/fleet/drone2", flight().flying(thinned)),
        ];
        let mut log = Recorder::new();
        for (namespace, recording) in &vehicles {
            let namespace = *namespace;
            log.rename(move |topic| format!("{namespace}{topic}"));
            recording.write(&mut log);
        }
        let log = log.finish();
        for (namespace, recording) in &vehicles {
            let request = Request {
                namespace: Some((*namespace).to_owned()),
                ..Request::default()
            };
            let readings = read(&log, &request).expect("it fits");
            assert_eq!(readings.profile, profile.name);
            let name = format!("{} in `{namespace}`", recording.name);
            Expectation::of(recording).check(&name, &readings.samples);
        }
        let chosen = read(&log, &Request::default()).map(|readings| readings.profile);
        let error = chosen.expect_err("there are several");
        assert!(
            error.contains("/drone1") && error.contains("/fleet/drone2"),
            "{error}"
        );
    }
}

#[test]
fn vehicles_with_numbers_are_distinguished() {
    let whole = recording_for("ardupilot-ros2");
    let short = recording_for("ardupilot-ros2").flying(Flight::beginning);
    let mut log = Recorder::new();
    for (number, recording) in [(1, &whole), (12, &short)] {
        log.rename(move |topic| topic.replace("/ap/", &format!("/ap/v{number}/")));
        recording.write(&mut log);
    }
    let log = log.finish();
    for (namespace, recording) in [("/ap/v1", &whole), ("/ap/v12", &short)] {
        let request = Request {
            namespace: Some(namespace.to_owned()),
            ..Request::default()
        };
        let readings = read(&log, &request).expect("it fits");
        Expectation::of(recording).check(namespace, &readings.samples);
    }
    let chosen = read(&log, &Request::default()).map(|readings| readings.profile);
    let error = chosen.expect_err("there are two");
    assert!(error.contains("/ap/v1, /ap/v12"), "{error}");
}

#[test]
fn a_vehicle_without_velocity_neither_takes_anothers_nor_is_passed_over_for_it() {
    for (profile, named) in [("ardupilot-ros2", "/ap/v{}/"), ("mavros", "/drone{}/")] {
        let mut log = Recorder::new();
        let rename = |number: &str| named.replace("{}", number);
        let root = ["/ap/", "/"][usize::from(profile == "mavros")];
        let one = rename("1");
        log.rename(move |topic| topic.replacen(root, &one, 1));
        recording_for(profile).write(&mut log);
        let two = rename("2");
        log.rename(
            move |topic| match topic.contains("twist") || topic.contains("velocity") {
                true => "/elsewhere".to_owned(),
                false => topic.replacen(root, &two, 1),
            },
        );
        recording_for(profile).write(&mut log);
        let log = log.finish();
        let namespace = rename("2").trim_end_matches('/').to_owned();
        let request = Request {
            namespace: Some(namespace.clone()),
            ..Request::default()
        };
        let readings = read(&log, &request).expect("it fits");
        let kinds: BTreeSet<Kind> = readings.samples.iter().map(Sample::kind).collect();
        assert!(!kinds.contains(&Kind::Velocity), "{profile}: {kinds:?}");
        let chosen = read(&log, &Request::default()).map(|readings| readings.profile);
        let error = chosen.expect_err("there are two");
        assert!(error.contains(&namespace), "{error}");
    }
}

#[test]
fn the_newest_of_a_topics_versions_is_used() {
    let newest = recording_for("px4-ros2");
    let older = recording_for("px4-ros2").flying(thinned);
    let mut log = Recorder::new();
    for (version, recording) in [
        ("", &older),
        ("_v2", &older),
        ("_v10", &newest),
        ("_v9", &older),
    ] {
        log.rename(move |topic| format!("{}{version}", topic.trim_end_matches("_v1")));
        recording.write(&mut log);
    }
    let readings = read(&log.finish(), &request(None)).expect("it fits");
    Expectation::of(&newest).check("the newest version", &readings.samples);
}

#[test]
fn unusable_samples_are_dropped_and_counted() {
    let dropped = |name: &str, kind: Kind| {
        let recording = recordings()
            .into_iter()
            .find(|recording| recording.name == name);
        let log = recording.expect("a flight").log();
        let mut readings = read(&log, &request(None)).expect("it fits");
        std::mem::take(&mut readings.dropped[kind].dropped)
    };
    let invalid = Flight::new().invalid_times.len() as u64;
    let velocities = Flight::new().velocity_times.len() as u64;
    let positions = Flight::new().position_times.len() as u64;

    let odometry = "px4-ros2: odometry in NED and in body FRD";
    let unknown = BTreeMap::from([(DropReason::UnmetCondition, invalid)]);
    assert_eq!(dropped(odometry, Kind::Attitude), unknown);
    assert_eq!(dropped(odometry, Kind::Velocity), unknown);

    // Its messages are valid for a velocity or for a position, or for neither.
    let local_position = "px4-ros2: 1.13";
    let marked = |count| BTreeMap::from([(DropReason::MarkedInvalid, count)]);
    assert_eq!(dropped(local_position, Kind::Attitude), BTreeMap::new());
    assert_eq!(
        dropped(local_position, Kind::Velocity),
        marked(invalid + positions)
    );
    assert_eq!(
        dropped(local_position, Kind::Position),
        marked(invalid + velocities)
    );

    // Its heights are valid where its positions are.
    let not_positions = invalid + velocities;
    assert_eq!(dropped(local_position, Kind::Height), marked(not_positions));

    // Between valid heights, this one has one of two numbers that stand for none.
    let heights = dropped("mavros: local position", Kind::Height);
    let reasons: Vec<DropReason> = heights.keys().copied().collect();
    assert_eq!(reasons, [DropReason::NonFinite, DropReason::NegativeHeight]);
    assert_eq!(heights.values().sum::<u64>(), invalid);

    let global_position = "px4-ros2: attitude and local position";
    assert_eq!(dropped(global_position, Kind::Position), marked(invalid));
}

#[test]
fn a_gimbal_may_be_given_in_any_axes_from_any_reference() {
    let as_it_is: fn(UnitQuaternion<f64>) -> UnitQuaternion<f64> = |q| q;
    let axes = [
        ("earth:frd-ned", Reference::Earth, as_it_is),
        ("earth:flu-enu", Reference::Earth, flight::flu_in_enu),
        ("heading:frd-ned", Reference::Heading, as_it_is),
        ("heading:flu-enu", Reference::Heading, flight::flu_in_flu),
        ("airframe:frd-ned", Reference::Airframe, as_it_is),
        ("airframe:flu-enu", Reference::Airframe, flight::flu_in_flu),
    ];
    for (words, reference, turned) in axes {
        let flight = Flight::in_one_message();
        let gimbal = flight.gimbal_times.iter().map(|&time| {
            let q = turned(flight.gimbal(time));
            (time, serde_json::json!({"q": [q.i, q.j, q.k, q.w]}))
        });
        let request = with_gimbal(&format!("/gimbal.q:xyzw:{words}"));
        let readings = read(&flat_log_with("/gimbal", gimbal), &request).expect("it fits");
        let following = Motion::derived(&readings.samples, Camera::Gimbal);
        let distance = following.distance(&Motion::of_gimbal(&flight, reference));
        assert!(distance < 1e-9, "{words}: {distance:e}");
    }
}

/// A flight in the profile `flat`, and another topic.
fn flat_log_with(
    topic: &str,
    messages: impl IntoIterator<Item = (u64, serde_json::Value)>,
) -> Vec<u8> {
    let mut log = Recorder::new();
    recording_for("flat").write(&mut log);
    log.json(topic, None, messages);
    log.finish()
}

/// A gimbal that always looks 30° down, as a user's own logger writes it in the field `tilt`.
struct OwnGimbal {
    tilt: f64,
    /// Where it is, as given on the command line.
    argument: &'static str,
    /// What it is, as given in a profile.
    orientation: &'static str,
}

const OWN_GIMBALS: [OwnGimbal; 4] = [
    OwnGimbal {
        tilt: 30.0,
        argument: "/gimbal.tilt:degrees:down",
        orientation: r#"pitch = { field = "tilt", unit = "degrees", positive = "down" }"#,
    },
    OwnGimbal {
        tilt: -FRAC_PI_6,
        argument: "/gimbal.tilt:radians",
        orientation: r#"pitch = { field = "tilt", unit = "radians", positive = "up" }"#,
    },
    OwnGimbal {
        tilt: -3000.0,
        argument: "/gimbal.tilt:centidegrees:up",
        orientation: r#"pitch = { field = "tilt", unit = "centidegrees", positive = "up" }"#,
    },
    OwnGimbal {
        tilt: -30.0,
        argument: "/gimbal.zero,/gimbal.tilt,/gimbal.zero:degrees:heading",
        orientation: r#"euler = { roll = "zero", pitch = "tilt", yaw = "zero", unit = "degrees" }"#,
    },
];

impl OwnGimbal {
    fn log(&self) -> Vec<u8> {
        let message = serde_json::json!({"tilt": self.tilt, "zero": 0});
        let times = Flight::in_one_message().gimbal_times.into_iter();
        flat_log_with("/gimbal", times.map(|time| (time, message.clone())))
    }

    fn profile(&self) -> String {
        let orientation = self.orientation;
        let flat = text_of("flat");
        format!(
            "{flat}\n[gimbal]\ntopics = [\"/gimbal\"]\norientation.{orientation}\n\
             convention = \"frd-ned\"\nreference = \"heading\"\n"
        )
    }
}

/// A request that says where the gimbal is.
fn with_gimbal(argument: &str) -> Request {
    let gimbal = RoleArgument::parse(Kind::Gimbal, argument).expect("an argument");
    Request {
        roles: [(Kind::Gimbal, gimbal)].into(),
        ..Request::default()
    }
}

/// By how much a camera that follows the gimbal differs from one that is 30° below the horizon.
fn distance_from_depression(samples: &[Sample]) -> f64 {
    let following = Motion::derived(samples, Camera::Gimbal);
    following.distance(&Motion::derived(samples, stabilised()))
}

#[test]
fn a_gimbal_that_keeps_its_pitch_is_a_depression() {
    for gimbal in &OWN_GIMBALS {
        let log = gimbal.log();
        let given = with_gimbal(gimbal.argument);
        let profile = Profile::parse(&gimbal.profile()).expect("a profile");
        for request in [given, request(Some(profile))] {
            let samples = read(&log, &request).expect("it fits").samples;
            let distance = distance_from_depression(&samples);
            assert!(distance < 1e-9, "{}: {distance:e}", gimbal.argument);
        }
    }
}

#[test]
fn a_convention_error_in_a_users_gimbal_shows() {
    for gimbal in &OWN_GIMBALS {
        let log = gimbal.log();
        for error in mutations(&gimbal.profile()) {
            if !error.name.starts_with("gimbal") {
                continue;
            }
            // Some make no sense for a pitch alone, and are refused at once.
            let Ok(profile) = Profile::parse(&error.profile) else {
                continue;
            };
            let samples = read(&log, &request(Some(profile)))
                .expect("it fits still")
                .samples;
            let distance = distance_from_depression(&samples);
            assert!(distance > 1e-3, "{} in {}", error.name, gimbal.argument);
        }
    }
}
