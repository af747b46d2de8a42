//! What viewers are shown is where the camera was, looked and went, whichever way it is put.

use std::{collections::BTreeMap, f64::consts::TAU};

use flightcam::{
    camera::Camera,
    derived::{
        Value,
        visual::{Frame, Shape, Visual},
    },
    geometry::DepressionAngle,
    sample::Sample,
    visuals::Reach,
};
use nalgebra::{Point3, Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::support::{cases, showing::*};

/// Ticks per second, and samples: ticks are at the times of samples.
const RATE: f64 = 10.0;

fn looking_down(degrees: f64) -> Camera {
    Camera::Stabilised {
        depression: DepressionAngle::from_degrees(degrees).expect("it is in range"),
        yaw_offset: 0.0,
    }
}

/// Samples ten times a second: roll, pitch, yaw in degrees; velocity; position.
fn flight(moments: &[([f64; 3], [f64; 3], [f64; 3])]) -> Vec<Sample> {
    let moments = moments.iter().enumerate();
    moments
        .flat_map(|(number, &(angles, ned, place))| {
            let time = 100.0 + number as f64 / RATE;
            [
                attitude(time, angles),
                velocity(time, ned),
                local(time, place),
            ]
        })
        .collect()
}

/// Whether two vectors are the same, but for the rounding to 28 bits of what viewers are shown.
fn close(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    (a - b).norm() < 3e-8 * (1.0 + a.norm())
}

/// What is derived at one time: the orientation and the velocity.
type DerivedAt = (Option<Rotation3<f64>>, Option<Vector3<f64>>);

/// The derived orientations and velocities by their times.
fn derived(showing: &Showing) -> BTreeMap<u64, DerivedAt> {
    let mut by_time: BTreeMap<u64, DerivedAt> = BTreeMap::new();
    for derived in &showing.derived {
        let entry = by_time.entry(derived.stamp.log_time).or_default();
        match derived.value {
            Value::Orientation(r_ned_camera) => entry.0 = Some(r_ned_camera),
            Value::CameraVelocity(velocity) => entry.1 = Some(velocity),
            _ => {}
        }
    }
    by_time
}

fn moments() -> impl Strategy<Value = Vec<([f64; 3], [f64; 3], [f64; 3])>> {
    let angles = [-50.0..50.0, -50.0..50.0, -180.0..180.0];
    let velocity = [-20.0..20.0, -20.0..20.0, -5.0..5.0];
    let place = [-100.0..100.0, -100.0..100.0, -90.0..-10.0];
    prop::collection::vec((angles, velocity, place), 3..12)
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn frames_lead_from_the_map_to_where_the_camera_looks_and_goes(
        moments in moments(),
        depression in -20.0..90.0,
    ) {
        let samples = flight(&moments);
        let showing = show(&samples, looking_down(depression), &with_field_of_view());
        let mut compared = 0;
        for (time, known) in derived(&showing) {
            let (Some(r_ned_camera), Some(v_camera)) = known else { continue };
            let map_from = |frame| showing.map_from(frame, time).expect("a chain of frames");
            let axis = in_map(r_ned_camera * Vector3::x());
            let camera = map_from(Frame::Camera);
            prop_assert!(close(&(camera.rotation * Vector3::x()), &axis));
            // Right in the picture stays right, and down down.
            let optical = map_from(Frame::CameraOptical);
            prop_assert!(close(&(optical.rotation * Vector3::z()), &axis));
            prop_assert!(close(
                &(optical.rotation * Vector3::x()),
                &in_map(r_ned_camera * Vector3::y()),
            ));
            let down = (-axis.z).asin().to_degrees();
            prop_assert!((down - depression).abs() < 1e-6);
            // The velocity is the same in the map, from the camera's axes and as the log has it.
            let number = ((time - nanoseconds(100.0)) as f64 / 1e9 * RATE).round() as usize;
            let ned = Vector3::from(moments[number].1);
            prop_assert!(close(&(camera.rotation * v_camera), &in_map(ned)));
            let place = Vector3::from(moments[number].2);
            prop_assert!(close(&camera.translation.vector, &in_map(place)));
            // With each scene, which here is each tick.
            let drone_enu = map_from(Frame::DroneEnu);
            prop_assert!(close(&drone_enu.translation.vector, &in_map(place)));
            prop_assert_eq!(drone_enu.rotation, UnitQuaternion::identity());
            compared += 1;
        }
        prop_assert!(compared >= moments.len() - 1);
    }

    #[test]
    fn poses_places_and_odometry_agree_with_the_frames(moments in moments()) {
        let camera = looking_down(30.0);
        let showing = show(&flight(&moments), camera, &with_field_of_view());
        let poses = showing.all(|visual| match visual {
            Visual::Pose(pose) => Some(*pose),
            _ => None,
        });
        prop_assert_eq!(poses.len(), moments.len());
        for (time, pose) in poses {
            let composed = showing.map_from(Frame::Camera, time).expect("a chain of frames");
            prop_assert!(close(&composed.translation.vector, &pose.position));
            prop_assert!(composed.rotation.angle_to(&pose.orientation) < 1e-6);
        }
        let odometries = showing.all(|visual| match visual {
            Visual::Odometry(odometry) => Some(*odometry),
            _ => None,
        });
        prop_assert_eq!(odometries.len(), moments.len());
        for (number, (_, odometry)) in odometries.iter().enumerate() {
            let ned = Vector3::from(moments[number].1);
            let in_its_axes = odometry.pose.orientation.inverse() * in_map(ned);
            prop_assert!(close(&odometry.velocity, &in_its_axes));
        }
        // Turning as fast for the time between the neighbours leads from the one to the other.
        for window in odometries.windows(3) {
            let [(from, before), (_, here), (to, after)] = window else { unreachable!() };
            let seconds = (to - from) as f64 / 1e9;
            let turned = before.pose.orientation
                * UnitQuaternion::from_scaled_axis(here.angular_velocity * seconds);
            prop_assert!(turned.angle_to(&after.pose.orientation) < 1e-6);
        }
    }

    #[test]
    fn the_corners_of_a_footprint_are_the_corners_of_the_picture(
        moments in moments(),
        depression in 60.0..90.0,
    ) {
        let camera = looking_down(depression);
        let showing = show(&flight(&moments), camera, &with_field_of_view());
        let calibration = showing.calibration();
        let (width, height) = (f64::from(calibration.width), f64::from(calibration.height));
        let picture = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        let mut seen = 0;
        for (time, scene) in showing.scenes() {
            let Some(outline) = outline(&scene, "footprint") else { continue };
            if outline.len() != 4 {
                // Some of it is out of reach.
                continue;
            }
            let optical = showing.map_from(Frame::CameraOptical, time).expect("a chain of frames");
            for (corner, expected) in outline.iter().zip(picture) {
                let point = optical.inverse() * Point3::from(*corner);
                prop_assert!(point.z > 0.0);
                for (at, expected) in pixel(&calibration, point).into_iter().zip(expected) {
                    prop_assert!((at - expected).abs() < 0.05, "{at}, not {expected}");
                }
            }
            seen += 1;
        }
        let highest = moments.iter().map(|(_, _, place)| place[2]).fold(f64::INFINITY, f64::min);
        let take_off = moments[0].2[2];
        prop_assert!(seen > 0 || take_off - highest < 1.0);
    }

    #[test]
    fn no_footprint_is_shown_beyond_the_reach(
        moments in moments(),
        depression in -30.0..60.0,
        heights in prop::option::of(1.0..20.0),
    ) {
        let camera = looking_down(depression);
        let reach = heights.map_or(Reach::default(), |heights| {
            Reach::from_heights(heights).expect("it is in range")
        });
        let heights = heights.unwrap_or(5.0);
        let options = with_field_of_view().reach(reach);
        let showing = show(&flight(&moments), camera, &options);
        for (time, scene) in showing.scenes() {
            let drone = showing.map_from(Frame::Drone, time).expect("a chain of frames");
            let drone = drone.translation.vector;
            for corner in outline(&scene, "footprint").into_iter().flatten() {
                let height = drone.z - corner.z;
                prop_assert!(height > 0.0);
                // The circle is a polygon of 32 corners around it.
                let reach = heights * height / (TAU / 64.0).cos();
                prop_assert!((corner - drone).xy().norm() <= reach * (1.0 + 1e-6));
            }
        }
    }
}

#[test]
fn a_flight_north_looks_north_and_down_in_the_map() {
    let north = ([0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, -40.0]);
    let showing = show(
        &flight(&[north; 4]),
        looking_down(30.0),
        &with_field_of_view(),
    );
    let camera = showing.map_from(Frame::Camera, u64::MAX).expect("a chain");
    let axis = camera.rotation * Vector3::x();
    let expected = Vector3::new(0.0, 30f64.to_radians().cos(), -0.5);
    assert!(close(&axis, &expected), "{axis}");
    // Right in the picture is east.
    assert!(close(&(camera.rotation * Vector3::y()), &Vector3::x()));
    assert!(close(
        &camera.translation.vector,
        &Vector3::new(0.0, 0.0, 40.0)
    ));
    // Up is up: the drone's down axis points down.
    let drone = showing.map_from(Frame::Drone, u64::MAX).expect("a chain");
    assert!(close(&(drone.rotation * Vector3::z()), &-Vector3::z()));
}

#[test]
fn the_middle_of_the_frustum_is_the_optical_axis() {
    let moment = ([3.0, 4.0, 50.0], [5.0, 1.0, 0.0], [0.0, 0.0, -40.0]);
    let showing = show(
        &flight(&[moment; 3]),
        looking_down(30.0),
        &with_field_of_view(),
    );
    let model = showing.only(|visual| match visual {
        Visual::Model(model) => Some(model.clone()),
        _ => None,
    });
    let frustum = model.entities.iter().find(|entity| entity.id == "frustum");
    let frustum = frustum.expect("a frustum");
    assert_eq!(
        (frustum.frame, frustum.is_frame_locked),
        (Frame::Camera, true)
    );
    let corners = frustum.shapes.iter().find_map(|shape| match shape {
        Shape::Lines { points, join, .. } if format!("{join:?}") == "Loop" => Some(points.clone()),
        _ => None,
    });
    let corners = corners.expect("the far side");
    let middle = corners.iter().sum::<Vector3<f64>>() / 4.0;
    assert!(close(&middle.normalize(), &Vector3::x()), "{middle}");
    // Its corners are where the calibration has the corners of the picture.
    let calibration = showing.calibration();
    for (corner, expected) in corners.iter().zip([
        [0.0, 0.0],
        [f64::from(calibration.width), 0.0],
        [f64::from(calibration.width), f64::from(calibration.height)],
        [0.0, f64::from(calibration.height)],
    ]) {
        // From where it looks, right, down to right, down, where it looks.
        let optical = Point3::new(corner.y, corner.z, corner.x);
        let at = pixel(&calibration, optical);
        assert!((at[0] - expected[0]).abs() < 1e-6 && (at[1] - expected[1]).abs() < 1e-6);
    }
    let [wide, high] = calibration.field_of_view_deg();
    assert!((wide - 70.0).abs() < 1e-9 && (high - 50.0).abs() < 1e-9);
}

#[test]
fn the_heading_on_the_map_is_the_cameras() {
    for (yaw, heading) in [
        (0.0, 0.0),
        (90.0, 90.0),
        (-90.0, 270.0),
        (179.0, 179.0),
        (-1.0, 359.0),
    ] {
        let mut samples = Vec::new();
        for number in 0..4 {
            let time = 100.0 + f64::from(number) / RATE;
            samples.push(attitude(time, [0.0, 0.0, yaw]));
            samples.push(velocity(time, [1.0, 2.0, -3.0]));
            samples.push(geodetic(time, [47.0, 8.0, 500.0]));
        }
        let showing = show(&samples, looking_down(30.0), &with_field_of_view());
        let locations = showing.all(|visual| match visual {
            Visual::Location(location) => Some(*location),
            _ => None,
        });
        assert!(!locations.is_empty());
        for (_, location) in locations {
            assert!((location.heading - f64::to_radians(heading)).abs() < 1e-9);
            let velocity = location.velocity_enu.expect("a velocity");
            assert!(close(&velocity, &Vector3::new(2.0, 1.0, 3.0)));
            assert!((location.latitude_deg - 47.0).abs() < 1e-12);
            assert!((location.longitude_deg - 8.0).abs() < 1e-12);
            assert_eq!(location.altitude, 500.0);
        }
        let displays = showing.all(|visual| match visual {
            Visual::Display(display) => Some(*display),
            _ => None,
        });
        for (_, display) in displays {
            assert!((f64::from(display.heading) - heading).abs() < 1e-4);
            assert!((display.tilt + 30.0).abs() < 1e-4);
            assert!(display.roll.abs() < 1e-4);
            let close = |number: Option<f32>, expected: f64| {
                (f64::from(number.expect("a number")) - expected).abs() < 1e-5
            };
            assert!(close(display.speed, 14f64.sqrt()));
            assert!(close(display.ground_speed, 5f64.sqrt()));
            assert!(close(display.climb, 3.0));
            assert!(close(display.height, 0.0));
        }
    }
}

#[test]
fn a_turn_to_the_right_is_a_positive_rate_and_the_unwrapped_heading_goes_on() {
    let mut samples = Vec::new();
    for number in 0..80 {
        let time = 100.0 + f64::from(number) / RATE;
        samples.push(attitude(time, [0.0, 0.0, 300.0 + 9.0 * f64::from(number)]));
    }
    let showing = show(&samples, looking_down(0.0), &with_field_of_view());
    let displays = showing.all(|visual| match visual {
        Visual::Display(display) => Some(*display),
        _ => None,
    });
    assert_eq!(displays.len(), 80);
    for (number, (_, display)) in displays.iter().enumerate() {
        let unwrapped = 300.0 + 9.0 * number as f32;
        assert!((display.heading_unwrapped - unwrapped).abs() < 1e-3);
        assert!((display.heading - unwrapped.rem_euclid(360.0)).abs() < 1e-3);
        let [roll, pitch, yaw] = display.rates.expect("it is known how fast it turns");
        assert!(roll.abs() < 1e-3 && pitch.abs() < 1e-3 && (yaw - 90.0).abs() < 1e-3);
    }
}
