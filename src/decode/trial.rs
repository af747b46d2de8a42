//! What the field of a filter has, so that it can be said why the filter never holds.

use std::fmt;

use serde::Serialize;

use super::{
    path::{Comparison, Filter, Literal},
    value::FieldValue,
};

/// Whether a filter has held yet, and what its field had until then.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trial {
    /// It has held.
    Held,
    /// It has not.
    NotYet(UnmetFilter),
}

/// A filter that held for nothing, and what its field has instead.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UnmetFilter {
    /// The filter.
    pub filter: Filter,
    /// The first few different values.
    pub values: Vec<Literal>,
    /// Whether there are more.
    pub has_more: bool,
    /// Whether the field is missing somewhere, or is no single value.
    pub is_missing: bool,
}

impl Trial {
    /// Begins with a filter of which nothing is known yet.
    pub fn of(filter: &Filter) -> Self {
        Self::NotYet(UnmetFilter {
            filter: filter.clone(),
            values: Vec::new(),
            has_more: false,
            is_missing: false,
        })
    }

    /// Takes note of what the field has, and whether the filter holds for it.
    pub fn note(&mut self, holds: bool, value: &FieldValue) {
        match self {
            Self::Held => {}
            trial if holds => *trial = Self::Held,
            Self::NotYet(unmet) => match Literal::of(value) {
                Some(value) => unmet.add(&value),
                None => unmet.is_missing = true,
            },
        }
    }

    /// Adds what others have noted of other messages, each of the same filter.
    pub fn merge_all(trials: &mut [Self], others: &[Self]) {
        for (trial, other) in trials.iter_mut().zip(others) {
            trial.merge(other);
        }
    }

    fn merge(&mut self, other: &Self) {
        match (self, other) {
            (Self::NotYet(unmet), Self::NotYet(other)) => {
                unmet.has_more |= other.has_more;
                unmet.is_missing |= other.is_missing;
                other.values.iter().for_each(|value| unmet.add(value));
            }
            (trial, Self::Held) => *trial = Self::Held,
            (Self::Held, _) => {}
        }
    }

    /// What the field has, if the filter was tried and has not held.
    pub fn unmet(&self) -> Option<UnmetFilter> {
        match self {
            Self::NotYet(unmet) if unmet.is_missing || !unmet.values.is_empty() => {
                Some(unmet.clone())
            }
            _ => None,
        }
    }
}

impl UnmetFilter {
    /// How many different values are remembered.
    const MOST: usize = 10;

    fn add(&mut self, value: &Literal) {
        if self.values.contains(value) {
            return;
        }
        match self.values.len() < Self::MOST {
            true => self.values.push(value.clone()),
            false => self.has_more = true,
        }
    }
}

/// Whether all of these filters hold for a message or an element. Each of the trials takes note of its filter, until one
/// does not hold.
pub fn all_hold(filters: &[Filter<usize>], values: &[FieldValue], trials: &mut [Trial]) -> bool {
    (filters.iter().zip(trials)).all(|(filter, trial)| {
        let holds = filter.holds(values);
        trial.note(holds, &values[filter.field]);
        holds
    })
}

impl fmt::Display for UnmetFilter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Filter {
            field,
            comparison,
            value: wanted,
        } = &self.filter;
        let mut values: Vec<String> = self.values.iter().map(Literal::to_string).collect();
        if self.has_more {
            values.push("something else".to_owned());
        }
        if self.is_missing {
            values.push("missing".to_owned());
        }
        let values = match values.split_last() {
            Some((last, others)) if !others.is_empty() => {
                format!("{} or {last}", others.join(", "))
            }
            _ => values.concat(),
        };
        match comparison {
            Comparison::Equal => write!(f, "`{field}` is {values}, never {wanted}"),
            Comparison::Unequal => write!(f, "`{field}` is always {values}"),
        }
    }
}
