//! Why a topic is not in the result.

use std::fmt;

use serde::Serialize;

use super::Lack;
use crate::{
    decode::trial::UnmetFilter,
    sample::{Kind, Tally},
    source::{RefusedFrames, UnmetCondition, error::Misfit, undecodable::UndecodableMessage},
    text::{self, Foreign},
};

/// A topic that the result does not have.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MissingTopic {
    /// Its name.
    pub topic: &'static str,
    /// Why it is missing.
    pub reason: MissingReason,
    /// The topic of positions from which the velocity could be taken, if that is what is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub positions: Option<Foreign>,
}

/// Why nothing can be derived for a topic.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum MissingReason {
    /// The log has no samples of a kind that is needed.
    NoSamples {
        /// The kind.
        sample: Kind,
        /// Why it has none.
        misfit: Misfit,
    },
    /// Too few of them are usable.
    TooFewUsable {
        /// The kind.
        sample: Kind,
        /// How many are needed.
        needed: u64,
        /// Where they come from.
        topic: Foreign,
        /// How many are usable, and how many are not, for which reason.
        #[serde(flatten)]
        tally: Tally,
        /// The frames for which samples are not usable.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        refused_frames: Vec<RefusedFrames>,
        /// The earliest message that could not be decoded.
        first_undecodable: Option<Box<UndecodableMessage>>,
        /// The filters that held for no message, and what their fields have instead.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        unmet_filters: Vec<UnmetFilter>,
        /// What conditions found in the messages that they left out.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        conditions: Vec<UnmetCondition>,
    },
    /// No two attitude samples belong together.
    NoneAdjacent {
        /// How often the next was too late.
        gaps: u64,
        /// How often the estimator was reset in between.
        resets: u64,
        /// How often the time went back in between.
        clock_steps: u64,
    },
    /// Viewers are not shown it.
    NotShown {
        /// What it needs and the flight does not have.
        lack: Lack,
    },
}

impl MissingReason {
    /// Whether samples of this kind are what is missing.
    pub(crate) fn is_about(&self, kind: Kind) -> bool {
        matches!(
            self,
            Self::NoSamples { sample, .. } | Self::TooFewUsable { sample, .. } if *sample == kind
        )
    }
}

/// Implemented in the library, because [`RunError::NothingDerived`](crate::error::RunError::NothingDerived) quotes it.
impl fmt::Display for MissingReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSamples { misfit, .. } => misfit.fmt(f),
            Self::TooFewUsable {
                sample,
                needed,
                topic,
                tally,
                refused_frames,
                first_undecodable,
                unmet_filters,
                conditions,
            } => {
                let kind = sample.name();
                match needed {
                    1 => write!(f, "at least one usable {kind} sample is needed")?,
                    2 => write!(f, "at least two usable {kind} samples are needed")?,
                    _ => write!(f, "at least {needed} usable {kind} samples are needed")?,
                }
                let (used, total) = (tally.used, tally.total());
                write!(f, ", and {topic} has {used} of {total} usable")?;
                for (reason, count) in &tally.dropped {
                    write!(f, ", {count} {reason}")?;
                }
                for refused in refused_frames {
                    write!(f, "; {refused}")?;
                }
                for condition in conditions {
                    write!(f, "; {condition}")?;
                }
                match tally.unselected {
                    0 => {}
                    1 => f.write_str("; 1 message is of another source")?,
                    count => write!(f, "; {count} messages are of another source")?,
                }
                if !unmet_filters.is_empty() {
                    write!(f, ": {}", text::join(unmet_filters, ", and "))?;
                }
                match first_undecodable {
                    Some(message) => write!(f, "; the first that cannot be decoded is {message}"),
                    None => Ok(()),
                }
            }
            Self::NotShown { lack } => lack.fmt(f),
            Self::NoneAdjacent {
                gaps,
                resets,
                clock_steps,
            } => write!(
                f,
                "no two attitude samples belong together (gaps between them: {gaps}, resets: {resets}, steps back in \
                 time: {clock_steps})"
            ),
        }
    }
}
