//! The camera's geometry against the reference vectors and against properties that need no reference.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use flightcam::geometry::{
    DepressionAngle, DepressionOutOfRange, RollPitchYaw, camera_orientation, relative_rpy, slerp,
    velocity_in_camera,
};
use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// For what takes a handful of operations on numbers of size one.
const ROUNDING: f64 = 1e-14;

fn rpy(roll: f64, pitch: f64, yaw: f64) -> RollPitchYaw {
    RollPitchYaw { roll, pitch, yaw }
}

fn depression(degrees: f64) -> DepressionAngle {
    DepressionAngle::from_degrees(degrees).expect("a depression angle in range")
}

/// The camera of a drone in this attitude, which must have a heading.
fn camera(drone: RollPitchYaw, depression: DepressionAngle) -> Rotation3<f64> {
    camera_orientation(&drone.to_quaternion(), depression).expect("a nose that is not vertical")
}

/// How the camera turns while a level drone turns from one heading to another.
fn relative_rpy_of_turn(depression: DepressionAngle, heading: f64, step: f64) -> RollPitchYaw {
    let before = camera(rpy(0.0, 0.0, heading), depression);
    let after = camera(rpy(0.0, 0.0, heading + step), depression);
    relative_rpy(&before, &after)
}

/// How far two matrices are apart. A norm, unlike the largest element, lets no NaN slip through.
fn distance(a: &Rotation3<f64>, b: &Rotation3<f64>) -> f64 {
    (a.matrix() - b.matrix()).norm()
}

/// The angle between two orientations, also where it is far smaller than an arc cosine can tell.
fn angle_between(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    let step = a.inverse() * b;
    2.0 * step.imag().norm().atan2(step.w.abs())
}

/// The difference of two angles modulo a full turn, −π to π.
fn angle_difference(a: f64, b: f64) -> f64 {
    (a - b + PI).rem_euclid(TAU) - PI
}

/// How far two triples are apart as numbers, each modulo a full turn.
fn triple_difference(a: RollPitchYaw, b: RollPitchYaw) -> f64 {
    let differences =
        [(a.roll, b.roll), (a.pitch, b.pitch), (a.yaw, b.yaw)].map(|(a, b)| angle_difference(a, b));
    Vector3::from(differences).norm()
}

/// The cosine of the pitch that will be extracted: at 0 is gimbal lock.
fn cos_pitch(r: &Rotation3<f64>) -> f64 {
    r[(2, 1)].hypot(r[(2, 2)])
}

/// How well an extracted triple rebuilds its rotation: to the last digits, but for gimbal lock (cos(pitch)
/// below 1e-9), where roll is taken for 0 and four numbers of that length may get the wrong sign.
fn rebuild_tolerance(r: &Rotation3<f64>) -> f64 {
    match cos_pitch(r) {
        locked if locked < 1e-9 => ROUNDING + 3.0 * locked,
        _ => ROUNDING,
    }
}

mod reference {
    use super::*;
    use serde::Deserialize;

    const TOLERANCE: f64 = 1e-9;

    #[derive(Deserialize)]
    struct Case {
        depression_rad: f64,
        drone1_rpy_rad: [f64; 3],
        drone2_rpy_rad: [f64; 3],
        velocity_ned_mps: [f64; 3],
        /// By rows.
        camera2_in_ned: [[f64; 3]; 3],
        relative_rpy_rad: [f64; 3],
        velocity_camera_mps: [f64; 3],
    }

    fn cases() -> Vec<Case> {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/vectors.json");
        let text = std::fs::read_to_string(path).expect("the reference vectors are readable");
        serde_json::from_str(&text).expect("the reference vectors are cases")
    }

    impl Case {
        fn camera(&self, [roll, pitch, yaw]: [f64; 3]) -> Rotation3<f64> {
            let depression = depression(self.depression_rad.to_degrees());
            camera(rpy(roll, pitch, yaw), depression)
        }
    }

    #[test]
    fn there_are_400_reference_cases() {
        assert_eq!(cases().len(), 400);
    }

    #[test]
    fn the_camera_looks_where_the_reference_says() {
        for (index, case) in cases().iter().enumerate() {
            let expected = Matrix3::from_fn(|row, column| case.camera2_in_ned[row][column]);
            let error = (case.camera(case.drone2_rpy_rad).matrix() - expected).norm();
            assert!(error < TOLERANCE, "case {index} is off by {error:e}");
        }
    }

    #[test]
    fn the_camera_turns_as_the_reference_says() {
        for (index, case) in cases().iter().enumerate() {
            let camera1 = case.camera(case.drone1_rpy_rad);
            let camera2 = case.camera(case.drone2_rpy_rad);
            let turn = camera1.inverse() * camera2;
            let [roll, pitch, yaw] = case.relative_rpy_rad;
            let expected = rpy(roll, pitch, yaw);
            let actual = relative_rpy(&camera1, &camera2);
            let error = if cos_pitch(&turn) < 1e-9 {
                // Many triples are right at gimbal lock: these must be the same rotation.
                distance(&actual.to_rotation(), &expected.to_rotation())
            } else {
                triple_difference(actual, expected)
            };
            assert!(error < TOLERANCE, "case {index} is off by {error:e}");
        }
    }

    #[test]
    fn velocity_in_the_camera_frame_is_as_the_reference_says() {
        for (index, case) in cases().iter().enumerate() {
            let camera2 = case.camera(case.drone2_rpy_rad);
            let actual = velocity_in_camera(&camera2, &case.velocity_ned_mps.into());
            let error = (actual - Vector3::from(case.velocity_camera_mps)).norm();
            assert!(error < TOLERANCE, "case {index} is off by {error:e}");
        }
    }
}

/// A small number of either sign and any order of magnitude.
fn hair() -> impl Strategy<Value = f64> {
    (-12.0..-1.0f64, prop::sample::select(vec![-1.0, 1.0]))
        .prop_map(|(exponent, sign)| sign * 10f64.powf(exponent))
}

/// Any angle, also exactly at and within a hair of the multiples of a quarter turn.
fn angle() -> impl Strategy<Value = f64> {
    let quarter_turns = (-2..=2i32).prop_map(|count| f64::from(count) * FRAC_PI_2);
    prop_oneof![
        3 => -PI..PI,
        1 => quarter_turns.clone(),
        1 => (quarter_turns, hair()).prop_map(|(near, hair)| near + hair),
    ]
}

fn attitude() -> impl Strategy<Value = RollPitchYaw> {
    (angle(), angle(), angle()).prop_map(|(roll, pitch, yaw)| rpy(roll, pitch, yaw))
}

/// Any attitude whose nose is not vertical.
fn attitude_with_heading() -> impl Strategy<Value = RollPitchYaw> {
    attitude().prop_filter("the nose is vertical", |drone| {
        drone.pitch.cos().abs() > 2e-9
    })
}

/// Upright: the nose heads where the yaw says.
fn upright_attitude() -> impl Strategy<Value = RollPitchYaw> {
    (angle(), -1.5..1.5, angle()).prop_map(|(roll, pitch, yaw)| rpy(roll, pitch, yaw))
}

/// The whole range: above −90° and up to 90°.
fn any_depression() -> impl Strategy<Value = DepressionAngle> {
    let degrees = prop_oneof![
        4 => (-90.0..90.0f64).prop_map(|degrees| -degrees),
        1 => prop::sample::select(vec![-89.9999, -45.0, 0.0, 45.0, 89.9999, 90.0]),
    ];
    degrees.prop_map(depression)
}

fn axis() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    (-1.0..1.0f64, -PI..PI).prop_map(|(z, longitude)| {
        let radius = (1.0 - z * z).sqrt();
        let (sin, cos) = longitude.sin_cos();
        Unit::new_normalize(Vector3::new(radius * cos, radius * sin, z))
    })
}

/// The camera by the four steps that define it: nose on the ground, tilted down, horizontal y, z downwards.
fn camera_by_construction(drone: RollPitchYaw, depression: DepressionAngle) -> Rotation3<f64> {
    let nose = drone.to_rotation() * Vector3::x();
    let ground = Vector3::new(nose.x, nose.y, 0.0);
    let down = ground.norm() * depression.radians().tan();
    let x = Vector3::new(ground.x, ground.y, down).normalize();
    let horizontal = Vector3::new(-x.y, x.x, 0.0).normalize();
    let points_down = x.cross(&horizontal).z > 0.0;
    let y = if points_down { horizontal } else { -horizontal };
    Rotation3::from_basis_unchecked(&[x, y, x.cross(&y)])
}

proptest! {
    #![proptest_config(crate::support::cases(1000))]

    #[test]
    fn a_triple_turns_about_x_then_y_then_z_of_the_fixed_axes(triple in attitude()) {
        let about = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
        let expected = about(Vector3::z_axis(), triple.yaw)
            * about(Vector3::y_axis(), triple.pitch)
            * about(Vector3::x_axis(), triple.roll);
        let by_quaternion = triple.to_quaternion().to_rotation_matrix();
        prop_assert!(distance(&triple.to_rotation(), &expected) < ROUNDING);
        prop_assert!(distance(&by_quaternion, &expected) < ROUNDING);
    }

    #[test]
    fn the_closed_form_is_the_four_step_construction(
        drone in attitude_with_heading(),
        degrees in -89.9..89.9,
    ) {
        let depression = depression(degrees);
        let error = distance(
            &camera(drone, depression),
            &camera_by_construction(drone, depression),
        );
        // The heading of a nose is known as well as its projection on the ground is long.
        let tolerance = ROUNDING / drone.pitch.cos().abs();
        prop_assert!(error < tolerance, "off by {error:e} of {tolerance:e}");
    }

    #[test]
    fn the_camera_is_a_right_handed_frame(
        drone in attitude_with_heading(),
        depression in any_depression(),
    ) {
        let r = camera(drone, depression).into_inner();
        prop_assert!((r.transpose() * r - Matrix3::identity()).norm() < ROUNDING);
        prop_assert!((r.determinant() - 1.0).abs() < ROUNDING);
    }

    #[test]
    fn the_camera_never_rolls_and_stands_upright(
        drone in attitude_with_heading(),
        depression in any_depression(),
    ) {
        let r = camera(drone, depression);
        prop_assert_eq!(r[(2, 1)], 0.0, "the right axis is horizontal");
        prop_assert_eq!(RollPitchYaw::from_rotation(&r).roll, 0.0);
        prop_assert!(r[(2, 2)] > 0.0 || depression.degrees() == 90.0, "the down axis points down");
        prop_assert!((r[(2, 0)] - depression.radians().sin()).abs() < ROUNDING, "it looks down by θ");
    }

    #[test]
    fn roll_and_pitch_of_the_drone_alone_do_not_move_the_camera(
        drone in upright_attitude(),
        depression in any_depression(),
    ) {
        let level = rpy(0.0, 0.0, drone.yaw);
        let error = distance(&camera(drone, depression), &camera(level, depression));
        prop_assert!(error < ROUNDING / drone.pitch.cos());
    }

    #[test]
    fn an_extracted_triple_rebuilds_its_rotation(
        drones in (attitude_with_heading(), attitude_with_heading()),
        depression in any_depression(),
    ) {
        let (before, after) = (camera(drones.0, depression), camera(drones.1, depression));
        let turn = before.inverse() * after;
        let error = distance(&relative_rpy(&before, &after).to_rotation(), &turn);
        prop_assert!(error < rebuild_tolerance(&turn), "off by {error:e}");
    }

    #[test]
    fn a_triple_extracted_near_gimbal_lock_rebuilds_its_rotation(
        heading in angle(),
        half_turn in prop::sample::select(vec![-PI, PI]),
        tilt in prop::sample::select(vec![-45.0, 45.0]),
        (off_step, off_tilt) in (hair(), hair()),
    ) {
        let depression = depression(tilt + off_tilt);
        let before = camera(rpy(0.0, 0.0, heading), depression);
        let after = camera(rpy(0.0, 0.0, heading + half_turn + off_step), depression);
        let turn = before.inverse() * after;
        let error = distance(&relative_rpy(&before, &after).to_rotation(), &turn);
        prop_assert!(error < rebuild_tolerance(&turn), "off by {error:e}");
    }

    #[test]
    fn a_camera_at_the_horizon_yaws_by_the_step_of_the_drone(heading in angle(), step in angle()) {
        let turn = relative_rpy_of_turn(depression(0.0), heading, step);
        prop_assert!(triple_difference(turn, rpy(0.0, 0.0, step)) < ROUNDING);
    }

    /// The camera's x axis then points down, as the axis of the drone's yaw does: the signs are the same.
    #[test]
    fn a_camera_at_nadir_rolls_by_the_step_of_the_drone(heading in angle(), step in angle()) {
        let turn = relative_rpy_of_turn(depression(90.0), heading, step);
        prop_assert!(triple_difference(turn, rpy(step, 0.0, 0.0)) < ROUNDING);
    }

    #[test]
    fn a_camera_does_not_turn_relative_to_itself(
        drone in attitude_with_heading(),
        depression in any_depression(),
    ) {
        let camera = camera(drone, depression);
        let still = rpy(0.0, 0.0, 0.0);
        prop_assert!(triple_difference(relative_rpy(&camera, &camera), still) < ROUNDING);
    }

    #[test]
    fn speed_is_the_same_in_the_camera_frame(
        drone in attitude_with_heading(),
        depression in any_depression(),
        (direction, speed) in (axis(), 0.0..100.0f64),
    ) {
        let velocity_ned = direction.into_inner() * speed;
        let velocity = velocity_in_camera(&camera(drone, depression), &velocity_ned);
        prop_assert!((velocity.norm() - speed).abs() < ROUNDING * speed.max(1.0));
    }

    #[test]
    fn there_is_no_camera_exactly_where_the_nose_is_vertical(
        roll in angle(),
        yaw in angle(),
        vertical in prop::sample::select(vec![-FRAC_PI_2, FRAC_PI_2]),
        depression in any_depression(),
    ) {
        let has_camera = |pitch| {
            camera_orientation(&rpy(roll, pitch, yaw).to_quaternion(), depression).is_some()
        };
        prop_assert!(!has_camera(vertical));
        prop_assert!(has_camera(vertical - 1e-6));
        prop_assert!(has_camera(vertical + 1e-6));
    }

    #[test]
    fn slerp_turns_by_its_fraction_of_the_angle_about_the_axis(
        drone in attitude(),
        axis in axis(),
        // Up to a hair below half a turn, where either way round is the shorter one.
        exponent in -12.0..(PI - 1e-9).log10(),
        u in prop_oneof![4 => 0.0..=1.0, 1 => Just(0.0), 1 => Just(1.0)],
    ) {
        let angle = 10f64.powf(exponent);
        let turned = |angle| drone.to_quaternion() * UnitQuaternion::from_axis_angle(&axis, angle);
        let (start, end, expected) = (turned(0.0), turned(angle), turned(u * angle));
        for end in [end, UnitQuaternion::new_unchecked(-end.into_inner())] {
            let actual = slerp(&start, &end, u);
            let error = angle_between(&actual, &expected);
            // Rounding alone: 1e-12 would let an interpolation pass that ignores such small angles.
            prop_assert!(error < 4e-15, "off by {error:e}");
            prop_assert!((actual.norm() - 1.0).abs() < 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn slerp_over_half_a_turn_goes_round_either_way(
        drone in attitude(),
        axis in axis(),
        u in 0.0..=1.0,
    ) {
        let turned = |angle| drone.to_quaternion() * UnitQuaternion::from_axis_angle(&axis, angle);
        let actual = slerp(&turned(0.0), &turned(PI), u);
        let error = [u * PI, -u * PI]
            .map(|angle| angle_between(&actual, &turned(angle)))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        prop_assert!(error < 4e-15, "off by {error:e}");
    }
}

#[test]
fn half_a_turn_rebuilds_at_every_depression_and_gimbal_lock_included() {
    for degrees in (-89..=90).map(f64::from) {
        for heading in (0..24).map(|step| f64::from(step) * PI / 12.0) {
            for step in [-PI, PI] {
                let before = camera(rpy(0.0, 0.0, heading), depression(degrees));
                let after = camera(rpy(0.0, 0.0, heading + step), depression(degrees));
                let turn = before.inverse() * after;
                let triple = relative_rpy(&before, &after);
                let error = distance(&triple.to_rotation(), &turn);
                assert!(error < 4.0 * ROUNDING, "{degrees}° is off by {error:e}");

                let locked = degrees.abs() == 45.0;
                assert_eq!(cos_pitch(&turn) < 1e-9, locked, "{degrees}°");
                if locked {
                    assert_eq!(triple.roll, 0.0);
                    let pitch = -FRAC_PI_2.copysign(degrees);
                    assert!((triple.pitch - pitch).abs() < ROUNDING);
                }
            }
        }
    }
}

#[test]
fn a_quarter_turn_of_the_drone_is_not_a_pure_yaw_of_a_tilted_camera() {
    for heading in [-180.0, -90.0, 0.0, 17.0, 90.0, 135.0f64] {
        let turn = relative_rpy_of_turn(depression(30.0), heading.to_radians(), FRAC_PI_2);
        let degrees = [turn.roll, turn.pitch, turn.yaw].map(f64::to_degrees);
        for (actual, expected) in degrees.into_iter().zip([33.7, -25.7, 73.9]) {
            assert!((actual - expected).abs() < 0.05, "{degrees:?}");
        }
    }
}

#[test]
fn a_depression_angle_is_above_minus_90_degrees_and_at_most_90() {
    for degrees in [(-90f64).next_up(), -30.0, 0.0, 90.0] {
        assert_eq!(depression(degrees).degrees(), degrees);
        assert_eq!(depression(degrees).radians(), degrees.to_radians());
    }
    for degrees in [-90.0, 90f64.next_up(), f64::INFINITY, f64::NEG_INFINITY] {
        let refused = DepressionAngle::from_degrees(degrees);
        assert_eq!(refused, Err(DepressionOutOfRange(degrees)));
    }
    assert!(DepressionAngle::from_degrees(f64::NAN).is_err());
}
