//! One channel of telemetry: its messages → samples.

use std::sync::Arc;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{
    binding::{
        BoundComponents, BoundCondition, BoundOrientation, BoundTest, BoundTime, Quantity, Reading,
        Role, Slot,
    },
    profile::convention::AngleUnit,
};
use crate::{
    decode::{
        error::SchemaError,
        field::Wanted,
        schema::{MessageDecoder, MessageSchema},
        value::{FieldValue, Number, Slots, Undecodable},
    },
    geometry::RollPitchYaw,
    log::record::RawMessage,
    sample::{
        AttitudeSample, DropReason, GimbalSample, Kind, Position, PositionSample, Sample, Stamp,
        VelocitySample,
    },
};

/// Lengths that a quaternion may have and still be taken for a rotation. Rounding and a filter's drift stay
/// far within; all zeros, or four other numbers, fall outside.
const QUATERNION_LENGTHS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Reads samples from one channel's messages. A clone reads others at the same time.
#[derive(Debug, Clone)]
pub struct ChannelSource {
    decoder: Arc<MessageDecoder>,
    slots: Slots,
    roles: Arc<[Role]>,
    largest: LargestAngles,
}

/// The largest of the attitude's Euler angles that were read as radians; 0 where there were none.
#[derive(Debug, Clone, Copy, Default)]
pub struct LargestAngles {
    pub pitch: f64,
    pub roll_or_yaw: f64,
}

impl LargestAngles {
    /// Of both.
    pub fn max(self, other: Self) -> Self {
        Self {
            pitch: self.pitch.max(other.pitch),
            roll_or_yaw: self.roll_or_yaw.max(other.roll_or_yaw),
        }
    }
}

impl ChannelSource {
    /// For roles that were bound to the channel's schema, which wants these fields.
    pub fn new(
        schema: &MessageSchema,
        wanted: &[Wanted],
        roles: Vec<Role>,
    ) -> Result<Self, SchemaError> {
        Ok(Self {
            decoder: Arc::new(schema.decoder(wanted)?),
            slots: Slots::new(wanted),
            roles: roles.into(),
            largest: LargestAngles::default(),
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
        for role in &*self.roles {
            let sample = decoded.map_err(DropReason::from).and_then(|()| {
                let reading = reading_for(role, values)?;
                self.largest = self.largest.max(largest_angles(&reading.quantity, values));
                reading.sample(message, values)
            });
            emit(role.kind, sample);
        }
    }

    /// Whether the times of samples are log times.
    pub fn is_in_log_time(&self) -> bool {
        let mut readings = self.roles.iter().flat_map(|role| &role.readings);
        readings.all(|reading| matches!(reading.time, BoundTime::LogTime))
    }

    /// Takes over what a clone learnt from the messages that it read.
    pub fn merge(&mut self, clone: &Self) {
        self.largest = self.largest.max(clone.largest);
    }

    /// The largest Euler angles that were read as radians.
    pub fn largest_angles(&self) -> LargestAngles {
        self.largest
    }
}

/// The reading that applies to a message.
fn reading_for<'a>(role: &'a Role, values: &[FieldValue]) -> Result<&'a Reading, DropReason> {
    for reading in &role.readings {
        match &reading.condition {
            Some(condition) if !condition.holds(values)? => {}
            _ => return Ok(reading),
        }
    }
    Err(DropReason::UnknownFrame)
}

impl BoundCondition {
    fn holds(&self, values: &[FieldValue]) -> Result<bool, DropReason> {
        let number = values[self.slot].exact().ok_or(DropReason::MissingField)?;
        Ok(match self.test {
            BoundTest::Is(wanted) => number.is(wanted),
            BoundTest::HasBits(bits) => number.bits() & bits != 0,
        })
    }
}

impl Reading {
    fn sample(&self, message: &RawMessage, values: &[FieldValue]) -> Result<Sample, DropReason> {
        let stamp = Stamp {
            log_time: self.time.read(message, values)?,
            publish_time: message.publish_time,
        };
        let sample = match &self.quantity {
            Quantity::Attitude {
                orientation,
                convention,
                reset_counter,
            } => Sample::Attitude(AttitudeSample {
                stamp,
                orientation: convention.attitude(orientation.read(values)?),
                reset_counter: match reset_counter {
                    Some(slot) => {
                        let counter = values[*slot].exact().ok_or(DropReason::MissingField)?;
                        Some(counter.bits())
                    }
                    None => None,
                },
            }),
            Quantity::Velocity {
                vector,
                frame,
                unit,
            } => {
                let vector = vector.finite(values)?;
                let per = unit.per_metre_per_second();
                Sample::Velocity(VelocitySample {
                    stamp,
                    velocity: frame.velocity(vector.map(|component| component / per)),
                })
            }
            Quantity::Gimbal {
                orientation,
                convention,
                reference,
            } => Sample::Gimbal(GimbalSample {
                stamp,
                orientation: convention.gimbal(orientation.read(values)?, *reference),
                reference: *reference,
            }),
            Quantity::Geodetic {
                latitude_longitude_altitude,
                unit,
                altitude_unit,
            } => {
                let [latitude, longitude, altitude] = latitude_longitude_altitude.finite(values)?;
                Sample::Position(PositionSample {
                    stamp,
                    position: Position::Geodetic {
                        latitude: unit.to_degrees(latitude),
                        longitude: unit.to_degrees(longitude),
                        altitude: altitude / altitude_unit.per_metre(),
                    },
                })
            }
            Quantity::Local {
                vector,
                frame,
                unit,
            } => {
                let vector = vector.finite(values)?;
                let metres = vector.map(|component| component / unit.per_metre());
                Sample::Position(PositionSample {
                    stamp,
                    position: Position::Local(frame.ned(metres)),
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

impl BoundTime {
    /// Nanoseconds since the log's epoch.
    fn read(self, message: &RawMessage, values: &[FieldValue]) -> Result<u64, DropReason> {
        let exact = |slot: Slot| values[slot].exact().ok_or(DropReason::MissingField);
        let nanoseconds = match self {
            Self::LogTime => Some(message.log_time),
            Self::PublishTime => Some(message.publish_time),
            Self::Number { slot, unit } => in_nanoseconds(exact(slot)?, unit.nanoseconds()),
            Self::SecondsAndNanoseconds([seconds, nanoseconds]) => {
                let seconds = in_nanoseconds(exact(seconds)?, 1_000_000_000);
                let nanoseconds = in_nanoseconds(exact(nanoseconds)?, 1);
                seconds.zip(nanoseconds).and_then(|(a, b)| a.checked_add(b))
            }
        };
        nanoseconds.ok_or(DropReason::BadTime)
    }
}

/// A time in nanoseconds, if it is one: not negative, finite, and not past the year 2554.
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

impl BoundOrientation {
    fn read(&self, values: &[FieldValue]) -> Result<UnitQuaternion<f64>, DropReason> {
        match self {
            Self::Quaternion { components, order } => {
                let numbers = components.read(values, DropReason::NotARotation)?;
                let quaternion: Quaternion<f64> = order.quaternion(numbers);
                if !QUATERNION_LENGTHS.contains(&quaternion.norm()) {
                    return Err(DropReason::NotARotation);
                }
                Ok(UnitQuaternion::from_quaternion(quaternion))
            }
            Self::Euler { rpy, unit } => {
                let [roll, pitch, yaw] = rpy.finite(values)?.map(|angle| unit.to_radians(angle));
                Ok(RollPitchYaw { roll, pitch, yaw }.to_quaternion())
            }
            Self::Pitch {
                slot,
                unit,
                positive,
            } => {
                let [angle] = BoundComponents::Each([*slot]).finite(values)?;
                let pitch = positive.up(unit.to_radians(angle));
                Ok(UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch))
            }
        }
    }
}

impl<const N: usize> BoundComponents<N> {
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
            Self::List(slot) => {
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

fn largest_angles(quantity: &Quantity, values: &[FieldValue]) -> LargestAngles {
    if let Quantity::Attitude {
        orientation:
            BoundOrientation::Euler {
                rpy,
                unit: AngleUnit::Radians,
            },
        ..
    } = quantity
        && let Ok([roll, pitch, yaw]) = rpy.finite(values)
    {
        return LargestAngles {
            pitch: pitch.abs(),
            roll_or_yaw: roll.abs().max(yaw.abs()),
        };
    }
    LargestAngles::default()
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
