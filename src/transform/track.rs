//! A quantity over time: known at the times of its samples, interpolated between them.

use std::collections::VecDeque;

use super::MaxGap;
use crate::sample::{DropReason, Kind};

/// A value of a track. How values are interpolated is up to them: orientations along the shorter arc, places
/// along a line.
pub(super) trait Interpolate: Copy {
    /// The kind of sample that has it.
    const KIND: Kind;
    /// Why there is none before the first sample and after the last.
    const OUTSIDE: DropReason;
    /// Why there is none between two samples that are too far apart.
    const IN_GAP: DropReason;

    /// The value at a fraction of the time from this one to a later one, or why there is none between these two.
    fn interpolate(&self, later: &Self, fraction: f64) -> Result<Self, DropReason>;
}

/// Why there is no value at some time.
#[derive(Debug, Clone, Copy)]
pub(super) enum Unavailable {
    /// The sample after that time may still come.
    Yet,
    /// Permanently.
    Forever(Never),
}

/// Why there never is a value at some time.
#[derive(Debug, Clone, Copy)]
pub(super) enum Never {
    /// The last sample of this kind is so long ago that no sample can come to interpolate towards: the time
    /// is in a gap if another comes, and outside if none does.
    OutOfReach(Kind),
    /// For this reason.
    For(DropReason),
}

impl From<DropReason> for Unavailable {
    fn from(reason: DropReason) -> Self {
        Self::Forever(Never::For(reason))
    }
}

/// Samples of a quantity in time order, as far back as they are needed.
#[derive(Debug)]
pub(super) struct Track<T> {
    max_gap: MaxGap,
    points: VecDeque<Point<T>>,
}

#[derive(Debug, Clone, Copy)]
struct Point<T> {
    time: u64,
    value: T,
}

impl<T: Interpolate> Track<T> {
    pub(super) fn new(max_gap: MaxGap) -> Self {
        Self {
            max_gap,
            points: VecDeque::new(),
        }
    }

    /// Takes the next sample, and returns whether it is the first at its time. A second one is not taken.
    #[must_use]
    pub(super) fn push(&mut self, time: u64, value: T) -> bool {
        let is_first = self.points.back().is_none_or(|last| last.time != time);
        if is_first {
            self.points.push_back(Point { time, value });
        }
        is_first
    }

    /// The value at a time that has not been forgotten. No sample will come before `soonest`, or none at all.
    pub(super) fn at(&self, time: u64, soonest: Option<u64>) -> Result<T, Unavailable> {
        let later = self.points.partition_point(|point| point.time <= time);
        let Some(before) = later.checked_sub(1).map(|index| self.points[index]) else {
            return Err(T::OUTSIDE.into());
        };
        if before.time == time {
            return Ok(before.value);
        }
        let Some(after) = self.points.get(later) else {
            let in_reach = soonest.is_some_and(|next| self.max_gap.spans(before.time, next));
            return Err(if in_reach {
                Unavailable::Yet
            } else {
                Unavailable::Forever(Never::OutOfReach(T::KIND))
            });
        };
        if !self.max_gap.spans(before.time, after.time) {
            return Err(T::IN_GAP.into());
        }
        let fraction = (time - before.time) as f64 / (after.time - before.time) as f64;
        Ok(before.value.interpolate(&after.value, fraction)?)
    }

    /// Forgets what is only needed for times before this one.
    pub(super) fn forget_before(&mut self, time: u64) {
        while self.points.get(1).is_some_and(|second| second.time <= time) {
            self.points.pop_front();
        }
    }
}
