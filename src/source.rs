//! How a log says it: the profile that fits, the channels that it names, and their messages → samples.

pub mod candidates;
pub mod profile;
pub mod request;

mod alternative;
mod binder;
mod binding;
mod channel;
mod finder;
mod selection;
mod topic;

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Channel;
use serde::Serialize;

use crate::{
    decode::path::FieldPath,
    log::{Log, record::RawMessage},
    sample::{DropReason, Kind, Sample},
};
use channel::{ChannelSource, LargestAngles};
use finder::Fit;
use profile::Profile;

/// The telemetry of one log: which channels have it, and how to read their messages. Clones may read some of the
/// messages each, and be [merged](Source::merge) again.
#[derive(Debug, Clone)]
pub struct Source {
    /// The profile that fits.
    pub profile: Profile,
    /// The prefix of the vehicle's topics; empty for a vehicle without.
    pub namespace: String,
    /// Where each kind of sample comes from, or why the log has none.
    pub roles: BTreeMap<Kind, Result<RoleSource, String>>,
    /// The other profiles that were tried, the better ones first.
    pub runners_up: Vec<RunnerUp>,
    fit: Fit,
    channels: BTreeMap<u16, ChannelSource>,
}

/// Where one kind of sample comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RoleSource {
    /// The topic.
    pub topic: String,
    /// The fields of its messages.
    pub fields: Vec<FieldPath>,
}

/// A profile that was tried and not chosen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RunnerUp {
    /// As the profile calls itself.
    pub profile: String,
    /// Whether it would fit, if not as well.
    pub fits: bool,
    /// What it found, or what it did not find.
    pub reason: String,
}

/// An attitude whose angles are larger than radians can be.
#[derive(Debug, Clone, PartialEq)]
pub struct TooLarge {
    /// The attitude's topic.
    pub topic: String,
    /// The largest angle, which was read as radians like the others.
    pub angle: f64,
}

impl RoleSource {
    /// What was found, in words.
    pub fn reason(&self) -> String {
        let names: Vec<String> = self.fields.iter().map(FieldPath::to_string).collect();
        format!("{} has {}", self.topic, names.join(", "))
    }
}

impl Source {
    /// Where the attitude comes from, which no source is without.
    pub fn attitude(&self) -> &RoleSource {
        self.role(Kind::Attitude).expect("a source has an attitude")
    }

    /// The channel with the attitude; of several on its topic, the first.
    pub fn attitude_channel<'a>(&self, log: &'a Log) -> &'a Channel {
        let channels = log.contents.definitions.channels.values();
        let mut of_source =
            channels.filter(|channel| self.channels.contains_key(&channel.record.id));
        let attitude = of_source.find(|channel| channel.record.topic == self.attitude().topic);
        &attitude
            .expect("a source has a channel with the attitude")
            .record
    }

    /// Where samples of a kind come from, if from anywhere.
    pub fn role(&self, kind: Kind) -> Option<&RoleSource> {
        self.roles.get(&kind)?.as_ref().ok()
    }

    /// Why there are no samples of a kind, if there are none.
    pub fn why_missing(&self, kind: Kind) -> Option<&str> {
        self.roles.get(&kind)?.as_ref().err().map(String::as_str)
    }

    /// The channels that have telemetry.
    pub fn channel_ids(&self) -> BTreeSet<u16> {
        self.channels.keys().copied().collect()
    }

    /// Whether the times of samples are log times.
    pub fn is_in_log_time(&self) -> bool {
        self.channels.values().all(ChannelSource::is_in_log_time)
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

    /// Takes over what a clone learnt from the messages that it read.
    pub fn merge(&mut self, clone: &Self) {
        for (id, channel) in &mut self.channels {
            if let Some(clone) = clone.channels.get(id) {
                channel.merge(clone);
            }
        }
    }

    /// What the user should look at twice, after all messages were read.
    pub fn suspicion(&self) -> Option<TooLarge> {
        let angles = self.channels.values().map(ChannelSource::largest_angles);
        let largest = angles.fold(LargestAngles::default(), LargestAngles::max);
        // A little more than a quarter and a full turn, for filters that overshoot.
        let limits = [(largest.pitch, 1.6), (largest.roll_or_yaw, 6.3)];
        let (angle, _) = limits.into_iter().find(|(angle, limit)| angle > limit)?;
        let topic = self.attitude().topic.clone();
        Some(TooLarge { topic, angle })
    }
}
