//! What is missing, in words, with what the user can do about it.

use flightcam::{Foreign, MissingTopic};

/// A topic that is missing, and why.
pub fn missing(
    MissingTopic {
        topic,
        reason,
        positions,
        ..
    }: &MissingTopic,
) -> String {
    match positions {
        None => format!("{topic}: {reason}"),
        Some(positions) => format!("{topic}: {reason}; {}", velocity_from_position(positions)),
    }
}

/// What can be done where the log has positions on this topic, and no usable velocity.
pub fn velocity_from_position(positions: &Foreign) -> String {
    format!("--velocity-from position takes it from the positions on {positions}")
}
