//! A place in a log that a profile fits, and how surely.

use std::collections::BTreeMap;

use super::choice::{Chosen, PassedOver};
use crate::{
    sample::Kind,
    source::{Origin, error::Misfit, profile::Alternative},
    text::Foreign,
};

/// A place in a log that a profile fits: one vehicle or, if the profile names no topics, one topic.
#[derive(Debug, Clone)]
pub struct Fit {
    pub namespace: String,
    pub attitude: Chosen,
    /// The topic that roles without topics of their own are read from: the attitude's or, if the user gives that, the one
    /// where the profile would find it.
    pub own: Foreign,
    /// The other roles, or why the log has none.
    pub others: BTreeMap<Kind, Result<Chosen, Misfit>>,
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
        self.chosen(kind).map(|chosen| &chosen.origin)
    }

    fn chosen(&self, kind: Kind) -> Result<&Chosen, &Misfit> {
        match self.others.get(&kind) {
            Some(chosen) => chosen.as_ref(),
            None => Ok(&self.attitude),
        }
    }

    /// The number of the first of a role's alternatives that is used.
    pub fn first(&self, kind: Kind) -> usize {
        self.chosen(kind).map_or(0, |chosen| chosen.first)
    }

    /// The places that were passed over.
    pub fn passed_over(&self) -> impl Iterator<Item = &PassedOver> {
        let chosen = Kind::LISTED.map(|kind| self.chosen(kind).ok());
        let chosen = chosen.into_iter().flatten();
        chosen.flat_map(|chosen| &chosen.passed_over)
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
        // A message that says of which type it is, is as good as a type.
        Some(first) if !first.location.schemas.is_empty() || !first.location.select.is_empty() => {
            Specificity::Schema
        }
        _ => Specificity::Fields,
    }
}
