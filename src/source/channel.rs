//! One channel of telemetry: its messages → samples.

mod angles;
mod frames;
mod ids;
mod quaternion;
mod unmet;

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};

pub use angles::OversizedAngle;
use angles::{AngleWatch, Angles};
pub use frames::RefusedFrames;
use frames::{Conversion, FrameTracker};
use ids::SeenIds;
pub use quaternion::WrittenQuaternion;
pub use unmet::{FoundValue, UnmetCondition, UnmetTracker};

use super::{
    bind::{BindError, BoundRole, Reading, Slot, TimeSlots},
    frames::taken::ReadAs,
    profile::{
        Components, Condition, Coordinates, Orientation, Pitch, RoleFields, SampleTime, Test,
    },
    selection::Selection,
};
use crate::{
    decode::{
        fault::Fault,
        field::Wanted,
        path::{FieldPath, Literal},
        schema::{MessageDecoder, MessageSchema},
        trial::{Trial, UnmetFilter},
        value::{FieldValue, Number, Slots, Undecodable},
    },
    geometry::RollPitchYaw,
    log::record::RawMessage,
    sample::{
        AccelerationSample, AngularRateSample, AttitudeSample, DropReason, GimbalSample, Kind,
        Position, PositionSample, Sample, Stamp, VelocitySample,
    },
};

/// Lengths that a quaternion may have and still be taken for a rotation. Rounding and a filter's drift stay well within
/// them; all zeros, or four other numbers, fall outside.
const QUATERNION_LENGTHS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

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

impl Condition<Slot> {
    pub fn holds(&self, values: &[FieldValue]) -> Result<bool, DropReason> {
        let value = &values[self.field];
        Ok(match &self.test {
            Test::Is(wanted) => exact(values, self.field)?.is(*wanted),
            Test::HasBits(bits) => exact(values, self.field)?.bits() & bits != 0,
            Test::Says(_) if !value.is_present() => return Err(DropReason::MissingField),
            Test::Says(wanted) => value.text() == Some(wanted.as_bytes()),
        })
    }
}

impl Reading {
    fn sample(
        &self,
        message: &RawMessage,
        values: &[FieldValue],
        conversion: Conversion,
        watch: &mut AngleWatch,
    ) -> Result<Sample, DropReason> {
        let stamp = Stamp {
            log_time: self.time.read(message, values)?,
            publish_time: message.publish_time,
        };
        let mut orientation = |fields: &Orientation<Slot>| {
            let note = |angles| watch.note(message.log_time, angles);
            let orientation = fields.read(values, note);
            orientation.map(|orientation| conversion.orientation(orientation))
        };
        let sample = match &self.fields {
            RoleFields::Attitude(attitude) => Sample::Attitude(AttitudeSample {
                stamp,
                orientation: orientation(&attitude.orientation)?,
                reset_counter: match &attitude.reset_counter {
                    Some(counter) => Some(exact(values, counter.field)?.bits()),
                    None => None,
                },
            }),
            RoleFields::Velocity(velocity) => {
                let vector = velocity.vector.finite(values)?;
                let per = velocity.unit.per_metre_per_second();
                let [x, y, z] = vector.map(|component| component / per);
                // In some axes it would be infinite.
                if !(x.abs() + y.abs() + z.abs()).is_finite() {
                    return Err(DropReason::TooLarge);
                }
                Sample::Velocity(VelocitySample {
                    stamp,
                    velocity: conversion.velocity(Vector3::new(x, y, z)),
                })
            }
            RoleFields::Gimbal(gimbal) => Sample::Gimbal(GimbalSample {
                stamp,
                orientation: orientation(&gimbal.orientation)?,
                reference: gimbal.reference,
            }),
            RoleFields::Position(coordinates) => Sample::Position(PositionSample {
                stamp,
                position: coordinates.read(values, conversion)?,
                resets: self.resets.read(values),
            }),
            RoleFields::AngularRate(fields) => {
                let numbers = Vector3::from(fields.vector.finite(values)?);
                let rate = numbers / fields.unit.per_radian_per_second();
                Sample::AngularRate(AngularRateSample {
                    stamp,
                    rate: conversion.vector(rate),
                })
            }
            RoleFields::Acceleration(fields) => {
                let numbers = Vector3::from(fields.vector.finite(values)?);
                let force = numbers / fields.unit.per_metre_per_second_squared();
                Sample::Acceleration(AccelerationSample {
                    stamp,
                    force: conversion.vector(force),
                })
            }
        };
        for &slot in &self.valid {
            if number(values, slot)? == 0.0 {
                return Err(DropReason::MarkedInvalid);
            }
        }
        Ok(sample)
    }
}

impl SampleTime<TimeSlots> {
    /// The time in nanoseconds since the log's epoch.
    fn read(&self, message: &RawMessage, values: &[FieldValue]) -> Result<u64, DropReason> {
        let nanoseconds = match *self {
            Self::LogTime => Some(message.log_time),
            Self::PublishTime => Some(message.publish_time),
            Self::Field(TimeSlots::Number { slot, unit }) => {
                in_nanoseconds(exact(values, slot)?, unit.nanoseconds())
            }
            Self::Field(TimeSlots::SecondsAndNanoseconds([seconds, nanoseconds])) => {
                let seconds = in_nanoseconds(exact(values, seconds)?, 1_000_000_000);
                let nanoseconds = in_nanoseconds(exact(values, nanoseconds)?, 1);
                seconds.zip(nanoseconds).and_then(|(a, b)| a.checked_add(b))
            }
        };
        nanoseconds.ok_or(DropReason::BadTime)
    }
}

/// Converts a time to nanoseconds; `None` if it is negative, not finite, or past the year 2554.
fn in_nanoseconds(number: Number, unit: u64) -> Option<u64> {
    match number {
        Number::Unsigned(number) => number.checked_mul(unit),
        Number::Signed(number) => u64::try_from(number).ok()?.checked_mul(unit),
        Number::Real(number) => {
            let nanoseconds = (number * unit as f64).round();
            (0.0..u64::MAX as f64)
                .contains(&nanoseconds)
                .then_some(nanoseconds as u64)
        }
    }
}

impl Orientation<Slot> {
    /// The orientation. `note` gets its angles, if it is given by angles, before they are taken for such of their unit.
    fn read(
        &self,
        values: &[FieldValue],
        note: impl FnOnce(Angles),
    ) -> Result<UnitQuaternion<f64>, DropReason> {
        match self {
            Self::Quaternion(quaternion) => {
                let numbers = (quaternion.fields).read(values, DropReason::NotARotation)?;
                let quaternion = quaternion.order.quaternion(numbers);
                if !QUATERNION_LENGTHS.contains(&quaternion.norm()) {
                    return Err(DropReason::NotARotation);
                }
                Ok(UnitQuaternion::from_quaternion(quaternion))
            }
            Self::Euler(euler) => {
                let angles = Components::Each([euler.roll, euler.pitch, euler.yaw]);
                let angles = angles.finite(values)?;
                note(Angles::RollPitchYaw(angles));
                let [roll, pitch, yaw] = angles.map(|angle| euler.unit.to_radians(angle));
                Ok(euler.order.rotation(RollPitchYaw { roll, pitch, yaw }))
            }
            Self::Pitch(Pitch {
                field,
                unit,
                positive,
            }) => {
                let [angle] = Components::Each([*field]).finite(values)?;
                note(Angles::Pitch(angle));
                let pitch = positive.up(unit.to_radians(angle));
                Ok(UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch))
            }
        }
    }
}

impl Coordinates<Slot> {
    fn read(&self, values: &[FieldValue], conversion: Conversion) -> Result<Position, DropReason> {
        Ok(match self {
            &Self::Geodetic {
                latitude,
                longitude,
                altitude,
                unit,
                altitude_unit,
            } => {
                let fields = Components::Each([latitude, longitude, altitude]);
                let [latitude, longitude, altitude] = fields.finite(values)?;
                let [latitude, longitude] = [latitude, longitude].map(|a| unit.to_degrees(a));
                if !(latitude.is_finite() && longitude.is_finite()) {
                    return Err(DropReason::TooLarge);
                }
                Position::Geodetic {
                    latitude,
                    longitude,
                    altitude: altitude / altitude_unit.per_metre(),
                }
            }
            Self::Local { vector, unit, .. } => {
                let vector = vector.finite(values)?;
                let metres = vector.map(|component| component / unit.per_metre());
                Position::Local(conversion.vector(metres.into()))
            }
        })
    }
}

impl<const N: usize> Components<N, Slot> {
    /// The numbers of a vector, if all are there and finite.
    fn finite(&self, values: &[FieldValue]) -> Result<[f64; N], DropReason> {
        self.read(values, DropReason::MissingField)
    }

    /// The numbers, if all are there and finite. A list of another length is dropped for the given reason.
    fn read(
        &self,
        values: &[FieldValue],
        wrong_length: DropReason,
    ) -> Result<[f64; N], DropReason> {
        let mut numbers = [0.0; N];
        let mut has_all = true;
        match self {
            Self::Together(slot) => {
                let list = &values[*slot];
                if !list.is_present() {
                    return Err(DropReason::MissingField);
                }
                has_all = list.len() == N;
                for (component, number) in numbers.iter_mut().zip(list.numbers()) {
                    *component = number;
                }
            }
            Self::Each(slots) => {
                for (component, &slot) in numbers.iter_mut().zip(slots) {
                    *component = number(values, slot)?;
                }
            }
        }
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(DropReason::NonFinite);
        }
        match has_all {
            true => Ok(numbers),
            false => Err(wrong_length),
        }
    }
}

fn number(values: &[FieldValue], slot: Slot) -> Result<f64, DropReason> {
    values[slot].number().ok_or(DropReason::MissingField)
}

/// The number at full precision.
fn exact(values: &[FieldValue], slot: Slot) -> Result<Number, DropReason> {
    values[slot].exact().ok_or(DropReason::MissingField)
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
