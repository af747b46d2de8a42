//! What the user says goes before what profiles say.

use super::Finder;
use crate::{
    sample::Kind,
    source::{
        error::{LogTopics, Misfit, TelemetryError, Unfit},
        pattern::{Pattern, is_within},
        profile::Profile,
        request::RoleArgument,
    },
};

impl Finder<'_> {
    /// Checks that the log has the namespace and the topics that the user names.
    pub fn check_request(&self) -> Result<(), TelemetryError> {
        if let Some(namespace) = self.namespace
            && !(self.topics.keys()).any(|topic| is_within(topic, namespace))
            && !namespace.is_empty()
        {
            return Err(TelemetryError::NoSuchNamespace {
                path: self.log.file.path().into(),
                namespace: namespace.to_owned(),
                topics: LogTopics::of(self.log),
            });
        }
        for (&kind, argument) in self.requested {
            let is_there = |topic: &String| {
                let pattern = Pattern::new("", topic);
                self.topics.keys().any(|topic| pattern.is_match(topic))
            };
            let topics = argument.topics();
            if !topics.is_empty() && !topics.iter().any(is_there) {
                let topics = topics.to_vec();
                return Err(self.role_does_not_fit(kind, Misfit::NoMessages { topics }));
            }
        }
        Ok(())
    }

    fn role_does_not_fit(&self, role: Kind, misfit: Misfit) -> TelemetryError {
        TelemetryError::RoleDoesNotFit {
            path: self.log.file.path().into(),
            role,
            misfit: misfit.into(),
            topics: LogTopics::of(self.log),
        }
    }

    /// Ends the search where a role is missing of which the user has given all, for then it is missing in every
    /// profile.
    pub fn as_requested(&self, kind: Kind, unfit: Unfit) -> Unfit {
        match (unfit, self.requested.get(&kind)) {
            (Unfit::Misfit(misfit), Some(RoleArgument::Fields(_))) => {
                self.role_does_not_fit(kind, misfit).into()
            }
            (unfit, _) => unfit,
        }
    }

    /// A topic as the profile names it, or as the user does, who names it as the log has it.
    pub fn pattern(&self, kind: Kind, namespace: &str, topic: &str) -> Pattern {
        match self.requested.contains_key(&kind) {
            true => Pattern::new("", topic),
            false => Pattern::new(namespace, topic),
        }
    }

    /// The topics that show a vehicle's namespace: those of the attitude, or where the user has given that, the
    /// others.
    pub fn namespaced_topics(&self, profile: &Profile) -> Vec<Pattern> {
        let of_role = |kind: Kind| -> Vec<Pattern> {
            let alternatives = match self.requested.contains_key(&kind) {
                true => &[],
                false => profile.alternatives(kind),
            };
            let topics = alternatives.iter().flat_map(|one| &one.place.topics);
            topics.map(|topic| Pattern::new("", topic)).collect()
        };
        match of_role(Kind::Attitude) {
            topics if topics.is_empty() => Kind::ALL.into_iter().flat_map(of_role).collect(),
            topics => topics,
        }
    }
}
