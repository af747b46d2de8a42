//! Profiles: how an autopilot or a logger names its telemetry, and in which conventions it writes it.
//!
//! A profile is a TOML file. The built-in ones lie in `profiles/` and are embedded in the program. For each
//! role, the attitude, the velocity, the gimbal and the position, it lists alternatives in order of preference.

pub mod convention;

mod text;

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{
    decode::path::{FieldPath, NotAPath},
    error::Error,
    sample::GimbalReference,
};
use convention::{
    AngleUnit, Convention, LengthUnit, PositionFrame, PositiveDirection, QuaternionOrder,
    SpeedUnit, TimeUnit, VelocityFrame,
};

/// Where a log of one kind has its telemetry, and in which conventions.
///
/// Unknown keys are refused by [`Profile::parse`].
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
pub struct Profile {
    /// What the report calls it.
    pub name: String,
    /// One line for people.
    #[serde(default)]
    pub description: String,
    /// Whether the profile is tried on a log for which none was named.
    #[serde(default = "yes")]
    pub automatic: bool,
    /// Whether all of its topics may stand in a vehicle's namespace: `/drone1/mavros/…` for `/mavros/…`.
    #[serde(default)]
    pub namespaced: bool,
    /// What the time of a sample is.
    #[serde(default)]
    pub time: TimeSource,
    /// Where the drone's attitude is. At least one.
    #[serde(with = "text::one_or_more")]
    pub attitude: Vec<AttitudeSource>,
    /// Where the drone's velocity over ground is. Without one there is no velocity in the result.
    #[serde(
        default,
        with = "text::one_or_more",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub velocity: Vec<VelocitySource>,
    /// Where the angles of a gimbal that moves are.
    #[serde(
        default,
        with = "text::one_or_more",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub gimbal: Vec<GimbalSource>,
    /// Where the drone's position is.
    #[serde(
        default,
        with = "text::one_or_more",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub position: Vec<PositionSource>,
}

/// Which messages an alternative reads, whatever it reads from them.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[serde(default)]
pub struct Place {
    /// Topics in order of preference; `{n}` in one stands for any number, the largest first, `{vehicle}` for a
    /// vehicle's number, which with all that comes before it is the vehicle's namespace. Empty: for an
    /// attitude any one topic whose messages have all of the fields, else the attitude's own messages.
    pub topics: Vec<String>,
    /// The names of message types, of which a channel must have one. Empty: any. A `/msg/` within makes no
    /// difference.
    pub schemas: Vec<String>,
    /// What must hold for a message to be read so. One for which no alternative holds is dropped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub when: Option<Condition>,
    /// Fields of which each must be true (not 0) for a sample to be valid.
    pub valid: Vec<FieldPath>,
    /// What the time of a sample is, where it is not the profile's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeSource>,
}

/// Where the drone's attitude is, and in which convention.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
pub struct AttitudeSource {
    /// Which messages.
    #[serde(flatten)]
    pub place: Place,
    /// How the drone lies.
    pub orientation: Orientation,
    /// Between which frames the orientation turns.
    #[serde(default)]
    pub convention: Convention,
    /// A count of the estimator's jumps.
    pub reset_counter: Option<OptionalField>,
}

/// Where the drone's velocity over ground is, and in which axes.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
pub struct VelocitySource {
    /// Which messages.
    #[serde(flatten)]
    pub place: Place,
    /// The velocity.
    pub vector: Components<3>,
    /// Its axes.
    pub frame: VelocityFrame,
    /// Its unit.
    #[serde(default)]
    pub unit: SpeedUnit,
    /// Whether the profile fits only a log that has it.
    #[serde(default)]
    pub required: bool,
}

/// Where the angles of a gimbal are, and what they are measured from.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
pub struct GimbalSource {
    /// Which messages.
    #[serde(flatten)]
    pub place: Place,
    /// How it holds the camera.
    pub orientation: GimbalOrientation,
    /// What the angles are measured from.
    pub reference: GimbalReference,
    /// Between which frames the orientation turns: [`Convention::FluEnu`] if camera and reference have their z
    /// axes up.
    #[serde(default)]
    pub convention: Convention,
}

/// Where the drone's position is.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
pub struct PositionSource {
    /// Which messages.
    #[serde(flatten)]
    pub place: Place,
    /// The fields.
    #[serde(flatten)]
    pub coordinates: Coordinates,
}

/// The fields that say how the drone lies.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Orientation {
    /// A rotation.
    Quaternion(Quaternion),
    /// Fixed-axis roll, pitch, yaw (intrinsic ZYX).
    Euler(Euler),
}

/// The fields that say how a gimbal holds the camera.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum GimbalOrientation {
    /// A rotation.
    Quaternion(Quaternion),
    /// Fixed-axis roll, pitch, yaw (intrinsic ZYX).
    Euler(Euler),
    /// The angle of the optical axis over the horizon alone: no roll, and no yaw.
    Pitch(Pitch),
}

/// The fields of a quaternion: one that has all of it, or four in the given order.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "toml::Value")]
pub struct Quaternion {
    /// The fields.
    pub fields: Components<4>,
    /// The order of a list, or of the fields. A message's are told by their names.
    pub order: QuaternionOrder,
}

/// A quaternion's fields with their order.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderedFields {
    fields: Components<4>,
    order: QuaternionOrder,
}

impl TryFrom<toml::Value> for Quaternion {
    type Error = toml::de::Error;

    fn try_from(text: toml::Value) -> Result<Self, Self::Error> {
        if text.is_table() {
            let OrderedFields { fields, order } = text.try_into()?;
            return Ok(Self { fields, order });
        }
        Ok(Self {
            fields: text.try_into()?,
            order: QuaternionOrder::default(),
        })
    }
}

/// The fields of fixed-axis angles, `R = Rz(yaw) Ry(pitch) Rx(roll)`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Euler {
    /// About the front axis.
    pub roll: FieldPath,
    /// About the side axis.
    pub pitch: FieldPath,
    /// About the vertical axis.
    pub yaw: FieldPath,
    /// Of all three.
    pub unit: AngleUnit,
}

/// Why a pitch alone is not measured from north.
pub(in crate::source) const PITCH_ALONE: &str = "a pitch alone has no yaw that could be measured from north: it is \
    measured from the horizon under the drone's heading (`heading`), or from the airframe \
    (`airframe`)";

/// The field of a pitch angle.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Pitch {
    /// The field.
    pub field: FieldPath,
    /// Its unit.
    pub unit: AngleUnit,
    /// Which way is positive.
    #[serde(default)]
    pub positive: PositiveDirection,
}

/// The fields of a position.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Coordinates {
    /// On the globe.
    Geodetic {
        /// North of the equator.
        latitude: FieldPath,
        /// East of Greenwich.
        longitude: FieldPath,
        /// Above whatever the log takes for zero.
        altitude: FieldPath,
        /// Of latitude and longitude.
        unit: AngleUnit,
        /// Of the altitude.
        #[serde(default)]
        altitude_unit: LengthUnit,
    },
    /// From an origin of the log's own.
    Local {
        /// The place.
        vector: Components<3>,
        /// Its axes.
        frame: PositionFrame,
        /// Its unit.
        #[serde(default)]
        unit: LengthUnit,
    },
}

/// The fields of a vector or a quaternion: one that is a list of numbers or a message with `x`, `y`, `z` (and
/// `w`), or a field for each component.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "ComponentsText", into = "ComponentsText")]
pub enum Components<const N: usize> {
    /// All in one.
    Together(FieldPath),
    /// Each by itself.
    Each([FieldPath; N]),
}

/// The ways to write the fields of components.
#[derive(Deserialize, Serialize)]
#[serde(untagged, expecting = "wanted a field or a list of fields")]
enum ComponentsText {
    Together(String),
    Each(Vec<String>),
}

impl<const N: usize> TryFrom<ComponentsText> for Components<N> {
    type Error = String;

    fn try_from(text: ComponentsText) -> Result<Self, String> {
        let path = |text: &String| text.parse().map_err(|error: NotAPath| error.to_string());
        match text {
            ComponentsText::Together(text) => Ok(Self::Together(path(&text)?)),
            ComponentsText::Each(texts) => {
                let paths: Result<Vec<FieldPath>, String> = texts.iter().map(path).collect();
                Self::of(&paths?)
            }
        }
    }
}

impl<const N: usize> From<Components<N>> for ComponentsText {
    fn from(components: Components<N>) -> Self {
        match components {
            Components::Together(path) => Self::Together(path.to_string()),
            Components::Each(paths) => Self::Each(paths.map(|path| path.to_string()).to_vec()),
        }
    }
}

impl<const N: usize> Components<N> {
    /// Of one field, or of as many as there are components.
    ///
    /// # Errors
    /// There are more or fewer.
    pub fn of(paths: &[FieldPath]) -> Result<Self, String> {
        match paths {
            [path] => Ok(Self::Together(path.clone())),
            paths => match paths.to_vec().try_into() {
                Ok(each) => Ok(Self::Each(each)),
                Err(_) => Err(format!(
                    "{} fields were given; it takes one or {N}",
                    paths.len()
                )),
            },
        }
    }

    /// The fields.
    pub fn paths(&self) -> Vec<&FieldPath> {
        match self {
            Self::Together(path) => vec![path],
            Self::Each(paths) => paths.iter().collect(),
        }
    }
}

impl Euler {
    /// The fields: roll, pitch, yaw.
    pub fn paths(&self) -> Vec<&FieldPath> {
        vec![&self.roll, &self.pitch, &self.yaw]
    }
}

/// A field that not every version of a schema has.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table, as in { field = \"count\" }"
)]
pub struct OptionalField {
    /// The field.
    pub field: FieldPath,
    /// Whether a schema without the field is fine.
    #[serde(default)]
    pub optional: bool,
}

/// What must hold for a message to be read in a certain way.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// The field that tells.
    pub field: FieldPath,
    /// What it must hold.
    #[serde(flatten)]
    pub test: Test,
}

/// What a field must hold.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Test {
    /// This number.
    Is(i64),
    /// This text.
    Says(String),
    /// A number with any of these bits.
    HasBits(u64),
}

/// What the time of a sample is.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum TimeSource {
    /// When the recorder received the message.
    #[default]
    LogTime,
    /// When the message was published.
    PublishTime,
    /// What a field of the message says: a number, or a message of seconds and nanoseconds.
    Field {
        /// The field.
        path: FieldPath,
        /// Of a number, which needs one.
        #[serde(skip_serializing_if = "Option::is_none")]
        unit: Option<TimeUnit>,
    },
}

/// Which profile to use.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum ProfileChoice {
    /// The built-in one that fits the log best.
    #[default]
    Automatic,
    /// This one, whatever the log looks like.
    Given(Box<Profile>),
}

/// The built-in profiles, in the order in which they are listed: that of the file names in `profiles/`.
const BUILT_IN: &[&str] = include!(concat!(env!("OUT_DIR"), "/profiles.rs"));

impl Profile {
    /// The built-in profiles.
    pub fn built_in() -> Vec<Self> {
        BUILT_IN
            .iter()
            .map(|text| Self::parse(text).expect("the built-in profiles are tested"))
            .collect()
    }

    /// The text of a built-in profile, with the sources of its conventions.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn built_in_text(name: &str) -> Result<&'static str, Error> {
        let profiles = Self::built_in();
        let place = profiles.iter().position(|profile| profile.name == name);
        place
            .map(|place| BUILT_IN[place])
            .ok_or_else(|| Error::UnknownProfile {
                name: name.to_owned(),
                builtin: profiles.into_iter().map(|profile| profile.name).collect(),
            })
    }

    /// A profile that has an attitude and nothing else.
    pub fn of_attitude(name: &str, attitude: AttitudeSource) -> Self {
        Self {
            name: name.to_owned(),
            description: String::new(),
            automatic: false,
            namespaced: false,
            time: TimeSource::default(),
            attitude: vec![attitude],
            velocity: Vec::new(),
            gimbal: Vec::new(),
            position: Vec::new(),
        }
    }

    /// Reads a profile from TOML.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn parse(toml: &str) -> Result<Self, String> {
        text::parse(toml)
    }

    /// A built-in profile by name, or one from a file: whatever ends in `.toml` or has a folder in its name
    /// is taken for a file.
    ///
    /// # Errors
    /// There is none of that name, or the file cannot be read or is not a profile.
    pub fn load(name_or_file: &str) -> Result<Self, Error> {
        let path = Path::new(name_or_file);
        let is_file = path
            .extension()
            .is_some_and(|extension| extension == "toml")
            || path.components().count() > 1;
        let bad = |problem: String| Error::BadProfile {
            path: path.into(),
            problem,
        };
        if is_file {
            let text = std::fs::read_to_string(path).map_err(|error| bad(error.to_string()))?;
            Self::parse(&text).map_err(bad)
        } else {
            Self::parse(Self::built_in_text(name_or_file)?).map_err(bad)
        }
    }
}

fn yes() -> bool {
    true
}
