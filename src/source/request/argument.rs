//! Where a role is, as an argument gives it.

use std::str::FromStr;

use super::{
    BadArgument,
    parts::{Parts, REFERENCES, TIME_UNITS, Words, vocabulary},
};
use crate::{
    decode::path::{FieldPath, Filter, split},
    sample::{GimbalReference, Kind},
    source::profile::{
        AccelerationFields, Alternative, AngularRateFields, AttitudeFields, Components,
        Coordinates, Euler, GimbalFields, HeightFields, Location, Orientation, Pitch, Quaternion,
        RoleFields, SampleTime, TimeField, VelocityFields, Written,
        convention::{AngleUnit, Axes, WorldAxes},
    },
};

/// One role's place in the log, as an argument gives it: paths of one topic, joined by commas, and after colons the
/// units and conventions, as in `/imu.roll,/imu.pitch,/imu.yaw:degrees`. Where several sources share a topic, a filter
/// after it says which one is meant, as in `/gimbal{device_id==1}.q`.
#[derive(Debug, Clone, PartialEq)]
pub enum RoleArgument {
    /// Only the topic; the profile says how to read its messages.
    Topic {
        /// The topic.
        topic: String,
        /// What its messages must satisfy, if that is not left to the profile.
        select: Vec<Filter>,
    },
    /// The topic, the fields and the conventions.
    Fields(Box<Alternative>),
}

impl RoleArgument {
    /// Reads a role's argument.
    ///
    /// # Errors
    /// The argument is wrong; the error says how.
    pub fn parse(role: Kind, text: &str) -> Result<Self, BadArgument> {
        let Parts {
            topic,
            filters,
            quoted,
            fields,
            mut words,
        } = text.parse()?;
        words.check(vocabulary(role))?;
        if fields.is_empty() {
            return match words.0.into_iter().next() {
                None => Ok(Self::Topic {
                    topic,
                    select: filters,
                }),
                Some(word) => Err(BadArgument::NoFields {
                    topic: topic.into(),
                    word: word.into(),
                }),
            };
        }
        let fields = match role {
            Kind::Attitude => RoleFields::Attitude(attitude(&fields, &mut words)?),
            Kind::Velocity => RoleFields::Velocity(velocity(&fields, &mut words)?),
            Kind::Gimbal => RoleFields::Gimbal(gimbal(&fields, &mut words)?),
            Kind::Position => RoleFields::Position(position(&fields, &mut words)?),
            Kind::Height => RoleFields::Height(height(&fields, &mut words)?),
            Kind::AngularRate => RoleFields::AngularRate(AngularRateFields {
                vector: components(role, &fields)?,
                frame: words.take().ok_or(BadArgument::NoBodyAxes)?,
                unit: words.take().unwrap_or_default(),
            }),
            Kind::Acceleration => RoleFields::Acceleration(AccelerationFields {
                vector: components(role, &fields)?,
                frame: words.take().ok_or(BadArgument::NoBodyAxes)?,
                unit: words.take().unwrap_or_default(),
            }),
        };
        fields.check()?;
        words.finish()?;
        let location = Location {
            select: filters,
            written: if quoted {
                Written::Exactly
            } else {
                Written::InPaths
            },
            ..Location::on(topic)
        };
        Ok(Self::Fields(Alternative { location, fields }.into()))
    }

    /// The topics as the log has them, whatever the namespace.
    pub fn topics(&self) -> &[String] {
        match self {
            Self::Topic { topic, .. } => std::slice::from_ref(topic),
            Self::Fields(alternative) => &alternative.location.topics,
        }
    }
}

fn attitude(fields: &[FieldPath], words: &mut Words) -> Result<AttitudeFields, BadArgument> {
    let role = Kind::Attitude;
    let unit: Option<AngleUnit> = words.take();
    Ok(AttitudeFields {
        orientation: match (fields, unit) {
            ([_, _, _], None) => return Err(BadArgument::NoAngleUnit),
            (fields, Some(unit)) => Orientation::Euler(euler(role, fields, unit, words)?),
            (fields, None) => Orientation::Quaternion(quaternion(role, fields, words)?),
        },
        convention: words.take(),
        reset_counter: None,
    })
}

fn velocity(fields: &[FieldPath], words: &mut Words) -> Result<VelocityFields, BadArgument> {
    Ok(VelocityFields {
        vector: components(Kind::Velocity, fields)?,
        frame: words.take::<Axes>().ok_or(BadArgument::NoAxes)?,
        unit: words.take().unwrap_or_default(),
        required: false,
    })
}

fn gimbal(fields: &[FieldPath], words: &mut Words) -> Result<GimbalFields, BadArgument> {
    let role = Kind::Gimbal;
    let unit: Option<AngleUnit> = words.take();
    let orientation = match (fields, unit) {
        ([field], Some(unit)) => {
            return Ok(GimbalFields {
                orientation: Orientation::Pitch(Pitch {
                    field: field.clone(),
                    unit,
                    positive: words.take().unwrap_or_default(),
                }),
                // A pitch alone has no yaw that would be measured from a reference.
                reference: words.take().unwrap_or(GimbalReference::Heading),
                // `up` and `down` say its sign.
                convention: None,
            });
        }
        (fields, Some(unit)) => Orientation::Euler(euler(role, fields, unit, words)?),
        ([_], None) if !words.has(REFERENCES) => return Err(BadArgument::PitchOrQuaternion),
        ([_, _, _], None) => return Err(BadArgument::NoAngleUnit),
        (fields, None) => Orientation::Quaternion(quaternion(role, fields, words)?),
    };
    Ok(GimbalFields {
        orientation,
        reference: words.take().ok_or(BadArgument::NoReference)?,
        convention: words.take(),
    })
}

fn position(fields: &[FieldPath], words: &mut Words) -> Result<Coordinates, BadArgument> {
    let unit: Option<AngleUnit> = words.take();
    let frame: Option<WorldAxes> = words.take();
    match (unit, frame, fields) {
        (Some(unit), None, [latitude, longitude, altitude]) => Ok(Coordinates::Geodetic {
            latitude: latitude.clone(),
            longitude: longitude.clone(),
            altitude: altitude.clone(),
            unit,
            altitude_unit: words.take().unwrap_or_default(),
        }),
        (None, Some(frame), fields) => Ok(Coordinates::Local {
            vector: components(Kind::Position, fields)?,
            frame,
            unit: words.take().unwrap_or_default(),
        }),
        _ => Err(BadArgument::NotAPosition),
    }
}

fn height(fields: &[FieldPath], words: &mut Words) -> Result<HeightFields, BadArgument> {
    match fields {
        [field] => Ok(HeightFields {
            field: field.clone(),
            unit: words.take().unwrap_or_default(),
        }),
        _ => Err(BadArgument::FieldCount {
            count: fields.len(),
            role: Kind::Height,
        }),
    }
}

/// Takes one field, or as many as there are components.
fn components<const N: usize>(
    role: Kind,
    fields: &[FieldPath],
) -> Result<Components<N>, BadArgument> {
    let count = fields.len();
    Components::of(fields.to_vec()).map_err(|_| BadArgument::FieldCount { count, role })
}

fn quaternion(
    role: Kind,
    fields: &[FieldPath],
    words: &mut Words,
) -> Result<Quaternion, BadArgument> {
    Ok(Quaternion {
        fields: components(role, fields)?,
        order: words.take().unwrap_or_default(),
    })
}

fn euler(
    role: Kind,
    fields: &[FieldPath],
    unit: AngleUnit,
    words: &mut Words,
) -> Result<Euler, BadArgument> {
    let [roll, pitch, yaw] = fields else {
        return Err(BadArgument::NoAngles { role });
    };
    Ok(Euler {
        roll: roll.clone(),
        pitch: pitch.clone(),
        yaw: yaw.clone(),
        unit,
        order: words.take().unwrap_or_default(),
    })
}

impl FromStr for SampleTime {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        match split(text, ':').as_slice() {
            ["log"] => Ok(Self::LogTime),
            ["publish"] => Ok(Self::PublishTime),
            [] => Err(BadArgument::NotATime { path: text.into() }),
            [path, words @ ..] => {
                let mut words = Words(words.iter().map(|&word| word.to_owned()).collect());
                words.check(TIME_UNITS)?;
                let path = path.parse().map_err(|_| BadArgument::NotATime {
                    path: (*path).into(),
                })?;
                let unit = words.take();
                words.finish()?;
                Ok(Self::Field(TimeField { path, unit }))
            }
        }
    }
}
