//! The camera's attitude: `/camera/orientation`.

use nalgebra::{Rotation3, UnitQuaternion};
use serde::Serialize;

use super::{
    Encoding, Header, MessageDefinition, cdr::Cdr, json, numbers::without_negative_zeros, protobuf,
    ros2, v1,
};
use crate::geometry::RollPitchYaw;

const NAME: &str = "flightcam.v1.CameraOrientation";

/// Cameras turn mostly in yaw.
const FIELD_TO_PLOT: Option<&str> = Some("yaw");

/// The definitions for ROS 2 are those of `common_interfaces` and `rcl_interfaces`, joined as rosbag2 does.
pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!(concat!(env!("OUT_DIR"), "/camera_orientation.bin")),
            FIELD_TO_PLOT,
        ),
        Encoding::Json => MessageDefinition::new(
            encoding,
            NAME,
            include_bytes!("../../schemas/flightcam.v1.CameraOrientation.json"),
            FIELD_TO_PLOT,
        ),
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "geometry_msgs/msg/QuaternionStamped",
            include_bytes!("../../schemas/geometry_msgs.QuaternionStamped.msg"),
            Some("quaternion.z"),
        ),
    }
}

/// In ROS 2 there is only the quaternion.
pub fn encode(
    encoding: Encoding,
    header: Header,
    r_ned_camera: &Rotation3<f64>,
    out: &mut Vec<u8>,
) {
    let [x, y, z, w] = quaternion(r_ned_camera);
    let angles = || {
        let rpy = RollPitchYaw::from_rotation(r_ned_camera);
        without_negative_zeros([rpy.roll, rpy.pitch, rpy.yaw])
    };
    match encoding {
        Encoding::Protobuf => {
            let [roll, pitch, yaw] = angles();
            let message = v1::CameraOrientation {
                timestamp: Some(protobuf::timestamp(header.time)),
                frame_id: header.frame_id.to_owned(),
                quaternion: Some(v1::camera_orientation::Quaternion { x, y, z, w }),
                roll,
                pitch,
                yaw,
            };
            protobuf::write(&message, out);
        }
        Encoding::Json => {
            let [roll, pitch, yaw] = angles();
            let message = JsonMessage {
                timestamp: json::Time::new(header.time),
                frame_id: header.frame_id,
                quaternion: JsonQuaternion { x, y, z, w },
                roll,
                pitch,
                yaw,
            };
            json::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_header(&mut cdr, header);
            for component in [x, y, z, w] {
                cdr.put(component.to_le_bytes());
            }
        }
    }
}

/// The rotation as x, y, z, w. Of the two quaternions that are the same rotation, the one with w ≥ 0.
fn quaternion(r_ned_camera: &Rotation3<f64>) -> [f64; 4] {
    let q = UnitQuaternion::from_rotation_matrix(r_ned_camera).into_inner();
    let q = if q.w < 0.0 { -q } else { q };
    without_negative_zeros(q.coords.into())
}

#[derive(Serialize)]
struct JsonMessage {
    timestamp: json::Time,
    frame_id: &'static str,
    quaternion: JsonQuaternion,
    roll: f64,
    pitch: f64,
    yaw: f64,
}

#[derive(Serialize)]
struct JsonQuaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}
