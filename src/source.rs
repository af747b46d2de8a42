//! How a log says it: the profile that fits, the channels that it names, and their messages → samples.

pub mod profile;

mod channel;
mod examples;
mod field;
mod json;
mod protobuf;
mod selection;

use std::collections::{BTreeMap, BTreeSet};

use crate::{
    error::Error,
    log::record::RawMessage,
    sample::{DropReason, Kind, Sample},
};
use channel::{ChannelSource, LargestAngles};
pub use field::FieldPath;
use profile::{AngleUnit, Orientation, Profile};

/// The telemetry of one log: which channels have it, and how to read their messages.
#[derive(Debug)]
pub struct Source {
    /// The profile that fits.
    pub profile: Profile,
    /// The topic with the attitude.
    pub attitude_topic: String,
    /// The topic with the velocity, or why there is none.
    pub velocity_topic: Result<String, String>,
    channels: BTreeMap<u16, ChannelSource>,
}

/// Why a channel's messages cannot be read as a profile says.
#[derive(Debug, thiserror::Error)]
enum Unresolved {
    #[error(
        "its messages are encoded as `{message_encoding}` with schema encoding `{schema_encoding}`; \
         flightcam reads protobuf and JSON"
    )]
    Encoding {
        message_encoding: String,
        schema_encoding: String,
    },
    #[error("{problem}")]
    Schema { problem: String },
    #[error("it has no field {}; {place} has {}", list(lacking), available.join(", "))]
    NoSuchField {
        lacking: Vec<FieldPath>,
        /// The message, or what else was searched for the first of them.
        place: String,
        available: Vec<String>,
    },
    #[error("its field `{path}` does not exist, because `{name}` is not a single message")]
    NotAMessage { path: FieldPath, name: String },
    #[error("its field `{path}` is not {wanted} but a {kind}")]
    WrongShape {
        path: FieldPath,
        wanted: &'static str,
        kind: &'static str,
    },
    #[error(transparent)]
    Unreadable(#[from] Error),
}

impl Source {
    /// What the profile found in the log, in words.
    pub fn reason(&self) -> String {
        let fields = self.profile.attitude.required_fields();
        let names: Vec<String> = fields.iter().map(FieldPath::to_string).collect();
        format!("{} has {}", self.attitude_topic, names.join(", "))
    }

    /// The channels that have telemetry.
    pub fn channel_ids(&self) -> BTreeSet<u16> {
        self.channels.keys().copied().collect()
    }

    /// Reads one message. `emit` gets a sample, or why there is none, for each kind that the channel has.
    pub fn read(
        &mut self,
        message: &RawMessage,
        emit: impl FnMut(Kind, Result<Sample, DropReason>),
    ) {
        if let Some(channel) = self.channels.get_mut(&message.channel_id) {
            channel.read(message, emit);
        }
    }

    /// What the user should look at twice, after all messages were read.
    pub fn suspicion(&self) -> Option<String> {
        let Orientation::Euler {
            unit: AngleUnit::Radians,
            ..
        } = self.profile.attitude.orientation
        else {
            return None;
        };
        let angles = self.channels.values().map(ChannelSource::largest_angles);
        let largest = angles.fold(LargestAngles::default(), LargestAngles::max);
        // A little more than a quarter and a full turn, for filters that overshoot.
        let limits = [(largest.pitch, 1.6), (largest.roll_or_yaw, 6.3)];
        let (angle, _) = limits.into_iter().find(|(angle, limit)| angle > limit)?;
        Some(format!(
            "{} has an angle of {angle:.1}, read as radians like all of its angles; \
             if they are degrees, use --profile flat-deg",
            self.attitude_topic
        ))
    }
}

fn list(fields: &[FieldPath]) -> String {
    let names: Vec<String> = fields.iter().map(|field| format!("`{field}`")).collect();
    names.join(", ")
}
