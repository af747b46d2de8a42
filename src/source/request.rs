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
use crate::{sample::Kind, text::Foreign};
pub use argument::RoleArgument;
pub use error::BadArgument;

/// How the user wants a log's telemetry to be found. By default everything is left to the built-in profiles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// The profile to use.
    pub profile: ProfileChoice,
    /// The vehicle to use, if there are several: the prefix of its topics, empty for one without.
    pub namespace: Option<String>,
    /// Where roles are, instead of where the profile says.
    pub roles: BTreeMap<Kind, RoleArgument>,
    /// What the time of a sample is, instead of what the profile says.
    pub time: Option<SampleTime>,
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
        let profile = (&profile.name).into();
        match (self.roles.get(&role), self.own_profile()) {
            (Some(RoleArgument::Fields(_)), _) => HowAsked::Argument,
            (_, Some(_)) => HowAsked::OwnProfile { profile },
            (_, None) => HowAsked::BuiltIn { profile },
        }
    }

    /// The profile to use, if it is not a built-in one.
    pub(super) fn own_profile(&self) -> Option<&Profile> {
        match &self.profile {
            ProfileChoice::Given(profile) if !Profile::built_in().contains(profile) => {
                Some(profile)
            }
            _ => None,
        }
    }

    /// The profiles to try: the one that was asked for, or all that are tried automatically.
    pub fn profiles(&self) -> Vec<Profile> {
        let attitude = self.roles.get(&Kind::Attitude);
        let mut profiles = match (&self.profile, attitude) {
            (ProfileChoice::Given(profile), _) => vec![(**profile).clone()],
            // If the attitude is given, nothing would be left of the built-in profiles that sets one apart from
            // another.
            (ProfileChoice::Automatic, Some(RoleArgument::Fields(attitude))) => {
                vec![Profile::new("command line").with((**attitude).clone())]
            }
            (ProfileChoice::Automatic, _) => Profile::built_in()
                .into_iter()
                .filter(|profile| profile.automatic)
                .collect(),
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
        profiles.iter_mut().for_each(|profile| self.change(profile));
        profiles
    }

    /// Replaces what the profile says by what was asked for.
    fn change(&self, profile: &mut Profile) {
        for (&kind, argument) in &self.roles {
            replace(profile.alternatives_mut(kind), argument);
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
            if alternatives.iter().any(|one| knows(one, topic)) {
                alternatives.retain(|one| knows(one, topic));
            }
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
