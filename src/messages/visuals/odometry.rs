//! Where the camera is and how it moves: `/camera/odometry`.

use foxglove::messages;

use super::{
    super::{Encoding, Format, MessageDefinition, cdr::Cdr, protobuf, ros2},
    to_foxglove, to_ros2,
};
use crate::derived::visual::{Frame, Odometry};

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => to_foxglove::definition::<messages::Odometry>(
            "foxglove.Odometry",
            Some("pose.position.z"),
        ),
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "nav_msgs/msg/Odometry",
            include_bytes!("../../../schemas/nav_msgs.Odometry.msg"),
            Some("pose.pose.position.z"),
        ),
    }
}

pub fn encode(format: &Format, time: u64, odometry: &Odometry, out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            let message = messages::Odometry {
                timestamp: Some(to_foxglove::timestamp(time)),
                frame_id: format.frame_id(Frame::Map).to_owned(),
                body_frame_id: format.frame_id(Frame::Camera).to_owned(),
                pose: Some(to_foxglove::pose(&odometry.pose)),
                linear_velocity: Some(to_foxglove::vector(odometry.velocity)),
                angular_velocity: Some(to_foxglove::vector(odometry.angular_velocity)),
                pose_covariance: Vec::new(),
                velocity_covariance: Vec::new(),
                metadata: Vec::new(),
            };
            protobuf::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_header(&mut cdr, format.header(time, Frame::Map));
            cdr.put_string(format.frame_id(Frame::Camera));
            to_ros2::put_pose(&mut cdr, &odometry.pose);
            cdr.put_doubles(UNKNOWN_COVARIANCE);
            to_ros2::put_vector(&mut cdr, odometry.velocity);
            to_ros2::put_vector(&mut cdr, odometry.angular_velocity);
            cdr.put_doubles(UNKNOWN_COVARIANCE);
        }
    }
}

/// "A covariance matrix of all zeros will be interpreted as 'covariance unknown'". A -1 as its first number would say
/// that the pose or the velocity itself is not known. `nav_msgs/Odometry` says nothing about it; this is from
/// `sensor_msgs/Imu`.
///
/// Source: <https://github.com/ros2/common_interfaces/blob/5283bd97/sensor_msgs/msg/Imu.msg>
const UNKNOWN_COVARIANCE: [f64; 36] = [0.0; 36];
