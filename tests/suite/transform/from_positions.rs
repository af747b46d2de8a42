//! Velocities that are taken from positions: against trajectories whose velocity is known.
//!
//! The drone is level, heads north, and its camera looks at the horizon: it sees a velocity as it is in NED.

use flightcam::camera::Camera;
use flightcam::derived::{Derived, Quantity, Value};
use flightcam::geometry::{DepressionAngle, RollPitchYaw};
use flightcam::sample::DropReason::{self, *};
use flightcam::sample::{
    AttitudeSample, Kind, Position, PositionSample, Sample, Stamp, Velocity, VelocityFrom,
    VelocitySample,
};
use flightcam::transform::{MaxGap, Outcome, Transform};
use nalgebra::Vector3;
use proptest::prelude::*;

mod accuracy;

const MAX_GAP: f64 = 5.0;

fn at(seconds: f64) -> Stamp {
    let log_time = (seconds * 1e9).round() as u64;
    Stamp {
        log_time,
        publish_time: log_time + 7,
    }
}

fn attitude(time: f64, heading: f64) -> Sample {
    let rpy = RollPitchYaw {
        roll: 0.0,
        pitch: 0.0,
        yaw: heading.to_radians(),
    };
    Sample::Attitude(AttitudeSample {
        stamp: at(time),
        orientation: rpy.to_quaternion(),
        reset_counter: None,
    })
}

fn position(time: f64, position: Position, resets: Option<u64>) -> Sample {
    Sample::Position(PositionSample {
        stamp: at(time),
        position,
        resets,
    })
}

fn local(time: f64, place: [f64; 3]) -> Sample {
    position(time, Position::Local(place.into()), None)
}

fn geodetic(time: f64, [latitude, longitude, altitude]: [f64; 3]) -> Sample {
    let place = Position::Geodetic {
        latitude,
        longitude,
        altitude,
    };
    position(time, place, None)
}

/// A drone at 3 m/s north, at these times.
fn northwards(times: impl IntoIterator<Item = f64>) -> Vec<Sample> {
    let times = times.into_iter();
    times.map(|t| local(t, [3.0 * t, 1.0, -20.0])).collect()
}

struct Run {
    derived: Vec<Derived>,
    outcome: Outcome,
}

/// With attitudes every half second from 0 to 200 s.
fn run(positions: &[Sample]) -> Run {
    let attitudes = (0..=400).map(|n| attitude(0.5 * f64::from(n), 0.0));
    run_all(attitudes.chain(positions.iter().copied()).collect())
}

fn sorted(mut samples: Vec<Sample>) -> Vec<Sample> {
    samples.sort_by_key(|sample| (sample.stamp().log_time, sample.kind()));
    samples
}

fn transform() -> Transform {
    let camera = Camera::Stabilised {
        depression: DepressionAngle::from_degrees(0.0).expect("in range"),
        yaw_offset: 0.0,
    };
    let max_gap = MaxGap::from_seconds(MAX_GAP).expect("in range");
    Transform::new(camera, max_gap).with_velocity_from(VelocityFrom::Position)
}

fn run_all(samples: Vec<Sample>) -> Run {
    let mut transform = transform();
    let mut derived = Vec::new();
    for sample in sorted(samples) {
        transform.push(sample, &mut derived);
    }
    let outcome = transform.finish(&mut derived);
    Run { derived, outcome }
}

impl Run {
    /// The velocities, north, east, down, by their times.
    fn velocities(&self) -> Vec<(f64, Vector3<f64>)> {
        let velocity = |derived: &Derived| match derived.value {
            Value::CameraVelocity(velocity) => {
                Some((derived.stamp.log_time as f64 / 1e9, velocity))
            }
            _ => None,
        };
        self.derived.iter().filter_map(velocity).collect()
    }

    fn times(&self) -> Vec<f64> {
        self.velocities().iter().map(|(time, _)| *time).collect()
    }

    fn dropped(&self) -> Vec<(DropReason, u64)> {
        let dropped = &self.outcome.tallies[Kind::Position].dropped;
        dropped.clone().into_iter().collect()
    }
}

fn is_north(velocity: &Vector3<f64>) -> bool {
    (velocity - Vector3::new(3.0, 0.0, 0.0)).norm() < 1e-9
}

// ---- Which positions have a velocity ----

#[test]
fn each_position_with_neighbours_has_a_velocity_and_its_times() {
    let run = run(&northwards([1.0, 1.2, 1.4, 1.5]));
    assert_eq!(run.times(), [1.2, 1.4]);
    let velocities = run.velocities();
    assert!(velocities.iter().all(|(_, velocity)| is_north(velocity)));
    let mut stamps = run.derived.iter().map(|derived| derived.stamp);
    assert!(stamps.all(|stamp| stamp.publish_time == stamp.log_time + 7));
    assert_eq!(run.dropped(), [(NoNeighbours, 2)]);
    assert_eq!(run.outcome.tallies[Kind::Position].used, 2);
    assert_eq!(run.outcome.tallies[Kind::Velocity].used, 2);
}

#[test]
fn nothing_is_taken_across_a_gap() {
    let run = run(&northwards([
        1.0, 2.0, 3.0, 8.1, 9.0, 14.0, 20.0, 100.0, 101.0,
    ]));
    assert_eq!(run.times(), [2.0, 9.0]);
    assert_eq!(run.dropped(), [(NoNeighbours, 7)]);
}

#[test]
fn nothing_is_taken_across_a_reset_of_the_estimator() {
    let resets = [0, 0, 0, 1, 1, 1].map(Some);
    let samples = (0..).zip(resets).map(|(n, resets)| {
        let time = 1.0 + f64::from(n);
        // The estimate jumps by 50 m.
        let north = 3.0 * time + 50.0 * resets.unwrap_or(0) as f64;
        position(time, Position::Local(Vector3::new(north, 0.0, 0.0)), resets)
    });
    let run = run(&samples.collect::<Vec<_>>());
    assert_eq!(run.times(), [2.0, 5.0]);
    assert!(
        run.velocities()
            .iter()
            .all(|(_, velocity)| is_north(velocity))
    );
}

/// Where the clock was set back, times begin anew.
#[test]
fn nothing_is_taken_across_a_step_of_the_clock() {
    let mut transform = transform();
    let mut derived = Vec::new();
    let epoch = || {
        let attitudes = (0..8).map(|n| attitude(0.5 * f64::from(n), 0.0));
        sorted(attitudes.chain(northwards([1.0, 1.5, 2.0])).collect())
    };
    for sample in epoch() {
        transform.push(sample, &mut derived);
    }
    // The attitudes after the last position have waited for the next.
    transform.begin_epoch(&mut derived);
    assert_eq!(derived.len(), 8 + 7 + 1, "orientations, turns, a velocity");
    for sample in epoch() {
        transform.push(sample, &mut derived);
    }
    let outcome = transform.finish(&mut derived);
    let run = Run { derived, outcome };
    assert_eq!(run.times(), [1.5, 1.5]);
    assert_eq!(run.dropped(), [(NoNeighbours, 4)]);
}

#[test]
fn local_and_geodetic_positions_are_not_mixed() {
    let samples = [
        northwards([1.0, 2.0, 3.0]),
        vec![
            geodetic(3.5, [47.0, 8.0, 1.0]),
            geodetic(4.0, [47.0, 8.1, 1.0]),
        ],
    ];
    assert_eq!(run(&samples.concat()).times(), [2.0]);
}

#[test]
fn a_second_position_at_the_same_time_is_not_used() {
    let mut samples = northwards([1.0, 2.0, 3.0]);
    samples.insert(2, local(2.0, [999.0, 0.0, 0.0]));
    let run = run(&samples);
    assert!(is_north(&run.velocities()[0].1));
    assert_eq!(run.dropped(), [(DuplicateTime, 1), (NoNeighbours, 2)]);
}

/// Of a burst the first is used: a difference over microseconds would be all noise.
#[test]
fn a_burst_of_positions_does_not_give_spikes() {
    let mut samples = northwards([1.0, 1.1, 1.2, 1.3]);
    samples.insert(2, local(1.1001, [3.6, 1.0, -20.0]));
    samples.insert(3, local(1.1002, [3.9, 1.0, -20.0]));
    let run = run(&samples);
    assert_eq!(run.times(), [1.1, 1.2]);
    assert!(
        run.velocities()
            .iter()
            .all(|(_, velocity)| is_north(velocity))
    );
    assert_eq!(run.dropped(), [(InBurst, 2), (NoNeighbours, 2)]);
}

#[test]
fn what_is_no_place_is_not_used() {
    let samples = [
        [0.0, 0.0, 0.0],
        [47.0, 8.0, 400.0],
        [0.0, 0.0, 0.0],
        [47.0001, 8.0, 400.0],
        [473_977_418.0, 85_455_939.0, 400.0],
        [47.0002, 8.0, 400.0],
        [47.0, 361.0, 400.0],
    ];
    let samples = (1..).zip(samples);
    let samples = samples.map(|(n, place)| geodetic(f64::from(n), place));
    let run = run(&samples.collect::<Vec<_>>());
    assert_eq!(run.times(), [4.0]);
    assert_eq!(run.dropped(), [(NoNeighbours, 2), (NotAPlace, 4)]);
}

#[test]
fn no_velocity_is_infinite() {
    let samples = [[0.0; 3], [1e308, 0.0, 0.0], [-1e308, 0.0, 0.0]];
    let samples = (0..).zip(samples);
    let samples = samples.map(|(n, place)| local(1.0 + 0.1 * f64::from(n), place));
    let run = run(&samples.collect::<Vec<_>>());
    assert!(run.times().is_empty());
    assert_eq!(run.dropped(), [(TooLarge, 1), (NoNeighbours, 2)]);
}

/// A receiver that measures five times a second, logged fifty times a second.
#[test]
fn a_receiver_that_is_logged_faster_than_it_measures_gives_what_it_measures() {
    let place = |t: f64| [3.0 * t + 0.5 * t * t, -t, 2.0 * t];
    let measured = |n: i32| f64::from(n / 10) * 0.2;
    let repeated = (50..200).map(|n| local(f64::from(n) * 0.02, place(measured(n))));
    let once = (5..20).map(|n| local(f64::from(n) * 0.2, place(f64::from(n) * 0.2)));
    let (repeated, once) = (
        run(&repeated.collect::<Vec<_>>()),
        run(&once.collect::<Vec<_>>()),
    );
    assert_eq!(repeated.velocities(), once.velocities());
    assert_eq!(once.velocities().len(), 13);
    assert_eq!(
        repeated.dropped(),
        [(RepeatedPosition, 135), (NoNeighbours, 2)]
    );
}

#[test]
fn a_place_that_is_left_and_reached_again_is_not_a_repeated_one() {
    let there_and_back = [0.0, 1.0, 0.0, 1.0, 0.0];
    let samples = (1..).zip(there_and_back);
    let samples = samples.map(|(n, north)| local(f64::from(n), [north, 0.0, 0.0]));
    assert_eq!(run(&samples.collect::<Vec<_>>()).times(), [2.0, 3.0, 4.0]);
}

#[test]
fn velocities_in_messages_are_not_used_beside_positions() {
    let mut samples = northwards([1.0, 2.0, 3.0]);
    samples.push(Sample::Velocity(VelocitySample {
        stamp: at(2.5),
        velocity: Velocity::Ned(Vector3::new(99.0, 0.0, 0.0)),
    }));
    let run = run(&samples);
    assert_eq!(run.times(), [2.0]);
    assert_eq!(run.outcome.tallies[Kind::Velocity].total(), 1);
}

#[test]
fn what_waits_for_a_position_that_never_comes_is_derived_all_the_same() {
    let turning = |n| attitude(1.0 + f64::from(n), 10.0 * f64::from(n));
    let mut samples: Vec<Sample> = (0..4).map(turning).collect();
    samples.extend(northwards([1.1, 1.2]));
    let run = run_all(samples);
    let quantities: Vec<Quantity> = run.derived.iter().map(Derived::quantity).collect();
    let later = [Quantity::RelativeRpy, Quantity::Orientation].repeat(3);
    assert_eq!(quantities[..1], [Quantity::Orientation]);
    assert_eq!(quantities[1..], later);
    assert_eq!(run.outcome.tallies[Kind::Attitude].used, 4);
}

// ---- In what order ----

/// Attitudes and positions at any times, in steps that make many of them coincide, and some positions repeat.
fn any_stream() -> impl Strategy<Value = Vec<Sample>> {
    let sample = (0..600u32, any::<bool>(), 0..30i32).prop_map(|(time, is_position, place)| {
        let time = 1.0 + 0.25 * f64::from(time);
        match is_position {
            true => local(time, [f64::from(place), 0.0, 0.0]),
            false => attitude(time, f64::from(place)),
        }
    });
    prop::collection::vec(sample, 0..200)
}

/// The velocities by their definition, without regard to order, cost or memory.
fn expected(samples: &[Sample]) -> Vec<(u64, f64)> {
    let mut positions: Vec<(u64, f64)> = Vec::new();
    let mut last_time = None;
    for sample in sorted(samples.to_vec()) {
        let Sample::Position(PositionSample {
            stamp,
            position: Position::Local(place),
            ..
        }) = sample
        else {
            continue;
        };
        let is_first = last_time.replace(stamp.log_time) != Some(stamp.log_time);
        let is_other = positions.last().is_none_or(|last| last.1 != place.x);
        if is_first && is_other {
            positions.push((stamp.log_time, place.x));
        }
    }
    let of_middle = positions.windows(3).filter_map(|three| {
        let [(t0, x0), (t1, x1), (t2, x2)] = three else {
            return None;
        };
        let [h, k] = [t1 - t0, t2 - t1].map(|span| span as f64 / 1e9);
        let is_near = h <= MAX_GAP && k <= MAX_GAP;
        // Lagrange's parabola through the three, derived at the middle one.
        let slope = -x0 * k / (h * (h + k)) + x1 * (k - h) / (h * k) + x2 * h / (k * (h + k));
        is_near.then_some((*t1, slope))
    });
    of_middle.collect()
}

proptest! {
    #![proptest_config(crate::support::cases(100))]

    #[test]
    fn any_stream_gives_its_velocities_in_order_and_leaves_the_rest_as_it_is(
        mut samples in any_stream(),
    ) {
        // So that an attitude is known everywhere.
        samples.extend((0..=400).map(|n| attitude(0.5 * f64::from(n), 0.0)));
        let with = run_all(samples.clone());
        let times: Vec<u64> = with.derived.iter().map(|derived| derived.stamp.log_time).collect();
        prop_assert!(times.is_sorted());

        let expected = expected(&samples);
        let found = with.velocities();
        prop_assert_eq!(found.len(), expected.len());
        for ((time, velocity), (expected_time, north)) in found.iter().zip(&expected) {
            prop_assert_eq!((time * 1e9).round() as u64, *expected_time);
            // Whatever the heading, the camera is level.
            prop_assert!((velocity.norm() - north.abs()).abs() < 1e-9);
        }
        let total = samples.iter().filter(|sample| sample.kind() == Kind::Position).count();
        prop_assert_eq!(with.outcome.tallies[Kind::Position].total(), total as u64);

        let is_attitude = |sample: &Sample| sample.kind() == Kind::Attitude;
        let without = run_all(samples.into_iter().filter(is_attitude).collect());
        let of_attitudes = |run: &Run| -> Vec<Derived> {
            let is_velocity = |derived: &&Derived| derived.quantity() == Quantity::CameraVelocity;
            run.derived.iter().filter(|derived| !is_velocity(derived)).copied().collect()
        };
        prop_assert_eq!(of_attitudes(&with), of_attitudes(&without));
    }
}

/// A sample waits only while the next position can still come within the maximum gap.
#[test]
fn nothing_waits_for_longer_than_the_maximum_gap() {
    let mut transform = transform();
    let mut derived = Vec::new();
    let mut derived_at = |sample| {
        transform.push(sample, &mut derived);
        derived.len()
    };
    for sample in northwards([0.1, 0.2]) {
        derived_at(sample);
    }
    let counts = [1.0, 2.0, 3.0, 4.0, 5.0, 5.3, 6.0].map(|t| derived_at(attitude(t, 0.0)));
    // An orientation of each, and a turn to each but the first.
    assert_eq!(counts, [0, 0, 0, 0, 0, 6 + 5, 7 + 6]);
}
