//! Motion that no drone makes is said: how often, where first, and the largest.

use flightcam::{
    camera::Camera,
    derived::Quantity,
    geometry::{DepressionAngle, RollPitchYaw},
    sample::{AttitudeSample, DropReason, Kind, Sample, Stamp, Velocity, VelocitySample},
    transform::{MaxGap, MinInterval, Motion, Outcome, Sighting, Transform},
};
use proptest::prelude::*;

fn stamp(seconds: f64) -> Stamp {
    let log_time = (seconds * 1e9).round() as u64;
    Stamp {
        log_time,
        publish_time: log_time,
    }
}

/// Roll, pitch and yaw in degrees.
fn attitude(seconds: f64, angles: [f64; 3]) -> Sample {
    let [roll, pitch, yaw] = angles.map(f64::to_radians);
    Sample::Attitude(AttitudeSample {
        stamp: stamp(seconds),
        orientation: RollPitchYaw { roll, pitch, yaw }.to_quaternion(),
        reset_counter: None,
    })
}

fn velocity(seconds: f64, velocity: Velocity) -> Sample {
    Sample::Velocity(VelocitySample {
        stamp: stamp(seconds),
        velocity,
    })
}

fn ned(seconds: f64, components: [f64; 3]) -> Sample {
    velocity(seconds, Velocity::Ned(components.into()))
}

/// What becomes of samples, and the times of the relative rotations.
fn outcome(samples: &[Sample], min_interval: f64) -> (Outcome, Vec<u64>) {
    let camera = Camera::Stabilised {
        depression: DepressionAngle::from_degrees(30.0).expect("an angle"),
        yaw_offset: 0.0,
    };
    let min_interval = MinInterval::from_seconds(min_interval).expect("an interval");
    let mut transform = Transform::new(camera, MaxGap::default()).thinned(min_interval);
    let mut derived = Vec::new();
    for &sample in samples {
        transform.push(sample, &mut derived);
    }
    let outcome = transform.finish(&mut derived);
    let turns = derived
        .iter()
        .filter(|one| one.quantity() == Quantity::RelativeRpy);
    let times = turns.map(|one| one.stamp.log_time).collect();
    (outcome, times)
}

fn motion(samples: &[Sample]) -> Motion {
    outcome(samples, 0.0).0.motion
}

fn seen(sighting: Option<Sighting>) -> (u64, u64, f64) {
    let Sighting {
        count,
        first,
        largest,
        ..
    } = sighting.expect("something is seen");
    (count, first, largest)
}

#[test]
fn samples_within_a_millisecond_are_a_burst() {
    let samples = [
        attitude(1.0, [0.0, 0.0, 0.0]),
        attitude(1.01, [0.0, 0.0, 1.0]),
        attitude(1.0105, [0.0, 0.0, 3.0]),
        attitude(1.0108, [0.0, 0.0, 2.0]),
        attitude(1.02, [0.0, 0.0, 2.0]),
    ];
    let motion = motion(&samples);
    let (count, first, largest) = seen(motion.bursts);
    assert_eq!((count, first), (2, 1_010_500_000));
    assert!((largest.to_degrees() - 2.0).abs() < 1e-6, "{largest}");
    let others = [motion.flips, motion.spins, motion.leaps];
    assert_eq!(others, [None; 3], "a burst is nothing else besides");
}

#[test]
fn a_camera_that_turns_where_the_drone_does_not_flips() {
    // The nose passes the vertical: the heading jumps by half a turn.
    let samples = [
        attitude(1.0, [0.0, 80.0, 20.0]),
        attitude(1.1, [0.0, 89.0, 20.0]),
        attitude(1.2, [180.0, 89.0, 200.0]),
        attitude(1.3, [180.0, 80.0, 200.0]),
    ];
    let (count, first, largest) = seen(motion(&samples).flips);
    assert_eq!((count, first), (1, 1_200_000_000));
    // Turned about the vertical by half a turn, whatever the depression.
    assert!((largest.to_degrees() - 180.0).abs() < 1e-6, "{largest}");
    // A drone that turns as much itself.
    let samples = [0.0, 120.0, 240.0].map(|yaw| attitude(1.0 + yaw / 120.0, [0.0, 0.0, yaw]));
    assert_eq!(motion(&samples), Motion::default());
}

#[test]
fn turns_and_changes_that_no_drone_makes_are_seen() {
    let samples = [
        attitude(1.0, [0.0, 0.0, 0.0]),
        ned(1.0, [3.0, 0.0, 0.0]),
        attitude(1.01, [0.0, 0.0, 19.0]),
        ned(1.01, [3.9, 0.0, 0.0]),
        attitude(1.02, [0.0, 0.0, 40.0]),
        ned(1.02, [5.0, 0.0, 0.0]),
        attitude(1.03, [0.0, 0.0, 70.0]),
        ned(1.03, [2.0, 0.0, 0.0]),
    ];
    let motion = motion(&samples);
    let (count, first, largest) = seen(motion.spins);
    assert_eq!((count, first), (2, 1_020_000_000));
    assert!((largest.to_degrees() - 3000.0).abs() < 1e-3, "{largest}");
    let (count, first, largest) = seen(motion.leaps);
    assert_eq!((count, first), (2, 1_020_000_000));
    assert!((largest - 300.0).abs() < 1e-6, "{largest}");
}

#[test]
fn a_velocity_in_the_drones_axes_does_not_leap_because_the_drone_turns() {
    let samples: Vec<Sample> = (0..40)
        .flat_map(|n| {
            let seconds = 1.0 + f64::from(n) * 0.02;
            let yaw = f64::from(n) * 30.0;
            let (sin, cos) = yaw.to_radians().sin_cos();
            // North at 20 m/s.
            let body = Velocity::Frd([20.0 * cos, -20.0 * sin, 0.0].into());
            [attitude(seconds, [0.0, 0.0, yaw]), velocity(seconds, body)]
        })
        .collect();
    assert_eq!(motion(&samples).leaps, None);
}

#[test]
fn a_minimum_interval_thins_bursts() {
    let samples: Vec<Sample> = (0..20)
        .flat_map(|n| {
            let start = 1.0 + f64::from(n) * 0.02;
            [0.0, 0.0001, 0.0004].map(|after| attitude(start + after, [0.0, 0.0, f64::from(n)]))
        })
        .collect();
    let (all, times) = outcome(&samples, 0.0);
    assert_eq!((all.tallies[Kind::Attitude].used, times.len()), (60, 59));
    let (thinned, times) = outcome(&samples, 0.001);
    assert_eq!(thinned.tallies[Kind::Attitude].used, 20);
    let dropped = &thinned.tallies[Kind::Attitude].dropped;
    assert_eq!(dropped.get(&DropReason::TooClose), Some(&40));
    assert_eq!(thinned.motion, Motion::default());
    assert_eq!(times.len(), 19);
}

proptest! {
    /// No two that are left are closer, and one that is left out is close to one that is not.
    #[test]
    fn what_is_left_keeps_its_distance(
        steps in prop::collection::vec(1_u64..3_000_000, 2..60),
        min_interval in 0_u64..4_000_000,
    ) {
        let mut time = 1_000_000_000;
        let mut expected = vec![];
        let samples: Vec<Sample> = steps.iter().map(|step| {
            time += step;
            if expected.last().is_none_or(|last| time - last >= min_interval) {
                expected.push(time);
            }
            attitude(time as f64 / 1e9, [0.0, 0.0, 0.0])
        }).collect();
        let (outcome, times) = outcome(&samples, min_interval as f64 / 1e9);
        prop_assert_eq!(&times, &expected[1..]);
        prop_assert_eq!(outcome.tallies[Kind::Attitude].total(), steps.len() as u64);
    }
}

#[test]
fn a_minimum_interval_is_a_number_of_seconds_in_range() {
    for seconds in [0.0, 1e-9, 0.001, 1000.0] {
        let interval = MinInterval::from_seconds(seconds).expect("in range");
        assert!((interval.seconds() - seconds).abs() < 1e-12);
    }
    for seconds in [-0.001, 1001.0, f64::NAN, f64::INFINITY] {
        assert!(MinInterval::from_seconds(seconds).is_err(), "{seconds}");
    }
}
