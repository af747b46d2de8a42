//! Every built-in profile understands the flights that its publisher records: what follows for the camera is what
//! follows from the same flight in the profile `flat`. And a profile with a convention error does not.

mod comparison;
mod flights;

use std::{
    collections::BTreeSet,
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
    source::{profile::Profile, request::Request},
};
use flights::{
    Recording,
    flight::{self, Flight},
    logbook::Logbook,
    recording::Reference,
    recordings,
};
use nalgebra::{Quaternion, UnitQuaternion};

/// The profile that a recording is read with: the one that is chosen by itself, or else one that is not.
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

/// What the flights are written with is what the publishers compute, not only what they say.
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

/// Reads the flights of a profile with each convention error that the profile could have. None may go unnoticed.
fn check_that_errors_show(profile: &str) {
    let flights: Vec<_> = recordings()
        .into_iter()
        .filter(|recording| recording.profile == profile)
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
    a_convention_error_in_ardupilot_ros2_shows: "ardupilot-ros2",
    a_convention_error_in_dji_osdk_shows: "dji-osdk",
    a_convention_error_in_nav_msgs_shows: "nav-msgs",
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
    let recordings = recordings();
    for profile in Profile::built_in() {
        let places = (profile.attitude.iter().map(|source| &source.place))
            .chain(profile.velocity.iter().map(|source| &source.place))
            .chain(profile.gimbal.iter().map(|source| &source.place))
            .chain(profile.position.iter().map(|source| &source.place));
        let lists: BTreeSet<&Vec<String>> = places.map(|place| &place.topics).collect();
        for list in lists {
            let topics: Vec<String> = list.iter().map(|topic| topic.replace("{n}", "1")).collect();
            for topic in &topics {
                let recording = (recordings.iter())
                    .filter(|recording| recording.profile == profile.name)
                    .find(|recording| {
                        recording
                            .topics()
                            .iter()
                            .any(|other| topics.contains(other))
                    });
                let recording = recording.unwrap_or_else(|| panic!("no flight with {topic}"));
                let mut log = Logbook::new();
                let (topic, topics) = (topic.clone(), topics.clone());
                let name = format!("{} on {topic}", recording.name);
                log.rename(move |other| match topics.iter().any(|one| one == other) {
                    true => topic.clone(),
                    false => other.to_owned(),
                });
                recording.write(&mut log);
                let readings = read(&log.finish(), &request(None)).expect("it fits");
                assert_eq!(readings.profile, profile.name);
                Expectation::of(recording).check(&name, &readings.samples);
            }
        }
    }
}

/// A recording of which every second message is missing.
fn thinned(recording: Recording) -> Recording {
    recording.flying(|flight| flight.only(|time| time / 1_000_000 / 100 % 2 == 0))
}

#[test]
fn vehicles_in_namespaces_are_told_apart() {
    let in_namespace = |name: &'static str| move |topic: &str| format!("{name}{topic}");
    for profile in Profile::built_in()
        .iter()
        .filter(|profile| profile.namespaced)
    {
        let mut log = Logbook::new();
        let first = || {
            recordings()
                .into_iter()
                .find(|recording| recording.profile == profile.name)
        };
        let vehicles = [
            ("", first().expect("a flight")),
            (
                "/drone1",
                first().expect("a flight").flying(Flight::beginning),
            ),
            ("/fleet/drone2", thinned(first().expect("a flight"))),
        ];
        for (namespace, recording) in &vehicles {
            log.rename(in_namespace(namespace));
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
        let error = read(&log, &Request::default()).map(|readings| readings.profile);
        let error = error.expect_err("there are several");
        for namespace in ["/drone1", "/fleet/drone2"] {
            assert!(error.contains(namespace), "{error}");
        }
    }
}

#[test]
fn of_a_topic_in_several_versions_the_newest_is_used() {
    let all = recordings();
    let recording = all
        .iter()
        .find(|recording| recording.profile == "px4-ros2")
        .expect("a flight");
    let older = thinned(
        recordings().remove(
            all.iter()
                .position(|other| other.name == recording.name)
                .expect("it"),
        ),
    );
    let version = |version: &'static str| {
        move |topic: &str| format!("{}{version}", topic.trim_end_matches("_v1"))
    };
    let mut log = Logbook::new();
    for (recording, suffix) in [
        (&older, ""),
        (&older, "_v2"),
        (recording, "_v10"),
        (&older, "_v9"),
    ] {
        log.rename(version(suffix));
        recording.write(&mut log);
    }
    let readings = read(&log.finish(), &request(None)).expect("it fits");
    Expectation::of(recording).check("the newest version", &readings.samples);
}

#[test]
fn what_cannot_be_used_is_dropped_and_counted() {
    let count = |name: &str, kind: Kind, reason: DropReason| {
        let recording = recordings()
            .into_iter()
            .find(|recording| recording.name.ends_with(name));
        let recording = recording.expect("a flight");
        let readings = read(&recording.log(), &request(None)).expect("it fits");
        readings.dropped[kind]
            .dropped
            .get(&reason)
            .copied()
            .unwrap_or_default()
    };
    let odometry = "px4-ros2: odometry in NED and in body FRD";
    assert_eq!(
        count(odometry, Kind::Attitude, DropReason::UnknownFrame),
        18
    );
    assert_eq!(
        count(odometry, Kind::Velocity, DropReason::UnknownFrame),
        18
    );
    let local_position = "px4-ros2: 1.13";
    assert_eq!(
        count(local_position, Kind::Attitude, DropReason::MarkedInvalid),
        0
    );
    // Those marked invalid, and those that have only the other of velocity and position.
    assert_eq!(
        count(local_position, Kind::Velocity, DropReason::MarkedInvalid),
        18 + 19
    );
    assert_eq!(
        count(local_position, Kind::Position, DropReason::MarkedInvalid),
        18 + 38
    );
    assert_eq!(
        count(
            "Foxglove's Python converter",
            Kind::Position,
            DropReason::MarkedInvalid
        ),
        18
    );
}

#[test]
fn a_gimbal_may_be_told_in_any_axes_from_any_reference() {
    let as_it_is = |q| q;
    let axes: [(
        &str,
        Reference,
        fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>,
    ); 6] = [
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
        let argument = format!("/gimbal.q:xyzw:{words}").parse();
        let request = Request {
            gimbal: Some(argument.expect("an argument")),
            ..Request::default()
        };
        let readings = read(&flat_log_with("/gimbal", gimbal), &request).expect("it fits");
        let following = Motion::derived(&readings.samples, Camera::Gimbal);
        let distance = following.distance(&Motion::of_gimbal(&flight, reference));
        assert!(distance < 1e-9, "{words}: {distance:e}");
    }
}

/// A flight in the profile `flat`, and beside it another topic.
fn flat_log_with(
    topic: &str,
    messages: impl IntoIterator<Item = (u64, serde_json::Value)>,
) -> Vec<u8> {
    let all = recordings();
    let flat = all.iter().find(|recording| recording.profile == "flat");
    let mut log = Logbook::new();
    flat.expect("a flight").write(&mut log);
    log.json(topic, None, messages);
    log.finish()
}

/// A gimbal that always looks 30° down, as a logger of one's own says it in the field `tilt`.
struct OwnGimbal {
    tilt: f64,
    /// How the command line says where it is.
    argument: &'static str,
    /// How a profile says what it is.
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

/// By how much a camera that follows the gimbal differs from one that is 30° below the horizon.
fn distance_from_depression(samples: &[Sample]) -> f64 {
    let following = Motion::derived(samples, Camera::Gimbal);
    following.distance(&Motion::derived(samples, stabilised()))
}

#[test]
fn a_gimbal_that_keeps_its_pitch_is_a_depression() {
    for gimbal in &OWN_GIMBALS {
        let log = gimbal.log();
        let argument = gimbal.argument.parse().expect("an argument");
        let told = Request {
            gimbal: Some(argument),
            ..Request::default()
        };
        let profile = Profile::parse(&gimbal.profile()).expect("a profile");
        for request in [told, request(Some(profile))] {
            let samples = read(&log, &request).expect("it fits").samples;
            let distance = distance_from_depression(&samples);
            assert!(distance < 1e-9, "{}: {distance:e}", gimbal.argument);
        }
    }
}

#[test]
fn a_convention_error_in_a_gimbal_of_ones_own_shows() {
    for gimbal in &OWN_GIMBALS {
        let log = gimbal.log();
        for error in mutations(&gimbal.profile()) {
            if !error.name.starts_with("gimbal") {
                continue;
            }
            let profile = Profile::parse(&error.profile).expect("a profile");
            let samples = read(&log, &request(Some(profile)))
                .expect("it fits still")
                .samples;
            let distance = distance_from_depression(&samples);
            assert!(distance > 1e-3, "{} in {}", error.name, gimbal.argument);
        }
    }
}
