use flightcam::check::verdict::{Outcome, Reading, Subject, Undecided, Verdict, Witness};

use crate::support::{
    judged_flight::{Written, only_explanation, verdict},
    manoeuvres::{Manoeuvre, Sensors},
};

fn late_by(seconds: f64) -> Written {
    Written {
        late_by: seconds,
        imu: None,
        ..Written::default()
    }
}

fn by_places(written: &Written, manoeuvre: Manoeuvre, seed: u64) -> Verdict {
    let findings = written.judge(manoeuvre, 60.0, seed);
    verdict(&findings, Subject::VelocityTime, Witness::GeodeticPosition).clone()
}

#[test]
fn a_shift_is_measured() {
    for manoeuvre in [Manoeuvre::Survey, Manoeuvre::Free, Manoeuvre::Wing] {
        for late in [-0.2, 0.05] {
            let verdict = by_places(&late_by(late), manoeuvre, 3);
            let shift = verdict.shift.expect("it is known");
            assert!(
                (shift.late_by_s - late).abs() < 0.03,
                "{manoeuvre:?} {late}: {shift:?}"
            );
            assert!(shift.resolution_s <= 0.15, "{shift:?}");
            assert!(verdict.fits(), "{verdict:#?}");
        }
    }
}

#[test]
fn clocks_that_are_a_second_apart_are_condemned() {
    for (manoeuvre, late) in [(Manoeuvre::Survey, -1.0), (Manoeuvre::Wing, 1.0)] {
        let findings = late_by(late).judge(manoeuvre, 60.0, 4);
        let Reading::ShiftedVelocity { late_by_s } = only_explanation(&findings) else {
            panic!("{:?}", findings.explanations);
        };
        assert!(
            (late_by_s - late).abs() < 0.05,
            "{manoeuvre:?} {late}: {late_by_s}"
        );
    }
}

#[test]
fn a_receivers_lag_is_not_condemned_and_the_same_shift_of_an_estimate_is() {
    for (lag_s, is_condemned) in [(0.3, false), (0.02, true)] {
        let written = Written {
            lag_s,
            ..late_by(0.2)
        };
        let verdict = by_places(&written, Manoeuvre::Free, 5);
        assert_eq!(verdict.is_contradicted(), is_condemned, "{verdict:#?}");
    }
}

#[test]
fn a_small_shift_is_condemned_where_samples_are_close_together() {
    let written = Written {
        lag_s: 0.0,
        sensors: Sensors {
            position_hz: 25.0,
            velocity_hz: 25.0,
            position_noise: 0.05,
            ..Sensors::default()
        },
        ..late_by(0.05)
    };
    let verdict = by_places(&written, Manoeuvre::Free, 5);
    assert!(verdict.is_contradicted(), "{verdict:#?}");
}

#[test]
fn a_steady_flight_does_not_tell_times() {
    for manoeuvre in [Manoeuvre::Line, Manoeuvre::Orbit] {
        for late in [0.0, 0.2] {
            let findings = late_by(late).judge(manoeuvre, 60.0, 6);
            assert!(!findings.is_contradicted(), "{findings:#?}");
        }
    }
    let verdict = by_places(&late_by(0.0), Manoeuvre::Line, 6);
    let why = Undecided::Unresolved;
    assert_eq!(verdict.outcome, Outcome::Undecidable { why });
}

#[test]
fn attitude_and_accelerations_condemn_a_clock_too() {
    let written = Written {
        has_positions: false,
        imu: Written::default().imu,
        ..late_by(1.0)
    };
    let findings = written.judge(Manoeuvre::Free, 60.0, 7);
    let verdict = verdict(&findings, Subject::VelocityTime, Witness::Inertia);
    assert!(verdict.is_contradicted(), "{findings:#?}");
}
