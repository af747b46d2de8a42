//! The attitude and the accelerations against the change of the velocity: an accelerometer measures the specific force f,
//! and `R f + g` is how the velocity changes (Newton's second law in an inertial frame; the earth's turning is far below
//! what is looked for).

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{
    displacement::{contract, products, spread},
    reading::{Reread, VectorReading},
    residual::{Pair, median},
    track::{self, Integral, LONGEST_GAP, Timed},
};

/// How long a window is, in seconds.
const WINDOW: f64 = 2.0;

/// How many windows are used at most.
const MOST_WINDOWS: usize = 240;

/// Standard gravity in m/s² (CGPM 1901).
pub const GRAVITY: f64 = 9.806_65;

/// The velocity at the ends of windows, and the specific force between them.
pub struct Inertia<'a> {
    windows: Vec<Window>,
    velocities: &'a [Timed<Vector3<f64>>],
    attitudes: &'a [Timed<UnitQuaternion<f64>>],
    felt: Vec<Felt>,
}

/// A window, and the integral of each element of the attitude's matrix times each of the accelerometer's numbers.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    pub from: f64,
    products: [f64; 27],
}

/// The accelerometer's numbers, and the attitude at their time.
#[derive(Debug, Clone, Copy)]
pub struct Felt {
    pub time: f64,
    pub attitude: UnitQuaternion<f64>,
    pub numbers: Vector3<f64>,
}

impl<'a> Inertia<'a> {
    /// Compares the log's numbers of the velocity and the accelerations, with the attitude as it was read.
    pub fn new(
        velocities: &'a [Timed<Vector3<f64>>],
        attitudes: &'a [Timed<UnitQuaternion<f64>>],
        accelerations: &[Timed<Vector3<f64>>],
    ) -> Self {
        let felt = felt(attitudes, accelerations);
        Self {
            windows: windows(&felt, starts(velocities, WINDOW, MOST_WINDOWS), WINDOW),
            velocities,
            attitudes,
            felt,
        }
    }

    /// What the specific force says, and how the velocity changes, in each window. `attitude` is another reading of it.
    pub fn pairs(
        &self,
        velocity: &VectorReading,
        acceleration: &VectorReading,
        attitude: Option<&Reread>,
        late_by: f64,
    ) -> Vec<Option<Pair>> {
        let (force_matrix, matrix) = (acceleration.matrix(), velocity.matrix());
        let reread = attitude.map(|reread| turned(&self.felt, reread, &force_matrix));
        let velocity_at = |time: f64| {
            let own = matrix * track::at(self.velocities, time + late_by)?;
            if !velocity.is_body() {
                return Some(own);
            }
            let orientation = track::at(self.attitudes, time)?;
            let orientation = attitude.map_or(orientation, |reread| reread.apply(orientation));
            Some(orientation * own)
        };
        let pairs = self.windows.iter().map(|window| {
            let (from, to) = (window.from, window.from + WINDOW);
            let force = window.force(reread.as_ref(), WINDOW, &force_matrix)?;
            Some(Pair {
                witness: force + Vector3::z() * (GRAVITY * WINDOW),
                account: velocity_at(to)? - velocity_at(from)?,
            })
        });
        without_vertical_bias(pairs.collect())
    }
}

/// An accelerometer's constant error is vertical most of the time, and large beside a drone's vertical accelerations.
fn without_vertical_bias(mut pairs: Vec<Option<Pair>>) -> Vec<Option<Pair>> {
    /// In m/s².
    const LARGEST_BIAS: f64 = 1.0;
    let largest = LARGEST_BIAS * WINDOW;
    let errors = pairs
        .iter()
        .flatten()
        .map(|pair| pair.witness.z - pair.account.z);
    let bias = median(errors).unwrap_or(0.0).clamp(-largest, largest);
    for pair in pairs.iter_mut().flatten() {
        pair.witness.z -= bias;
    }
    pairs
}

/// The accelerometer's numbers with the attitude at their time, where it is known.
pub fn felt(
    attitudes: &[Timed<UnitQuaternion<f64>>],
    accelerations: &[Timed<Vector3<f64>>],
) -> Vec<Felt> {
    let felt = accelerations.iter().filter_map(|sample| {
        Some(Felt {
            time: sample.time,
            attitude: track::at(attitudes, sample.time)?,
            numbers: sample.value,
        })
    });
    felt.collect()
}

/// The windows with these starts that are felt throughout.
pub fn windows(felt: &[Felt], starts: Vec<f64>, length: f64) -> Vec<Window> {
    let all = felt.iter();
    let all = Integral::of(all.map(|one| (one.time, products(one.attitude, one.numbers))));
    let windows = starts.into_iter().filter_map(|from| {
        let products = all.over(from, from + length)?;
        Some(Window { from, products })
    });
    windows.collect()
}

impl Window {
    /// The integral of the specific force in NED: with the attitude as it was read, or `reread`.
    pub fn force(
        &self,
        reread: Option<&Integral<3>>,
        length: f64,
        matrix: &Matrix3<f64>,
    ) -> Option<Vector3<f64>> {
        match reread {
            Some(reread) => Some(reread.over(self.from, self.from + length)?.into()),
            None => Some(contract(&self.products, matrix)),
        }
    }
}

/// The integral of the specific force in NED, with the attitude in another reading.
pub fn turned(felt: &[Felt], attitude: &Reread, matrix: &Matrix3<f64>) -> Integral<3> {
    Integral::of(felt.iter().map(|one| {
        let force = attitude.apply(one.attitude) * (matrix * one.numbers);
        (one.time, force.into())
    }))
}

/// The starts of windows that begin and end within a series without gaps, half a window apart or more.
pub fn starts<T>(series: &[Timed<T>], window: f64, most: usize) -> Vec<f64> {
    let mut starts = Vec::new();
    let mut next = f64::NEG_INFINITY;
    let mut open: Vec<f64> = Vec::new();
    let mut last = f64::NEG_INFINITY;
    for sample in series {
        if sample.time - last > LONGEST_GAP {
            open.clear();
            next = next.max(sample.time);
        }
        last = sample.time;
        open.retain(|&start| {
            let is_over = start + window <= sample.time;
            if is_over {
                starts.push(start);
            }
            !is_over
        });
        if sample.time >= next {
            open.push(sample.time);
            next = sample.time + window / 2.0;
        }
    }
    spread(starts, most)
}
