//! A place in a log that a profile fits, and how surely.

use std::collections::BTreeMap;

use crate::{
    sample::Kind,
    source::{Origin, error::Misfit, profile::Alternative},
    text::Foreign,
};

/// A place in a log that a profile fits: one vehicle or, if the profile names no topics, one topic.
#[derive(Debug, Clone)]
pub struct Fit {
    pub namespace: String,
    pub attitude: Origin,
    /// The topic that roles without topics of their own are read from: the attitude's or, if the user gives that, the one
    /// where the profile would find it.
    pub own: Foreign,
    /// The other roles, or why the log has none.
    pub others: BTreeMap<Kind, Result<Origin, Misfit>>,
}

impl Fit {
    /// Where each role is, or why the log has none.
    pub fn roles(&self) -> BTreeMap<Kind, Result<&Origin, &Misfit>> {
        Kind::ALL.map(|kind| (kind, self.role(kind))).into()
    }

    /// The first of these kinds that is found, in their order, and where.
    pub fn first_of(&self, kinds: &[Kind]) -> Option<&Origin> {
        kinds.iter().find_map(|kind| self.role(*kind).ok())
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

/// How a profile recognises this attitude.
pub fn specificity(attitude: &[Alternative]) -> Specificity {
    match attitude.first() {
        Some(first) if !first.location.topics.is_empty() => Specificity::Topic,
        Some(first) if !first.location.schemas.is_empty() => Specificity::Schema,
        _ => Specificity::Fields,
    }
}
