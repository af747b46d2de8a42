use flightcam::{
    check::{
        RECEIVER_LAG,
        reading::{ANGLE_UNITS, AttitudeReading, Form, SPEED_UNITS, VectorReading},
        verdict::{Outcome, Reading, Subject, Undecided, Witness},
    },
    geometry::axes::{Axes, BodyAxes, WorldAxes},
};
use proptest::prelude::*;

use crate::support::{
    cases,
    judged_flight::{
        Written, angles_read_wrongly, attitude_reading, inverse, is_proven, only_explanation,
        ros_read_as_aerospace, scalar_last_read_as_first, verdict, yaw_from_east,
    },
    manoeuvres::{Manoeuvre, Sensors},
};

const ALL: [Manoeuvre; 8] = [
    Manoeuvre::Hover,
    Manoeuvre::Line,
    Manoeuvre::Survey,
    Manoeuvre::Free,
    Manoeuvre::Orbit,
    Manoeuvre::Wing,
    Manoeuvre::Race,
    Manoeuvre::Tail,
];

const VELOCITY: [Subject; 2] = [Subject::VelocityHorizontal, Subject::VelocityVertical];

fn axes(letters: &str) -> Axes {
    letters.parse().expect("these are axes")
}

fn read(letters: &str) -> Reading {
    Reading::Velocity(VectorReading {
        axes: axes(letters),
        unit: SPEED_UNITS[0],
    })
}

/// Sensors of all qualities: receivers, whose positions are late and coarse, and estimates, which are not late.
fn sensors() -> impl Strategy<Value = (Sensors, f64)> {
    let positions = (
        any::<bool>(),
        0.02..1.0_f64,
        0.05..0.3_f64,
        prop_oneof![Just(1.0), Just(5.0), Just(50.0)],
        prop_oneof![Just(0.0), Just(2.0)],
    );
    let velocities = (
        0.02..0.3_f64,
        prop_oneof![Just(2.0), Just(10.0), Just(50.0)],
    );
    let attitudes = (prop_oneof![Just(5.0), Just(20.0)], -0.17..0.17_f64);
    (positions, velocities, attitudes).prop_map(|(positions, velocities, attitudes)| {
        let (is_receiver, noise, late_by, position_hz, position_drift) = positions;
        let sensors = Sensors {
            position_noise: if is_receiver {
                2.0 * noise
            } else {
                noise / 2.0
            },
            position_late_by: if is_receiver { late_by } else { 0.0 },
            position_hz,
            position_drift,
            velocity_noise: velocities.0,
            velocity_hz: velocities.1,
            attitude_hz: attitudes.0,
            heading_error: attitudes.1,
            ..Sensors::default()
        };
        (sensors, if is_receiver { RECEIVER_LAG } else { 0.0 })
    })
}

proptest! {
    #![proptest_config(cases(4))]

    #[test]
    fn a_log_that_is_read_as_it_is_written_is_never_contradicted(
        place in 0..ALL.len(),
        seed in any::<u64>(),
        seconds in 20.0..60.0_f64,
        (sensors, lag_s) in sensors(),
        strongest_wind in 0.0..9.0_f64,
        is_geodetic: bool,
        read_as_body: bool,
        in_angles: bool,
        has_imu: bool,
    ) {
        let written = Written {
            sensors,
            lag_s,
            strongest_wind,
            is_geodetic,
            read_as_body,
            in_angles,
            velocity: axes(if read_as_body { "body-frd" } else { "ned" }),
            imu: has_imu.then_some([BodyAxes::FRD; 2]),
            ..Written::default()
        };
        let findings = written.judge(ALL[place], seconds, seed);
        prop_assert!(!findings.is_contradicted(), "{findings:#?}");
        prop_assert!(findings.explanations.is_empty());
    }

    #[test]
    fn no_wrong_axes_are_ever_proven_and_no_right_ones_condemned(
        place in 0..ALL.len(),
        seed in any::<u64>(),
        axes in 0..48_usize,
        (sensors, lag_s) in sensors(),
    ) {
        let actual = WorldAxes::all().nth(axes).expect("there are 48");
        let velocity = Axes::World(actual);
        let written = Written { sensors, lag_s, velocity, imu: None, ..Written::default() };
        let findings = written.judge(ALL[place], 40.0, seed);
        let letters = actual.to_string();
        let is_right = [letters.starts_with("ne"), letters.ends_with('d')];
        for (subject, is_right) in VELOCITY.into_iter().zip(is_right) {
            let verdict = verdict(&findings, subject, Witness::GeodeticPosition);
            match &verdict.outcome {
                Outcome::Proven => prop_assert!(is_right, "{letters} {verdict:#?}"),
                Outcome::Contradicted { .. } => prop_assert!(!is_right, "{letters} {verdict:#?}"),
                _ => {}
            }
        }
    }
}

#[test]
fn a_velocity_that_is_read_rightly_is_proven_by_places_on_the_globe() {
    let written = Written {
        imu: None,
        ..Written::default()
    };
    for manoeuvre in [Manoeuvre::Free, Manoeuvre::Wing] {
        let findings = written.judge(manoeuvre, 60.0, 3);
        for subject in VELOCITY {
            let verdict = verdict(&findings, subject, Witness::GeodeticPosition);
            assert!(is_proven(verdict), "{verdict:#?}");
        }
    }
    // To and fro at one height.
    let findings = written.judge(Manoeuvre::Survey, 60.0, 3);
    let horizontal = verdict(&findings, VELOCITY[0], Witness::GeodeticPosition);
    assert!(is_proven(horizontal), "{horizontal:#?}");
    let vertical = verdict(&findings, VELOCITY[1], Witness::GeodeticPosition);
    let why = Undecided::HardlyMoved { needed: 0.5 };
    assert_eq!(vertical.outcome, Outcome::Undecidable { why });
}

fn wrong_axes_are_condemned(manoeuvre: Manoeuvre, letters: &str) {
    let written = Written {
        velocity: axes(letters),
        imu: None,
        ..Written::default()
    };
    let findings = written.judge(manoeuvre, 60.0, 5);
    assert!(findings.is_contradicted(), "{letters}: {findings:#?}");
    assert_eq!(only_explanation(&findings), read(letters), "{manoeuvre:?}");
}

#[test]
fn wrong_axes_of_a_velocity_are_condemned_by_places_on_the_globe() {
    wrong_axes_are_condemned(Manoeuvre::Free, "enu");
    wrong_axes_are_condemned(Manoeuvre::Free, "body-flu");
    wrong_axes_are_condemned(Manoeuvre::Wing, "dne");
}

#[test]
#[ignore = "takes a minute unoptimised"]
fn all_wrong_axes_of_a_velocity_are_condemned_by_places_on_the_globe() {
    let body = BodyAxes::all().map(|axes| format!("body-{axes}"));
    let world = WorldAxes::all().map(|axes| axes.to_string());
    for letters in world.chain(body).filter(|letters| letters != "ned") {
        for manoeuvre in [Manoeuvre::Free, Manoeuvre::Wing] {
            wrong_axes_are_condemned(manoeuvre, &letters);
        }
    }
}

#[test]
fn a_velocity_of_the_world_read_as_the_drones_is_condemned() {
    for letters in ["ned", "body-flu"] {
        let written = Written {
            velocity: axes(letters),
            read_as_body: true,
            imu: None,
            ..Written::default()
        };
        let findings = written.judge(Manoeuvre::Free, 50.0, 2);
        assert_eq!(only_explanation(&findings), read(letters));
    }
}

#[test]
fn wrong_units_of_a_velocity_are_condemned() {
    for unit in &SPEED_UNITS[1..] {
        let written = Written {
            per_metre_per_second: unit.per_own,
            imu: None,
            ..Written::default()
        };
        let findings = written.judge(Manoeuvre::Free, 40.0, 7);
        let expected = Reading::Velocity(VectorReading {
            axes: axes("ned"),
            unit: *unit,
        });
        assert_eq!(only_explanation(&findings), expected);
    }
}

#[test]
fn metres_per_second_read_as_centimetres_per_second_are_condemned() {
    let written = Written {
        per_metre_per_second: 0.01,
        imu: None,
        ..Written::default()
    };
    let mut claims = written.claims();
    claims.velocity = Some(VectorReading {
        axes: axes("ned"),
        unit: SPEED_UNITS[1],
    });
    let findings = written.record(Manoeuvre::Free, 40.0, 7).judge(&claims);
    assert_eq!(only_explanation(&findings), read("ned"));
}

#[test]
fn positions_in_the_same_axes_prove_nothing() {
    for letters in ["ned", "enu"] {
        let written = Written {
            velocity: axes(letters),
            is_geodetic: false,
            imu: None,
            ..Written::default()
        };
        let findings = written.judge(Manoeuvre::Free, 40.0, 9);
        for subject in VELOCITY {
            let verdict = verdict(&findings, subject, Witness::LocalPosition);
            assert_eq!(verdict.outcome, Outcome::Consistent);
        }
    }
}

#[test]
fn a_drone_that_stays_where_it_is_shows_nothing() {
    for letters in ["ned", "enu", "body-flu"] {
        let written = Written {
            velocity: axes(letters),
            ..Written::default()
        };
        let findings = written.judge(Manoeuvre::Hover, 30.0, 4);
        for verdict in &findings.verdicts {
            let is_open = matches!(verdict.outcome, Outcome::Undecidable { .. });
            let is_of_gravity = verdict.subject == Subject::AttitudeTilt;
            assert!(is_open || is_of_gravity, "{verdict:#?}");
        }
    }
}

#[test]
fn a_straight_flight_does_not_tell_what_lies_across_it() {
    let findings = Written::default().judge(Manoeuvre::Line, 40.0, 4);
    let verdict = verdict(&findings, VELOCITY[0], Witness::GeodeticPosition);
    let Outcome::Undecidable {
        why: Undecided::Tied { with },
    } = &verdict.outcome
    else {
        panic!("{verdict:#?}");
    };
    assert!(with.contains(&read("nwu")), "{with:?}");
}

/// Attitudes that are read wrongly, and how they would have to be read.
fn attitudes() -> Vec<(Written, Reading)> {
    let (frd, ned) = (BodyAxes::FRD, WorldAxes::NED);
    let claimed = AttitudeReading::new(AttitudeReading::WXYZ, frd, ned);
    let angles = |swapped, opposite| {
        let unit = ANGLE_UNITS[0];
        let form = Form::Angles {
            unit,
            swapped,
            opposite,
        };
        attitude_reading(form, frd, ned)
    };
    let quaternion = |attitude| Written {
        attitude,
        ..Written::default()
    };
    let in_angles = |attitude| Written {
        in_angles: true,
        attitude,
        ..Written::default()
    };
    vec![
        (
            quaternion(ros_read_as_aerospace),
            attitude_reading(AttitudeReading::WXYZ, BodyAxes::FLU, WorldAxes::ENU),
        ),
        (
            quaternion(scalar_last_read_as_first),
            attitude_reading(AttitudeReading::XYZW, frd, ned),
        ),
        (
            quaternion(inverse),
            Reading::Attitude(AttitudeReading {
                inverse: true,
                ..claimed
            }),
        ),
        (
            quaternion(yaw_from_east),
            Reading::Attitude(AttitudeReading {
                north_deg: 90.0,
                ..claimed
            }),
        ),
        (
            in_angles(angles_read_wrongly::<0>),
            angles(false, [true, false, false]),
        ),
        (
            in_angles(angles_read_wrongly::<1>),
            angles(false, [false, true, false]),
        ),
        (
            in_angles(angles_read_wrongly::<2>),
            angles(false, [false, false, true]),
        ),
        (
            in_angles(angles_read_wrongly::<3>),
            angles(true, [false; 3]),
        ),
    ]
}

fn condemned_by_rates_and_accelerations((written, expected): (Written, Reading)) {
    let findings = written.judge(Manoeuvre::Free, 50.0, 6);
    assert!(findings.is_contradicted());
    assert_eq!(only_explanation(&findings), expected);
}

fn condemned_by_lean((written, expected): (Written, Reading)) {
    let written = Written {
        imu: None,
        has_positions: false,
        ..written
    };
    let findings = written.judge(Manoeuvre::Free, 60.0, 6);
    let verdict = verdict(&findings, Subject::AttitudeAndVelocity, Witness::Lean);
    assert!(verdict.is_contradicted(), "{expected:?}: {verdict:#?}");
    assert_eq!(only_explanation(&findings), expected);
}

#[test]
fn a_wrong_reading_of_the_attitude_is_condemned_by_rates_and_accelerations() {
    let first = attitudes().into_iter().next();
    condemned_by_rates_and_accelerations(first.expect("there is one"));
}

#[test]
fn a_wrong_reading_of_the_attitude_is_condemned_by_how_the_drone_leans() {
    attitudes()
        .into_iter()
        .step_by(3)
        .for_each(condemned_by_lean);
}

#[test]
#[ignore = "takes a minute unoptimised"]
fn all_wrong_readings_of_the_attitude_are_condemned() {
    attitudes()
        .into_iter()
        .for_each(condemned_by_rates_and_accelerations);
    attitudes().into_iter().for_each(condemned_by_lean);
}

#[test]
fn a_tailsitter_is_not_a_drone_whose_nose_is_elsewhere() {
    let written = Written {
        imu: None,
        ..Written::default()
    };
    let findings = written.judge(Manoeuvre::Tail, 60.0, 6);
    assert!(!findings.is_contradicted(), "{findings:#?}");
    let verdict = verdict(&findings, Subject::AttitudeAndVelocity, Witness::Lean);
    let Outcome::Undecidable {
        why: Undecided::Doubtful { better },
    } = &verdict.outcome
    else {
        panic!("{verdict:#?}");
    };
    let claimed = written.claims().attitude.expect("it is claimed");
    let body = "ubr".parse().expect("these are axes");
    assert_eq!(
        better,
        &[Reading::Attitude(AttitudeReading { body, ..claimed })]
    );
}

#[test]
fn attitude_and_accelerations_prove_the_axes_of_a_velocity() {
    for (letters, is_right) in [("ned", true), ("enu", false)] {
        let written = Written {
            velocity: axes(letters),
            has_positions: false,
            ..Written::default()
        };
        let findings = written.judge(Manoeuvre::Free, 40.0, 8);
        let verdict = verdict(&findings, VELOCITY[0], Witness::Inertia);
        assert_eq!(is_proven(verdict), is_right, "{verdict:#?}");
        assert_eq!(verdict.is_contradicted(), !is_right, "{verdict:#?}");
        if !is_right {
            assert_eq!(only_explanation(&findings), read(letters));
        }
    }
}

#[test]
fn what_agrees_with_a_misread_attitude_is_not_proven_if_places_deny_it() {
    let written = Written {
        velocity: axes("esd"),
        attitude: yaw_from_east,
        ..Written::default()
    };
    let findings = written.judge(Manoeuvre::Free, 40.0, 8);
    let by_inertia = verdict(&findings, VELOCITY[0], Witness::Inertia);
    assert!(!is_proven(by_inertia), "{by_inertia:#?}");
    assert!(verdict(&findings, VELOCITY[0], Witness::GeodeticPosition).is_contradicted());
    let both = findings.explanations.first().expect("there is one");
    assert_eq!(both.len(), 2, "{both:?}");
}

#[test]
fn rates_and_accelerations_in_other_axes_are_condemned() {
    let (frd, flu) = (BodyAxes::FRD, BodyAxes::FLU);
    let cases = [
        ([flu, frd], Subject::AttitudeTurns, Witness::AngularRates),
        ([frd, flu], Subject::AttitudeTilt, Witness::Gravity),
    ];
    for (imu, subject, witness) in cases {
        let written = Written {
            imu: Some(imu),
            ..Written::default()
        };
        let findings = written.judge(Manoeuvre::Free, 50.0, 1);
        assert!(
            verdict(&findings, subject, witness).is_contradicted(),
            "{findings:#?}"
        );
        // The velocity does not have to be read in another way.
        for subject in VELOCITY {
            let verdict = verdict(&findings, subject, Witness::GeodeticPosition);
            assert!(is_proven(verdict), "{verdict:#?}");
        }
    }
}

#[test]
fn what_is_found_quickly_is_what_is_contradicted() {
    let cases = [
        Written::default(),
        Written {
            velocity: axes("enu"),
            ..Written::default()
        },
        Written {
            attitude: inverse,
            ..Written::default()
        },
    ];
    for written in cases {
        let written = Written {
            imu: None,
            ..written
        };
        let recorder = written.record(Manoeuvre::Free, 40.0, 2);
        let all = recorder.judge(&written.claims());
        let certain = recorder.certain(&written.claims());
        let contradicted = all
            .verdicts
            .iter()
            .filter(|verdict| verdict.is_contradicted());
        let subjects: Vec<_> = contradicted.map(|one| (one.subject, one.witness)).collect();
        let found: Vec<_> = certain
            .verdicts
            .iter()
            .map(|one| (one.subject, one.witness))
            .collect();
        assert_eq!(found, subjects);
        assert_eq!(certain.explanations, all.explanations);
    }
}
