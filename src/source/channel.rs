//! One channel of telemetry: its messages → samples.

use mcap::records::Channel;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{
    Unresolved,
    examples::Examples,
    field::{FieldPath, FieldValue, Shape, Undecodable, Wanted},
    json,
    profile::{AngleUnit, Orientation, Profile},
    protobuf,
};
use crate::{
    geometry::RollPitchYaw,
    log::{Log, record::RawMessage},
    sample::{AttitudeSample, DropReason, Kind, Sample, Stamp, Velocity, VelocitySample},
};

/// Lengths that a quaternion may have and still be taken for a rotation. Rounding and a filter's drift stay
/// far within; all zeros, or four other numbers, fall outside.
const QUATERNION_LENGTHS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Reads samples from one channel's messages.
#[derive(Debug)]
pub struct ChannelSource {
    decoder: Decoder,
    slots: Vec<FieldValue>,
    attitude: Option<AttitudeSlots>,
    velocity: Option<VelocitySlots>,
    largest: LargestAngles,
}

/// The largest Euler angles that were read, in the profile's unit; 0 where the log has quaternions.
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

#[derive(Debug)]
enum Decoder {
    Protobuf(protobuf::Decoder),
    Json(json::Decoder),
}

/// Where the decoder puts what an attitude is made of.
#[derive(Debug)]
struct AttitudeSlots {
    orientation: OrientationSlots,
    reset_counter: Option<usize>,
}

#[derive(Debug)]
enum OrientationSlots {
    Quaternion(usize),
    Euler { rpy: [usize; 3], unit: AngleUnit },
}

#[derive(Debug)]
struct VelocitySlots {
    ned: [usize; 3],
    valid: Vec<usize>,
}

impl ChannelSource {
    /// Resolves the profile's fields for the wanted kinds of sample against a channel.
    pub fn new(
        log: &Log,
        examples: &Examples,
        channel: &Channel,
        profile: &Profile,
        kinds: &[Kind],
    ) -> Result<Self, Unresolved> {
        let mut wanted: Vec<Wanted> = Vec::new();
        let mut slot_of = |path: &FieldPath, shape: Shape| {
            let path = path.clone();
            let field = Wanted { path, shape };
            let known = wanted.iter().position(|other| *other == field);
            known.unwrap_or_else(|| {
                wanted.push(field);
                wanted.len() - 1
            })
        };
        let mut attitude = None;
        let mut velocity = None;
        if kinds.contains(&Kind::Attitude) {
            let role = &profile.attitude;
            let orientation = match &role.orientation {
                Orientation::Quaternion(quaternion) => {
                    OrientationSlots::Quaternion(slot_of(quaternion, Shape::List))
                }
                Orientation::Euler {
                    roll,
                    pitch,
                    yaw,
                    unit,
                } => OrientationSlots::Euler {
                    rpy: [roll, pitch, yaw].map(|path| slot_of(path, Shape::Number)),
                    unit: *unit,
                },
            };
            let reset_counter = match &role.reset_counter {
                Some(counter) if counter.optional => {
                    let alone = [Wanted {
                        path: counter.field.clone(),
                        shape: Shape::Number,
                    }];
                    let exists = Decoder::new(log, examples, channel, &alone).is_ok();
                    exists.then(|| slot_of(&counter.field, Shape::Number))
                }
                counter => (counter.as_ref()).map(|c| slot_of(&c.field, Shape::Number)),
            };
            attitude = Some(AttitudeSlots {
                orientation,
                reset_counter,
            });
        }
        if let Some(role) = &profile.velocity
            && kinds.contains(&Kind::Velocity)
        {
            velocity = Some(VelocitySlots {
                ned: (role.ned.each_ref()).map(|path| slot_of(path, Shape::Number)),
                valid: (role.valid.iter())
                    .map(|path| slot_of(path, Shape::Number))
                    .collect(),
            });
        }
        Ok(Self {
            decoder: Decoder::new(log, examples, channel, &wanted)?,
            slots: vec![FieldValue::default(); wanted.len()],
            attitude,
            velocity,
            largest: LargestAngles::default(),
        })
    }

    /// Reads one message. `emit` gets a sample, or why there is none, for each kind that the channel has.
    pub fn read(
        &mut self,
        message: &RawMessage,
        mut emit: impl FnMut(Kind, Result<Sample, DropReason>),
    ) {
        self.slots.iter_mut().for_each(FieldValue::clear);
        let decoded = self.decoder.decode(message.payload, &mut self.slots);
        let decoded = decoded.map_err(|Undecodable| DropReason::Undecodable);
        let stamp = Stamp {
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        if let Some(slots) = &self.attitude {
            let sample = decoded.and_then(|()| {
                let (orientation, angles) = slots.orientation.read(&self.slots)?;
                self.largest = self.largest.max(angles);
                let counter = slots
                    .reset_counter
                    .and_then(|slot| self.slots[slot].number());
                Ok(Sample::Attitude(AttitudeSample {
                    stamp,
                    orientation,
                    reset_counter: counter.map(|counter| counter as u64),
                }))
            });
            emit(Kind::Attitude, sample);
        }
        if let Some(slots) = &self.velocity {
            let sample = decoded.and_then(|()| {
                let velocity_ned = slots.read(&self.slots)?;
                Ok(Sample::Velocity(VelocitySample {
                    stamp,
                    velocity: Velocity::Ned(velocity_ned),
                }))
            });
            emit(Kind::Velocity, sample);
        }
    }

    pub fn largest_angles(&self) -> LargestAngles {
        self.largest
    }
}

impl Decoder {
    fn new(
        log: &Log,
        examples: &Examples,
        channel: &Channel,
        wanted: &[Wanted],
    ) -> Result<Self, Unresolved> {
        let schema = log.contents.schema_of(channel);
        let schema_encoding = schema.map_or("", |schema| schema.encoding.as_str());
        match (channel.message_encoding.as_str(), schema_encoding, schema) {
            ("protobuf", "protobuf", Some(schema)) => {
                let decoder = protobuf::Decoder::new(&schema.name, schema.data(), wanted);
                decoder.map(Self::Protobuf)
            }
            ("json", "jsonschema" | "", schema) => {
                let data = schema
                    .map(|schema| schema.data())
                    .filter(|data| !data.is_empty());
                let examples = || examples.of(channel.id);
                json::Decoder::new(data, wanted, examples).map(Self::Json)
            }
            (message_encoding, schema_encoding, _) => Err(Unresolved::Encoding {
                message_encoding: message_encoding.to_owned(),
                schema_encoding: schema_encoding.to_owned(),
            }),
        }
    }

    fn decode(&self, message: &[u8], slots: &mut [FieldValue]) -> Result<(), Undecodable> {
        match self {
            Self::Protobuf(decoder) => decoder.decode(message, slots),
            Self::Json(decoder) => decoder.decode(message, slots),
        }
    }
}

impl OrientationSlots {
    /// The attitude, and the Euler angles of which it was made.
    fn read(
        &self,
        slots: &[FieldValue],
    ) -> Result<(UnitQuaternion<f64>, LargestAngles), DropReason> {
        match self {
            Self::Quaternion(slot) => {
                let value = &slots[*slot];
                if !value.is_present() {
                    return Err(DropReason::MissingField);
                }
                if value.numbers().iter().any(|number| !number.is_finite()) {
                    return Err(DropReason::NonFinite);
                }
                let [w, x, y, z] = value.four().ok_or(DropReason::NotARotation)?;
                let quaternion = Quaternion::new(w, x, y, z);
                if !QUATERNION_LENGTHS.contains(&quaternion.norm()) {
                    return Err(DropReason::NotARotation);
                }
                let orientation = UnitQuaternion::from_quaternion(quaternion);
                Ok((orientation, LargestAngles::default()))
            }
            Self::Euler { rpy, unit } => {
                let [roll, pitch, yaw] = finite(rpy, slots)?;
                let rpy = RollPitchYaw {
                    roll: unit.to_radians(roll),
                    pitch: unit.to_radians(pitch),
                    yaw: unit.to_radians(yaw),
                };
                let angles = LargestAngles {
                    pitch: pitch.abs(),
                    roll_or_yaw: roll.abs().max(yaw.abs()),
                };
                Ok((rpy.to_quaternion(), angles))
            }
        }
    }
}

impl VelocitySlots {
    fn read(&self, slots: &[FieldValue]) -> Result<Vector3<f64>, DropReason> {
        let velocity = finite(&self.ned, slots)?;
        for &slot in &self.valid {
            let valid = slots[slot].number().ok_or(DropReason::MissingField)?;
            if valid == 0.0 {
                return Err(DropReason::MarkedInvalid);
            }
        }
        Ok(velocity.into())
    }
}

/// Three numbers, if all are there and finite.
fn finite(wanted: &[usize; 3], slots: &[FieldValue]) -> Result<[f64; 3], DropReason> {
    let mut numbers = [0.0; 3];
    for (number, &slot) in numbers.iter_mut().zip(wanted) {
        *number = slots[slot].number().ok_or(DropReason::MissingField)?;
    }
    if numbers.iter().all(|number| number.is_finite()) {
        Ok(numbers)
    } else {
        Err(DropReason::NonFinite)
    }
}
