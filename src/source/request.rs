//! What the user says of a log's telemetry: a profile, a vehicle, and fields on the command line.

mod argument;

use std::{collections::BTreeMap, str::FromStr};

use super::{
    alternative::Alternative,
    profile::{
        AttitudeSource, Coordinates, GimbalOrientation, GimbalSource, Orientation, PITCH_ALONE,
        Pitch, PositionSource, Profile, ProfileChoice, TimeSource, VelocitySource,
        convention::{AngleUnit, Convention, PositionFrame},
    },
    topic::Pattern,
};
use crate::sample::{GimbalReference, Kind};
use argument::{ANGLE_UNITS, CONVENTIONS, Parts, QUATERNION_ORDERS, REFERENCES, Vocabulary, Words};

/// How the user wants a log's telemetry to be found. By default all is left to the built-in profiles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// Which profile.
    pub profile: ProfileChoice,
    /// Which vehicle of several: the prefix of its topics, empty for the one without.
    pub namespace: Option<String>,
    /// Where the attitude is, instead of where the profile says.
    pub attitude: Option<RoleArgument<AttitudeSource>>,
    /// Where the velocity is, instead of where the profile says.
    pub velocity: Option<RoleArgument<VelocitySource>>,
    /// Where the gimbal's angles are, instead of where the profile says.
    pub gimbal: Option<RoleArgument<GimbalSource>>,
    /// Where the position is, instead of where the profile says.
    pub position: Option<RoleArgument<PositionSource>>,
    /// What the time of a sample is, instead of what the profile says.
    pub time: Option<TimeSource>,
}

/// One role's place in the log, as told on the command line: paths of one topic, joined by commas, and behind
/// colons the units and conventions, as in `/imu.roll,/imu.pitch,/imu.yaw:degrees`.
#[derive(Debug, Clone, PartialEq)]
pub enum RoleArgument<Source> {
    /// Only the topic; the profile says how to read its messages.
    Topic(String),
    /// Everything.
    Source(Source),
}

/// What is wrong with a role's argument.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct BadArgument(String);

/// The prefix that a namespace gives to topics: `/drone1` for `drone1` and `/drone1/`, nothing for `/`.
///
/// # Errors
/// None; command-line parsers want a result.
pub fn namespace(text: &str) -> Result<String, std::convert::Infallible> {
    Ok(match text.trim_matches('/') {
        "" => String::new(),
        name => format!("/{name}"),
    })
}

impl Request {
    /// The profiles to try: that which was asked for, or all that are tried by themselves.
    pub fn profiles(&self) -> Vec<Profile> {
        let mut profiles = match (&self.profile, &self.attitude) {
            (ProfileChoice::Given(profile), _) => vec![(**profile).clone()],
            // With the attitude told, nothing of a built-in profile would be left that tells it from another.
            (ProfileChoice::Automatic, Some(RoleArgument::Source(attitude))) => {
                vec![Profile::of_attitude("command line", attitude.clone())]
            }
            (ProfileChoice::Automatic, _) => Profile::built_in()
                .into_iter()
                .filter(|profile| profile.automatic)
                .collect(),
        };
        if let Some(RoleArgument::Topic(topic)) = &self.attitude {
            let knows =
                |profile: &Profile| profile.attitude.iter().any(|source| knows(source, topic));
            if profiles.iter().any(knows) {
                profiles.retain(knows);
            }
        }
        for profile in &mut profiles {
            replace(&mut profile.attitude, &self.attitude);
            replace(&mut profile.velocity, &self.velocity);
            replace(&mut profile.gimbal, &self.gimbal);
            replace(&mut profile.position, &self.position);
            if let Some(time) = &self.time {
                profile.time = time.clone();
                keep_one_time(&mut profile.attitude);
                keep_one_time(&mut profile.velocity);
                keep_one_time(&mut profile.gimbal);
                keep_one_time(&mut profile.position);
            }
        }
        profiles
    }

    /// The roles whose place is told.
    pub(super) fn told(&self) -> BTreeMap<Kind, Told<'_>> {
        let told = [
            told(&self.attitude),
            told(&self.velocity),
            told(&self.gimbal),
            told(&self.position),
        ];
        told.into_iter().flatten().collect()
    }
}

/// What is told of a role.
#[derive(Debug, Clone, Copy)]
pub(super) struct Told<'a> {
    /// Its topics, as the log has them, whatever the namespace.
    pub topics: &'a [String],
    /// Whether the fields are told too, so that no profile changes anything.
    pub has_fields: bool,
}

fn told<Source: Alternative>(argument: &Option<RoleArgument<Source>>) -> Option<(Kind, Told<'_>)> {
    let told = match argument.as_ref()? {
        RoleArgument::Topic(topic) => Told {
            topics: std::slice::from_ref(topic),
            has_fields: false,
        },
        RoleArgument::Source(source) => Told {
            topics: &source.place().topics,
            has_fields: true,
        },
    };
    Some((Source::KIND, told))
}

fn replace<Source: Alternative + Clone>(
    alternatives: &mut Vec<Source>,
    argument: &Option<RoleArgument<Source>>,
) {
    match argument {
        None => {}
        Some(RoleArgument::Source(source)) => *alternatives = vec![source.clone()],
        Some(RoleArgument::Topic(topic)) => {
            // How a topic is to be read is known of that topic, not of others.
            if alternatives.iter().any(|source| knows(source, topic)) {
                alternatives.retain(|source| knows(source, topic));
            }
            for alternative in alternatives {
                alternative.place_mut().topics = vec![topic.clone()];
            }
        }
    }
}

/// Whether an alternative is for a topic, in any namespace.
fn knows(alternative: &impl Alternative, topic: &str) -> bool {
    let mut topics = alternative.place().topics.iter();
    topics.any(|known| Pattern::new("", known).namespace_of(topic).is_some())
}

/// Leaves the time of samples to the profile.
fn keep_one_time<Source: Alternative>(alternatives: &mut [Source]) {
    for alternative in alternatives {
        alternative.place_mut().time = None;
    }
}

impl<Source> RoleArgument<Source> {
    /// Reads an argument that has fields with `read`.
    fn parse(
        text: &str,
        read: impl FnOnce(&mut Parts) -> Result<Source, BadArgument>,
        known_words: Vocabulary,
    ) -> Result<Self, BadArgument> {
        let mut parts: Parts = text.parse()?;
        parts.words.check(known_words)?;
        if parts.fields.is_empty() {
            return match parts.words.0.first() {
                None => Ok(Self::Topic(parts.topic)),
                Some(word) => Err(BadArgument(format!(
                    "only a topic is given, of which the profile says how to read it; \
                     name the fields that `{word}` is said of, as in {}.field:{word}",
                    parts.topic
                ))),
            };
        }
        let source = read(&mut parts)?;
        parts.words.finish()?;
        Ok(Self::Source(source))
    }
}

impl FromStr for RoleArgument<AttitudeSource> {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let what =
            "an attitude takes one (a quaternion), three (roll, pitch, yaw) or four (w, x, y, z)";
        let read = |parts: &mut Parts| {
            let unit: Option<AngleUnit> = parts.words.take();
            let orientation = match (parts.fields.len(), unit) {
                (3, None) => {
                    return Err(BadArgument(
                        "roll, pitch and yaw need their unit: `:degrees` or `:radians` behind the fields"
                            .to_owned(),
                    ));
                }
                (_, Some(unit)) => Orientation::Euler(parts.euler(unit).ok_or_else(|| {
                    BadArgument(
                        "an angle's unit goes with three fields: roll, pitch, yaw".to_owned(),
                    )
                })?),
                (_, None) => Orientation::Quaternion(parts.quaternion(what)?),
            };
            Ok(AttitudeSource {
                place: parts.place(),
                orientation,
                convention: parts.words.take().unwrap_or_default(),
                reset_counter: None,
            })
        };
        Self::parse(text, read, &[ANGLE_UNITS, QUATERNION_ORDERS, CONVENTIONS])
    }
}

impl FromStr for RoleArgument<VelocitySource> {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let what = "a velocity takes one (a vector) or three";
        let read = |parts: &mut Parts| {
            Ok(VelocitySource {
                place: parts.place(),
                vector: parts.components(what)?,
                frame: parts.words.take().ok_or_else(|| {
                    BadArgument(
                        "a velocity needs its axes: `:ned`, `:enu`, `:body-frd` or `:body-flu` behind the fields"
                            .to_owned(),
                    )
                })?,
                unit: parts.words.take().unwrap_or_default(),
                required: false,
            })
        };
        Self::parse(
            text,
            read,
            &[
                &["ned", "enu", "body-frd", "body-flu"],
                &["m/s", "cm/s", "mm/s"],
            ],
        )
    }
}

impl FromStr for RoleArgument<GimbalSource> {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let what = "a gimbal takes one (a pitch angle or a quaternion), three (roll, pitch, yaw) or four (w, x, y, z)";
        let read = |parts: &mut Parts| {
            let unit: Option<AngleUnit> = parts.words.take();
            let orientation = match (parts.fields.as_slice(), unit) {
                ([field], Some(unit)) => GimbalOrientation::Pitch(Pitch {
                    field: field.clone(),
                    unit,
                    positive: parts.words.take().unwrap_or_default(),
                }),
                (_, Some(unit)) => {
                    GimbalOrientation::Euler(parts.euler(unit).ok_or_else(|| {
                        BadArgument(
                        "an angle's unit goes with one field, the pitch, or three: roll, pitch, yaw"
                            .to_owned(),
                    )
                    })?)
                }
                ([_], None)
                    if parts
                        .words
                        .0
                        .iter()
                        .all(|word| !REFERENCES.contains(&word.as_str())) =>
                {
                    return Err(BadArgument(
                        "one field is a pitch angle, which needs its unit (`:degrees`, `:radians`), or a quaternion, \
                         which needs what it is measured from (`:earth`, `:heading`, `:airframe`)"
                            .to_owned(),
                    ));
                }
                ([_, _, _], None) => {
                    return Err(BadArgument(
                        "roll, pitch and yaw need their unit: `:degrees` or `:radians` behind the fields"
                            .to_owned(),
                    ));
                }
                (_, None) => GimbalOrientation::Quaternion(parts.quaternion(what)?),
            };
            let reference = match (parts.words.take(), &orientation) {
                (Some(GimbalReference::Earth), GimbalOrientation::Pitch(_)) => {
                    return Err(BadArgument(PITCH_ALONE.to_owned()));
                }
                (Some(reference), _) => reference,
                // A pitch alone has no yaw that would be measured from anything.
                (None, GimbalOrientation::Pitch(_)) => GimbalReference::Heading,
                (None, _) => {
                    return Err(BadArgument(
                        "a gimbal's rotation needs what it is measured from: `:earth`, `:heading` or `:airframe` \
                         behind the fields"
                            .to_owned(),
                    ));
                }
            };
            let convention = match orientation {
                // Its sign is told by `up` and `down`.
                GimbalOrientation::Pitch(_) => Convention::default(),
                _ => parts.words.take().unwrap_or_default(),
            };
            Ok(GimbalSource {
                place: parts.place(),
                orientation,
                reference,
                convention,
            })
        };
        Self::parse(
            text,
            read,
            &[
                ANGLE_UNITS,
                &["up", "down"],
                QUATERNION_ORDERS,
                REFERENCES,
                CONVENTIONS,
            ],
        )
    }
}

impl FromStr for RoleArgument<PositionSource> {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let what = "a position takes three: latitude, longitude, altitude or x, y, z, or one (a vector x, y, z)";
        let read = |parts: &mut Parts| {
            let unit: Option<AngleUnit> = parts.words.take();
            let frame: Option<PositionFrame> = parts.words.take();
            let length = parts.words.take().unwrap_or_default();
            let coordinates = match (unit, frame, parts.fields.as_slice()) {
                (Some(unit), None, [latitude, longitude, altitude]) => Coordinates::Geodetic {
                    latitude: latitude.clone(),
                    longitude: longitude.clone(),
                    altitude: altitude.clone(),
                    unit,
                    altitude_unit: length,
                },
                (None, Some(frame), _) => Coordinates::Local {
                    vector: parts.components(what)?,
                    frame,
                    unit: length,
                },
                _ => {
                    return Err(BadArgument(format!(
                        "{what}; latitude and longitude need their unit (`:degrees`, `:degE7`), x, y and z their \
                         axes (`:ned`, `:enu`)"
                    )));
                }
            };
            Ok(PositionSource {
                place: parts.place(),
                coordinates,
            })
        };
        Self::parse(
            text,
            read,
            &[
                &["radians", "degrees", "degE7"],
                &["ned", "enu"],
                &["m", "cm", "mm"],
            ],
        )
    }
}

impl FromStr for TimeSource {
    type Err = BadArgument;

    fn from_str(text: &str) -> Result<Self, BadArgument> {
        let (path, unit) = match text.split_once(':') {
            Some((path, unit)) => (path, Some(unit)),
            None => (text, None),
        };
        match (path, unit) {
            ("log", None) => Ok(Self::LogTime),
            ("publish", None) => Ok(Self::PublishTime),
            (path, unit) => {
                let mut words = Words(unit.map(str::to_owned).into_iter().collect());
                words.check(&[&["s", "ms", "us", "ns"]])?;
                let not_a_field = |_| {
                    BadArgument(format!(
                        "`{path}` is not a time: write log, publish, or a field of the messages without their \
                         topic, as in header.stamp or time_usec:us"
                    ))
                };
                Ok(Self::Field {
                    path: path.parse().map_err(not_a_field)?,
                    unit: words.take(),
                })
            }
        }
    }
}
