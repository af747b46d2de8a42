//! Which channels flightcam itself wrote: what is on them is derived from telemetry, and never is telemetry.
//!
//! The log's Metadata record says so, too, but it can be lost, as when another program filters or merges logs. What every
//! channel keeps is its own metadata and its schema.

use mcap::records::Channel;

use crate::{
    log::Log,
    messages::{Encoding, OWN_CHANNEL, Topic, definition},
};

/// The packages of flightcam's own types, in protobuf and JSON and in ROS 2.
const OWN_PACKAGES: [&str; 2] = ["flightcam.v1.", "flightcam_msgs/"];

/// Whether flightcam wrote a channel: the channel says so, or it has a type of flightcam's own.
pub fn is_own(log: &Log, channel: &Channel) -> bool {
    channel.metadata.contains_key(OWN_CHANNEL)
        || schema_name(log, channel)
            .is_some_and(|name| OWN_PACKAGES.iter().any(|package| name.starts_with(package)))
}

/// Whether flightcam would write messages of the same type to the same topic. A program that writes channels anew may have
/// left their metadata out, so such a channel is read only if the user names it.
pub fn is_like_own(log: &Log, channel: &Channel) -> bool {
    let Some(topic) = Topic::of_name(&channel.topic).filter(|topic| !topic.is_shared()) else {
        return false;
    };
    let name = schema_name(log, channel);
    let types = Encoding::ALL
        .into_iter()
        .filter_map(|encoding| definition(encoding, topic));
    name.is_some_and(|name| types.map(|own| own.name).any(|own| own == name))
}

fn schema_name<'a>(log: &'a Log, channel: &Channel) -> Option<&'a str> {
    let schema = log.contents.schema_of(channel)?;
    Some(schema.name.as_str())
}
