//! What the transform makes of the log's gimbal, and of velocities in the drone's axes: one behaviour a test.
//!
//! Times are seconds and angles degrees. By default the gimbal looks at the horizon, to the
//! right of the nose by its angle, and the drone flies north.

use flightcam::camera::{Camera, Mount};
use flightcam::derived::{Derived, Value};
use flightcam::geometry::RollPitchYaw;
use flightcam::sample::DropReason::{self, *};
use flightcam::sample::GimbalReference::{self, Earth, Heading};
use flightcam::sample::{
    AttitudeSample, GimbalSample, Kind, Position, PositionSample, Sample, Stamp, Velocity,
    VelocitySample,
};
use flightcam::transform::{Breaks, MaxGap, Outcome, Transform};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

fn at(seconds: f64) -> Stamp {
    let log_time = (seconds * 1e9).round() as u64;
    Stamp {
        log_time,
        publish_time: log_time - 7,
    }
}

fn rpy(degrees: [f64; 3]) -> UnitQuaternion<f64> {
    let [roll, pitch, yaw] = degrees.map(f64::to_radians);
    RollPitchYaw { roll, pitch, yaw }.to_quaternion()
}

fn attitude(time: f64, orientation: UnitQuaternion<f64>) -> Sample {
    Sample::Attitude(AttitudeSample {
        stamp: at(time),
        orientation,
        reset_counter: None,
    })
}

/// A level drone heading this far east of north.
fn yaw(time: f64, heading: f64) -> Sample {
    attitude(time, rpy([0.0, 0.0, heading]))
}

fn nose_up(time: f64) -> Sample {
    attitude(time, rpy([0.0, 90.0, 0.0]))
}

fn gimbal_from(reference: GimbalReference, time: f64, angle: f64) -> Sample {
    Sample::Gimbal(GimbalSample {
        stamp: at(time),
        orientation: rpy([0.0, 0.0, angle]),
        reference,
    })
}

fn gimbal(time: f64, angle: f64) -> Sample {
    gimbal_from(Heading, time, angle)
}

fn velocity(time: f64, velocity: Velocity) -> Sample {
    Sample::Velocity(VelocitySample {
        stamp: at(time),
        velocity,
    })
}

fn north(time: f64) -> Sample {
    velocity(time, Velocity::Ned(Vector3::x()))
}

fn transform(camera: Camera, max_gap: f64) -> Transform {
    Transform::new(
        camera,
        MaxGap::from_seconds(max_gap).expect("a gap in range"),
    )
}

struct Run {
    derived: Vec<Derived>,
    outcome: Outcome,
}

fn run_with(camera: Camera, samples: &[Sample]) -> Run {
    let mut transform = transform(camera, 5.0);
    let mut derived = Vec::new();
    for sample in samples {
        transform.push(*sample, &mut derived);
    }
    let outcome = transform.finish(&mut derived);
    Run { derived, outcome }
}

fn run(samples: &[Sample]) -> Run {
    run_with(Camera::Gimbal, samples)
}

fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

impl Run {
    /// The relative rotations: time and yaw, which is all there is at the horizon.
    fn turns(&self) -> Vec<(f64, f64)> {
        let turn = |derived: &Derived| match derived.value {
            Value::RelativeRpy { rpy, .. } => {
                assert!(rpy.roll.abs() < 1e-12 && rpy.pitch.abs() < 1e-12);
                let time = derived.stamp.log_time as f64 / 1e9;
                Some((time, rounded(rpy.yaw.to_degrees())))
            }
            _ => None,
        };
        self.derived.iter().filter_map(turn).collect()
    }

    /// The velocities: time, and where the camera heads (0 to 360) if the velocity was one to the north.
    fn headings(&self) -> Vec<(f64, f64)> {
        let heading = |derived: &Derived| match derived.value {
            Value::CameraVelocity(v) => {
                let heading = rounded((-v.y).atan2(v.x).to_degrees());
                let time = derived.stamp.log_time as f64 / 1e9;
                Some((time, heading.rem_euclid(360.0)))
            }
            _ => None,
        };
        self.derived.iter().filter_map(heading).collect()
    }

    fn dropped(&self, kind: Kind) -> Vec<(DropReason, u64)> {
        let dropped = &self.outcome.tallies[kind].dropped;
        dropped.clone().into_iter().collect()
    }
}

mod gimbal_track {
    use super::*;

    #[test]
    fn the_gimbal_is_taken_at_the_time_of_the_attitude() {
        let first = [gimbal(1.0, 10.0), yaw(1.0, 100.0)];
        let second = [gimbal(2.0, 25.0), yaw(2.0, 105.0)];
        let run = run(&[first, second].concat());
        assert_eq!(run.turns(), [(2.0, 20.0)]);
        assert_eq!(run.outcome.tallies[Kind::Gimbal].used, 2);
        assert_eq!(run.outcome.tallies[Kind::Attitude].used, 2);
    }

    #[test]
    fn the_gimbal_is_interpolated_along_the_shorter_arc_between_samples_at_another_rate() {
        let slow = [gimbal(1.0, 350.0), yaw(1.0, 0.0), north(1.5), yaw(2.0, 0.0)];
        let end = [gimbal(3.0, 30.0), yaw(3.0, 0.0)];
        let run = run(&[&slow[..], &end].concat());
        assert_eq!(run.headings(), [(1.5, 0.0)]);
        assert_eq!(run.turns(), [(2.0, 20.0), (3.0, 20.0)]);
    }

    #[test]
    fn the_gimbal_is_not_extrapolated() {
        let before = [yaw(0.5, 0.0), north(0.6), gimbal(1.0, 0.0), yaw(1.0, 0.0)];
        let after = [yaw(2.0, 5.0), gimbal(2.5, 0.0), yaw(3.0, 0.0), north(3.0)];
        let run = run(&[before, after].concat());
        assert_eq!(run.turns(), [(2.0, 5.0)]);
        assert_eq!(run.dropped(Kind::Attitude), [(OutsideGimbal, 2)]);
        assert_eq!(run.dropped(Kind::Velocity), [(OutsideGimbal, 2)]);
        assert_eq!(run.outcome.breaks, Breaks::default());
    }

    #[test]
    fn the_gimbal_is_interpolated_over_the_maximum_gap_but_not_a_nanosecond_more() {
        let over = |end| {
            run(&[
                gimbal(1.0, 0.0),
                yaw(3.5, 0.0),
                north(3.5),
                gimbal(end, 40.0),
            ])
        };
        assert_eq!(over(6.0).headings(), [(3.5, 20.0)]);
        let broken = over(6.000000001);
        assert_eq!(broken.headings(), []);
        assert_eq!(broken.dropped(Kind::Attitude), [(InGimbalGap, 1)]);
        assert_eq!(broken.dropped(Kind::Velocity), [(InGimbalGap, 1)]);
    }

    #[test]
    fn samples_inside_a_gap_of_the_gimbal_are_dropped_however_near_its_ends() {
        let gap = [gimbal(1.0, 0.0), yaw(1.5, 0.0), yaw(6.1, 0.0), north(6.1)];
        let resumed = [yaw(50.0, 0.0), gimbal(60.0, 0.0), yaw(60.0, 0.0)];
        let run = run(&[&gap[..], &resumed, &[yaw(99.0, 0.0)]].concat());
        let expected = [(OutsideGimbal, 1), (InGimbalGap, 3)];
        assert_eq!(run.dropped(Kind::Attitude), expected);
        assert_eq!(run.dropped(Kind::Velocity), [(InGimbalGap, 1)]);
    }

    #[test]
    fn the_gimbal_is_not_interpolated_between_references_but_known_at_either() {
        let earth = [
            gimbal_from(Earth, 1.0, 10.0),
            yaw(1.0, 90.0),
            yaw(1.5, 90.0),
        ];
        let heading = [gimbal_from(Heading, 2.0, 0.0), yaw(2.0, 90.0)];
        let run = run(&[&earth[..], &heading].concat());
        assert_eq!(run.turns(), [(2.0, 80.0)]);
        assert_eq!(run.dropped(Kind::Attitude), [(InGimbalGap, 1)]);
        assert_eq!(run.outcome.breaks, Breaks::default());
    }

    #[test]
    fn an_attitude_without_a_gimbal_still_serves_to_interpolate_the_drone() {
        let first = [gimbal_from(Earth, 1.0, 0.0), yaw(1.0, 0.0), yaw(1.8, 0.0)];
        let second = [
            gimbal(2.0, 0.0),
            north(2.0),
            gimbal(3.0, 0.0),
            yaw(3.0, 120.0),
        ];
        let run = run(&[&first[..], &second].concat());
        assert_eq!(run.headings(), [(2.0, 20.0)]);
        assert_eq!(run.dropped(Kind::Attitude), [(InGimbalGap, 1)]);
    }

    #[test]
    fn a_gimbal_measured_from_the_earth_needs_no_heading() {
        let run_from = |from| run(&[gimbal_from(from, 1.0, 70.0), nose_up(1.0), north(1.0)]);
        assert_eq!(run_from(Earth).headings(), [(1.0, 70.0)]);
        let undefined = run_from(Heading);
        assert_eq!(undefined.dropped(Kind::Attitude), [(UndefinedHeading, 1)]);
        assert_eq!(undefined.dropped(Kind::Velocity), [(UndefinedHeading, 1)]);
    }

    #[test]
    fn the_first_of_two_simultaneous_gimbal_samples_is_used() {
        let run = run(&[
            gimbal(1.0, 10.0),
            gimbal(1.0, 70.0),
            yaw(1.0, 0.0),
            north(1.0),
        ]);
        assert_eq!(run.headings(), [(1.0, 10.0)]);
        assert_eq!(run.outcome.tallies[Kind::Gimbal].used, 1);
        assert_eq!(run.dropped(Kind::Gimbal), [(DuplicateTime, 1)]);
    }

    #[test]
    fn the_gimbal_is_ignored_by_a_camera_that_does_not_follow_it() {
        let level = Camera::Fixed(Mount::from_degrees(0.0, 0.0, 0.0).expect("in range"));
        let samples = [gimbal(1.0, 10.0), yaw(1.0, 3.0), north(1.0)];
        let run = run_with(level, &samples);
        assert_eq!(run.headings(), [(1.0, 3.0)]);
        assert_eq!(run.outcome.tallies[Kind::Gimbal].total(), 0);
    }
}

mod drop_reason {
    use super::*;

    #[test]
    fn a_velocity_is_dropped_for_the_attitude_before_the_gimbal_before_the_heading() {
        let nothing = run(&[north(1.0)]);
        assert_eq!(nothing.dropped(Kind::Velocity), [(OutsideAttitude, 1)]);

        let gaps = run(&[gimbal(1.0, 0.0), yaw(1.0, 0.0), north(2.0), yaw(9.0, 0.0)]);
        assert_eq!(gaps.dropped(Kind::Velocity), [(InAttitudeGap, 1)]);

        let no_gimbal = run(&[nose_up(1.0), north(1.0)]);
        assert_eq!(no_gimbal.dropped(Kind::Velocity), [(OutsideGimbal, 1)]);
    }
}

#[test]
fn positions_are_ignored() {
    let position = Sample::Position(PositionSample {
        stamp: at(1.0),
        position: Position::Local(Vector3::zeros()),
        resets: None,
    });
    let run = run(&[gimbal(1.0, 0.0), yaw(1.0, 0.0), position, position]);
    assert_eq!(run.outcome.tallies[Kind::Position].total(), 0);
    assert_eq!(run.outcome.tallies[Kind::Attitude].used, 1);
}

#[test]
fn a_velocity_in_the_drones_axes_is_turned_by_its_interpolated_attitude() {
    let ahead = Velocity::Frd(Vector3::x());
    let level = [
        gimbal_from(Earth, 1.0, 0.0),
        yaw(1.0, 0.0),
        velocity(1.5, ahead),
    ];
    let run = run(&[&level[..], &[gimbal_from(Earth, 2.0, 0.0), yaw(2.0, 60.0)]].concat());
    // The camera looks north, and the drone flies 30° to the right of that.
    assert_eq!(run.headings(), [(1.5, 330.0)]);
}

/// Samples at 100 Hz of the kinds that there are at a time, for a minute.
fn flight(kinds: impl Fn(f64) -> Vec<Kind>) -> Vec<Sample> {
    let moments = (100..6100).map(|hundredths| f64::from(hundredths) / 100.0);
    let samples = moments.flat_map(|time| {
        let sample = move |kind| match kind {
            Kind::Gimbal => gimbal(time, time),
            Kind::Attitude => yaw(time, -time),
            _ => north(time),
        };
        kinds(time).into_iter().map(sample)
    });
    samples.collect()
}

/// By what the transform shows of itself: a tenth of what it would show if it held a minute of samples.
#[test]
fn samples_held_back_are_bounded_by_the_maximum_gap_whatever_stops() {
    use Kind::{Attitude, Gimbal, Velocity};
    let stops = |kind: Kind| {
        flight(move |time| {
            let mut kinds = vec![Gimbal, Attitude, Velocity];
            kinds.retain(|&other| other != kind || time < 2.0);
            kinds
        })
    };
    let alternates = flight(|time| match (time / 7.0) as u32 % 2 {
        0 => vec![Gimbal, Velocity],
        _ => vec![Attitude, Velocity],
    });
    let only_gimbal = flight(|_| vec![Gimbal]);
    for samples in [
        stops(Gimbal),
        stops(Attitude),
        stops(Velocity),
        alternates,
        only_gimbal,
    ] {
        let mut transform = transform(Camera::Gimbal, 2.0);
        let mut shown = Vec::new();
        for (index, sample) in samples.iter().enumerate() {
            transform.push(*sample, &mut Vec::new());
            if index % 100 == 0 {
                shown.push(format!("{transform:?}").len());
            }
        }
        // Two seconds of a hundred samples each of the gimbal, the attitude and the velocity.
        let most = 2 * 100 * (150 + 300);
        assert!(shown.iter().all(|&length| length < most), "{shown:?}");
    }
}

proptest! {
    #![proptest_config(crate::support::cases(200))]

    /// A drone that turns evenly, so that interpolation is exact.
    #[test]
    fn a_velocity_is_the_same_in_whatever_axes_the_log_has_it(
        start in prop::array::uniform3(-180.0..180.0),
        rate in prop::array::uniform3(-2.0..2.0f64),
        velocity_ned in prop::array::uniform3(-30.0..30.0f64),
        mount in prop::array::uniform3(-90.0..90.0),
    ) {
        let q_ned_drone = |time: f64| {
            rpy(start) * UnitQuaternion::from_scaled_axis(Vector3::from(rate) * time)
        };
        let velocity_ned = Vector3::from(velocity_ned);
        let flight = |in_drone_axes: bool| {
            let samples = (10..50).flat_map(move |tenths| {
                let time = f64::from(tenths) / 10.0;
                [0.0, 0.04, 0.08].into_iter().map(move |later| {
                    let time = time + later;
                    let velocity_frd = q_ned_drone(time).inverse() * velocity_ned;
                    velocity(time, match in_drone_axes {
                        true => Velocity::Frd(velocity_frd),
                        false => Velocity::Ned(velocity_ned),
                    })
                })
                .chain([attitude(time, q_ned_drone(time)), gimbal_from(Earth, time, 40.0)])
            });
            let mut samples: Vec<_> = samples.collect();
            samples.sort_by_key(|sample| (sample.stamp().log_time, sample.kind()));
            samples
        };
        let [roll, pitch, yaw] = mount;
        let fixed = Camera::Fixed(Mount::from_degrees(roll, pitch, yaw).expect("in range"));
        for camera in [fixed, Camera::Gimbal] {
            let (drone, ned) = (run_with(camera, &flight(true)), run_with(camera, &flight(false)));
            prop_assert_eq!(&drone.outcome, &ned.outcome);
            prop_assert_eq!(ned.outcome.tallies[Kind::Velocity].used, 118);
            for (drone, ned) in drone.derived.iter().zip(&ned.derived) {
                if let (Value::CameraVelocity(a), Value::CameraVelocity(b)) = (drone.value, ned.value) {
                    prop_assert!((a - b).norm() < 1e-11);
                }
            }
        }
    }
}
