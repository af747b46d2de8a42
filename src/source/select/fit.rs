//! A place in a log that a profile fits, and how surely.

use std::collections::BTreeMap;

use crate::{
    sample::Kind,
    source::{Origin, error::Misfit, profile::Profile},
};

/// A place in a log that a profile fits: one vehicle or, if the profile names no topics, one topic.
#[derive(Debug, Clone)]
pub struct Fit {
    pub namespace: String,
    pub attitude: Origin,
    /// The other roles, or why the log has none.
    pub others: BTreeMap<Kind, Result<Origin, Misfit>>,
}

impl Fit {
    /// Where each role is, or why the log has none.
    pub fn roles(&self) -> BTreeMap<Kind, Result<&Origin, &Misfit>> {
        Kind::ALL.map(|kind| (kind, self.role(kind))).into()
    }

    /// Where a role is, or why the log has none.
    pub fn role(&self, kind: Kind) -> Result<&Origin, &Misfit> {
        match self.others.get(&kind) {
            Some(origin) => origin.as_ref(),
            None => Ok(&self.attitude),
        }
    }
}

/// How the attitude is recognised, weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Specificity {
    Fields,
    Schema,
    Topic,
}

/// How a profile recognises the attitude.
pub fn specificity(profile: &Profile) -> Specificity {
    match profile.alternatives(Kind::Attitude).first() {
        Some(first) if !first.location.topics.is_empty() => Specificity::Topic,
        Some(first) if !first.location.schemas.is_empty() => Specificity::Schema,
        _ => Specificity::Fields,
    }
}
