//! An orientation as it is written: the same rotation in each encoding, and as a quaternion and as angles.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

use flightcam::{
    derived::{Derived, Value},
    messages::Encoding,
    sample::Stamp,
};
use nalgebra::{Matrix3, Rotation3};
use proptest::prelude::*;

use crate::support::{
    ReadMessage,
    message::DerivedMessage,
    orientations::{assert_well_formed, of_angles, of_quaternion},
};

fn written(encoding: Encoding, r_ned_camera: Rotation3<f64>) -> DerivedMessage {
    let stamp = Stamp {
        log_time: 2_000_000_003,
        publish_time: 0,
    };
    let value = Value::Orientation(r_ned_camera);
    let mut payload = Vec::new();
    encoding.encode(&Derived { stamp, value }, &mut payload);
    DerivedMessage::decode(&ReadMessage {
        topic: "/camera/orientation".to_owned(),
        encoding: encoding.message_encoding().to_owned(),
        log_time: stamp.log_time,
        publish_time: stamp.publish_time,
        sequence: 0,
        payload,
    })
}

/// Checks what each encoding makes of a rotation. Returns the quaternion and the angles.
fn check(r_ned_camera: Rotation3<f64>) -> [f64; 7] {
    let [protobuf, json, ros2] = Encoding::ALL.map(|encoding| {
        let message = written(encoding, r_ned_camera);
        assert_well_formed(&message);
        assert_eq!((message.stamp, &*message.frame_id), (2_000_000_003, "ned"));
        let error = of_quaternion(&message).to_rotation_matrix().matrix() - r_ned_camera.matrix();
        assert!(error.norm() < 1e-14, "{message:?} is not {r_ned_camera}");
        message
            .numbers
            .into_iter()
            .map(f64::to_bits)
            .collect::<Vec<u64>>()
    });
    assert_eq!(json, protobuf);
    assert_eq!(ros2, protobuf[..4]);
    let numbers = <[u64; 7]>::try_from(protobuf).expect("a quaternion and three angles");
    numbers.map(f64::from_bits)
}

#[test]
fn the_numbers_of_simple_orientations_are_those_computed_by_hand() {
    let half = 0.5f64.sqrt();
    // To the east and 30° down: cos 45° cos 15° and sin 45° sin 15°.
    let [plus, minus] = [1.0, -1.0].map(|sign| (3f64.sqrt() + sign) / 4.0);
    for (angles, quaternion) in [
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]),
        ([0.0, 0.0, FRAC_PI_2], [0.0, 0.0, half, half]),
        ([0.0, -FRAC_PI_2, 0.0], [0.0, -half, 0.0, half]),
        ([FRAC_PI_2, 0.0, 0.0], [half, 0.0, 0.0, half]),
        ([0.0, 0.0, -FRAC_PI_2], [0.0, 0.0, -half, half]),
        ([0.0, -FRAC_PI_6, FRAC_PI_2], [minus, -minus, plus, plus]),
    ] {
        let [q @ .., roll, pitch, yaw] = check(of_angles(angles).to_rotation_matrix());
        let pairs =
            (q.into_iter().zip(quaternion)).chain([roll, pitch, yaw].into_iter().zip(angles));
        for (actual, expected) in pairs {
            assert!(
                (actual - expected).abs() < 1e-15,
                "{actual}, not {expected}"
            );
        }
    }
}

/// The rotations that map axes to axes, by matrices whose zeros have either sign.
#[test]
fn quarter_and_half_turns_have_no_negative_zeros() {
    let axes = [0, 1, 2].map(|axis| [1.0, -1.0].map(|sign| (axis, sign)));
    let axes = axes.as_flattened();
    let mut count = 0;
    for zero in [0.0, -0.0] {
        for &(x, sign_x) in axes {
            for &(y, sign_y) in axes.iter().filter(|(y, _)| *y != x) {
                let mut matrix = Matrix3::repeat(zero);
                matrix[(x, 0)] = sign_x;
                matrix[(y, 1)] = sign_y;
                let is_in_order = (x + 1) % 3 == y;
                let sign_z = if is_in_order { 1.0 } else { -1.0 };
                matrix[(3 - x - y, 2)] = sign_z * sign_x * sign_y;
                let numbers = check(Rotation3::from_matrix_unchecked(matrix));
                count += usize::from(numbers[3] == 0.0);
            }
        }
    }
    assert_eq!(count, 2 * 9, "half turns, whose w is 0");
}

/// Any angle, the multiples of a quarter turn included.
fn angle() -> impl Strategy<Value = f64> {
    let quarter_turns = (-2..=2i32).prop_map(|count| f64::from(count) * FRAC_PI_2);
    prop_oneof![3 => -PI..PI, 1 => quarter_turns]
}

proptest! {
    #![proptest_config(crate::support::cases(1000))]

    #[test]
    fn every_encoding_has_the_same_rotation_as_a_quaternion_and_as_angles(
        angles in [angle(), angle(), angle()],
    ) {
        check(of_angles(angles).to_rotation_matrix());
    }
}
