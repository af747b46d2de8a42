//! Where a camera looks, by how it is mounted on the drone.

use std::convert::Infallible;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

use flightcam::camera::{Camera, Mount, MountOutOfRange};
use flightcam::geometry::{DepressionAngle, RollPitchYaw, camera_orientation};
use flightcam::sample::GimbalReference::{self, Airframe, Earth, Heading};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// For what takes a handful of operations on numbers of size one.
const ROUNDING: f64 = 1e-14;

fn rpy(roll: f64, pitch: f64, yaw: f64) -> UnitQuaternion<f64> {
    RollPitchYaw { roll, pitch, yaw }.to_quaternion()
}

fn depression(degrees: f64) -> DepressionAngle {
    DepressionAngle::from_degrees(degrees).expect("a depression angle in range")
}

fn stabilised(degrees: f64, yaw_offset: f64) -> Camera {
    Camera::Stabilised {
        depression: depression(degrees),
        yaw_offset,
    }
}

fn fixed(roll: f64, pitch: f64, yaw: f64) -> Camera {
    Camera::Fixed(Mount::from_degrees(roll, pitch, yaw).expect("a mount in range"))
}

/// Where a camera that does not follow the gimbal looks.
fn orientation(camera: Camera, drone: &UnitQuaternion<f64>) -> Option<Rotation3<f64>> {
    let Ok(orientation) = camera.orientation::<Infallible>(drone, || {
        panic!("{camera:?} does not ask for the gimbal's orientation")
    });
    orientation
}

fn looks(camera: Camera, drone: &UnitQuaternion<f64>) -> Rotation3<f64> {
    orientation(camera, drone).expect("a nose that is not vertical")
}

/// Where a camera that follows the gimbal looks.
fn follows(
    drone: &UnitQuaternion<f64>,
    gimbal: UnitQuaternion<f64>,
    reference: GimbalReference,
) -> Option<Rotation3<f64>> {
    let Ok(orientation) =
        Camera::Gimbal.orientation::<Infallible>(drone, || Ok((gimbal, reference)));
    orientation
}

/// How far two orientations are apart. A norm, unlike the largest element, lets no NaN slip through.
fn distance(a: &Rotation3<f64>, b: &Rotation3<f64>) -> f64 {
    (a.matrix() - b.matrix()).norm()
}

/// Any angle, the multiples of a quarter turn included.
fn angle() -> impl Strategy<Value = f64> {
    let quarter_turns = (-2..=2i32).prop_map(|count| f64::from(count) * FRAC_PI_2);
    prop_oneof![3 => -PI..PI, 1 => quarter_turns]
}

fn attitude() -> impl Strategy<Value = UnitQuaternion<f64>> {
    (angle(), angle(), angle()).prop_map(|(roll, pitch, yaw)| rpy(roll, pitch, yaw))
}

/// An attitude whose nose heads where the yaw says, and that yaw.
fn upright_attitude() -> impl Strategy<Value = (UnitQuaternion<f64>, f64)> {
    (angle(), -1.5..1.5, angle()).prop_map(|(roll, pitch, yaw)| (rpy(roll, pitch, yaw), yaw))
}

/// The whole range: above −90° and up to 90°.
fn any_depression() -> impl Strategy<Value = f64> {
    let degrees = (-90.0..90.0f64).prop_map(|degrees| -degrees);
    prop_oneof![4 => degrees, 1 => prop::sample::select(vec![-45.0, 0.0, 45.0, 90.0])]
}

fn any_mount() -> impl Strategy<Value = Mount> {
    (-180.0..=180.0, -90.0..=90.0, -180.0..=180.0).prop_map(|(roll, pitch, yaw)| {
        Mount::from_degrees(roll, pitch, yaw).expect("a mount in range")
    })
}

proptest! {
    #![proptest_config(crate::support::cases(1000))]

    /// To the last bit, the signs of zeros included: they decide between half a turn and minus half a turn.
    #[test]
    fn a_stabilised_camera_without_offset_is_that_of_the_geometry(
        drone in attitude(),
        degrees in any_depression(),
    ) {
        let bits = |r: Rotation3<f64>| r.into_inner().map(f64::to_bits);
        let actual = orientation(stabilised(degrees, 0.0), &drone);
        let expected = camera_orientation(&drone, depression(degrees));
        prop_assert_eq!(actual.map(bits), expected.map(bits));
    }

    #[test]
    fn an_offset_turns_a_stabilised_camera_as_turning_the_drone_does(
        (drone, _) in upright_attitude(),
        degrees in any_depression(),
        offset in angle(),
    ) {
        let actual = looks(stabilised(degrees, offset), &drone);
        let turned = rpy(0.0, 0.0, offset) * drone;
        let expected = looks(stabilised(degrees, 0.0), &turned);
        let tolerance = ROUNDING / (drone * Vector3::x()).xy().norm();
        prop_assert!(distance(&actual, &expected) < tolerance);
    }

    #[test]
    fn a_gimbal_that_only_pitches_is_a_stabilised_camera(
        drone in attitude(),
        degrees in any_depression(),
    ) {
        let gimbal = rpy(0.0, -depression(degrees).radians(), 0.0);
        let actual = follows(&drone, gimbal, Heading);
        let expected = orientation(stabilised(degrees, 0.0), &drone);
        prop_assert_eq!(actual.is_some(), expected.is_some());
        for (actual, expected) in actual.into_iter().zip(expected) {
            let error = (actual.matrix() - expected.matrix()).map(f64::abs);
            prop_assert!(error.iter().all(|&error| error <= 1e-15), "{error}");
        }
    }

    #[test]
    fn gimbal_angles_from_every_reference_give_the_same_camera(
        (drone, heading) in upright_attitude(),
        camera in attitude(),
    ) {
        let expected = camera.to_rotation_matrix();
        let from_heading = rpy(0.0, 0.0, heading).inverse() * camera;
        let from_airframe = drone.inverse() * camera;
        let tolerance = ROUNDING / (drone * Vector3::x()).xy().norm();
        for (gimbal, reference) in [(camera, Earth), (from_heading, Heading), (from_airframe, Airframe)] {
            let actual = follows(&drone, gimbal, reference).expect("a heading");
            prop_assert!(distance(&actual, &expected) < tolerance, "{reference:?}");
        }
    }

    #[test]
    fn a_gimbal_at_rest_on_the_airframe_is_a_fixed_camera(drone in attitude(), mount in any_mount()) {
        let [roll, pitch, yaw] = mount.degrees().map(f64::to_radians);
        let expected = follows(&drone, rpy(roll, pitch, yaw), Airframe).expect("always defined");
        prop_assert!(distance(&looks(Camera::Fixed(mount), &drone), &expected) < ROUNDING);
    }

    #[test]
    fn a_mount_pitches_down_and_yaws_right_like_a_stabilised_camera_in_level_flight(
        heading in angle(),
        degrees in any_depression(),
        yaw in -180.0..=180.0f64,
    ) {
        let drone = rpy(0.0, 0.0, heading);
        let actual = looks(fixed(0.0, -degrees, yaw), &drone);
        let expected = looks(stabilised(degrees, yaw.to_radians()), &drone);
        prop_assert!(distance(&actual, &expected) < ROUNDING);
    }

    #[test]
    fn a_mount_turns_with_the_drone_about_all_axes(
        (drone, turn) in (attitude(), attitude()),
        mount in any_mount(),
    ) {
        let camera = Camera::Fixed(mount);
        let actual = looks(camera, &(turn * drone));
        let expected = turn.to_rotation_matrix() * looks(camera, &drone);
        prop_assert!(distance(&actual, &expected) < ROUNDING);
    }

    #[test]
    fn every_camera_is_a_right_handed_frame(
        (drone, gimbal) in (attitude(), attitude()),
        (mount, degrees, offset) in (any_mount(), any_depression(), angle()),
    ) {
        let cameras = [
            orientation(stabilised(degrees, offset), &drone),
            orientation(Camera::Fixed(mount), &drone),
            follows(&drone, gimbal, Earth),
            follows(&drone, gimbal, Heading),
            follows(&drone, gimbal, Airframe),
        ];
        for r in cameras.into_iter().flatten().map(Rotation3::into_inner) {
            prop_assert!((r.transpose() * r - Matrix3::identity()).norm() < ROUNDING);
            prop_assert!((r.determinant() - 1.0).abs() < ROUNDING);
        }
    }

    #[test]
    fn only_a_camera_that_follows_the_heading_needs_one(
        (roll, yaw) in (angle(), angle()),
        vertical in prop::sample::select(vec![-FRAC_PI_2, FRAC_PI_2]),
        (mount, gimbal) in (any_mount(), attitude()),
    ) {
        let drone = rpy(roll, vertical, yaw);
        prop_assert!(orientation(stabilised(30.0, 0.5), &drone).is_none());
        prop_assert!(follows(&drone, gimbal, Heading).is_none());
        prop_assert!(follows(&drone, gimbal, Earth).is_some());
        prop_assert!(follows(&drone, gimbal, Airframe).is_some());
        prop_assert!(orientation(Camera::Fixed(mount), &drone).is_some());
    }
}

/// The camera's axes (where it looks, right, down) in NED.
fn assert_axes(camera: Camera, drone: UnitQuaternion<f64>, axes: [[f64; 3]; 3]) {
    let expected = Matrix3::from_columns(&axes.map(Vector3::from));
    let actual = looks(camera, &drone).into_inner();
    assert!((actual - expected).norm() < ROUNDING, "{actual}");
}

#[test]
fn a_camera_offset_to_the_right_of_north_looks_east() {
    let axes = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    assert_axes(stabilised(0.0, FRAC_PI_2), rpy(0.4, 0.2, 0.0), axes);
}

#[test]
fn a_mount_pitched_by_minus_30_looks_30_degrees_down() {
    let (sin, cos) = FRAC_PI_6.sin_cos();
    let axes = [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]];
    assert_axes(fixed(0.0, -30.0, 0.0), rpy(0.0, 0.0, 0.0), axes);
}

#[test]
fn a_fixed_camera_rolls_with_the_drone() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
    assert_axes(fixed(0.0, 0.0, 0.0), rpy(FRAC_PI_2, 0.0, 0.0), axes);
    assert_axes(fixed(90.0, 0.0, 0.0), rpy(0.0, 0.0, 0.0), axes);
}

#[test]
fn a_fixed_camera_on_the_right_looks_down_when_the_drone_rolls() {
    let (sin, cos) = FRAC_PI_6.sin_cos();
    let axes = [[0.0, cos, sin], [-1.0, 0.0, 0.0], [0.0, -sin, cos]];
    assert_axes(fixed(0.0, 0.0, 90.0), rpy(FRAC_PI_6, 0.0, 0.0), axes);
}

/// Yaw about the drone's down axis is undone last, roll about the optical axis first.
#[test]
fn the_angles_of_a_mount_are_yaw_then_pitch_then_roll_about_its_own_axes() {
    let about = |axis, degrees: f64| Rotation3::from_axis_angle(&axis, degrees.to_radians());
    let expected = about(Vector3::z_axis(), 70.0)
        * about(Vector3::y_axis(), -40.0)
        * about(Vector3::x_axis(), 15.0);
    let mount = Mount::from_degrees(15.0, -40.0, 70.0).expect("in range");
    assert!(distance(&mount.to_rotation(), &expected) < ROUNDING);
}

#[test]
fn an_unknown_gimbal_orientation_is_an_unknown_camera_orientation() {
    let failed = Camera::Gimbal.orientation(&rpy(0.0, 0.0, 0.0), || Err("broken"));
    assert_eq!(failed, Err("broken"));
}

#[test]
fn a_mount_rolls_and_yaws_up_to_half_a_turn_and_pitches_up_to_a_quarter() {
    for [roll, pitch, yaw] in [[-180.0, -90.0, -180.0], [180.0, 90.0, 180.0], [0.0; 3]] {
        let mount = Mount::from_degrees(roll, pitch, yaw).expect("in range");
        assert_eq!(mount.degrees(), [roll, pitch, yaw]);
    }
    let (roll, pitch) = (180f64.next_up(), 90f64.next_up());
    for out in [[roll, 0.0, 0.0], [0.0, pitch, 0.0], [0.0, 0.0, roll]] {
        for [roll, pitch, yaw] in [out, out.map(|angle| -angle)] {
            let refused = Mount::from_degrees(roll, pitch, yaw);
            assert_eq!(refused, Err(MountOutOfRange([roll, pitch, yaw])));
        }
    }
    assert!(Mount::from_degrees(f64::NAN, 0.0, 0.0).is_err());
    assert!(Mount::from_degrees(0.0, f64::NAN, 0.0).is_err());
    assert!(Mount::from_degrees(0.0, 0.0, f64::INFINITY).is_err());
}

#[test]
fn a_mount_out_of_range_is_refused_with_the_range() {
    let refused = Mount::from_degrees(0.0, -100.5, 0.0).expect_err("out of range");
    assert_eq!(
        refused.to_string(),
        "a mount of roll 0°, pitch -100.5°, yaw 0° is out of range: roll and yaw must be from -180 to 180, \
         pitch from -90 to 90 (0,-30,0 looks ahead and 30° down)"
    );
}
