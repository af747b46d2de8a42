//! Profiles: how an autopilot or a logger names its telemetry, and in which conventions it writes it.
//!
//! A profile is a TOML file. The built-in ones are in `profiles/` and are embedded in the program. For each
//! role, the attitude, the velocity, the gimbal and the position, it lists alternatives in order of preference.

pub mod convention;

mod camera;
mod components;
mod error;
mod fields;
mod location;
mod own;
mod toml;

use std::{path::Path, sync::OnceLock};

use serde::Serialize;

use super::error::PathReading;
use crate::{decode::path::FieldPath, sample::Kind};
pub use camera::CameraSetup;
pub use components::{Components, WrongCount};
pub use error::{BadRole, NotAProfile, Problem, ProfileError};
pub use fields::{
    AccelerationFields, AngularRateFields, AttitudeFields, Coordinates, Euler, GimbalFields,
    HeightFields, OptionalField, Orientation, Pitch, Quaternion, RoleFields, VelocityFields,
};
pub use location::{Condition, Location, Primary, SampleTime, Test, TimeField, Written};
pub use own::OwnProfile;

/// Where a log of one kind has its telemetry, and in which conventions. [`Profile::parse`] reads it from TOML.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// What the report calls it.
    pub name: String,
    /// A one-line description.
    pub description: String,
    /// Whether the profile is tried on a log for which the user names none.
    pub automatic: bool,
    /// Whether the profile is tried only if no other fits.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub fallback: bool,
    /// Whether all of its topics may be in a vehicle's namespace: `/drone1/mavros/…` for `/mavros/…`.
    pub namespaced: bool,
    /// What the time of a sample is.
    pub time: SampleTime,
    /// How the camera is built, as far as the profile says. What the caller says takes precedence.
    #[serde(skip_serializing_if = "is_default")]
    pub camera: CameraSetup,
    #[serde(flatten, serialize_with = "toml::roles::serialize")]
    roles: Roles,
}

/// The alternatives of each role.
type Roles = [Vec<Alternative>; Kind::ALL.len()];

/// One of the places where a role may be, and what it is made of there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alternative {
    /// Which messages it reads.
    #[serde(flatten)]
    pub location: Location,
    /// The fields that it reads from them.
    #[serde(flatten)]
    pub fields: RoleFields,
}

impl Alternative {
    /// Whether it reads any message, whatever that says.
    pub(in crate::source) fn reads_any_message(&self) -> bool {
        let Location { when, select, .. } = &self.location;
        let chooses_elements = |path: &&FieldPath| path.has_filters();
        when.is_none() && select.is_empty() && !self.fields.fields().iter().any(chooses_elements)
    }
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

impl Alternative {
    /// What its paths mean if more of them is the topic, which may have dots; nothing if the topic was in quotes.
    pub(super) fn longer_readings(&self) -> Vec<PathReading> {
        let mut readings = Vec::new();
        let (Written::InPaths, [topic]) = (self.location.written, &self.location.topics[..]) else {
            return readings;
        };
        let mut topic = topic.clone();
        let mut fields: Vec<FieldPath> = self.fields.fields().into_iter().cloned().collect();
        loop {
            let split: Option<Vec<_>> = fields.iter().map(FieldPath::split_first).collect();
            let Some(split) = split else {
                return readings;
            };
            let first = split[0].0;
            if split.iter().any(|(name, _)| *name != first) {
                return readings;
            }
            topic = format!("{topic}.{first}");
            let rest: Vec<FieldPath> = split.into_iter().filter_map(|(_, rest)| rest).collect();
            let is_whole = rest.is_empty();
            if !is_whole && rest.len() < fields.len() {
                return readings;
            }
            readings.push(PathReading {
                topic: (&topic).into(),
                fields: rest.clone(),
            });
            if is_whole {
                return readings;
            }
            fields = rest;
        }
    }
}

impl Profile {
    /// The built-in profiles.
    pub fn built_in() -> Vec<Self> {
        Self::known().to_vec()
    }

    /// The same, parsed only once.
    pub(in crate::source) fn known() -> &'static [Self] {
        static PROFILES: OnceLock<Vec<Profile>> = OnceLock::new();
        PROFILES.get_or_init(|| {
            BUILT_IN
                .iter()
                .map(|text| Self::parse(text).expect("the built-in profiles are tested"))
                .collect()
        })
    }

    /// The texts of the built-in profiles, with the sources of their conventions.
    pub fn built_in_texts() -> &'static [&'static str] {
        BUILT_IN
    }

    /// The text of a built-in profile, with the sources of its conventions.
    ///
    /// # Errors
    /// No built-in profile has this name.
    pub fn built_in_text(name: &str) -> Result<&'static str, ProfileError> {
        Self::place(name).map(|place| BUILT_IN[place])
    }

    /// The place of a built-in profile among the others.
    fn place(name: &str) -> Result<usize, ProfileError> {
        let profiles = Self::known();
        let place = profiles.iter().position(|profile| profile.name == name);
        place.ok_or_else(|| ProfileError::Unknown {
            name: name.into(),
            built_in: profiles.iter().map(|one| (&one.name).into()).collect(),
        })
    }

    /// Creates a profile that has no role yet. It needs at least an attitude.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            description: String::new(),
            automatic: false,
            fallback: false,
            namespaced: false,
            time: SampleTime::default(),
            camera: CameraSetup::default(),
            roles: Roles::default(),
        }
    }

    /// Adds an alternative, after the others of its role.
    #[must_use]
    pub fn with(mut self, alternative: Alternative) -> Self {
        self.alternatives_mut(alternative.fields.kind())
            .push(alternative);
        self
    }

    /// The alternatives of a role, in order of preference.
    pub fn alternatives(&self, role: Kind) -> &[Alternative] {
        &self.roles[role as usize]
    }

    /// Reads what is in the attitude's own messages from those of the same source, if all of the attitude's alternatives
    /// select the same.
    pub(super) fn share_selection(&mut self) {
        let [first, others @ ..] = self.alternatives(Kind::Attitude) else {
            return;
        };
        let select = first.location.select.clone();
        if others.iter().any(|other| other.location.select != select) {
            return;
        }
        for alternative in self.roles.iter_mut().flatten() {
            let Location {
                topics,
                select: own,
                ..
            } = &mut alternative.location;
            if topics.is_empty() && own.is_empty() {
                own.clone_from(&select);
            }
        }
    }

    /// Whether it fits only a log that has a velocity.
    pub(super) fn requires_velocity(&self) -> bool {
        let mut alternatives = self.alternatives(Kind::Velocity).iter();
        alternatives.any(|alternative| alternative.fields.is_required())
    }

    pub(super) fn alternatives_mut(&mut self, role: Kind) -> &mut Vec<Alternative> {
        &mut self.roles[role as usize]
    }

    /// Reads a profile from TOML.
    ///
    /// # Errors
    /// The text is not a profile; the error says why, and where.
    pub fn parse(toml: &str) -> Result<Self, NotAProfile> {
        toml::parse(toml)
    }

    /// Loads a built-in profile by name, or one from [a file](Self::is_in_a_file).
    ///
    /// # Errors
    /// No built-in profile has this name, or the file cannot be read or is not a profile.
    pub fn load(name_or_file: &str) -> Result<Self, ProfileError> {
        match Self::is_in_a_file(name_or_file) {
            true => Ok(OwnProfile::read(Path::new(name_or_file))?.profile),
            false => Ok(Self::known()[Self::place(name_or_file)?].clone()),
        }
    }

    /// Whether this is the path of a file, and not a name: it ends in `.toml`, or contains a folder.
    pub fn is_in_a_file(name_or_file: &str) -> bool {
        let path = Path::new(name_or_file);
        own::is_toml(path) || path.components().count() > 1
    }
}

fn yes() -> bool {
    true
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
