//! What the user asks for: a profile, a vehicle, and where roles are in the log.

mod argument;
mod error;
mod parts;

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    pattern::Pattern,
    profile::{Alternative, Profile, ProfileChoice, SampleTime},
};
use crate::{
    sample::{Kind, VelocityFrom},
    text::Foreign,
};
pub use argument::RoleArgument;
pub use error::BadArgument;

/// How the user wants a log's telemetry to be found. By default everything is left to the built-in profiles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// The profile to use.
    pub profile: ProfileChoice,
    /// Profiles of the user's own, which are tried beside the built-in ones. One that fits as well as a built-in one is
    /// preferred, and one with the name of a built-in one takes its place.
    pub own_profiles: Vec<Profile>,
    /// The vehicle to use, if there are several: the prefix of its topics, empty for one without.
    pub namespace: Option<String>,
    /// Where roles are, instead of where the profile says.
    pub roles: BTreeMap<Kind, RoleArgument>,
    /// What the time of a sample is, instead of what the profile says.
    pub time: Option<SampleTime>,
    /// What the velocity is taken from. A profile that fits only a log with a velocity then fits one with positions.
    pub velocity_from: VelocityFrom,
}

/// A profile with what was asked for in place of what it says.
#[derive(Debug, Clone)]
pub struct Adapted {
    /// The profile, changed.
    pub profile: Profile,
    /// Where the profile itself finds the attitude, if the user gives the fields of another.
    pub own_attitude: Option<Vec<Alternative>>,
    /// Whether the profile is one of the user's own.
    pub is_own: bool,
}

impl Adapted {
    /// Where the profile itself finds the attitude, by which it recognises its logs.
    pub(super) fn attitude(&self) -> &[Alternative] {
        let changed = self.profile.alternatives(Kind::Attitude);
        self.own_attitude.as_deref().unwrap_or(changed)
    }

    /// The profile with the attitude of its own, if the user gives another.
    pub(super) fn with_own_attitude(&self) -> Option<Profile> {
        let own_attitude = self.own_attitude.clone()?;
        let mut profile = self.profile.clone();
        *profile.alternatives_mut(Kind::Attitude) = own_attitude;
        Some(profile)
    }
}

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

/// How the user asked for a role to be read, which is where to change it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "by", rename_all = "snake_case")]
#[non_exhaustive]
pub enum HowAsked {
    /// By naming its fields.
    Argument,
    /// By a profile of the user's own.
    OwnProfile {
        /// Its name.
        profile: Foreign,
    },
    /// By the name of a built-in profile, or not at all.
    BuiltIn {
        /// The profile's name.
        profile: Foreign,
    },
}

impl Request {
    /// How the user asked for a role to be read that is read by this profile.
    pub fn how_asked(&self, role: Kind, profile: &Profile) -> HowAsked {
        let is_own = self.is_own(&profile.name);
        let profile = (&profile.name).into();
        match (self.roles.get(&role), is_own) {
            (Some(RoleArgument::Fields(_)), _) => HowAsked::Argument,
            (_, true) => HowAsked::OwnProfile { profile },
            (_, false) => HowAsked::BuiltIn { profile },
        }
    }

    /// Whether the profile of this name that is used is one of the user's own.
    fn is_own(&self, name: &str) -> bool {
        match &self.profile {
            ProfileChoice::Given(profile) => !Profile::known().contains(profile),
            ProfileChoice::Automatic => self.is_replaced(name),
        }
    }

    /// Whether one of the user's own profiles has this name.
    fn is_replaced(&self, name: &str) -> bool {
        self.own_profiles.iter().any(|own| own.name == name)
    }

    /// The profiles to try: the one that was asked for, or all that are tried automatically.
    pub fn profiles(&self) -> Vec<Adapted> {
        let attitude = self.roles.get(&Kind::Attitude);
        let mut profiles = match &self.profile {
            ProfileChoice::Given(profile) => vec![(**profile).clone()],
            ProfileChoice::Automatic => {
                let mut built_in = Profile::built_in();
                built_in.retain(|profile| !self.is_replaced(&profile.name));
                let all = self.own_profiles.iter().cloned().chain(built_in);
                all.filter(|profile| profile.automatic).collect()
            }
        };
        if let Some(RoleArgument::Topic { topic, .. }) = attitude {
            let knows = |profile: &Profile| {
                let mut alternatives = profile.alternatives(Kind::Attitude).iter();
                alternatives.any(|alternative| knows(alternative, topic))
            };
            if profiles.iter().any(knows) {
                profiles.retain(knows);
            }
        }
        let profiles = profiles.into_iter();
        profiles.map(|profile| self.adapt(profile)).collect()
    }

    /// A profile of only what was given, for a log in which no profile finds more; `None` if that lacks the attitude, or if
    /// a profile was asked for.
    pub fn without_profile(&self) -> Option<Adapted> {
        match (&self.profile, self.roles.get(&Kind::Attitude)) {
            (ProfileChoice::Automatic, Some(RoleArgument::Fields(_))) => {
                Some(self.adapt(Profile::new("command line")))
            }
            _ => None,
        }
    }

    fn adapt(&self, mut profile: Profile) -> Adapted {
        let own_attitude = match self.roles.get(&Kind::Attitude) {
            Some(RoleArgument::Fields(_)) => Some(profile.alternatives(Kind::Attitude).to_vec()),
            _ => None,
        };
        let is_own = self.is_own(&profile.name);
        self.change(&mut profile);
        Adapted {
            profile,
            is_own,
            own_attitude,
        }
    }

    /// Replaces what the profile says by what was asked for.
    fn change(&self, profile: &mut Profile) {
        for (&kind, argument) in &self.roles {
            replace(profile.alternatives_mut(kind), argument);
        }
        if !matches!(
            self.roles.get(&Kind::Attitude),
            Some(RoleArgument::Fields(_))
        ) {
            profile.share_selection();
        }
        if let Some(time) = &self.time {
            profile.time = time.clone();
            for kind in Kind::ALL {
                let alternatives = profile.alternatives_mut(kind).iter_mut();
                alternatives.for_each(|alternative| alternative.location.time = None);
            }
        }
    }
}

fn replace(alternatives: &mut Vec<Alternative>, argument: &RoleArgument) {
    match argument {
        RoleArgument::Fields(alternative) => *alternatives = vec![(**alternative).clone()],
        RoleArgument::Topic { topic, select } => {
            // How to read one topic says nothing about how to read others.
            alternatives.retain(|one| one.location.topics.is_empty() || knows(one, topic));
            for alternative in alternatives {
                alternative.location.topics = vec![topic.clone()];
                if !select.is_empty() {
                    alternative.location.select = select.clone();
                }
            }
        }
    }
}

/// Whether an alternative is for a topic, in any namespace.
fn knows(alternative: &Alternative, topic: &str) -> bool {
    let mut topics = alternative.location.topics.iter();
    topics.any(|known| Pattern::new("", known).namespace_of(topic).is_some())
}
