//! What Foxglove's protobuf types have in common.

use std::borrow::Cow;

use foxglove::{
    Encode,
    messages::{self, Timestamp},
};
use nalgebra::{UnitQuaternion, Vector3};

use super::super::{
    Encoding, MessageDefinition,
    numbers::{split_seconds, without_negative_zeros},
};
use crate::derived::visual;

/// The definition of the type `M`, which has this name.
pub fn definition<M: Encode>(
    name: &'static str,
    field_to_plot: Option<&'static str>,
) -> MessageDefinition {
    let schema = M::get_schema().expect("Foxglove's types have schemas");
    let data = match schema.data {
        Cow::Borrowed(data) => data,
        // None of them is: they are constants of the crate.
        Cow::Owned(data) => data.leak(),
    };
    MessageDefinition::new(Encoding::Protobuf, name, data, field_to_plot)
}

/// A time. Foxglove's crate has none after February 2106; later ones become its last.
pub fn timestamp(nanoseconds: u64) -> Timestamp {
    let (seconds, nanoseconds) = split_seconds(nanoseconds);
    u32::try_from(seconds).map_or(Timestamp::MAX, |seconds| {
        Timestamp::new(seconds, nanoseconds)
    })
}

pub fn vector(vector: Vector3<f64>) -> messages::Vector3 {
    let [x, y, z] = without_negative_zeros(vector.into());
    messages::Vector3 { x, y, z }
}

pub fn point(point: Vector3<f64>) -> messages::Point3 {
    let [x, y, z] = without_negative_zeros(point.into());
    messages::Point3 { x, y, z }
}

pub fn quaternion(quaternion: &UnitQuaternion<f64>) -> messages::Quaternion {
    let [x, y, z, w] = without_negative_zeros(quaternion.coords.into());
    messages::Quaternion { x, y, z, w }
}

pub fn pose(pose: &visual::Pose) -> messages::Pose {
    messages::Pose {
        position: Some(vector(pose.position)),
        orientation: Some(quaternion(&pose.orientation)),
    }
}

pub fn colour(visual::Colour(channels): visual::Colour) -> messages::Color {
    let [r, g, b, a] = channels.map(f64::from);
    messages::Color { r, g, b, a }
}

pub fn key_value(key: &str, value: &str) -> messages::KeyValuePair {
    messages::KeyValuePair {
        key: key.to_owned(),
        value: value.to_owned(),
    }
}
