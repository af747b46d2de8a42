//! A flight, written as each publisher would have recorded it: in its messages, units, frames and encodings.
//!
//! Nothing here uses flightcam. Conventions are turned by matrices written out in [`flight`], messages are
//! written by encoders of our own in [`encode`], from the publishers' own definitions in `definitions/`. Fields
//! that no profile reads are full of junk.

pub mod definition;
pub mod encode;
pub mod flight;
pub mod recorder;
pub mod recording;
pub mod simulated;

mod ardupilot;
mod dataflash;
mod dji;
mod dji_json;
mod dji_ros;
mod flat;
mod mavlink;
mod mavros;
mod nav_msgs;
mod parrot;
mod px4;
mod px4_ros2;
mod px4_ulog;
pub mod ros;
mod sdk_json;

pub use flat::reference;
pub use recording::Recording;

/// Every way to record the flight that a profile should understand.
pub fn recordings() -> Vec<Recording> {
    let groups = [
        px4_ulog::recordings(),
        px4_ros2::recordings(),
        mavros::recordings(),
        mavlink::recordings(),
        ardupilot::recordings(),
        dataflash::recordings(),
        dji::recordings(),
        dji_ros::recordings(),
        dji_json::recordings(),
        parrot::recordings(),
        nav_msgs::recordings(),
        nav_msgs::poses(),
        sdk_json::recordings(),
        flat::recordings(),
    ];
    groups.into_iter().flatten().collect()
}

/// The ways to record it that one profile should understand.
pub fn recordings_for(profile: &str) -> impl Iterator<Item = Recording> {
    recordings()
        .into_iter()
        .filter(move |recording| recording.profile == profile)
}

/// The first of them.
pub fn recording_for(profile: &str) -> Recording {
    let first = recordings_for(profile).next();
    first.unwrap_or_else(|| panic!("no recording for {profile}"))
}
