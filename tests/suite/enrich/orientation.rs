//! The orientations in a result, against the telemetry of its log.

use std::{f64::consts::*, fs};

use flightcam::{
    Options, Report,
    camera::Mount,
    enrich::enrich,
    geometry::DepressionAngle,
    messages::{Encoding, EncodingChoice},
    sample::Kind,
};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;
use serde_json::json;

use crate::support::{
    DERIVED, ReadMessage, cases,
    logbook::Logbook,
    message::DerivedMessage,
    options,
    orientations::{check_orientations, of_angles, of_quaternion},
    stream,
};

/// A reading of a drone: roll, pitch, yaw, and the velocity to north, east, down.
#[derive(Debug, Clone, Copy)]
struct State {
    /// Milliseconds.
    time: u64,
    angles: [f64; 3],
    velocity: [f64; 3],
}

/// What is derived from these readings.
fn derived(states: &[State], options: &Options) -> (Vec<ReadMessage>, Report) {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    for state in states {
        let [[roll, pitch, yaw], [vx, vy, vz]] = [state.angles, state.velocity];
        let json =
            json!({ "roll": roll, "pitch": pitch, "yaw": yaw, "vx": vx, "vy": vy, "vz": vz });
        log.put(channel, state.time, json.to_string().as_bytes());
    }
    let (folder, input) = log.finish();
    let output = folder.path().join("result.mcap");
    // Random motion contradicts itself.
    let report = enrich(&input, &output, &options.clone().trust(true)).expect("a result");
    let mut messages = stream(&fs::read(output).expect("the result"), false);
    messages.retain(|message| DERIVED.contains(&message.topic.as_str()));
    (messages, report)
}

fn of_topic(messages: &[ReadMessage], topic: &str) -> Vec<DerivedMessage> {
    let of_topic = messages.iter().filter(|message| message.topic == topic);
    of_topic.map(DerivedMessage::decode).collect()
}

#[test]
fn a_camera_30_degrees_down_on_a_flight_to_the_east_looks_east_and_30_degrees_down() {
    // The gimbal cancels roll and pitch.
    let states = [[0.0, 0.0], [0.3, -0.1], [-0.2, 0.4]];
    let states = (0..).zip(states).map(|(n, [roll, pitch])| State {
        time: 20 * n,
        angles: [roll, pitch, FRAC_PI_2],
        velocity: [0.0, 8.0, 0.0],
    });
    let states: Vec<State> = states.collect();
    // cos 45° cos 15° and sin 45° sin 15°.
    let [plus, minus] = [1.0, -1.0].map(|sign| (3f64.sqrt() + sign) / 4.0);
    let expected = [minus, -minus, plus, plus, 0.0, -FRAC_PI_6, FRAC_PI_2];
    for (encoding, count) in [
        (Encoding::Protobuf, 7),
        (Encoding::Json, 7),
        (Encoding::Ros2, 4),
    ] {
        let options = options().encoding(EncodingChoice::Given(encoding));
        let (messages, _) = derived(&states, &options);
        let orientations = of_topic(&messages, "/camera/orientation");
        assert_eq!(orientations.len(), states.len());
        for message in orientations {
            assert_eq!(message.numbers.len(), count);
            for (actual, expected) in message.numbers.iter().zip(expected) {
                assert!((actual - expected).abs() < 1e-15, "{message:?}");
            }
        }
    }
}

/// How a camera is mounted.
#[derive(Debug, Clone, Copy)]
enum Mounting {
    /// On a gimbal: degrees below the horizon, and to the right of the nose.
    Stabilised(f64, f64),
    /// On the airframe, degrees.
    Fixed([f64; 3]),
}

impl Mounting {
    fn options(self) -> Options {
        let mount = |[roll, pitch, yaw]: [f64; 3]| {
            Mount::from_degrees(roll, pitch, yaw).expect("a mount in range")
        };
        match self {
            Self::Stabilised(depression, right) => Options::new()
                .depression(DepressionAngle::from_degrees(depression).expect("an angle in range"))
                .mount(mount([0.0, 0.0, right])),
            Self::Fixed(angles) => Options::new().mount(mount(angles)),
        }
    }

    /// The camera's attitude on a drone with these angles; `None` if its heading is needed and not defined.
    fn attitude(self, angles: [f64; 3]) -> Option<UnitQuaternion<f64>> {
        match self {
            Self::Stabilised(depression, right) => {
                let [_, pitch, yaw] = angles;
                let nose = [yaw.cos(), yaw.sin()].map(|part| pitch.cos() * part);
                let heading = nose[1].atan2(nose[0]) + right.to_radians();
                let is_vertical = pitch.cos().abs() < 1e-9;
                (!is_vertical).then(|| of_angles([0.0, -depression.to_radians(), heading]))
            }
            Self::Fixed(mount) => Some(of_angles(angles) * of_angles(mount.map(f64::to_radians))),
        }
    }
}

fn any_mounting() -> impl Strategy<Value = Mounting> {
    let half_turn = -180.0..=180.0;
    let fixed = (half_turn.clone(), -90.0..=90.0, half_turn.clone());
    prop_oneof![
        (-89.0..=90.0, half_turn)
            .prop_map(|(depression, right)| Mounting::Stabilised(depression, right)),
        fixed.prop_map(|(roll, pitch, yaw)| Mounting::Fixed([roll, pitch, yaw])),
    ]
}

/// Readings with some gaps, the first of which has a heading.
fn any_states() -> impl Strategy<Value = Vec<State>> {
    let pitch = prop_oneof![4 => -PI..PI, 1 => prop::sample::select(vec![FRAC_PI_2, -FRAC_PI_2])];
    let wait = prop::sample::select(vec![1, 20, 20, 20, 5000, 5001, 60_000]);
    let state = (
        wait,
        -PI..PI,
        pitch,
        -PI..PI,
        prop::array::uniform3(-30.0..30.0),
    );
    prop::collection::vec(state, 0..40).prop_map(|states| {
        let mut time = 1000;
        let first = State {
            time,
            angles: [0.1, 0.2, 0.3],
            velocity: [1.0, 2.0, 3.0],
        };
        let later = states
            .into_iter()
            .map(|(wait, roll, pitch, yaw, velocity)| {
                time += wait;
                let angles = [roll, pitch, yaw];
                State {
                    time,
                    angles,
                    velocity,
                }
            });
        std::iter::once(first).chain(later).collect()
    })
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn each_used_attitude_has_the_orientation_that_rotations_and_velocities_are_those_of(
        states in any_states(),
        mounting in any_mounting(),
        encoding in prop::sample::select(Encoding::ALL.to_vec()),
    ) {
        let options = mounting.options().encoding(EncodingChoice::Given(encoding));
        let (messages, report) = derived(&states, &options);
        let expected: Vec<(State, UnitQuaternion<f64>)> = states
            .iter()
            .filter_map(|state| Some((*state, mounting.attitude(state.angles)?)))
            .collect();

        let times = check_orientations(&messages);
        let expected_times = expected.iter().map(|(state, _)| state.time * 1_000_000);
        prop_assert_eq!(&times, &expected_times.collect::<Vec<_>>());
        prop_assert_eq!(times.len() as u64, report.samples[&Kind::Attitude].tally.used);
        let rotations = of_topic(&messages, "/camera/relative_rpy").len() as u64;
        prop_assert_eq!(rotations + report.breaks.gaps + 1, times.len() as u64);

        let orientations = of_topic(&messages, "/camera/orientation");
        let velocities = of_topic(&messages, "/camera/velocity");
        for (message, (state, camera)) in orientations.iter().zip(expected) {
            let orientation = of_quaternion(message);
            let error = (camera.inverse() * orientation).imag().norm();
            prop_assert!(error < 1e-9, "{:?} is not {}", message, camera);
            let mut velocities = velocities.iter();
            let velocity = velocities.find(|velocity| velocity.log_time == message.log_time);
            let velocity = Vector3::from(velocity.expect("one at each attitude").triple());
            let in_camera = orientation.inverse() * Vector3::from(state.velocity);
            prop_assert!((velocity - in_camera).norm() < 1e-12, "{} is not {}", velocity, in_camera);
        }
    }
}
