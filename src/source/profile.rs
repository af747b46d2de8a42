//! Profiles: how an autopilot or a logger names its telemetry.
//!
//! A profile is a TOML file. The built-in ones lie in `profiles/` and are embedded in the program.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::field::FieldPath;
use crate::{error::Error, sample::Kind};

/// Where a log of one kind has its telemetry, and in which convention.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// What the report calls it.
    pub name: String,
    /// One line for people.
    #[serde(default)]
    pub description: String,
    /// Whether the profile is tried on a log for which none was named.
    #[serde(default = "yes")]
    pub automatic: bool,
    /// Where the drone's attitude is.
    pub attitude: AttitudeRole,
    /// Without it there is no velocity in the result.
    pub velocity: Option<VelocityRole>,
}

/// Where the drone's attitude is: FRD in NED.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AttitudeRole {
    /// Topics in order of preference. Empty: any one topic whose messages have all of the fields.
    #[serde(default)]
    pub topics: Vec<String>,
    /// How the drone lies.
    pub orientation: Orientation,
    /// A count of the estimator's jumps.
    pub reset_counter: Option<OptionalField>,
}

/// The fields that say how the drone lies.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Orientation {
    /// A list of four numbers: w, x, y, z.
    Quaternion(FieldPath),
    /// Fixed-axis roll, pitch, yaw (intrinsic ZYX).
    Euler {
        /// About the front axis.
        roll: FieldPath,
        /// About the right axis.
        pitch: FieldPath,
        /// About the down axis.
        yaw: FieldPath,
        /// Of all three.
        unit: AngleUnit,
    },
}

/// The unit of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AngleUnit {
    /// One turn is 2π.
    Radians,
    /// One turn is 360.
    Degrees,
}

impl AngleUnit {
    /// An angle of this unit in radians.
    pub fn to_radians(self, angle: f64) -> f64 {
        match self {
            AngleUnit::Radians => angle,
            AngleUnit::Degrees => angle.to_radians(),
        }
    }
}

/// A field that not every version of a schema has.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct OptionalField {
    /// The field.
    pub field: FieldPath,
    /// Whether a schema without the field is fine.
    #[serde(default)]
    pub optional: bool,
}

/// Where the drone's velocity over ground is.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityRole {
    /// Topics in order of preference. Empty: the attitude's own messages have the velocity as well.
    #[serde(default)]
    pub topics: Vec<String>,
    /// Its components to north, east and down, m/s.
    pub ned: [FieldPath; 3],
    /// Fields of which each must be true (not 0) for a sample to be valid.
    #[serde(default)]
    pub valid: Vec<FieldPath>,
}

/// Which profile to use.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum ProfileChoice {
    /// The first built-in one that fits the log.
    #[default]
    Automatic,
    /// This one, whatever the log looks like.
    Given(Box<Profile>),
}

const BUILT_IN: [&str; 3] = [
    include_str!("../../profiles/px4-ulog.toml"),
    include_str!("../../profiles/flat.toml"),
    include_str!("../../profiles/flat-deg.toml"),
];

impl Profile {
    /// The built-in profiles, in the order in which they are tried.
    pub fn built_in() -> Vec<Self> {
        BUILT_IN
            .iter()
            .map(|text| toml::from_str(text).expect("the built-in profiles are tested"))
            .collect()
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
        if is_file {
            let bad = |problem: String| Error::BadProfile {
                path: path.into(),
                problem,
            };
            let text = std::fs::read_to_string(path).map_err(|error| bad(error.to_string()))?;
            return toml::from_str(&text).map_err(|error| bad(error.to_string().trim().to_owned()));
        }
        let mut built_in = Self::built_in();
        match built_in
            .iter()
            .position(|profile| profile.name == name_or_file)
        {
            Some(index) => Ok(built_in.swap_remove(index)),
            None => Err(Error::UnknownProfile {
                name: name_or_file.to_owned(),
                builtin: built_in.into_iter().map(|profile| profile.name).collect(),
            }),
        }
    }

    /// The fields that a message must have for these kinds of sample.
    pub fn required_fields(&self, kinds: &[Kind]) -> Vec<FieldPath> {
        let mut fields = Vec::new();
        if kinds.contains(&Kind::Attitude) {
            fields.extend(self.attitude.required_fields());
        }
        if let Some(velocity) = &self.velocity
            && kinds.contains(&Kind::Velocity)
        {
            fields.extend(velocity.ned.iter().chain(&velocity.valid).cloned());
        }
        fields
    }
}

impl AttitudeRole {
    /// The fields that a message with the attitude must have.
    pub fn required_fields(&self) -> Vec<FieldPath> {
        let mut fields = match &self.orientation {
            Orientation::Quaternion(quaternion) => vec![quaternion.clone()],
            Orientation::Euler {
                roll, pitch, yaw, ..
            } => vec![roll.clone(), pitch.clone(), yaw.clone()],
        };
        let counter = self
            .reset_counter
            .as_ref()
            .filter(|counter| !counter.optional);
        fields.extend(counter.map(|counter| counter.field.clone()));
        fields
    }
}

fn yes() -> bool {
    true
}
