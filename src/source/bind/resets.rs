//! Fields that count how often an estimator moved what it takes for its place.

use super::{Binder, Slot};
use crate::{decode::value::FieldValue, source::profile::RoleFields};

/// Their names, beside a position: in PX4's `VehicleLocalPosition`, `VehicleGlobalPosition` and `VehicleOdometry`, and in
/// MAVLink's `ODOMETRY`.
///
/// Sources: <https://github.com/PX4/px4_msgs/tree/a4a9864b/msg>,
/// <https://github.com/mavlink/mavlink/blob/de1e078a/message_definitions/v1.0/common.xml>
const NAMES: [&str; 5] = [
    "xy_reset_counter",
    "z_reset_counter",
    "lat_lon_reset_counter",
    "alt_reset_counter",
    "reset_counter",
];

/// Those of them that are beside a position.
#[derive(Debug)]
pub struct ResetCounts(Vec<Slot>);

impl ResetCounts {
    /// Finds them. Beside other fields there are none.
    pub fn bind(binder: &mut Binder, fields: &RoleFields) -> Self {
        let (RoleFields::Position(_), [found, ..]) = (fields, &fields.fields()[..]) else {
            return Self(Vec::new());
        };
        let beside = found.first(found.steps().len().saturating_sub(1));
        let slots = NAMES
            .iter()
            .filter_map(|name| binder.number_if_there(&beside.child(name)));
        Self(slots.collect())
    }

    /// One number that changes when any of the counts does; `None` if there are none, or one is missing.
    pub fn read(&self, values: &[FieldValue]) -> Option<u64> {
        // The counts have eight bits.
        let mut counts = (self.0.iter()).map(|&slot| Some(values[slot].exact()?.bits()));
        let first = counts.next()?;
        counts.fold(first, |all, count| Some(all?.rotate_left(16) ^ count?))
    }
}
