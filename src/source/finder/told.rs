//! What the user has told goes before what profiles say.

use super::{Finder, Missing, is_within};
use crate::{
    error::Error,
    sample::Kind,
    source::{
        alternative::Alternative,
        profile::{AttitudeSource, GimbalSource, PositionSource, Profile, VelocitySource},
        request::Request,
        topic::{Pattern, describe_topics},
    },
};

impl Finder<'_> {
    /// Checks that the log has what the user says that it has.
    pub fn check_told(&self, request: &Request) -> Result<(), Error> {
        if let Some(namespace) = &request.namespace
            && !(self.topics.keys()).any(|topic| is_within(topic, namespace))
            && !namespace.is_empty()
        {
            return Err(Error::NoSuchNamespace {
                path: self.log.file.path().into(),
                namespace: namespace.clone(),
                topics: describe_topics(self.log),
            });
        }
        for (&kind, told) in &self.told {
            let is_there = |topic: &String| {
                let pattern = Pattern::new("", topic);
                self.topics.keys().any(|topic| pattern.is_match(topic))
            };
            if !told.topics.is_empty() && !told.topics.iter().any(is_there) {
                let topics = told.topics.join(" or ");
                return Err(
                    self.role_does_not_fit(kind, format!("there is no message on {topics}"))
                );
            }
        }
        Ok(())
    }

    fn role_does_not_fit(&self, kind: Kind, problem: String) -> Error {
        Error::RoleDoesNotFit {
            path: self.log.file.path().into(),
            role: kind.name(),
            problem,
            topics: describe_topics(self.log),
        }
    }

    /// Why a profile does not fit for want of a role; an error where the user has told all of the role, for then
    /// no other profile will.
    pub(super) fn misfit(&self, kind: Kind, missing: &Missing) -> Result<String, Error> {
        match self.told.get(&kind) {
            Some(told) if told.has_fields => {
                Err(self.role_does_not_fit(kind, missing.reason.clone()))
            }
            _ => Ok(missing.reason.clone()),
        }
    }

    /// A topic as the profile names it, or as the user does, who names it as the log has it.
    pub(super) fn pattern<A: Alternative>(&self, namespace: &str, topic: &str) -> Pattern {
        match self.told.contains_key(&A::KIND) {
            true => Pattern::new("", topic),
            false => Pattern::new(namespace, topic),
        }
    }

    /// The topics that tell a vehicle's namespace: those of the attitude, or where the user has told that, the
    /// others.
    pub(super) fn telling_topics(&self, profile: &Profile) -> Vec<Pattern> {
        fn topics<A: Alternative>(finder: &Finder, profile: &Profile) -> Vec<Pattern> {
            if finder.told.contains_key(&A::KIND) {
                return Vec::new();
            }
            let places = A::of(profile).iter().map(Alternative::place);
            let topics = places.flat_map(|place| &place.topics);
            topics.map(|topic| Pattern::new("", topic)).collect()
        }
        match topics::<AttitudeSource>(self, profile) {
            none if none.is_empty() => [
                topics::<VelocitySource>(self, profile),
                topics::<GimbalSource>(self, profile),
                topics::<PositionSource>(self, profile),
            ]
            .concat(),
            topics => topics,
        }
    }
}
