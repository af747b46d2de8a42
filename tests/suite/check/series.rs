use flightcam::{
    check::{Claims, Oddity, Recorder, reading::AttitudeReading},
    geometry::axes::{BodyAxes, WorldAxes},
    sample::{
        AttitudeSample, GimbalReference, GimbalSample, Kind, Sample, Stamp, Velocity,
        VelocitySample,
    },
};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::support::{
    cases,
    judged_flight::{Written, scalar_last_read_as_first},
    manoeuvres::{Manoeuvre, Random},
};

fn stamp(milliseconds: u64) -> Stamp {
    let log_time = milliseconds * 1_000_000;
    Stamp {
        log_time,
        publish_time: log_time,
    }
}

fn gimbal(milliseconds: u64, pitch_deg: f64) -> Sample {
    Sample::Gimbal(GimbalSample {
        stamp: stamp(milliseconds),
        orientation: UnitQuaternion::from_euler_angles(0.0, pitch_deg.to_radians(), 0.3),
        reference: GimbalReference::Earth,
    })
}

fn attitude(milliseconds: u64, yaw_deg: f64) -> Sample {
    Sample::Attitude(AttitudeSample {
        stamp: stamp(milliseconds),
        orientation: UnitQuaternion::from_euler_angles(0.02, -0.05, yaw_deg.to_radians()),
        reset_counter: None,
    })
}

fn velocity(milliseconds: u64, north: f64) -> Sample {
    Sample::Velocity(VelocitySample {
        stamp: stamp(milliseconds),
        velocity: Velocity::Ned(Vector3::new(north, 1.0, 0.0)),
    })
}

fn oddities(samples: impl IntoIterator<Item = Sample>) -> Vec<Oddity> {
    let mut recorder = Recorder::default();
    for sample in samples {
        recorder.push(&sample);
    }
    recorder.certain(&Claims::default()).oddities
}

#[test]
fn two_gimbals_on_one_topic_are_noticed() {
    for pattern in [
        &[0, 1][..],
        &[0, 0, 1, 0, 1, 1],
        &[0, 0, 0, 0, 1],
        &[0, 1, 2],
    ] {
        let samples = (0..240).map(|place| {
            let pitch = [-28.6, -85.9, -55.0][pattern[place % pattern.len()]];
            gimbal(25 * place as u64, pitch + 0.01 * place as f64)
        });
        let found = oddities(samples);
        let [Oddity::ToAndFro { of, jumps }] = found.as_slice() else {
            panic!("{pattern:?}: {found:?}");
        };
        assert_eq!(*of, Kind::Gimbal);
        assert!(jumps.largest > 26_f64.to_radians(), "{jumps:?}");
    }
}

#[test]
fn two_drones_on_one_topic_are_noticed() {
    let attitudes = (0..100).map(|place| attitude(20 * place, [10.0, 200.0][place as usize % 2]));
    assert!(matches!(
        oddities(attitudes).as_slice(),
        [Oddity::ToAndFro {
            of: Kind::Attitude,
            ..
        }]
    ));
    let velocities = (0..100).map(|place| velocity(20 * place, [4.0, -3.0][place as usize % 2]));
    assert!(matches!(
        oddities(velocities).as_slice(),
        [Oddity::ToAndFro {
            of: Kind::Velocity,
            ..
        }]
    ));
}

#[test]
fn jumps_that_stay_are_not_several_sources() {
    // A gimbal that is told to look elsewhere, again and again; a heading that is reset.
    let samples = (0..400).map(|place| gimbal(25 * place, [-10.0, -80.0][place as usize / 5 % 2]));
    assert_eq!(oddities(samples), []);
    let samples = (0..400).map(|place| attitude(25 * place, f64::from(place as u32 / 10) * 40.0));
    assert_eq!(oddities(samples), []);
}

#[test]
fn a_few_strays_are_not_another_source() {
    let samples =
        (0..1000).map(|place| attitude(20 * place, if place % 50 == 7 { 120.0 } else { 0.0 }));
    assert_eq!(oddities(samples), []);
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn a_drone_that_rocks_is_one_drone(
        seed in any::<u64>(),
        hertz in 0.1..3.0_f64,
        degrees in 1.0..40.0_f64,
        noise in 0.0..5.0_f64,
        spacing in 20_u64..400,
    ) {
        // No faster than drones turn.
        prop_assume!(std::f64::consts::TAU * hertz * degrees < 250.0);
        let mut random = Random::new(seed);
        let samples = (0..500).map(|place| {
            let time = (place * spacing) as f64 / 1e3;
            let swing = degrees * (std::f64::consts::TAU * hertz * time).sin();
            attitude(place * spacing, swing + random.normal(noise))
        });
        prop_assert_eq!(oddities(samples), []);
    }
}

#[test]
fn samples_that_are_all_at_one_time_are_noticed() {
    let found = oddities((0..50).map(|_| attitude(5, 10.0)));
    let expected = Oddity::OneTime {
        of: Kind::Attitude,
        samples: 50,
    };
    assert_eq!(found, [expected]);
    // A few may well be.
    assert_eq!(oddities((0..5).map(|_| attitude(5, 10.0))), []);
}

fn claims(form: flightcam::check::reading::Form) -> Claims {
    Claims {
        attitude: Some(AttitudeReading::new(form, BodyAxes::FRD, WorldAxes::NED)),
        ..Claims::default()
    }
}

#[test]
fn a_scalar_that_is_plainly_in_the_other_place_is_noticed() {
    let written = Written {
        attitude: scalar_last_read_as_first,
        imu: None,
        ..Written::default()
    };
    let recorder = written.record(Manoeuvre::Survey, 90.0, 2);
    let found = recorder.certain(&claims(AttitudeReading::WXYZ)).oddities;
    let [Oddity::ScalarElsewhere { fits, .. }] = found.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!(fits.form, AttitudeReading::XYZW);
    // Read as it is written, all is well.
    let recorder = Written::default().record(Manoeuvre::Survey, 90.0, 2);
    assert_eq!(
        recorder.certain(&claims(AttitudeReading::WXYZ)).oddities,
        []
    );
}

#[test]
fn a_drone_on_its_side_and_a_gimbal_that_points_up_are_odd_but_not_wrong() {
    let mut recorder = Recorder::default();
    for place in 0..100 {
        let mut sample = attitude(20 * place, 0.0);
        if let Sample::Attitude(sample) = &mut sample {
            // A tailsitter.
            sample.orientation = UnitQuaternion::from_euler_angles(0.0, 1.5, 0.2);
        }
        recorder.push(&sample);
        recorder.push(&gimbal(20 * place, 40.0));
    }
    let claims = claims(AttitudeReading::ANGLES);
    let found = recorder.certain(&claims);
    assert!(!found.is_contradicted(), "{found:#?}");
    let expected = [
        Oddity::OnItsSide { share: 1.0 },
        Oddity::GimbalUp { share: 1.0 },
    ];
    assert_eq!(found.oddities, expected);
}
