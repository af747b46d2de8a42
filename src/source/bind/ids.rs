//! Fields that tell several sources on one topic apart.

use super::{Binder, Slot};
use crate::decode::path::FieldPath;

/// A field that tells sources apart.
#[derive(Debug)]
pub struct BoundId {
    pub field: FieldPath,
    pub slot: Slot,
}

/// The names of such fields, beside a value or beside a message that it is in: those of gimbal devices, vehicles and
/// their components in MAVLink and PX4, the frames of ROS, and the usual ones of people's own loggers.
const NAMES: [&str; 26] = [
    "gimbal_device_id",
    "gimbal_id",
    "device_id",
    "system_id",
    "sysid",
    "sys_id",
    "srcSystem",
    "component_id",
    "compid",
    "comp_id",
    "srcComponent",
    "header.system_id",
    "header.component_id",
    "meta.srcSystem",
    "meta.srcComponent",
    "vehicle_id",
    "drone_id",
    "uav_id",
    "robot_id",
    "agent_id",
    "camera_id",
    "sensor_id",
    "imu_id",
    "instance",
    "child_frame_id",
    "body_frame_id",
];

/// Finds these fields around a value, and one that the profile names.
pub fn bind_ids(binder: &mut Binder, value: &FieldPath, named: Option<&FieldPath>) -> Vec<BoundId> {
    let mut ids = Vec::new();
    if let Some(field) = named.cloned()
        && let Some(slot) = binder.id_if_there(&field)
    {
        ids.push(BoundId { field, slot });
    }
    for depth in 0..value.steps().len() {
        for name in NAMES {
            let names = name.split('.');
            let field = names.fold(value.first(depth), |path, name| path.child(name));
            if let Some(slot) = binder.id_if_there(&field) {
                ids.push(BoundId { field, slot });
            }
        }
    }
    ids
}
