use std::{f64::consts::PI, sync::OnceLock};

use flightcam::{
    check::{
        Findings, Outcome,
        verdict::{Reading, Subject, Undecided, Witness},
    },
    sample::{GimbalReference, GimbalSample, Sample, Stamp},
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::support::{
    judged_flight::{Written, verdict},
    manoeuvres::{Manoeuvre, Sensors, State, fly, measure},
};

/// How a gimbal holds the camera.
#[derive(Debug, Clone, Copy)]
enum Holds {
    /// Level, and turned with the drone.
    LevelWithHeading,
    /// Level, and towards one point of the compass.
    LevelToNorth,
    /// Not at all: it is bolted to the airframe.
    Fixed,
}

fn heading(state: &State) -> UnitQuaternion<f64> {
    let nose = state.attitude * Vector3::x();
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), nose.y.atan2(nose.x))
}

/// The camera's orientation in NED.
fn camera(holds: Holds, state: &State) -> UnitQuaternion<f64> {
    let down = UnitQuaternion::from_euler_angles(0.0, -0.6, 0.0);
    match holds {
        Holds::LevelWithHeading => heading(state) * down,
        Holds::LevelToNorth => down,
        Holds::Fixed => UnitQuaternion::from_rotation_matrix(&state.attitude) * down,
    }
}

fn angles_from(
    reference: GimbalReference,
    camera: UnitQuaternion<f64>,
    state: &State,
) -> UnitQuaternion<f64> {
    match reference {
        GimbalReference::Earth => camera,
        GimbalReference::Heading => heading(state).inverse() * camera,
        GimbalReference::Airframe => {
            UnitQuaternion::from_rotation_matrix(&state.attitude).inverse() * camera
        }
    }
}

/// A flight, and its attitudes with their times.
type Flight = (Vec<State>, Vec<(f64, UnitQuaternion<f64>)>);

fn flight() -> &'static Flight {
    static FLIGHT: OnceLock<Flight> = OnceLock::new();
    FLIGHT.get_or_init(|| {
        let sensors = Sensors {
            attitude_hz: 10.0,
            imu_hz: 0.0,
            ..Sensors::default()
        };
        let states = fly(Manoeuvre::Free, 60.0, 4.0, 11);
        let attitudes = measure(&states, sensors, 11).attitudes;
        (states, attitudes)
    })
}

/// A flight whose gimbal's angles are measured from one thing and read as if from another.
fn judge(
    holds: Holds,
    is: GimbalReference,
    read_as: GimbalReference,
    is_flipped: bool,
) -> Findings {
    let written = Written {
        imu: None,
        has_positions: false,
        ..Written::default()
    };
    let mut recorder = flightcam::check::Recorder::default();
    let (states, attitudes) = flight();
    let half_turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    for &(time, orientation) in attitudes {
        let state = &states[(time * 100.0).round() as usize];
        let log_time = 1_000_000_000 + (time * 1e9) as u64;
        let stamp = Stamp {
            log_time,
            publish_time: log_time,
        };
        let angles = angles_from(is, camera(holds, state), state);
        recorder.push(&Sample::Gimbal(GimbalSample {
            stamp,
            orientation: match is_flipped {
                true => half_turn * angles * half_turn,
                false => angles,
            },
            reference: read_as,
        }));
        recorder.push(&Sample::Attitude(flightcam::sample::AttitudeSample {
            stamp,
            orientation,
            reset_counter: None,
        }));
    }
    recorder.judge(&written.claims())
}

const REFERENCES: [GimbalReference; 3] = [
    GimbalReference::Earth,
    GimbalReference::Heading,
    GimbalReference::Airframe,
];

const ALL: [Holds; 3] = [Holds::LevelWithHeading, Holds::LevelToNorth, Holds::Fixed];

#[test]
fn a_gimbal_that_is_read_rightly_is_never_condemned() {
    for holds in ALL {
        for reference in REFERENCES {
            let findings = judge(holds, reference, reference, false);
            assert!(
                !findings.is_contradicted(),
                "{holds:?} {reference:?}: {findings:#?}"
            );
        }
    }
}

#[test]
fn no_wrong_reference_is_named() {
    for holds in ALL {
        for is in REFERENCES {
            for read_as in REFERENCES {
                let findings = judge(holds, is, read_as, false);
                for verdict in findings
                    .verdicts
                    .iter()
                    .filter(|verdict| verdict.is_contradicted())
                {
                    let Outcome::Contradicted { fits } = &verdict.outcome else {
                        continue;
                    };
                    let [
                        Reading::Gimbal {
                            reference,
                            flipped: false,
                        },
                    ] = fits.as_slice()
                    else {
                        panic!("{fits:?}");
                    };
                    let is_tilt = verdict.subject == Subject::GimbalTilt;
                    let rides = |one: GimbalReference| one == GimbalReference::Airframe;
                    let turns = |one: GimbalReference| one != GimbalReference::Earth;
                    match is_tilt {
                        true => {
                            assert_eq!(rides(*reference), rides(is), "{holds:?} {is:?} {read_as:?}")
                        }
                        false => {
                            assert_eq!(turns(*reference), turns(is), "{holds:?} {is:?} {read_as:?}")
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn joint_angles_that_are_read_from_the_horizon_are_condemned() {
    // As of a Ronin-MX under DJI's onboard SDK.
    let findings = judge(
        Holds::LevelWithHeading,
        GimbalReference::Airframe,
        GimbalReference::Earth,
        false,
    );
    let verdict = verdict(&findings, Subject::GimbalTilt, Witness::Attitude);
    let reference = GimbalReference::Airframe;
    let fits = vec![Reading::Gimbal {
        reference,
        flipped: false,
    }];
    assert_eq!(verdict.outcome, Outcome::Contradicted { fits });
}

#[test]
fn a_fixed_camera_measured_from_the_earth_is_not_on_joints() {
    let findings = judge(
        Holds::Fixed,
        GimbalReference::Earth,
        GimbalReference::Airframe,
        false,
    );
    let verdict = verdict(&findings, Subject::GimbalTilt, Witness::Attitude);
    assert!(verdict.is_contradicted(), "{verdict:#?}");
}

#[test]
fn joint_angles_with_the_opposite_signs_are_condemned() {
    let findings = judge(
        Holds::LevelWithHeading,
        GimbalReference::Airframe,
        GimbalReference::Airframe,
        true,
    );
    let verdict = verdict(&findings, Subject::GimbalTilt, Witness::Attitude);
    let fits = vec![Reading::Gimbal {
        reference: GimbalReference::Airframe,
        flipped: true,
    }];
    assert_eq!(verdict.outcome, Outcome::Contradicted { fits });
}

#[test]
fn what_a_yaw_is_measured_from_shows_when_the_drone_turns() {
    let cases = [
        // The camera turns with the drone.
        (
            Holds::LevelWithHeading,
            GimbalReference::Earth,
            GimbalReference::Heading,
        ),
        // It does not.
        (
            Holds::LevelToNorth,
            GimbalReference::Heading,
            GimbalReference::Earth,
        ),
    ];
    for (holds, is, read_as) in cases {
        let findings = judge(holds, is, read_as, false);
        let verdict = verdict(&findings, Subject::GimbalYaw, Witness::Attitude);
        let fits = vec![Reading::Gimbal {
            reference: is,
            flipped: false,
        }];
        assert_eq!(verdict.outcome, Outcome::Contradicted { fits });
    }
}

#[test]
fn a_steady_camera_does_not_tell_what_its_yaw_is_measured_from() {
    let findings = judge(
        Holds::LevelWithHeading,
        GimbalReference::Heading,
        GimbalReference::Earth,
        false,
    );
    let verdict = verdict(&findings, Subject::GimbalYaw, Witness::Attitude);
    let why = Undecided::Tied { with: Vec::new() };
    assert_eq!(verdict.outcome, Outcome::Undecidable { why });
}
