//! Where the camera is on the globe: `/camera/location`.

use foxglove::messages::{LocationFix, location_fix::PositionCovarianceType};

use super::{
    super::{
        Encoding, Format, MessageDefinition,
        cdr::Cdr,
        numbers::{without_negative_zero, without_negative_zeros},
        protobuf, ros2,
    },
    to_foxglove,
};
use crate::derived::visual::{Frame, Location};

const FIELD_TO_PLOT: Option<&str> = Some("altitude");

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            to_foxglove::definition::<LocationFix>("foxglove.LocationFix", FIELD_TO_PLOT)
        }
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "sensor_msgs/msg/NavSatFix",
            include_bytes!("../../../schemas/sensor_msgs.NavSatFix.msg"),
            FIELD_TO_PLOT,
        ),
    }
}

/// In ROS 2 there is no place for the heading and the velocity.
pub fn encode(format: &Format, time: u64, location: &Location, out: &mut Vec<u8>) {
    let [latitude, longitude, altitude] = without_negative_zeros([
        location.latitude_deg,
        location.longitude_deg,
        location.altitude,
    ]);
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            let message = LocationFix {
                timestamp: Some(to_foxglove::timestamp(time)),
                frame_id: format.frame_id(Frame::Camera).to_owned(),
                latitude,
                longitude,
                altitude,
                position_covariance: Vec::new(),
                position_covariance_type: PositionCovarianceType::Unknown.into(),
                heading: Some(without_negative_zero(location.heading)),
                velocity: location.velocity_enu.map(to_foxglove::vector),
                color: None,
                metadata: Vec::new(),
            };
            protobuf::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_header(&mut cdr, format.header(time, Frame::Camera));
            cdr.put(STATUS_FIX.to_le_bytes());
            cdr.put(SERVICE_UNKNOWN.to_le_bytes());
            cdr.put_doubles([latitude, longitude, altitude]);
            cdr.put_doubles([0.0; 9]);
            cdr.put(COVARIANCE_TYPE_UNKNOWN.to_le_bytes());
        }
    }
}

// Constants of `sensor_msgs/NavSatStatus` and `sensor_msgs/NavSatFix`.

/// Viewers show no location without a fix.
const STATUS_FIX: i8 = 0;
const SERVICE_UNKNOWN: u16 = 0;
const COVARIANCE_TYPE_UNKNOWN: u8 = 0;
