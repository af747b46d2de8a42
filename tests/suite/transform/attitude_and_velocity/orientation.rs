//! The orientations among what is derived.

use super::*;
use nalgebra::Matrix3;

#[test]
fn every_attitude_has_one_from_the_first_on() {
    let run = run(&[yaw(1.0, 10.0), yaw(1.1, 25.0), yaw(3.0, -5.0)]);
    assert_eq!(run.directions(), [(1.0, 10.0), (1.1, 25.0), (3.0, 355.0)]);
}

#[test]
fn it_does_not_depend_on_the_attitudes_before() {
    let after_a_gap = run(&[yaw(1.0, 0.0), yaw(9.0, 20.0)]);
    assert_eq!(after_a_gap.directions(), [(1.0, 0.0), (9.0, 20.0)]);
    assert_eq!(after_a_gap.outcome.breaks, ONE_GAP);
    let after_a_reset = run(&[reset(3, 1.0, 0.0), reset(4, 2.0, 90.0)]);
    assert_eq!(after_a_reset.directions(), [(1.0, 0.0), (2.0, 90.0)]);
    assert_eq!(after_a_reset.outcome.breaks.resets, 1);
}

#[test]
fn an_attitude_that_is_not_used_has_none() {
    let run = run(&[
        yaw(1.0, 10.0),
        nose_up(2.0, 70.0),
        yaw(3.0, 30.0),
        yaw(3.0, 50.0),
    ]);
    assert_eq!(run.directions(), [(1.0, 10.0), (3.0, 30.0)]);
    let dropped = [(DuplicateTime, 1), (UndefinedHeading, 1)];
    assert_eq!(run.dropped(Kind::Attitude), dropped);
}

#[test]
fn a_velocity_has_none() {
    let run = run(&[yaw(1.0, 10.0), north(1.5), yaw(2.0, 30.0), north(2.0)]);
    assert_eq!(run.directions(), [(1.0, 10.0), (2.0, 30.0)]);
}

#[test]
fn it_is_that_of_the_tilted_camera_in_the_axes_of_the_world() {
    let run = run_at_depression(30.0, &[yaw(1.0, 90.0)]);
    let Value::Orientation(r_ned_camera) = run.derived[0].value else {
        panic!("not an orientation: {:?}", run.derived);
    };
    // The camera's axes, in north, east, down: ahead is east and down, down is down and back west.
    let (sin, cos) = (0.5, 0.75f64.sqrt());
    let axes = [[0.0, cos, sin], [-1.0, 0.0, 0.0], [0.0, -sin, cos]];
    let expected = Matrix3::from_columns(&axes.map(Vector3::from));
    assert!((r_ned_camera.matrix() - expected).norm() < 1e-15);
}
