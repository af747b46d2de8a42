//! Series that jump to and fro, as those of several sources do.
//!
//! What is measured of one thing jumps rarely, and when it does (a reset, a gimbal that is told where to look), it stays
//! there. Two sources in turn (A B A B, or less regularly A A B A B B) jump again and again, faster than anything moves,
//! and soon the value is one that was there before the jump.

use serde::Serialize;

/// How many samples back a value is looked for.
const REACH: usize = 3;

/// Smaller turns, in radians, are not jumps (15°), nor are slower ones, in radians per second
/// (300°/s): autopilots limit a drone's rates to less (PX4's `MC_ROLLRATE_MAX` to 220°/s), and gimbals are slower still.
pub const TURN: Jump = Jump {
    least: 0.26,
    least_rate: 5.2,
};

/// Smaller changes of a velocity, in m/s, are not jumps, nor are slower ones, in m/s².
pub const SPEED: Jump = Jump {
    least: 2.0,
    least_rate: 20.0,
};

/// After a jump, a value counts as the same as an earlier one if it differs by less than this share of the jump.
const SAME: f64 = 0.2;

/// Jumps are conclusive only if there are as many as this, this share of the steps are jumps, and this share of them
/// are returned from.
const ENOUGH: u32 = 20;
const SHARE_OF_STEPS: f64 = 0.1;
const SHARE_RETURNED: f64 = 0.9;

/// What counts as a jump.
#[derive(Debug, Clone, Copy)]
pub struct Jump {
    least: f64,
    /// Per second.
    least_rate: f64,
}

/// Counts how often a series of `N` numbers jumps, and how often it returns.
#[derive(Debug, Clone)]
pub struct Jumps<const N: usize> {
    /// The last values, the latest at `latest`.
    recent: [[f64; N]; REACH],
    latest: usize,
    time: u64,
    steps: u32,
    jumps: u32,
    returned: u32,
    /// Whether the last jump is among those that were returned from.
    is_last_returned: bool,
    largest: f64,
}

/// How often a series jumped to and fro.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ToAndFro {
    /// How many steps from one sample to the next there are.
    pub steps: u32,
    /// How many of them are jumps.
    pub jumps: u32,
    /// The largest, in radians or m/s.
    pub largest: f64,
}

impl<const N: usize> Default for Jumps<N> {
    fn default() -> Self {
        Self {
            recent: [[f64::INFINITY; N]; REACH],
            latest: 0,
            time: 0,
            steps: 0,
            jumps: 0,
            returned: 0,
            is_last_returned: true,
            largest: 0.0,
        }
    }
}

impl<const N: usize> Jumps<N> {
    /// Takes the next vector.
    #[inline]
    pub fn push_vector(&mut self, time: u64, vector: [f64; N]) {
        let distance = |a: &[f64; N], b: &[f64; N]| {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>()
        };
        self.push(time, vector, SPEED, 1.0, distance);
    }

    /// Takes the next unit quaternion.
    #[inline]
    pub fn push_rotation(&mut self, time: u64, quaternion: [f64; N]) {
        // The square of twice the sine of a quarter of the angle; q and −q are the same rotation.
        let distance = |a: &[f64; N], b: &[f64; N]| {
            let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            2.0 - 2.0 * dot.abs()
        };
        self.push(time, quaternion, TURN, 0.5, distance);
    }

    /// Takes the next value; `scale` is what a small jump of one is as a distance.
    #[inline]
    fn push(
        &mut self,
        time: u64,
        value: [f64; N],
        jump: Jump,
        scale: f64,
        distance: impl Fn(&[f64; N], &[f64; N]) -> f64,
    ) {
        let last = &self.recent[self.latest];
        if last[0].is_finite() {
            let step = distance(&value, last);
            self.steps = self.steps.saturating_add(1);
            if step > (jump.least * scale).powi(2) {
                let seconds = time.saturating_sub(self.time) as f64 / 1e9;
                if step > (jump.least_rate * scale * seconds).powi(2) {
                    self.count_jump(&value, step, distance);
                }
            }
        }
        self.time = time;
        self.latest = (self.latest + 1) % REACH;
        self.recent[self.latest] = value;
    }

    #[cold]
    fn count_jump(
        &mut self,
        value: &[f64; N],
        step: f64,
        distance: impl Fn(&[f64; N], &[f64; N]) -> f64,
    ) {
        let is_same = |earlier: &[f64; N]| {
            earlier[0].is_finite() && distance(value, earlier) < step * SAME * SAME
        };
        let is_returned = self.recent.iter().any(is_same);
        self.jumps += 1;
        self.largest = self.largest.max(step);
        if is_returned {
            // From the jump before it, too.
            self.returned += 1 + u32::from(!self.is_last_returned);
        }
        self.is_last_returned = is_returned;
    }

    /// How a series of vectors jumped to and fro, if it certainly did.
    pub fn of_vectors(&self) -> Option<ToAndFro> {
        self.to_and_fro(f64::sqrt)
    }

    /// How a series of rotations jumped to and fro, if it certainly did.
    pub fn of_rotations(&self) -> Option<ToAndFro> {
        self.to_and_fro(|chord| 4.0 * (chord.sqrt() / 2.0).min(1.0).asin())
    }

    fn to_and_fro(&self, size: impl Fn(f64) -> f64) -> Option<ToAndFro> {
        let [steps, jumps, returned] = [self.steps, self.jumps, self.returned].map(f64::from);
        let is_certain = self.jumps >= ENOUGH
            && jumps >= SHARE_OF_STEPS * steps
            && returned >= SHARE_RETURNED * jumps;
        is_certain.then(|| ToAndFro {
            steps: self.steps,
            jumps: self.jumps,
            largest: size(self.largest),
        })
    }
}
