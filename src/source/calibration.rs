//! How the log says that its camera projects: the first message of a camera calibration.

use std::collections::BTreeSet;

use mcap::records::Channel;

use crate::{
    decode::{
        FirstMessages, Proof,
        field::{Shape, Wanted},
        schema::MessageSchema,
    },
    derived::visual::Calibration,
    log::{Log, ReadError},
    text::Foreign,
};

/// The types of such messages. They all have `width`, `height` and a row-major intrinsic matrix `K`, which ROS 2 calls
/// `k`: "[fx 0 cx; 0 fy cy; 0 0 1]".
///
/// Sources: <https://github.com/ros2/common_interfaces/blob/5283bd97/sensor_msgs/msg/CameraInfo.msg>,
/// <https://docs.foxglove.dev/docs/visualization/message-schemas/camera-calibration>
const TYPES: [&str; 5] = [
    "foxglove.CameraCalibration",
    "foxglove_msgs/msg/CameraCalibration",
    "foxglove_msgs/CameraCalibration",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/CameraInfo",
];

/// A calibration that a log has. Its distortion is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct LogCalibration {
    /// Where it is.
    pub topic: Foreign,
    /// Pixels in a row of a picture, and rows.
    pub size: [u32; 2],
    /// The focal length in pixels, along a row and along a column.
    pub focal: [f64; 2],
    /// The pixel on the optical axis, along a row and along a column.
    pub centre: [f64; 2],
    /// How many other topics have a calibration that differs from it.
    pub others: usize,
}

impl From<&LogCalibration> for Calibration {
    fn from(found: &LogCalibration) -> Self {
        let LogCalibration {
            size: [width, height],
            focal,
            centre,
            ..
        } = *found;
        Self {
            width,
            height,
            focal,
            centre,
        }
    }
}

impl LogCalibration {
    /// Whether another one says the same.
    fn is_same(&self, other: &Self) -> bool {
        (self.size, self.focal, self.centre) == (other.size, other.focal, other.centre)
    }
}

/// The first calibration in a log that can be used.
///
/// # Errors
/// The log cannot be read.
pub fn find(log: &Log) -> Result<Option<LogCalibration>, ReadError> {
    let channels: Vec<&Channel> = (log.contents.channels_with_messages())
        .map(|(channel, _)| channel)
        .filter(|channel| is_calibration(log, channel))
        .collect();
    let ids: BTreeSet<u16> = channels.iter().map(|channel| channel.id).collect();
    if ids.is_empty() {
        return Ok(None);
    }
    let payloads = log.first_payloads(&ids, 1)?;
    let examples = FirstMessages::new(log);
    let mut found = (channels.iter()).filter_map(|channel| {
        let first = payloads.get(&channel.id)?.first()?;
        read(log, channel, &examples, first)
    });
    let first = found.next();
    Ok(first.map(|first| LogCalibration {
        others: found.filter(|other| !other.is_same(&first)).count(),
        ..first
    }))
}

fn is_calibration(log: &Log, channel: &Channel) -> bool {
    let schema = log.contents.schema_of(channel);
    schema.is_some_and(|schema| TYPES.contains(&schema.name.as_str()))
}

/// Reads a message; `None` if it is not usable, such as one of a camera that is not calibrated, whose numbers are 0.
fn read(
    log: &Log,
    channel: &Channel,
    examples: &FirstMessages,
    message: &[u8],
) -> Option<LogCalibration> {
    let schema = log.contents.schema_of(channel);
    let schema = MessageSchema::of(channel, schema, examples, Proof::Listed).ok()?;
    let numbers = ["K", "k"].into_iter().find_map(|matrix| {
        let elements = [0, 4, 2, 5].map(|element| format!("{matrix}[{element}]"));
        let paths = ["width", "height"]
            .map(str::to_owned)
            .into_iter()
            .chain(elements);
        let wanted: Option<Vec<Wanted>> = paths
            .map(|path| {
                Some(Wanted {
                    path: path.parse().ok()?,
                    shape: Shape::Number,
                })
            })
            .collect();
        let (decoder, mut slots) = schema.decoder(&wanted?).ok()?;
        decoder.decode(message, &mut slots).ok()?;
        let numbers = slots.values[..6].iter().map(|value| value.number());
        numbers.collect::<Option<Vec<f64>>>()
    })?;
    let [width, height, fx, fy, cx, cy] = numbers[..] else {
        return None;
    };
    let is_usable = [width, height, fx, fy].iter().all(|&n| n > 0.0 && n < 1e6);
    let is_inside = (0.0..=width).contains(&cx) && (0.0..=height).contains(&cy);
    (is_usable && is_inside).then(|| LogCalibration {
        topic: (&channel.topic).into(),
        size: [width, height].map(|pixels| pixels as u32),
        focal: [fx, fy],
        centre: [cx, cy],
        others: 0,
    })
}
