//! The attitude against the angular rates: what it turns by, and what the rates add up to, about the drone's own axes.

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    displacement::spread,
    reading::{Reread, VectorReading},
    residual::Pair,
    track::{Integral, LONGEST_GAP, Timed},
};

/// How long a window is at least and at most, in seconds. It is short, so that the sum of small turns about different
/// axes is their product.
const WINDOW: f64 = 0.4;
const LONGEST_WINDOW: f64 = 0.8;

/// How many windows are used at most.
const MOST_WINDOWS: usize = 1200;

/// The attitude at the ends of windows, and the integral of the rates between them.
pub struct Turning {
    windows: Vec<[Timed<UnitQuaternion<f64>>; 2]>,
    /// Of the log's numbers.
    rates: Integral<3>,
}

impl Turning {
    /// Compares the log's numbers of the rates with the attitude as it was read.
    pub fn new(attitudes: &[Timed<UnitQuaternion<f64>>], rates: &[Timed<Vector3<f64>>]) -> Self {
        let mut windows: Vec<[Timed<_>; 2]> = Vec::new();
        let mut start: Option<Timed<_>> = None;
        let mut last = f64::NEG_INFINITY;
        for &sample in attitudes {
            let begun = start.filter(|_| sample.time - last <= LONGEST_GAP);
            last = sample.time;
            match begun {
                Some(begun) if sample.time - begun.time < WINDOW => {}
                Some(begun) => {
                    if sample.time - begun.time <= LONGEST_WINDOW {
                        windows.push([begun, sample]);
                    }
                    start = Some(sample);
                }
                None => start = Some(sample),
            }
        }
        Self {
            windows: spread(windows, MOST_WINDOWS),
            rates: Integral::of(rates.iter().map(|rate| (rate.time, rate.value.into()))),
        }
    }

    /// What the attitude turns by, and what the rates add up to, in radians about front, right and down.
    pub fn pairs(&self, rate: &VectorReading, attitude: Option<&Reread>) -> Vec<Option<Pair>> {
        let matrix = rate.matrix();
        let pairs = self.windows.iter().map(|[start, end]| {
            let [from, to] = [start, end]
                .map(|sample| attitude.map_or(sample.value, |reread| reread.apply(sample.value)));
            let rates = self.rates.over(start.time, end.time)?;
            Some(Pair {
                witness: (from.inverse() * to).scaled_axis(),
                account: matrix * Vector3::from(rates),
            })
        });
        pairs.collect()
    }
}
