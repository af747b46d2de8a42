//! One channel of telemetry: its messages → samples.

mod angles;
mod frames;
mod ids;
mod quaternion;
mod sample;
mod unmet;

use std::sync::Arc;

use angles::AngleWatch;
pub use angles::OversizedAngle;
use frames::FrameTracker;
pub use frames::RefusedFrames;
use ids::SeenIds;
pub use quaternion::WrittenQuaternion;
pub use unmet::{FoundValue, UnmetCondition, UnmetTracker};

use super::{
    bind::{BindError, BoundRole},
    frames::taken::ReadAs,
    profile::SampleTime,
    selection::Selection,
};
use crate::{
    decode::{
        fault::Fault,
        field::Wanted,
        path::{FieldPath, Literal},
        schema::{MessageDecoder, MessageSchema},
        trial::{Trial, UnmetFilter},
        value::{Slots, Undecodable},
    },
    log::record::RawMessage,
    sample::{DropReason, Kind, Sample},
};

/// Reads samples from one channel's messages. A clone can read other messages at the same time.
#[derive(Debug, Clone)]
pub struct ChannelReader {
    decoder: Arc<MessageDecoder>,
    slots: Slots,
    roles: Arc<[BoundRole]>,
    /// What was found in the messages, by role.
    found: Vec<FoundInRole>,
    /// The earliest message that could not be decoded: its log time, and what is wrong with it.
    undecodable: Option<(u64, Fault)>,
}

/// What was found in the messages for one role.
#[derive(Debug, Clone)]
struct FoundInRole {
    /// What is noted while messages are selected.
    selection: Selection,
    /// The frames of each reading.
    frames: Vec<FrameTracker>,
    /// The angles of each reading.
    angles: Vec<AngleWatch>,
    ids: SeenIds,
    /// What the conditions left out.
    unmet: UnmetTracker,
}

/// Sources that are mixed on one topic.
#[derive(Debug, Clone, PartialEq)]
pub struct MixedSources {
    /// What is read from them.
    pub kind: Kind,
    /// The field that tells them apart.
    pub field: FieldPath,
    /// Its values.
    pub ids: Vec<Literal>,
}

impl ChannelReader {
    /// Reads samples for roles that were bound to the channel's schema, whose fields are `wanted`.
    pub fn new(
        schema: &MessageSchema,
        wanted: &[Wanted],
        roles: Vec<BoundRole>,
    ) -> Result<Self, BindError> {
        let (decoder, slots) = schema.decoder(wanted)?;
        let found = roles.iter().map(|role| FoundInRole {
            selection: Selection::new(role, &slots),
            frames: vec![FrameTracker::default(); role.readings.len()],
            angles: vec![AngleWatch::default(); role.readings.len()],
            ids: SeenIds::new(&role.ids),
            unmet: UnmetTracker::new(role, wanted),
        });
        Ok(Self {
            found: found.collect(),
            decoder: Arc::new(decoder),
            slots,
            roles: roles.into(),
            undecodable: None,
        })
    }

    /// Reads one message. `emit` gets a sample, or why there is none, for each kind that the channel has.
    pub fn read(
        &mut self,
        message: &RawMessage,
        mut emit: impl FnMut(Kind, Result<Sample, DropReason>),
    ) {
        self.slots.clear();
        let decoded = self.decoder.decode(message.payload, &mut self.slots);
        let values = self.slots.values.as_slice();
        for (role, found) in self.roles.iter().zip(&mut self.found) {
            let place = match decoded {
                Ok(()) => found.selection.reading_for(role, &self.slots),
                Err(undecodable) => Err(undecodable.into()),
            };
            let sample = match place {
                Ok(Some(place)) => {
                    let reading = &role.readings[place];
                    let conversion = found.frames[place].conversion(&reading.frames, values);
                    conversion.and_then(|conversion| {
                        found.ids.note(&role.ids, values);
                        reading.sample(message, values, conversion, &mut found.angles[place])
                    })
                }
                // The message is another source's.
                Ok(None) => continue,
                Err(reason) => {
                    if reason == DropReason::UnmetCondition {
                        found.unmet.note(values);
                    }
                    Err(reason)
                }
            };
            emit(role.kind, sample);
        }
        if decoded.is_err() {
            self.note_undecodable(message);
        }
    }

    #[cold]
    fn note_undecodable(&mut self, message: &RawMessage) {
        let known = self.undecodable.as_ref();
        if known.is_none_or(|(time, _)| message.log_time < *time)
            && let Some(fault) = self.decoder.explain(message.payload, &mut self.slots)
        {
            self.undecodable = Some((message.log_time, fault));
        }
    }

    /// Whether the channel has samples of a kind.
    pub fn has(&self, kind: Kind) -> bool {
        self.roles.iter().any(|role| role.kind == kind)
    }

    /// How many messages were not of the source that is selected for a kind of sample.
    pub fn unselected(&self, kind: Kind) -> u64 {
        self.selections_for(kind).map(Selection::unselected).sum()
    }

    /// The filters for a kind of sample that held for no message.
    pub fn unmet_filters(&self, kind: Kind) -> Vec<UnmetFilter> {
        let of_messages = self.selections_for(kind).flat_map(Selection::unmet);
        let of_elements = self.slots.trials.iter().filter_map(Trial::unmet);
        of_messages.chain(of_elements).collect()
    }

    fn selections_for(&self, kind: Kind) -> impl Iterator<Item = &Selection> {
        let of_roles = self.roles.iter().zip(&self.found);
        of_roles
            .filter(move |(role, _)| role.kind == kind)
            .map(|(_, found)| &found.selection)
    }

    /// The earliest message that could not be decoded: its log time, and what is wrong with it.
    pub fn undecodable(&self) -> Option<&(u64, Fault)> {
        self.undecodable.as_ref()
    }

    /// Whether the times of samples are log times.
    pub fn is_in_log_time(&self) -> bool {
        let mut readings = self.roles.iter().flat_map(|role| &role.readings);
        readings.all(|reading| matches!(reading.time, SampleTime::LogTime))
    }

    /// Merges what a clone has learnt from the messages that it read.
    pub fn merge(&mut self, clone: &Self) {
        for (found, more) in self.found.iter_mut().zip(&clone.found) {
            found.selection.merge(&more.selection);
            found.ids.merge(&more.ids);
            found.unmet.merge(&more.unmet);
            for (frames, more) in found.frames.iter_mut().zip(&more.frames) {
                frames.merge(more);
            }
            for (angles, more) in found.angles.iter_mut().zip(&more.angles) {
                angles.merge(more);
            }
        }
        let both = self
            .undecodable
            .take()
            .into_iter()
            .chain(clone.undecodable.clone());
        self.undecodable = both.min_by_key(|(time, _)| *time);
        Trial::merge_all(&mut self.slots.trials, &clone.slots.trials);
    }

    /// How samples of a kind were read.
    pub fn read_as(&self, kind: Kind) -> impl Iterator<Item = &ReadAs> {
        self.frames(kind).flat_map(|frames| &frames.taken)
    }

    /// Frames for which samples of a kind were dropped.
    pub fn refused(&self, kind: Kind) -> impl Iterator<Item = &RefusedFrames> {
        self.frames(kind).flat_map(|frames| &frames.refused)
    }

    fn frames(&self, kind: Kind) -> impl Iterator<Item = &FrameTracker> {
        let of_roles = self.roles.iter().zip(&self.found);
        of_roles
            .filter(move |(role, _)| role.kind == kind)
            .flat_map(|(_, found)| &found.frames)
    }

    /// A role whose samples come from several sources.
    pub fn mixed_sources(&self) -> Option<MixedSources> {
        self.roles
            .iter()
            .zip(&self.found)
            .find_map(|(role, found)| {
                let (place, ids) = found.ids.several()?;
                Some(MixedSources {
                    kind: role.kind,
                    field: role.ids[place].field.clone(),
                    ids: ids.to_vec(),
                })
            })
    }

    /// What conditions left out of the samples of a kind.
    pub fn unmet(&self, kind: Kind) -> Option<&UnmetTracker> {
        let place = self.roles.iter().position(|role| role.kind == kind)?;
        self.found.get(place).map(|found| &found.unmet)
    }

    /// Angles that are too large for their units, with the kinds of sample that they are of.
    pub fn oversized_angles(&self) -> impl Iterator<Item = (Kind, OversizedAngle)> {
        let of_roles = self.roles.iter().zip(&self.found);
        of_roles.flat_map(|(role, found)| {
            let of_readings = role.readings.iter().zip(&found.angles);
            of_readings.filter_map(|(reading, angles)| {
                let unit = reading.fields.angle_unit()?;
                Some((role.kind, angles.oversized(unit)?))
            })
        })
    }
}

impl From<Undecodable> for DropReason {
    fn from(undecodable: Undecodable) -> Self {
        match undecodable {
            Undecodable::Malformed => Self::Undecodable,
            Undecodable::Xcdr2 => Self::Xcdr2,
            Undecodable::ParameterList => Self::ParameterList,
        }
    }
}
