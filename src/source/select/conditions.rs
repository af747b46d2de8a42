//! Conditions that can never hold, because no message has the field that they look at.

use std::collections::BTreeSet;

use super::{Fit, NamespaceSearch};
use crate::{
    decode::path::FieldPath,
    log::ReadError,
    sample::Kind,
    source::{
        bind::{BindError, Binder},
        error::{Misfit, TelemetryError, TopicMisfit},
        profile::{Alternative, Location, Profile},
    },
};

impl NamespaceSearch<'_> {
    /// Checks the conditions of a user's own profile: an alternative that lacks nothing but the fields of its `when` or
    /// `valid`, in all messages that it is for, would never be used, and the next one would be, without a word. So it is
    /// taken for a mistake. Fields that the built-in profiles' conditions look at are not misspelt; those are for other
    /// versions of a message type.
    ///
    /// # Errors
    /// A field is missing, or the log cannot be read.
    pub fn check_conditions(&self, fit: &Fit) -> Result<(), TelemetryError> {
        let alternatives = Profile::known().iter().flat_map(|profile| {
            Kind::ALL
                .into_iter()
                .flat_map(|kind| profile.alternatives(kind))
        });
        let known: Vec<&FieldPath> = alternatives.flat_map(condition_fields).collect();
        for kind in Kind::ALL {
            if self.log_search.requested.contains_key(&kind) {
                continue;
            }
            for alternative in self.profile.alternatives(kind) {
                let mut fields = condition_fields(alternative);
                if fields.any(|field| !known.contains(&field))
                    && let Some(misfit) = self.missing_condition(kind, alternative, fit)?
                {
                    let misfit = Misfit::Condition { role: kind, misfit };
                    return Err(TelemetryError::ProfileDoesNotFit {
                        path: self.log_search.log.file.path().into(),
                        profile: (&self.profile.name).into(),
                        instead: self
                            .log_search
                            .instead_of_profile(self.profile, &misfit)
                            .into(),
                        misfit: misfit.into(),
                    });
                }
            }
        }
        Ok(())
    }

    /// Which field of an alternative's conditions none of the messages has that have its other fields.
    fn missing_condition(
        &self,
        kind: Kind,
        alternative: &Alternative,
        fit: &Fit,
    ) -> Result<Option<TopicMisfit>, ReadError> {
        let mut first = None;
        for topic in self.topics_of(kind, alternative, &fit.own) {
            for channel in &self.log_search.topics[topic] {
                if !alternative
                    .location
                    .is_for(self.log_search.schema_name(channel))
                {
                    continue;
                }
                let Ok(schema) = self.log_search.schema(channel) else {
                    continue;
                };
                let mut binder = Binder::new(&schema, self.name_of(channel));
                if binder
                    .attempt(|binder| binder.role(&alternative.fields))
                    .is_err()
                {
                    continue;
                }
                match binder.attempt(|binder| bind_conditions(binder, alternative)) {
                    Err(error) if error.missing_fields() != usize::MAX => {
                        let misfit = TopicMisfit::new(topic, error.unless_of_reading()?);
                        first.get_or_insert(misfit);
                    }
                    // In some messages the field is there, or what is wrong was said before.
                    _ => return Ok(None),
                }
            }
        }
        Ok(first)
    }

    /// The topics that an alternative is for; `own` is the one that roles without topics are read from.
    fn topics_of(&self, kind: Kind, alternative: &Alternative, own: &str) -> BTreeSet<&str> {
        let topics = self.log_search.topics.keys().copied();
        topics
            .filter(|topic| self.is_at(kind, alternative, topic, own))
            .collect()
    }
}

/// The fields that an alternative's conditions look at.
fn condition_fields(alternative: &Alternative) -> impl Iterator<Item = &FieldPath> {
    let Location { when, valid, .. } = &alternative.location;
    when.iter().map(|when| &when.field).chain(valid)
}

fn bind_conditions(binder: &mut Binder, alternative: &Alternative) -> Result<(), BindError> {
    let location = &alternative.location;
    if let Some(when) = &location.when {
        binder.condition(when)?;
    }
    location
        .valid
        .iter()
        .try_for_each(|field| binder.number(field).map(drop))
}
