//! What viewers are shown, in types that they know: Foxglove's in protobuf, and in a ROS 2 log the corresponding ones of
//! ROS 2. A file for each kind of content says how it is written in both.
//!
//! JSON logs have Foxglove's types in protobuf, too. Only what no known type can express, the state and the numbers for
//! people, is of types of the program's own and in the encoding of the log.

mod calibration;
mod display;
mod event;
mod footprint;
mod location;
mod log;
mod odometry;
mod pose;
mod scene;
mod state;
mod transforms;

mod to_foxglove;
mod to_ros2;

use super::{Encoding, Format, MessageDefinition};
use crate::derived::visual::{Shown, Visual, VisualTopic};

/// The type of the messages on a topic, in a log whose camera motion has this encoding; `None` if they are not written.
pub fn definition(encoding: Encoding, topic: VisualTopic) -> Option<MessageDefinition> {
    Some(match topic {
        VisualTopic::StaticTransforms
        | VisualTopic::TfStatic
        | VisualTopic::Transforms
        | VisualTopic::Tf => transforms::definition(encoding),
        VisualTopic::Odometry => odometry::definition(encoding),
        VisualTopic::Pose => pose::definition(encoding),
        VisualTopic::Location => location::definition(encoding),
        VisualTopic::Model | VisualTopic::Scene | VisualTopic::Path => scene::definition(encoding),
        VisualTopic::Calibration => calibration::definition(encoding),
        VisualTopic::Footprint => footprint::definition(encoding),
        VisualTopic::Events => event::definition(encoding),
        VisualTopic::Log => return log::definition(encoding),
        VisualTopic::State => state::definition(encoding),
        VisualTopic::Display => display::definition(encoding),
    })
}

/// Appends the message to `out`.
pub fn encode(format: &Format, shown: &Shown, out: &mut Vec<u8>) {
    let time = shown.time;
    match &shown.visual {
        Visual::Transforms(transforms) | Visual::StaticTransforms(transforms) => {
            transforms::encode(format, time, transforms, out);
        }
        Visual::Odometry(odometry) => odometry::encode(format, time, odometry, out),
        Visual::Pose(pose) => pose::encode(format, time, pose, out),
        Visual::Location(location) => location::encode(format, time, location, out),
        Visual::Model(scene) | Visual::Scene(scene) | Visual::Path(scene) => {
            scene::encode(format, time, scene, out);
        }
        Visual::Calibration(calibration) => calibration::encode(format, time, calibration, out),
        Visual::Footprint(footprint) => footprint::encode(format, footprint, out),
        Visual::Event(event) => event::encode(format, time, event, out),
        Visual::Log(event) => log::encode(time, event, out),
        Visual::State(state) => state::encode(format, time, *state, out),
        Visual::Display(display) => display::encode(format, time, display, out),
    }
}
