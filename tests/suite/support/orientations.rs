//! Orientations in a result: the rotations that they are, and how they fit the other messages.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{ReadMessage, message::DerivedMessage};

/// Roll, pitch and yaw as turns about fixed axes, one after the other.
pub fn of_angles([roll, pitch, yaw]: [f64; 3]) -> UnitQuaternion<f64> {
    let about = UnitQuaternion::from_axis_angle;
    about(&Vector3::z_axis(), yaw)
        * about(&Vector3::y_axis(), pitch)
        * about(&Vector3::x_axis(), roll)
}

/// The rotation that an orientation is, by its quaternion.
pub fn of_quaternion(message: &DerivedMessage) -> UnitQuaternion<f64> {
    let [x, y, z, w, ..] = message.numbers[..] else {
        panic!("a quaternion in {message:?}");
    };
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// Checks what holds for each orientation by itself: the quaternion is a unit one with w ≥ 0, no zero has a sign, and the
/// angles are the same rotation.
#[track_caller]
pub fn assert_well_formed(message: &DerivedMessage) {
    let quaternion = of_quaternion(message);
    assert!((quaternion.norm() - 1.0).abs() < 1e-14, "{message:?}");
    assert!(quaternion.w >= 0.0, "{message:?}");
    let is_negative_zero = |number: &f64| *number == 0.0 && number.is_sign_negative();
    assert!(!message.numbers.iter().any(is_negative_zero), "{message:?}");
    if let [_, _, _, _, angles @ ..] = &message.numbers[..]
        && let &[roll, pitch, yaw] = angles
    {
        // At gimbal lock, roll is taken for 0.
        let tolerance = if pitch.cos() < 1e-8 { 1e-8 } else { 1e-13 };
        let turn = quaternion.inverse() * of_angles([roll, pitch, yaw]);
        assert!(turn.imag().norm() < tolerance, "{message:?}");
    }
}

/// Checks the orientations among the derived messages of a log, in the order of the file: each is well-formed and has the
/// time of its sample; each relative rotation is followed by the orientation that it ends at, and is the turn there from
/// the orientation before. Returns the times of the orientations.
#[track_caller]
pub fn check_orientations(derived: &[ReadMessage]) -> Vec<u64> {
    let mut times = Vec::new();
    let mut rotation: Option<DerivedMessage> = None;
    let mut previous: Option<UnitQuaternion<f64>> = None;
    for message in derived.iter().map(DerivedMessage::decode) {
        match message.topic.as_str() {
            "/camera/relative_rpy" => {
                assert_eq!(rotation, None, "its orientation is missing");
                rotation = Some(message);
            }
            "/camera/orientation" => {
                assert_well_formed(&message);
                let header = (message.stamp, message.frame_id.as_str());
                assert_eq!(header, (message.log_time, "ned"));
                let orientation = of_quaternion(&message);
                let before = previous.replace(orientation);
                if let Some(rotation) = rotation.take() {
                    assert_eq!(rotation.log_time, message.log_time);
                    let turn = before.expect("one before").inverse() * orientation;
                    let difference = turn.inverse() * of_angles(rotation.triple());
                    // At gimbal lock, the rotation's roll is taken for 0.
                    let error = difference.imag().norm();
                    assert!(error < 1e-8, "{rotation:?} does not lead to {message:?}");
                }
                times.push(message.log_time);
            }
            _ => {}
        }
    }
    assert_eq!(rotation, None, "its orientation is missing");
    times
}
