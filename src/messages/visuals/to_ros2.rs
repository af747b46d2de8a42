//! What the ROS 2 types for viewers have in common.
//!
//! The definitions are those of ROS 2's `common_interfaces`, `rcl_interfaces` and `geometry2` and of Foxglove, with
//! shorter comments, joined as rosbag2 does.

use nalgebra::{UnitQuaternion, Vector3};

use super::super::{cdr::Cdr, numbers::without_negative_zeros};
use crate::derived::visual::Pose;

/// Writes a `geometry_msgs/Vector3` or a `geometry_msgs/Point`.
#[inline]
pub fn put_vector(cdr: &mut Cdr, vector: Vector3<f64>) {
    cdr.put_doubles(without_negative_zeros(vector.into()));
}

/// Writes a `geometry_msgs/Quaternion`.
#[inline]
pub fn put_quaternion(cdr: &mut Cdr, quaternion: &UnitQuaternion<f64>) {
    cdr.put_doubles(without_negative_zeros(quaternion.coords.into()));
}

/// Writes a `geometry_msgs/Pose` or a `geometry_msgs/Transform`.
#[inline]
pub fn put_pose(cdr: &mut Cdr, pose: &Pose) {
    put_vector(cdr, pose.position);
    put_quaternion(cdr, &pose.orientation);
}
