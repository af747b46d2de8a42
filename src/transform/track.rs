//! An orientation over time: known at the times of its samples, interpolated in between.

use std::collections::VecDeque;

use nalgebra::UnitQuaternion;

use super::MaxGap;
use crate::{
    geometry::slerp,
    sample::{DropReason, GimbalReference, Kind},
};

/// What an orientation is measured from, and what it is the orientation of.
pub(super) trait Origin: Copy {
    /// What is oriented.
    const KIND: Kind;
    /// Before the first sample or after the last.
    const OUTSIDE: DropReason;
    /// Between two samples that are too far apart.
    const IN_GAP: DropReason;
    /// Between two samples whose origins do not agree.
    const ACROSS_ORIGINS: DropReason;

    /// Whether orientations that are measured from the two can be compared.
    fn agrees(self, other: Self) -> bool;
}

/// The log's count of attitude resets: each moves what the estimator takes for north and level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Resets(pub(super) Option<u64>);

impl Origin for Resets {
    const KIND: Kind = Kind::Attitude;
    const OUTSIDE: DropReason = DropReason::OutsideAttitude;
    const IN_GAP: DropReason = DropReason::InAttitudeGap;
    const ACROSS_ORIGINS: DropReason = DropReason::AcrossAttitudeReset;

    fn agrees(self, other: Self) -> bool {
        self.0.zip(other.0).is_none_or(|(a, b)| a == b)
    }
}

impl Origin for GimbalReference {
    const KIND: Kind = Kind::Gimbal;
    const OUTSIDE: DropReason = DropReason::OutsideGimbal;
    const IN_GAP: DropReason = DropReason::InGimbalGap;
    const ACROSS_ORIGINS: DropReason = DropReason::InGimbalGap;

    fn agrees(self, other: Self) -> bool {
        self == other
    }
}

/// Why an orientation is not known at some time.
#[derive(Debug, Clone, Copy)]
pub(super) enum Missing {
    /// The sample that would tell may still come.
    Yet,
    /// The last sample of this kind lies so far back that no sample can come to interpolate towards: the time
    /// lies in a gap if another comes, and outside if none does.
    OutOfReach(Kind),
    /// For good.
    For(DropReason),
}

#[derive(Debug, Clone, Copy)]
struct Link<O> {
    time: u64,
    orientation: UnitQuaternion<f64>,
    origin: O,
}

/// Samples of an orientation in time order, as far back as they are needed.
#[derive(Debug)]
pub(super) struct Track<O> {
    max_gap: MaxGap,
    chain: VecDeque<Link<O>>,
}

impl<O: Origin> Track<O> {
    pub(super) fn new(max_gap: MaxGap) -> Self {
        Self {
            max_gap,
            chain: VecDeque::new(),
        }
    }

    /// Takes the next sample, and says whether it is the first at its time. Another is not taken.
    #[must_use]
    pub(super) fn push(&mut self, time: u64, orientation: UnitQuaternion<f64>, origin: O) -> bool {
        let is_first = self.chain.back().is_none_or(|last| last.time != time);
        if is_first {
            self.chain.push_back(Link {
                time,
                orientation,
                origin,
            });
        }
        is_first
    }

    /// The orientation at a time that has not been forgotten, and its origin. No sample will come before
    /// `soonest`, or none at all.
    pub(super) fn at(
        &self,
        time: u64,
        soonest: Option<u64>,
    ) -> Result<(UnitQuaternion<f64>, O), Missing> {
        let later = self.chain.partition_point(|link| link.time <= time);
        let Some(before) = later.checked_sub(1).map(|index| self.chain[index]) else {
            return Err(Missing::For(O::OUTSIDE));
        };
        if before.time == time {
            return Ok((before.orientation, before.origin));
        }
        let Some(after) = self.chain.get(later) else {
            let in_reach = soonest.is_some_and(|next| self.max_gap.spans(before.time, next));
            return Err(if in_reach {
                Missing::Yet
            } else {
                Missing::OutOfReach(O::KIND)
            });
        };
        if !self.max_gap.spans(before.time, after.time) {
            return Err(Missing::For(O::IN_GAP));
        }
        if !before.origin.agrees(after.origin) {
            return Err(Missing::For(O::ACROSS_ORIGINS));
        }
        let fraction = (time - before.time) as f64 / (after.time - before.time) as f64;
        let orientation = slerp(&before.orientation, &after.orientation, fraction);
        Ok((orientation, before.origin))
    }

    /// Forgets what only times before this one need.
    pub(super) fn forget_before(&mut self, time: u64) {
        while self.chain.get(1).is_some_and(|second| second.time <= time) {
            self.chain.pop_front();
        }
    }
}
