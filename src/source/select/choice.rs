//! Which of several places a role is read from: the order of the profile counts, unless the messages speak against it.

use serde::Serialize;

use super::look::Look;
use crate::{
    sample::{Kind, Tally},
    source::Origin,
    text::Foreign,
};

/// A place with so many usable messages is used whatever the others have. At any usual rate, fewer are a few seconds.
const ENOUGH: f64 = 100.0;

/// One with fewer is used if it has more than one in so many of those of the best place. A place that has less than
/// that is not what the flight was recorded with.
const ONE_IN: f64 = 50.0;

/// The place that was chosen for a role.
#[derive(Debug, Clone)]
pub struct Chosen {
    pub origin: Origin,
    /// The number of the first alternative that its messages are read by. Earlier ones for the same topic were passed
    /// over.
    pub first: usize,
    /// What the profile prefers.
    pub passed_over: Vec<PassedOver>,
}

/// A place that comes before another, and that was passed over because of what its messages hold.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PassedOver {
    /// What was looked for.
    pub role: Kind,
    /// The place.
    #[serde(flatten)]
    pub place: SeenPlace,
    /// The one that is used.
    pub instead: SeenPlace,
}

/// A place whose messages were looked at.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SeenPlace {
    /// The profile that names it.
    pub profile: Foreign,
    /// Where it is.
    #[serde(flatten)]
    pub origin: Origin,
    /// How many messages it has.
    pub messages: u64,
    /// How many of those that were looked at are usable, how many are not, for which reason, and how many are of another
    /// source.
    #[serde(flatten)]
    pub looked_at: Tally,
}

impl SeenPlace {
    pub fn new(profile: &str, origin: &Origin, look: Look) -> Self {
        Self {
            profile: profile.into(),
            origin: origin.clone(),
            messages: look.messages,
            looked_at: look.tally,
        }
    }
}

/// Whether so many usable messages are enough where other places have up to so many.
pub fn is_enough(usable: f64, most_elsewhere: f64) -> bool {
    usable >= ENOUGH.min(most_elsewhere / ONE_IN)
}

/// The place that is used, by the looks at all of them in their order.
pub fn choose(looks: &[Look]) -> usize {
    let most = looks.iter().map(Look::usable).fold(0.0, f64::max);
    let chosen = (looks.iter()).position(|look| is_enough(look.usable(), most));
    chosen.unwrap_or(0)
}
