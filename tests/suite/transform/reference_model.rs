//! The transform against a model of it that sees all samples at once and looks up what it needs by search.
//!
//! Times are in quarters of a second, some of them a millisecond late, so that many coincide and many gaps are
//! just as long as the maximum or just longer.

use flightcam::camera::{Camera, Mount};
use flightcam::derived::{Derived, Value};
use flightcam::geometry::{DepressionAngle, RollPitchYaw};
use flightcam::sample::{
    AttitudeSample, DropReason, GimbalReference, GimbalSample, Kind, Sample, Stamp, Velocity,
    VelocitySample,
};
use flightcam::transform::{MaxGap, Outcome, Transform};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

const MAX_GAP_SECONDS: f64 = 2.0;
const MAX_GAP: u64 = 2_000_000_000;
const TOLERANCE: f64 = 1e-9;

/// The model: definitions, without regard to order, cost or memory.
mod model {
    use super::*;

    pub struct Expected {
        pub derived: Vec<Derived>,
        pub outcome: Outcome,
    }

    pub struct Derived {
        pub stamp: Stamp,
        pub value: Value,
        pub tolerance: f64,
    }

    pub enum Value {
        Turn { interval: u64, turn: Rotation3<f64> },
        Orientation(Rotation3<f64>),
        Velocity(Vector3<f64>),
    }

    /// An orientation at a time, measured from something.
    type Oriented<O> = (u64, UnitQuaternion<f64>, O);

    struct Reasons {
        outside: DropReason,
        gap: DropReason,
        disagreement: DropReason,
    }

    fn orientation_at<O: Copy>(
        samples: &[Oriented<O>],
        time: u64,
        agree: impl Fn(O, O) -> bool,
        reasons: Reasons,
    ) -> Result<(UnitQuaternion<f64>, O), DropReason> {
        if let Some(exact) = samples.iter().find(|sample| sample.0 == time) {
            return Ok((exact.1, exact.2));
        }
        let before = samples.iter().filter(|s| s.0 < time).max_by_key(|s| s.0);
        let after = samples.iter().filter(|s| s.0 > time).min_by_key(|s| s.0);
        let (Some(before), Some(after)) = (before, after) else {
            return Err(reasons.outside);
        };
        if after.0 - before.0 > MAX_GAP {
            return Err(reasons.gap);
        }
        if !agree(before.2, after.2) {
            return Err(reasons.disagreement);
        }
        let fraction = (time - before.0) as f64 / (after.0 - before.0) as f64;
        let step = before.1.inverse() * after.1;
        Ok((before.1 * step.powf(fraction), before.2))
    }

    fn same_estimate(a: Option<u64>, b: Option<u64>) -> bool {
        a.is_none() || b.is_none() || a == b
    }

    fn about_z(angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
    }

    struct Heading {
        angle: f64,
        /// What rounding makes of it, radians: the closer the nose is to the vertical, the more.
        error: f64,
    }

    fn heading(drone: UnitQuaternion<f64>) -> Result<Heading, DropReason> {
        let nose = drone * Vector3::x();
        let level = nose.xy().norm();
        if level < 1e-9 {
            return Err(DropReason::UndefinedHeading);
        }
        Ok(Heading {
            angle: nose.y.atan2(nose.x),
            error: 8.0 * f64::EPSILON / level,
        })
    }

    fn is_used(camera: &Camera, sample: &Sample) -> bool {
        match sample.kind() {
            Kind::Gimbal => matches!(camera, Camera::Gimbal),
            Kind::Attitude | Kind::Velocity => true,
            _ => false,
        }
    }

    pub fn expected(camera: &Camera, samples: &[Sample]) -> Expected {
        let mut outcome = Outcome::default();
        let mut firsts: Vec<Sample> = Vec::new();
        for sample in samples.iter().filter(|sample| is_used(camera, sample)) {
            let of = |s: &Sample| (s.kind(), s.stamp().log_time);
            if firsts.iter().any(|first| of(first) == of(sample)) {
                let tally = &mut outcome.tallies[sample.kind()];
                tally.count_dropped(DropReason::DuplicateTime, 1);
            } else {
                firsts.push(*sample);
            }
        }
        let (mut attitudes, mut gimbals) = (Vec::new(), Vec::new());
        for sample in &firsts {
            let time = sample.stamp().log_time;
            match sample {
                Sample::Attitude(s) => attitudes.push((time, s.orientation, s.reset_counter)),
                Sample::Gimbal(s) => gimbals.push((time, s.orientation, s.reference)),
                _ => {}
            }
        }
        outcome.tallies[Kind::Gimbal].used = gimbals.len() as u64;

        let drone_at = |time| {
            let reasons = Reasons {
                outside: DropReason::OutsideAttitude,
                gap: DropReason::InAttitudeGap,
                disagreement: DropReason::AcrossAttitudeReset,
            };
            orientation_at(&attitudes, time, same_estimate, reasons)
        };
        let gimbal_at = |time| {
            let reasons = Reasons {
                outside: DropReason::OutsideGimbal,
                gap: DropReason::InGimbalGap,
                disagreement: DropReason::InGimbalGap,
            };
            orientation_at(&gimbals, time, |a, b| a == b, reasons)
        };
        let camera_at = |time, drone| match *camera {
            Camera::Stabilised {
                depression,
                yaw_offset,
            } => {
                let down = UnitQuaternion::from_euler_angles(0.0, -depression.radians(), 0.0);
                let Heading { angle, error } = heading(drone)?;
                Ok::<_, DropReason>((about_z(angle + yaw_offset) * down, error))
            }
            Camera::Fixed(mount) => {
                let [roll, pitch, yaw] = mount.degrees().map(f64::to_radians);
                let mount = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
                Ok((drone * mount, 0.0))
            }
            Camera::Gimbal => match gimbal_at(time)? {
                (gimbal, GimbalReference::Earth) => Ok((gimbal, 0.0)),
                (gimbal, GimbalReference::Heading) => {
                    let Heading { angle, error } = heading(drone)?;
                    Ok((about_z(angle) * gimbal, error))
                }
                (gimbal, GimbalReference::Airframe) => Ok((drone * gimbal, 0.0)),
            },
        };

        let mut derived = Vec::new();
        let mut previous: Option<(Oriented<Option<u64>>, f64)> = None;
        for sample in firsts.iter().filter(|sample| sample.kind() != Kind::Gimbal) {
            let stamp = sample.stamp();
            let time = stamp.log_time;
            let known = drone_at(time)
                .and_then(|(drone, resets)| Ok((drone, resets, camera_at(time, drone)?)));
            let tally = &mut outcome.tallies[sample.kind()];
            let (drone, resets, (camera, error)) = match known {
                Ok(known) => known,
                Err(reason) => {
                    tally.count_dropped(reason, 1);
                    continue;
                }
            };
            tally.used += 1;
            if let Sample::Velocity(sample) = sample {
                let velocity_ned = match sample.velocity {
                    Velocity::Ned(velocity) => velocity,
                    Velocity::Frd(velocity) => drone * velocity,
                };
                derived.push(Derived {
                    stamp,
                    value: Value::Velocity(camera.inverse() * velocity_ned),
                    tolerance: TOLERANCE + error * velocity_ned.norm(),
                });
                continue;
            }
            if let Some((before, error_before)) = previous.replace(((time, camera, resets), error))
            {
                let interval = time - before.0;
                if interval > MAX_GAP {
                    outcome.breaks.gaps += 1;
                } else if !same_estimate(before.2, resets) {
                    outcome.breaks.resets += 1;
                } else {
                    let turn = (before.1.inverse() * camera).to_rotation_matrix();
                    derived.push(Derived {
                        stamp,
                        value: Value::Turn { interval, turn },
                        tolerance: TOLERANCE + error_before + error,
                    });
                }
            }
            derived.push(Derived {
                stamp,
                value: Value::Orientation(camera.to_rotation_matrix()),
                tolerance: TOLERANCE + error,
            });
        }
        Expected { derived, outcome }
    }
}

fn moment() -> impl Strategy<Value = Stamp> {
    (4..150u64, prop::sample::select(vec![0, 0, 0, 0, 1_000_000])).prop_map(|(quarters, late)| {
        let log_time = quarters * 250_000_000 + late;
        Stamp {
            log_time,
            publish_time: log_time + 3,
        }
    })
}

/// Any orientation, often one with a vertical x axis.
fn orientation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    let pitch = prop_oneof![4 => -180.0..180.0, 1 => prop::sample::select(vec![-90.0, 90.0])];
    (-180.0..180.0f64, pitch, -180.0..180.0f64).prop_map(|(roll, pitch, yaw)| {
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_radians);
        RollPitchYaw { roll, pitch, yaw }.to_quaternion()
    })
}

fn any_reference() -> impl Strategy<Value = GimbalReference> {
    use GimbalReference::{Airframe, Earth, Heading};
    prop::sample::select(vec![Heading, Heading, Heading, Heading, Earth, Airframe])
}

fn any_sample() -> impl Strategy<Value = Sample> {
    let resets = prop::sample::select(vec![None, Some(0), Some(0), Some(0), Some(1)]);
    let attitude =
        (moment(), orientation(), resets).prop_map(|(stamp, orientation, reset_counter)| {
            Sample::Attitude(AttitudeSample {
                stamp,
                orientation,
                reset_counter,
            })
        });
    let vector = prop::array::uniform3(-30.0..30.0f64).prop_map(Vector3::from);
    let velocity = prop_oneof![
        vector.clone().prop_map(Velocity::Ned),
        vector.prop_map(Velocity::Frd),
    ];
    let velocity = (moment(), velocity)
        .prop_map(|(stamp, velocity)| Sample::Velocity(VelocitySample { stamp, velocity }));
    let gimbal =
        (moment(), orientation(), any_reference()).prop_map(|(stamp, orientation, reference)| {
            Sample::Gimbal(GimbalSample {
                stamp,
                orientation,
                reference,
            })
        });
    prop_oneof![attitude, velocity, gimbal]
}

/// Samples in the order that the transform wants them.
fn any_stream() -> impl Strategy<Value = Vec<Sample>> {
    prop::collection::vec(any_sample(), 0..150).prop_map(|mut samples| {
        samples.sort_by_key(|sample| (sample.stamp().log_time, sample.kind()));
        samples
    })
}

fn any_camera() -> impl Strategy<Value = Camera> {
    let depression = (-89.0..=90.0)
        .prop_map(|degrees| DepressionAngle::from_degrees(degrees).expect("in range"));
    let stabilised =
        (depression, -3.0..3.0).prop_map(|(depression, yaw_offset)| Camera::Stabilised {
            depression,
            yaw_offset,
        });
    let mount = (-180.0..180.0, -90.0..90.0, -180.0..180.0)
        .prop_map(|(roll, pitch, yaw)| Mount::from_degrees(roll, pitch, yaw).expect("in range"));
    prop_oneof![1 => stabilised, 1 => mount.prop_map(Camera::Fixed), 2 => Just(Camera::Gimbal)]
}

fn is_as_expected(actual: &Derived, expected: &model::Derived) -> bool {
    let same_value = match (actual.value, &expected.value) {
        (
            Value::RelativeRpy { interval, rpy },
            model::Value::Turn {
                interval: as_long,
                turn,
            },
        ) => {
            let error = (rpy.to_rotation().matrix() - turn.matrix()).norm();
            interval == *as_long && error < expected.tolerance
        }
        (Value::Orientation(actual), model::Value::Orientation(orientation)) => {
            (actual.matrix() - orientation.matrix()).norm() < expected.tolerance
        }
        (Value::CameraVelocity(actual), model::Value::Velocity(velocity)) => {
            (actual - velocity).norm() < expected.tolerance
        }
        _ => false,
    };
    actual.stamp == expected.stamp && same_value
}

proptest! {
    #![proptest_config(crate::support::cases(2000))]

    #[test]
    fn the_transform_gives_what_the_model_gives(camera in any_camera(), samples in any_stream()) {
        let expected = model::expected(&camera, &samples);
        let max_gap = MaxGap::from_seconds(MAX_GAP_SECONDS).expect("in range");
        let mut transform = Transform::new(camera, max_gap);
        let mut derived = Vec::new();
        for sample in &samples {
            transform.push(*sample, &mut derived);
            let now = sample.stamp().log_time;
            let due = expected.derived.iter().filter(|d| now - d.stamp.log_time.min(now) > MAX_GAP);
            let is_read = camera == Camera::Gimbal || sample.kind() != Kind::Gimbal;
            prop_assert!(!is_read || derived.len() >= due.count(), "held back longer than a gap");
        }
        let outcome = transform.finish(&mut derived);
        prop_assert_eq!(outcome.tallies, expected.outcome.tallies);
        prop_assert_eq!(outcome.breaks, expected.outcome.breaks);
        prop_assert_eq!(derived.len(), expected.derived.len());
        for (actual, expected) in derived.iter().zip(&expected.derived) {
            prop_assert!(is_as_expected(actual, expected), "{:?}", actual);
        }
    }
}
