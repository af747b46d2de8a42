//! The values of one message → a sample.

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    angles::{AngleWatch, Angles},
    frames::Conversion,
};
use crate::{
    decode::value::{FieldValue, Number},
    geometry::RollPitchYaw,
    log::record::RawMessage,
    sample::{
        AccelerationSample, AngularRateSample, AttitudeSample, DropReason, GimbalSample,
        HeightSample, Position, PositionSample, Sample, Stamp, VelocitySample,
    },
    source::{
        bind::{Reading, Slot, TimeSlots},
        profile::{
            Components, Condition, Coordinates, Orientation, Pitch, RoleFields, SampleTime, Test,
        },
    },
};

/// Lengths that a quaternion may have and still be taken for a rotation. Rounding and a filter's drift stay well within
/// them; all zeros, or four other numbers, fall outside.
const QUATERNION_LENGTHS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

impl Condition<Slot> {
    pub fn holds(&self, values: &[FieldValue]) -> Result<bool, DropReason> {
        let value = &values[self.field];
        Ok(match &self.test {
            Test::Is(wanted) => exact(values, self.field)?.is(*wanted),
            Test::HasBits(bits) => exact(values, self.field)?.bits() & bits != 0,
            Test::IsInteger(wanted) => exact(values, self.field)?.is_integer() == *wanted,
            Test::Says(_) | Test::Contains(_) if !value.is_present() => {
                return Err(DropReason::MissingField);
            }
            Test::Says(wanted) => value.text() == Some(wanted.as_bytes()),
            Test::Contains(part) => value.text().is_some_and(|text| {
                let part = part.as_bytes();
                part.is_empty() || text.windows(part.len()).any(|bytes| bytes == part)
            }),
        })
    }
}

impl Reading {
    /// The sample of a message, or why there is none. `watch` gets its angles.
    pub(super) fn sample(
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
            RoleFields::Height(height) => {
                let [number] = Components::Each([height.field]).finite(values)?;
                let metres = number / height.unit.per_metre();
                if metres < 0.0 {
                    return Err(DropReason::NegativeHeight);
                }
                Sample::Height(HeightSample { stamp, metres })
            }
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
