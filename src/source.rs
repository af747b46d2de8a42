//! A log's telemetry: the profile that fits, the channels that it names, and their messages → samples.

pub mod calibration;
pub mod error;
pub mod profile;
pub mod request;
pub mod stream_filter;
pub mod undecodable;

mod bind;
mod channel;
mod frames;
pub(crate) mod own;
mod pattern;
mod runner_up;
mod select;
mod selection;

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

use mcap::records::Channel;
use serde::Serialize;

use crate::{
    decode::{
        Proof,
        path::{FieldPath, Filter, MessagePath},
        trial::UnmetFilter,
    },
    log::{Log, record::RawMessage},
    sample::{DropReason, Kind, Sample},
    text::{self, Foreign},
};
use channel::{ChannelReader, MixedSources, UnmetTracker};
pub use channel::{FoundValue, OversizedAngle, RefusedFrames, UnmetCondition, WrittenQuaternion};
use error::{Misfit, TelemetryError};
pub use frames::taken::{Because, NamedFrame, ReadAs, Reading};
use profile::Profile;
use request::{HowAsked, Request};
pub use runner_up::RunnerUp;
use select::{Fit, Specificity};
pub use select::{PassedOver, SeenPlace};
use selection::paths_of_source;
use undecodable::UndecodableMessage;

/// The telemetry of one log: which channels have it, and how to read their messages. Clones may each read some of the
/// messages, and be [merged](Source::merge) again.
#[derive(Debug, Clone)]
pub struct Source {
    /// The profile that fits.
    pub profile: Profile,
    /// The other profiles that were tried, the better ones first.
    pub runners_up: Vec<RunnerUp>,
    /// The places that come first, but were passed over because of what their messages hold, for the kinds of sample that
    /// are read.
    pub passed_over: Vec<PassedOver>,
    fit: Fit,
    /// How the profile recognises its logs.
    specificity: Specificity,
    /// Where it finds what it was chosen by.
    chosen_by: Origin,
    /// What it took for its fields to be there.
    proof: Proof,
    channels: BTreeMap<u16, ChannelReader>,
}

/// Where one kind of sample comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// The topic.
    pub topic: Foreign,
    /// Which of its messages; all, if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub select: Vec<Filter>,
    /// The fields of its messages.
    pub fields: Vec<FieldPath>,
}

impl Source {
    /// The prefix of the vehicle's topics; empty if they have none.
    pub fn namespace(&self) -> &str {
        &self.fit.namespace
    }

    /// Where the attitude comes from, which every source has.
    pub fn attitude(&self) -> &Origin {
        &self.fit.attitude.origin
    }

    /// Where the profile finds what it was chosen by: the attitude or, if the user gives that, what the profile adds.
    pub fn chosen_by(&self) -> &Origin {
        &self.chosen_by
    }

    /// The profile with the topics that its roles without topics were read from, where that is not the attitude's.
    pub fn profile_as_read(&self) -> Profile {
        let Fit {
            namespace,
            attitude,
            own,
            ..
        } = &self.fit;
        let mut profile = self.profile.clone();
        if attitude.origin.topic == *own {
            return profile;
        }
        let topic = own.strip_prefix(namespace.as_str()).unwrap_or(own);
        for kind in Kind::ALL {
            for alternative in profile.alternatives_mut(kind) {
                let topics = &mut alternative.location.topics;
                if topics.is_empty() {
                    topics.push(topic.to_owned());
                }
            }
        }
        profile
    }

    /// The channel with the attitude; if its topic has several, the first.
    pub fn attitude_channel<'a>(&self, log: &'a Log) -> &'a Channel {
        let channels = log.contents.definitions.channels.values();
        let mut of_source =
            channels.filter(|channel| self.channels.contains_key(&channel.record.id));
        let attitude = of_source.find(|channel| self.attitude().topic == channel.record.topic);
        &attitude
            .expect("a source has a channel with the attitude")
            .record
    }

    /// Where each kind of sample comes from, or why the log has none.
    pub fn roles(&self) -> BTreeMap<Kind, Result<&Origin, &Misfit>> {
        self.fit.roles()
    }

    /// Where samples of a kind come from, if the log has any.
    pub fn role(&self, kind: Kind) -> Option<&Origin> {
        self.fit.role(kind).ok()
    }

    /// Why there are no samples of a kind, if there are none.
    pub fn why_missing(&self, kind: Kind) -> Option<&Misfit> {
        self.fit.role(kind).err()
    }

    /// The channels that have telemetry.
    pub fn channel_ids(&self) -> BTreeSet<u16> {
        self.channels.keys().copied().collect()
    }

    /// The types of the messages that a kind of sample comes from.
    pub fn schemas(&self, log: &Log, kind: Kind) -> Vec<String> {
        let channels = self.channels.iter().filter(|(_, reader)| reader.has(kind));
        let definitions = &log.contents.definitions;
        let schemas = channels.filter_map(|(id, _)| {
            let channel = &definitions.channels.get(id)?.record;
            Some(log.contents.schema_of(channel)?.name.clone())
        });
        schemas.collect()
    }

    /// How an orientation of this kind is written, if it is a quaternion.
    pub fn quaternion(&self, kind: Kind) -> Option<WrittenQuaternion> {
        let mut channels = self.channels.values();
        channels.find_map(|channel| channel.quaternion(kind))
    }

    /// Whether the times of samples are log times.
    pub fn is_in_log_time(&self) -> bool {
        self.channels.values().all(ChannelReader::is_in_log_time)
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

    /// Merges what a clone has learnt from the messages that it read.
    pub fn merge(&mut self, clone: &Self) {
        for (id, channel) in &mut self.channels {
            if let Some(clone) = clone.channels.get(id) {
                channel.merge(clone);
            }
        }
    }

    /// How the samples of a kind were read, as far as messages have been read.
    pub fn read_as(&self, kind: Kind) -> Vec<ReadAs> {
        distinct(
            self.channels
                .values()
                .flat_map(|channel| channel.read_as(kind)),
        )
    }

    /// Frames for which samples of a kind were dropped, as far as messages have been read.
    pub fn refused_frames(&self, kind: Kind) -> Vec<RefusedFrames> {
        distinct(
            self.channels
                .values()
                .flat_map(|channel| channel.refused(kind)),
        )
    }

    /// Checks that the samples of each kind come from one source, as far as messages have been read.
    ///
    /// # Errors
    /// Those of a kind come from several, which a field tells apart.
    pub fn check_sources(&self, log: &Log, request: &Request) -> Result<(), TelemetryError> {
        let mut mixed = self
            .channels
            .values()
            .filter_map(ChannelReader::mixed_sources);
        match mixed.next() {
            None => Ok(()),
            Some(mixed) => Err(TelemetryError::SeveralSources {
                path: log.file.path().into(),
                topic: self.topic_of(mixed.kind),
                role: mixed.kind,
                example: self.example(&mixed, request).into(),
                field: mixed.field,
                ids: mixed.ids,
            }),
        }
    }

    /// How to name the first of several sources.
    fn example(&self, mixed: &MixedSources, request: &Request) -> Vec<MessagePath> {
        let (Some(origin), Some(id)) = (self.role(mixed.kind), mixed.ids.first()) else {
            return Vec::new();
        };
        let paths = paths_of_source(origin, &mixed.field, id);
        match request.how_asked(mixed.kind, &self.profile) {
            HowAsked::Argument => paths,
            // The profile says which fields to read.
            _ if paths.iter().all(|path| !path.filters.is_empty()) => {
                let whole = |path| MessagePath {
                    field: None,
                    ..path
                };
                paths.into_iter().take(1).map(whole).collect()
            }
            _ => paths,
        }
    }

    /// How many of the messages that have been read are not of the source that was selected for a kind of sample.
    pub fn unselected(&self, kind: Kind) -> u64 {
        self.channels
            .values()
            .map(|channel| channel.unselected(kind))
            .sum()
    }

    /// The filters for a kind of sample that held for none of the messages that have been read, and what their fields
    /// have instead.
    pub fn unmet_filters(&self, kind: Kind) -> Vec<UnmetFilter> {
        let channels = self.channels.values().filter(|channel| channel.has(kind));
        channels
            .flat_map(|channel| channel.unmet_filters(kind))
            .collect()
    }

    /// The earliest message of a kind of sample that could not be decoded, among those that have been read.
    pub fn undecodable(&self, kind: Kind) -> Option<UndecodableMessage> {
        let channels = self.channels.values().filter(|channel| channel.has(kind));
        let undecodable = channels.filter_map(ChannelReader::undecodable);
        let (log_time, problem) = undecodable.min_by_key(|(time, _)| *time)?.clone();
        Some(UndecodableMessage {
            topic: self.role(kind)?.topic.clone(),
            log_time,
            problem,
        })
    }

    /// How many samples of a kind were left out because no condition holds for their messages, and what those held, as far
    /// as messages have been read.
    pub fn unmet_conditions(&self, kind: Kind) -> (u64, Vec<UnmetCondition>) {
        let trackers = || {
            self.channels
                .values()
                .filter_map(|channel| channel.unmet(kind))
        };
        let samples = trackers().map(|tracker| tracker.messages).sum();
        (samples, trackers().flat_map(UnmetTracker::unmet).collect())
    }

    /// An angle that is larger than its unit allows, as far as messages have been read, and what it is of. One that is
    /// certainly wrong comes first.
    pub fn oversized_angle(&self) -> Option<(Kind, OversizedAngle)> {
        let channels = self.channels.values();
        let angles = channels.flat_map(ChannelReader::oversized_angles);
        angles.max_by_key(|(_, angle)| angle.is_certain)
    }

    /// Checks that angles can be of the units in which they were read, as far as messages have been read.
    ///
    /// # Errors
    /// One is certainly not.
    pub fn check_angles(&self, log: &Log, request: &Request) -> Result<(), TelemetryError> {
        match self.oversized_angle() {
            Some((role, found)) if found.is_certain => Err(TelemetryError::ImpossibleAngle {
                path: log.file.path().into(),
                role,
                topic: self.topic_of(role),
                angle: found.angle,
                unit: found.unit,
                asked: request.how_asked(role, &self.profile),
            }),
            _ => Ok(()),
        }
    }

    /// The topic that samples of a kind come from; empty if there are none.
    pub fn topic_of(&self, kind: Kind) -> Foreign {
        let origin = self.role(kind);
        origin
            .map(|origin| origin.topic.clone())
            .unwrap_or_default()
    }
}

fn distinct<'a, T: PartialEq + Clone + 'a>(all: impl Iterator<Item = &'a T>) -> Vec<T> {
    all.fold(Vec::new(), |mut known, one| {
        if !known.contains(one) {
            known.push(one.clone());
        }
        known
    })
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fields = text::join(&self.fields, ", ");
        write!(f, "{}", self.topic)?;
        for filter in &self.select {
            write!(f, "{{{filter}}}")?;
        }
        write!(f, " has {fields}")
    }
}
