//! Series of samples over time: their values between samples, and their integrals.

use std::array;

use nalgebra::{UnitQuaternion, Vector3};

use crate::geometry::slerp;

/// A value and its time, in seconds since the recorder's first sample.
#[derive(Debug, Clone, Copy)]
pub struct Timed<T> {
    pub time: f64,
    pub value: T,
}

/// Samples that are further apart than this, in seconds, do not belong together: nothing is interpolated between them.
pub const LONGEST_GAP: f64 = 1.2;

/// A value that can be interpolated.
pub trait Between: Copy {
    fn between(&self, later: &Self, fraction: f64) -> Self;
}

impl Between for Vector3<f64> {
    fn between(&self, later: &Self, fraction: f64) -> Self {
        self + (later - self) * fraction
    }
}

impl Between for UnitQuaternion<f64> {
    fn between(&self, later: &Self, fraction: f64) -> Self {
        slerp(self, later, fraction)
    }
}

/// The value at a time, if there are samples close enough before and after it.
pub fn at<T: Between>(track: &[Timed<T>], time: f64) -> Option<T> {
    let later = track.partition_point(|sample| sample.time <= time);
    let before = track.get(later.checked_sub(1)?)?;
    if before.time == time {
        return Some(before.value);
    }
    let after = track.get(later)?;
    let step = after.time - before.time;
    (step <= LONGEST_GAP).then(|| {
        let fraction = (time - before.time) / step;
        before.value.between(&after.value, fraction)
    })
}

/// The integral of `N` numbers over time, by trapezoids.
#[derive(Debug, Clone)]
pub struct Integral<const N: usize> {
    points: Vec<Point<N>>,
}

#[derive(Debug, Clone)]
struct Point<const N: usize> {
    time: f64,
    value: [f64; N],
    /// The integral up to here.
    sum: [f64; N],
    /// How many gaps there are before.
    gaps: u32,
}

impl<const N: usize> Integral<N> {
    /// Integrates values in the order of their times.
    pub fn of(values: impl IntoIterator<Item = (f64, [f64; N])>) -> Self {
        let mut points: Vec<Point<N>> = Vec::new();
        for (time, value) in values {
            let (mut sum, mut gaps) = ([0.0; N], 0);
            if let Some(last) = points.last() {
                let step = time - last.time;
                gaps = last.gaps + u32::from(step > LONGEST_GAP);
                sum = array::from_fn(|place| {
                    last.sum[place] + 0.5 * step * (last.value[place] + value[place])
                });
            }
            points.push(Point {
                time,
                value,
                sum,
                gaps,
            });
        }
        Self { points }
    }

    /// The integral from one time to a later one; `None` if samples are missing in between.
    pub fn over(&self, from: f64, to: f64) -> Option<[f64; N]> {
        let (start, gaps_at_start) = self.up_to(from)?;
        let (end, gaps_at_end) = self.up_to(to)?;
        (gaps_at_start == gaps_at_end).then(|| array::from_fn(|place| end[place] - start[place]))
    }

    fn up_to(&self, time: f64) -> Option<([f64; N], u32)> {
        let later = self.points.partition_point(|point| point.time <= time);
        let before = &self.points[later.checked_sub(1)?];
        let step = time - before.time;
        if step == 0.0 {
            return Some((before.sum, before.gaps));
        }
        let after = self.points.get(later)?;
        if after.gaps > before.gaps {
            return None;
        }
        let fraction = step / (after.time - before.time);
        let sum = array::from_fn(|place| {
            let change = after.value[place] - before.value[place];
            before.sum[place] + step * (before.value[place] + 0.5 * fraction * change)
        });
        Some((sum, before.gaps))
    }
}
