//! How the camera projects: `/camera/calibration`.

use foxglove::messages::CameraCalibration;

use super::{
    super::{Encoding, Format, MessageDefinition, cdr::Cdr, protobuf, ros2},
    to_foxglove,
};
use crate::derived::visual::{Calibration, Frame};

pub fn definition(encoding: Encoding) -> MessageDefinition {
    match encoding {
        Encoding::Protobuf | Encoding::Json => {
            to_foxglove::definition::<CameraCalibration>("foxglove.CameraCalibration", None)
        }
        Encoding::Ros2 => MessageDefinition::new(
            encoding,
            "sensor_msgs/msg/CameraInfo",
            include_bytes!("../../../schemas/sensor_msgs.CameraInfo.msg"),
            None,
        ),
    }
}

pub fn encode(format: &Format, time: u64, calibration: &Calibration, out: &mut Vec<u8>) {
    match format.encoding {
        Encoding::Protobuf | Encoding::Json => {
            let message = CameraCalibration {
                timestamp: Some(to_foxglove::timestamp(time)),
                frame_id: format.frame_id(Frame::CameraOptical).to_owned(),
                width: calibration.width,
                height: calibration.height,
                distortion_model: DISTORTION_MODEL.to_owned(),
                d: NO_DISTORTION.into(),
                k: intrinsic_matrix(calibration).into(),
                r: IDENTITY.into(),
                p: projection_matrix(calibration).into(),
            };
            protobuf::write(&message, out);
        }
        Encoding::Ros2 => {
            let mut cdr = Cdr::begin(out);
            ros2::put_header(&mut cdr, format.header(time, Frame::CameraOptical));
            cdr.put(calibration.height.to_le_bytes());
            cdr.put(calibration.width.to_le_bytes());
            cdr.put_string(DISTORTION_MODEL);
            cdr.put_length(NO_DISTORTION.len());
            cdr.put_doubles(NO_DISTORTION);
            cdr.put_doubles(intrinsic_matrix(calibration));
            cdr.put_doubles(IDENTITY);
            cdr.put_doubles(projection_matrix(calibration));
            put_whole_picture(&mut cdr);
        }
    }
}

/// OpenCV's model of radial and tangential distortion.
const DISTORTION_MODEL: &str = "plumb_bob";

const NO_DISTORTION: [f64; 5] = [0.0; 5];

// All matrices are row by row.

const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

fn intrinsic_matrix(calibration: &Calibration) -> [f64; 9] {
    let ([fx, fy], [cx, cy]) = (calibration.focal, calibration.centre);
    [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
}

fn projection_matrix(calibration: &Calibration) -> [f64; 12] {
    let ([fx, fy], [cx, cy]) = (calibration.focal, calibration.centre);
    [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]
}

/// Writes a binning and a `sensor_msgs/RegionOfInterest` that say that the picture has all pixels of the sensor.
fn put_whole_picture(cdr: &mut Cdr) {
    const BINNING: [u32; 2] = [0; 2];
    const REGION: [u32; 4] = [0; 4];
    for number in BINNING.into_iter().chain(REGION) {
        cdr.put(number.to_le_bytes());
    }
    cdr.put_bool(false);
}
