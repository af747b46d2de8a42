//! What a result has messages about, and the topics that they are on.

use crate::derived::{
    Derived, Quantity,
    visual::{Shown, VisualTopic},
};

/// A message of a result.
#[derive(Debug, Clone, Copy)]
pub enum Message<'a> {
    /// The camera's motion.
    Derived(&'a Derived),
    /// What viewers are shown.
    Shown(&'a Shown),
}

/// A topic of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Topic {
    /// The camera's motion.
    Derived(Quantity),
    /// What viewers are shown.
    Visual(VisualTopic),
}

impl<'a> From<&'a Derived> for Message<'a> {
    fn from(derived: &'a Derived) -> Self {
        Self::Derived(derived)
    }
}

impl<'a> From<&'a Shown> for Message<'a> {
    fn from(shown: &'a Shown) -> Self {
        Self::Shown(shown)
    }
}

impl From<Quantity> for Topic {
    fn from(quantity: Quantity) -> Self {
        Self::Derived(quantity)
    }
}

impl From<VisualTopic> for Topic {
    fn from(topic: VisualTopic) -> Self {
        Self::Visual(topic)
    }
}

impl Message<'_> {
    /// Its log time, nanoseconds.
    pub fn log_time(&self) -> u64 {
        match self {
            Self::Derived(derived) => derived.stamp.log_time,
            Self::Shown(shown) => shown.time,
        }
    }

    /// When it counts as published, nanoseconds.
    pub fn publish_time(&self) -> u64 {
        match self {
            Self::Derived(derived) => derived.stamp.publish_time,
            Self::Shown(shown) => shown.time,
        }
    }
}

impl Topic {
    /// All topics, in the order of reports.
    pub fn all() -> impl Iterator<Item = Self> {
        let visuals = VisualTopic::ALL.into_iter().map(Self::Visual);
        Quantity::ALL.into_iter().map(Self::Derived).chain(visuals)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Derived(quantity) => quantity.topic(),
            Self::Visual(topic) => topic.name(),
        }
    }

    /// Whether other programs write to a topic of this name, too.
    pub fn is_shared(self) -> bool {
        matches!(self, Self::Visual(topic) if topic.is_shared())
    }

    /// The topic of this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::all().find(|topic| topic.name() == name)
    }
}
