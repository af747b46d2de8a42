use flightcam::{
    check::{Claims, Recorder},
    sample::{
        AccelerationSample, AngularRateSample, AttitudeSample, Sample, Stamp, Velocity,
        VelocitySample,
    },
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::support::{
    judged_flight::{Written, only_explanation},
    manoeuvres::Manoeuvre,
};

/// Many hours of samples at 100 Hz.
fn record_long_flight(hours: u64) -> Recorder {
    let mut recorder = Recorder::default();
    for step in 0..hours * 360_000 {
        let log_time = step * 10_000_000;
        let stamp = Stamp {
            log_time,
            publish_time: log_time,
        };
        recorder.push(&Sample::Attitude(AttitudeSample {
            stamp,
            orientation: UnitQuaternion::identity(),
            reset_counter: None,
        }));
        recorder.push(&Sample::Velocity(VelocitySample {
            stamp,
            velocity: Velocity::Ned(Vector3::zeros()),
        }));
        let rate = Vector3::zeros();
        recorder.push(&Sample::AngularRate(AngularRateSample { stamp, rate }));
        let force = Vector3::z();
        recorder.push(&Sample::Acceleration(AccelerationSample { stamp, force }));
    }
    recorder
}

#[test]
fn the_memory_for_a_long_flight_is_bounded() {
    let used = allocation_counter::measure(|| {
        record_long_flight(1);
    });
    assert!(used.bytes_max < 12_000_000, "{used:?}");
}

#[test]
fn a_flight_of_which_stretches_are_dropped_is_judged_as_a_short_one_is() {
    let written = Written {
        velocity: "enu".parse().expect("these are axes"),
        imu: None,
        ..Written::default()
    };
    let long = written.judge(Manoeuvre::Free, 1000.0, 3);
    let short = written.judge(Manoeuvre::Free, 60.0, 3);
    assert_eq!(only_explanation(&long), only_explanation(&short));
}

#[test]
fn nothing_is_found_where_nothing_was_recorded() {
    let findings = Recorder::default().judge(&Claims::default());
    assert_eq!(findings.verdicts, []);
    assert_eq!(findings.oddities, []);
    let written = Written::default();
    let findings = Recorder::default().judge(&written.claims());
    assert!(!findings.is_contradicted());
}
