//! What the transform makes of a stream of samples: one behaviour a test, then what holds for any stream.
//!
//! Times are seconds and angles degrees. The camera of most tests looks at the horizon: a relative rotation
//! is then a yaw by the step of the heading, and a drone that flies north sees where its camera heads.

mod orientation;

use flightcam::camera::Camera;
use flightcam::derived::{Derived, Quantity, Value};
use flightcam::geometry::{DepressionAngle, RollPitchYaw};
use flightcam::sample::DropReason::{self, *};
use flightcam::sample::{AttitudeSample, Kind, Sample, Stamp, Velocity, VelocitySample};
use flightcam::transform::{Breaks, MaxGap, MaxGapOutOfRange, Outcome, Transform};
use nalgebra::Vector3;
use proptest::prelude::*;

const MAX_GAP: f64 = 5.0;
const NO_BREAKS: Breaks = Breaks {
    gaps: 0,
    resets: 0,
    clock_steps: 0,
};
const ONE_GAP: Breaks = Breaks {
    gaps: 1,
    ..NO_BREAKS
};

/// A moment, with a publish time of its own so that no other time can be mistaken for it.
fn at(seconds: f64) -> Stamp {
    let log_time = (seconds * 1e9).round() as u64;
    Stamp {
        log_time,
        publish_time: log_time - 7,
    }
}

fn attitude(time: f64, [roll, pitch, yaw]: [f64; 3]) -> AttitudeSample {
    let rpy = RollPitchYaw {
        roll: roll.to_radians(),
        pitch: pitch.to_radians(),
        yaw: yaw.to_radians(),
    };
    AttitudeSample {
        stamp: at(time),
        orientation: rpy.to_quaternion(),
        reset_counter: None,
    }
}

/// A drone heading north with its nose this high.
fn pitched(time: f64, pitch: f64) -> Sample {
    Sample::Attitude(attitude(time, [0.0, pitch, 0.0]))
}

/// A level drone heading this far east of north.
fn yaw(time: f64, heading: f64) -> Sample {
    Sample::Attitude(attitude(time, [0.0, 0.0, heading]))
}

/// A drone with its nose straight up, pulled up from this heading.
fn nose_up(time: f64, heading: f64) -> Sample {
    Sample::Attitude(attitude(time, [0.0, 90.0, heading]))
}

/// A level drone after this many resets of its estimator.
fn reset(resets: u64, time: f64, heading: f64) -> Sample {
    Sample::Attitude(AttitudeSample {
        reset_counter: Some(resets),
        ..attitude(time, [0.0, 0.0, heading])
    })
}

fn velocity(time: f64, velocity_ned: [f64; 3]) -> Sample {
    Sample::Velocity(VelocitySample {
        stamp: at(time),
        velocity: Velocity::Ned(velocity_ned.into()),
    })
}

fn north(time: f64) -> Sample {
    velocity(time, [1.0, 0.0, 0.0])
}

fn east(time: f64) -> Sample {
    velocity(time, [0.0, 1.0, 0.0])
}

fn max_gap(seconds: f64) -> MaxGap {
    MaxGap::from_seconds(seconds).expect("a gap in range")
}

struct Run {
    derived: Vec<Derived>,
    outcome: Outcome,
}

fn run_at_depression(degrees: f64, samples: &[Sample]) -> Run {
    let depression = DepressionAngle::from_degrees(degrees).expect("a depression in range");
    let camera = Camera::Stabilised {
        depression,
        yaw_offset: 0.0,
    };
    let mut transform = Transform::new(camera, max_gap(MAX_GAP));
    let mut derived = Vec::new();
    for sample in samples {
        transform.push(*sample, &mut derived);
    }
    let outcome = transform.finish(&mut derived);
    Run { derived, outcome }
}

fn run(samples: &[Sample]) -> Run {
    run_at_depression(0.0, samples)
}

/// Without the noise of rounding.
fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 / 1e9
}

impl Run {
    fn dropped(&self, kind: Kind) -> Vec<(DropReason, u64)> {
        let dropped = &self.outcome.tallies[kind].dropped;
        dropped.clone().into_iter().collect()
    }

    /// The relative rotations: time, interval, and yaw, which is all there is at the horizon.
    fn turns(&self) -> Vec<(f64, f64, f64)> {
        let turn = |derived: &Derived| match derived.value {
            Value::RelativeRpy { interval, rpy } => {
                assert!(rpy.roll.abs() < 1e-12 && rpy.pitch.abs() < 1e-12);
                let time = seconds(derived.stamp.log_time);
                Some((time, seconds(interval), rounded(rpy.yaw.to_degrees())))
            }
            _ => None,
        };
        self.derived.iter().filter_map(turn).collect()
    }

    /// The orientations: time, and where the camera heads (0 to 360), which is all there is at the horizon.
    fn directions(&self) -> Vec<(f64, f64)> {
        let direction = |derived: &Derived| match derived.value {
            Value::Orientation(r_ned_camera) => {
                let [ahead, right] =
                    [0, 1].map(|axis| r_ned_camera.matrix().column(axis).into_owned());
                assert!(ahead.z.abs() < 1e-12 && right.z.abs() < 1e-12);
                let heading = rounded(ahead.y.atan2(ahead.x).to_degrees());
                Some((seconds(derived.stamp.log_time), heading.rem_euclid(360.0)))
            }
            _ => None,
        };
        self.derived.iter().filter_map(direction).collect()
    }

    /// The velocities: time, and where the camera heads (0 to 360) if the velocity was one to the north.
    fn headings(&self) -> Vec<(f64, f64)> {
        let heading = |derived: &Derived| match derived.value {
            Value::CameraVelocity(v) => {
                assert!((v.norm() - 1.0).abs() < 1e-12 && v.z.abs() < 1e-12);
                let heading = rounded((-v.y).atan2(v.x).to_degrees());
                Some((seconds(derived.stamp.log_time), heading.rem_euclid(360.0)))
            }
            _ => None,
        };
        self.derived.iter().filter_map(heading).collect()
    }
}

mod relative_rotation {
    use super::*;

    #[test]
    fn the_first_attitude_has_no_rotation() {
        let run = run(&[yaw(1.0, 10.0)]);
        assert_eq!(run.turns(), []);
        assert_eq!(run.outcome.tallies[Kind::Attitude].used, 1);
        assert_eq!(run.outcome.breaks, NO_BREAKS);
    }

    #[test]
    fn every_further_attitude_has_the_rotation_since_the_previous_one() {
        let run = run(&[yaw(1.0, 10.0), yaw(1.1, 25.0), yaw(3.0, -5.0)]);
        assert_eq!(run.turns(), [(1.1, 0.1, 15.0), (3.0, 1.9, -30.0)]);
    }

    #[test]
    fn the_rotation_is_that_of_the_tilted_camera() {
        let run = run_at_depression(90.0, &[yaw(1.0, 10.0), yaw(2.0, 40.0)]);
        let Value::RelativeRpy { rpy, .. } = run.derived[1].value else {
            panic!("not a rotation: {:?}", run.derived);
        };
        let degrees = [rpy.roll, rpy.pitch, rpy.yaw].map(|angle| rounded(angle.to_degrees()));
        assert_eq!(degrees, [30.0, 0.0, 0.0]);
    }

    #[test]
    fn a_rotation_spans_the_maximum_gap_but_not_a_nanosecond_more() {
        let allowed = run(&[yaw(1.0, 0.0), yaw(6.0, 20.0)]);
        assert_eq!(allowed.turns(), [(6.0, 5.0, 20.0)]);
        assert_eq!(allowed.outcome.breaks, NO_BREAKS);

        let broken = run(&[yaw(1.0, 0.0), yaw(6.000000001, 20.0)]);
        assert_eq!(broken.turns(), []);
        assert_eq!(broken.outcome.breaks, ONE_GAP);
    }

    #[test]
    fn rotations_resume_after_a_gap() {
        let run = run(&[yaw(1.0, 0.0), yaw(9.0, 20.0), yaw(9.5, 50.0)]);
        assert_eq!(run.turns(), [(9.5, 0.5, 30.0)]);
        assert_eq!(run.outcome.tallies[Kind::Attitude].used, 3);
    }

    #[test]
    fn no_rotation_crosses_a_reset_of_the_estimator() {
        let run = run(&[
            reset(3, 1.0, 0.0),
            reset(3, 2.0, 10.0),
            reset(4, 3.0, 90.0),
            reset(4, 4.0, 95.0),
            reset(0, 5.0, 20.0),
        ]);
        assert_eq!(run.turns(), [(2.0, 1.0, 10.0), (4.0, 1.0, 5.0)]);
        assert_eq!(
            run.outcome.breaks,
            Breaks {
                resets: 2,
                ..NO_BREAKS
            }
        );
        assert_eq!(run.outcome.tallies[Kind::Attitude].used, 5);
    }

    #[test]
    fn a_rotation_exists_where_the_reset_counter_is_missing_on_one_side() {
        let run = run(&[reset(3, 1.0, 0.0), yaw(2.0, 10.0), reset(4, 3.0, 30.0)]);
        assert_eq!(run.turns(), [(2.0, 1.0, 10.0), (3.0, 1.0, 20.0)]);
        assert_eq!(run.outcome.breaks, NO_BREAKS);
    }

    #[test]
    fn a_rotation_spans_from_the_last_attitude_with_a_heading() {
        let run = run(&[
            yaw(1.0, 10.0),
            nose_up(2.0, 70.0),
            nose_up(2.5, 70.0),
            yaw(3.0, 30.0),
            yaw(4.0, 35.0),
        ]);
        assert_eq!(run.turns(), [(3.0, 2.0, 20.0), (4.0, 1.0, 5.0)]);
        assert_eq!(run.dropped(Kind::Attitude), [(UndefinedHeading, 2)]);
        assert_eq!(run.outcome.breaks, NO_BREAKS);
    }

    #[test]
    fn a_rotation_counts_its_gap_from_the_last_attitude_with_a_heading() {
        let run = run(&[yaw(1.0, 10.0), nose_up(4.0, 0.0), yaw(7.0, 30.0)]);
        assert_eq!(run.turns(), []);
        assert_eq!(run.outcome.breaks, ONE_GAP);
    }
}

mod velocity {
    use super::*;

    #[test]
    fn a_velocity_takes_the_attitude_at_its_own_time_and_needs_no_other() {
        let run = run(&[yaw(1.0, 30.0), north(1.0)]);
        assert_eq!(run.headings(), [(1.0, 30.0)]);
    }

    #[test]
    fn a_velocity_between_two_attitudes_takes_the_interpolated_one() {
        let run = run(&[yaw(1.0, 350.0), north(1.25), north(2.5), yaw(3.0, 30.0)]);
        assert_eq!(run.headings(), [(1.25, 355.0), (2.5, 20.0)]);
    }

    #[test]
    fn a_velocity_is_in_the_axes_of_the_tilted_camera() {
        let sinking = velocity(1.0, [0.0, 0.0, 2.0]);
        let run = run_at_depression(90.0, &[yaw(1.0, 30.0), sinking]);
        let Value::CameraVelocity(velocity) = run.derived[1].value else {
            panic!("not a velocity: {:?}", run.derived);
        };
        assert!((velocity - Vector3::new(2.0, 0.0, 0.0)).norm() < 1e-12);
    }

    /// A drone that loops over backwards keeps its heading to the top and has the opposite one from there.
    #[test]
    fn the_drones_attitude_is_interpolated_and_not_the_cameras() {
        let climb = [pitched(1.0, 0.0), north(1.8)];
        let fall = [north(2.0), pitched(2.5, 150.0)];
        let run = run(&[climb, fall].concat());
        assert_eq!(run.headings(), [(1.8, 0.0), (2.0, 180.0)]);
    }

    #[test]
    fn a_velocity_where_the_interpolated_nose_is_vertical_is_dropped() {
        let run = run(&[pitched(1.0, 0.0), north(1.9), pitched(2.5, 150.0)]);
        assert_eq!(run.headings(), []);
        assert_eq!(run.dropped(Kind::Velocity), [(UndefinedHeading, 1)]);
    }

    #[test]
    fn a_velocity_at_an_attitude_without_a_heading_is_dropped() {
        let run = run(&[yaw(1.0, 0.0), nose_up(2.0, 0.0), north(2.0), yaw(3.0, 0.0)]);
        assert_eq!(run.headings(), []);
        assert_eq!(run.dropped(Kind::Velocity), [(UndefinedHeading, 1)]);
    }

    /// Without the attitude at 2 s, the heading would turn evenly from 0° to 90°.
    #[test]
    fn the_attitude_is_interpolated_on_either_side_of_one_without_a_heading() {
        let climb = run(&[yaw(1.0, 0.0), north(1.5), nose_up(2.0, 0.0), yaw(3.0, 90.0)]);
        assert_eq!(climb.headings(), [(1.5, 0.0)]);
        let fall = run(&[
            yaw(1.0, 0.0),
            nose_up(2.0, 90.0),
            north(2.5),
            yaw(3.0, 90.0),
        ]);
        assert_eq!(fall.headings(), [(2.5, 90.0)]);
    }

    #[test]
    fn a_velocity_outside_the_attitude_is_dropped() {
        let before = [north(0.5), north(0.999), yaw(1.0, 0.0), yaw(2.0, 0.0)];
        let after = [north(2.001), north(7.0), north(7.001), north(9e4)];
        let run = run(&[before, after].concat());
        assert_eq!(run.headings(), []);
        assert_eq!(run.dropped(Kind::Velocity), [(OutsideAttitude, 6)]);
    }

    #[test]
    fn the_attitude_is_interpolated_over_the_maximum_gap_but_not_a_nanosecond_more() {
        let allowed = run(&[yaw(1.0, 0.0), north(3.5), yaw(6.0, 40.0)]);
        assert_eq!(allowed.headings(), [(3.5, 20.0)]);

        let broken = run(&[yaw(1.0, 0.0), north(3.5), yaw(6.000000001, 40.0)]);
        assert_eq!(broken.headings(), []);
        assert_eq!(broken.dropped(Kind::Velocity), [(InAttitudeGap, 1)]);
    }

    #[test]
    fn a_velocity_inside_a_gap_is_dropped_however_near_its_ends() {
        let gap = [yaw(1.0, 0.0), north(1.1), north(6.1), north(50.0)];
        let resumed = [yaw(99.0, 40.0), north(100.0), yaw(101.0, 60.0)];
        let run = run(&[&gap[..], &resumed].concat());
        assert_eq!(run.headings(), [(100.0, 50.0)]);
        assert_eq!(run.dropped(Kind::Velocity), [(InAttitudeGap, 3)]);
    }

    #[test]
    fn a_velocity_at_either_end_of_a_gap_is_kept() {
        let run = run(&[yaw(1.0, 10.0), north(1.0), yaw(9.0, 40.0), north(9.0)]);
        assert_eq!(run.headings(), [(1.0, 10.0), (9.0, 40.0)]);
    }

    #[test]
    fn a_velocity_across_a_reset_of_the_estimator_is_dropped_but_not_next_to_it() {
        let before = [reset(1, 1.0, 0.0), north(1.0), north(1.5)];
        let after = [reset(2, 2.0, 90.0), north(2.0), north(2.5)];
        let end = [reset(2, 3.0, 100.0)];
        let run = run(&[&before[..], &after, &end].concat());
        assert_eq!(run.headings(), [(1.0, 0.0), (2.0, 90.0), (2.5, 95.0)]);
        assert_eq!(run.dropped(Kind::Velocity), [(AcrossAttitudeReset, 1)]);
    }

    #[test]
    fn the_attitude_is_interpolated_where_the_reset_counter_is_missing_on_one_side() {
        let run = run(&[reset(1, 1.0, 0.0), north(1.5), yaw(2.0, 20.0)]);
        assert_eq!(run.headings(), [(1.5, 10.0)]);
    }
}

mod simultaneous_samples {
    use super::*;

    #[test]
    fn the_second_of_two_simultaneous_attitudes_is_dropped() {
        let run = run(&[yaw(1.0, 10.0), yaw(1.0, 70.0), north(1.0), yaw(2.0, 30.0)]);
        assert_eq!(run.headings(), [(1.0, 10.0)]);
        assert_eq!(run.turns(), [(2.0, 1.0, 20.0)]);
        assert_eq!(run.dropped(Kind::Attitude), [(DuplicateTime, 1)]);
    }

    #[test]
    fn the_second_of_two_simultaneous_attitudes_is_dropped_even_if_the_first_has_no_heading() {
        let run = run(&[yaw(1.0, 10.0), nose_up(2.0, 0.0), yaw(2.0, 70.0)]);
        assert_eq!(run.turns(), []);
        let expected = [(DuplicateTime, 1), (UndefinedHeading, 1)];
        assert_eq!(run.dropped(Kind::Attitude), expected);
    }

    #[test]
    fn the_second_of_two_simultaneous_velocities_is_dropped() {
        let at_attitude = [yaw(1.0, 0.0), north(1.0), east(1.0)];
        let between = [north(1.5), east(1.5), east(1.5), yaw(2.0, 0.0)];
        let run = run(&[&at_attitude[..], &between].concat());
        assert_eq!(run.headings(), [(1.0, 0.0), (1.5, 0.0)]);
        assert_eq!(run.dropped(Kind::Velocity), [(DuplicateTime, 3)]);
    }

    #[test]
    fn rotation_orientation_and_velocity_come_in_this_order_and_all_in_time_order() {
        let run = run(&[yaw(1.0, 0.0), north(1.5), yaw(2.0, 0.0), north(2.0)]);
        let order = run.derived.iter().map(|d| (d.stamp, d.quantity()));
        let expected = [
            (at(1.0), Quantity::Orientation),
            (at(1.5), Quantity::CameraVelocity),
            (at(2.0), Quantity::RelativeRpy),
            (at(2.0), Quantity::Orientation),
            (at(2.0), Quantity::CameraVelocity),
        ];
        assert!(order.eq(expected), "{:?}", run.derived);
    }
}

#[test]
fn a_maximum_gap_is_from_a_nanosecond_to_a_billion_seconds() {
    for seconds in [1e-9, 0.5, 1e9] {
        assert_eq!(max_gap(seconds).seconds(), seconds);
    }
    for seconds in [0.0, 4e-10, -1.0, 1e9f64.next_up(), f64::INFINITY] {
        let refused = MaxGap::from_seconds(seconds);
        assert_eq!(refused, Err(MaxGapOutOfRange(seconds)));
    }
    assert!(MaxGap::from_seconds(f64::NAN).is_err());
    assert_eq!(MaxGap::default(), max_gap(5.0));
}

/// Moments half a second apart, so that many coincide and some gaps are too long.
fn moment() -> impl Strategy<Value = f64> {
    (1..120u8).prop_map(|halves| f64::from(halves) / 2.0)
}

fn any_attitude() -> impl Strategy<Value = Sample> {
    let pitch = prop_oneof![2 => -180.0..180.0, 1 => prop::sample::select(vec![-90.0, 90.0])];
    let rpy = (-180.0..180.0, pitch, -180.0..180.0);
    let resets = prop::option::of(0..2u64);
    (moment(), rpy, resets).prop_map(|(time, (roll, pitch, yaw), reset_counter)| {
        let attitude = attitude(time, [roll, pitch, yaw]);
        Sample::Attitude(AttitudeSample {
            reset_counter,
            ..attitude
        })
    })
}

fn any_velocity() -> impl Strategy<Value = Sample> {
    (moment(), prop::array::uniform3(-30.0..30.0)).prop_map(|(time, ned)| velocity(time, ned))
}

/// Samples in the order that the transform wants them.
fn any_stream() -> impl Strategy<Value = Vec<Sample>> {
    let sample = prop_oneof![any_attitude(), any_velocity()];
    prop::collection::vec(sample, 0..100).prop_map(|mut samples| {
        samples.sort_by_key(|sample| (sample.stamp().log_time, sample.kind()));
        samples
    })
}

proptest! {
    #![proptest_config(crate::support::cases(1000))]

    #[test]
    fn every_sample_is_accounted_for(samples in any_stream(), depression in -89.0..=90.0) {
        let Run { derived, outcome } = run_at_depression(depression, &samples);
        let Outcome {
            tallies, breaks, ..
        } = outcome;
        let (attitude, velocity) = (&tallies[Kind::Attitude], &tallies[Kind::Velocity]);
        let pushed = |kind| samples.iter().filter(|sample| sample.kind() == kind).count() as u64;
        let made = |quantity| derived.iter().filter(|d| d.quantity() == quantity).count() as u64;

        prop_assert_eq!(attitude.total(), pushed(Kind::Attitude));
        prop_assert_eq!(velocity.total(), pushed(Kind::Velocity));
        prop_assert_eq!(made(Quantity::CameraVelocity), velocity.used);
        prop_assert_eq!(made(Quantity::Orientation), attitude.used);
        let with_a_predecessor = attitude.used.saturating_sub(1);
        let rotations_and_breaks = made(Quantity::RelativeRpy) + breaks.gaps + breaks.resets;
        prop_assert_eq!(rotations_and_breaks, with_a_predecessor);
    }

    #[test]
    fn every_derived_value_is_finite_and_in_order_and_at_a_sample(
        samples in any_stream(),
        depression in -89.0..=90.0,
    ) {
        let Run { derived, .. } = run_at_depression(depression, &samples);
        let order = |d: &Derived| (d.stamp.log_time, d.quantity());
        prop_assert!(derived.is_sorted_by(|a, b| order(a) < order(b)), "in order, nothing twice");
        for Derived { stamp, value } in derived {
            let (kind, numbers) = match value {
                Value::RelativeRpy { interval, rpy } => {
                    prop_assert!(interval > 0 && seconds(interval) <= MAX_GAP);
                    (Kind::Attitude, vec![rpy.roll, rpy.pitch, rpy.yaw])
                }
                Value::Orientation(r_ned_camera) => {
                    (Kind::Attitude, r_ned_camera.matrix().as_slice().to_vec())
                }
                Value::CameraVelocity(velocity) => (Kind::Velocity, velocity.as_slice().to_vec()),
                other => panic!("a value of a new kind: {other:?}"),
            };
            prop_assert!(numbers.iter().all(|number| number.is_finite()), "{numbers:?}");
            prop_assert!(samples.iter().any(|s| (s.stamp(), s.kind()) == (stamp, kind)));
        }
    }
}
