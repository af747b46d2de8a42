//! How a quaternion is written.

use super::ChannelReader;
use crate::{
    sample::Kind,
    source::profile::{
        AttitudeFields, Components, GimbalFields, Orientation, RoleFields,
        convention::QuaternionOrder,
    },
};

/// How the four numbers of a quaternion are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrittenQuaternion {
    /// In this order: as a list, or as four fields.
    InOrder(QuaternionOrder),
    /// As a message with x, y, z and w.
    Named,
}

impl WrittenQuaternion {
    /// Whether the scalar part is the last of the four.
    pub fn is_scalar_last(self) -> bool {
        self != Self::InOrder(QuaternionOrder::Wxyz)
    }
}

impl ChannelReader {
    /// How an orientation of this kind is written, if it is a quaternion.
    pub fn quaternion(&self, kind: Kind) -> Option<WrittenQuaternion> {
        let role = self.roles.iter().find(|role| role.kind == kind)?;
        let orientation = match &role.readings.first()?.fields {
            RoleFields::Attitude(AttitudeFields { orientation, .. })
            | RoleFields::Gimbal(GimbalFields { orientation, .. }) => orientation,
            _ => return None,
        };
        let Orientation::Quaternion(quaternion) = orientation else {
            return None;
        };
        Some(match (&quaternion.fields, role.fields.len()) {
            (Components::Each(_), 1) => WrittenQuaternion::Named,
            _ => WrittenQuaternion::InOrder(quaternion.order),
        })
    }
}
