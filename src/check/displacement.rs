//! The velocity against the positions: what the drone moved by, and what its velocity adds up to, over windows of two
//! seconds. All readings of the velocity are linear in the log's numbers, so the integrals are computed once.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{
    reading::VectorReading,
    residual::Pair,
    track::{self, Integral, LONGEST_GAP, Timed},
};

/// How long a window is at least and at most, in seconds.
const WINDOW: f64 = 2.0;
const LONGEST_WINDOW: f64 = 3.5;

/// How many windows are used at most.
const MOST_WINDOWS: usize = 240;

/// What the drone moved by in one window.
#[derive(Debug, Clone, Copy)]
struct Window {
    from: f64,
    to: f64,
    metres: Vector3<f64>,
}

/// Displacements, and the integrals of the velocity that they are compared with.
pub struct Displacement {
    windows: Vec<Window>,
    /// Of the log's numbers.
    world: Integral<3>,
    /// Of each element of the attitude's matrix times each of the log's numbers.
    body: Integral<27>,
}

impl Displacement {
    /// Compares positions in metres with the log's numbers of the velocity.
    pub fn new(
        positions: &[Timed<Vector3<f64>>],
        velocities: &[Timed<Vector3<f64>>],
        attitudes: &[Timed<UnitQuaternion<f64>>],
    ) -> Self {
        let numbers = velocities.iter().map(|v| (v.time, v.value.into()));
        let turned = velocities.iter().filter_map(|velocity| {
            let attitude = track::at(attitudes, velocity.time)?;
            Some((velocity.time, products(attitude, velocity.value)))
        });
        Self {
            windows: windows(positions),
            world: Integral::of(numbers),
            body: Integral::of(turned),
        }
    }

    /// Displacement and integrated velocity of each window, for a reading of the velocity and a shift of its times in
    /// seconds.
    pub fn pairs(&self, velocity: &VectorReading, late_by: f64) -> Vec<Option<Pair>> {
        let matrix = velocity.matrix();
        let pairs = self.windows.iter().map(|window| {
            let (from, to) = (window.from + late_by, window.to + late_by);
            let account = match velocity.is_body() {
                false => matrix * Vector3::from(self.world.over(from, to)?),
                true => contract(&self.body.over(from, to)?, &matrix),
            };
            Some(Pair {
                witness: window.metres,
                account,
            })
        });
        pairs.collect()
    }
}

/// Windows between positions, spread over all of them.
fn windows(positions: &[Timed<Vector3<f64>>]) -> Vec<Window> {
    let mut windows = Vec::new();
    let mut next_start = f64::NEG_INFINITY;
    for (place, start) in positions.iter().enumerate() {
        if start.time < next_start {
            continue;
        }
        let rest = &positions[place..];
        let has_gap = |pair: &[Timed<_>]| pair[1].time - pair[0].time > LONGEST_GAP;
        let end = rest.partition_point(|end| end.time < start.time + WINDOW);
        let Some(last) = rest.get(end) else { break };
        if last.time - start.time > LONGEST_WINDOW || rest[..=end].windows(2).any(has_gap) {
            continue;
        }
        windows.push(Window {
            from: start.time,
            to: last.time,
            metres: last.value - start.value,
        });
        next_start = start.time + WINDOW / 2.0;
    }
    spread(windows, MOST_WINDOWS)
}

/// At most so many of them, spread over all.
pub fn spread<T>(all: Vec<T>, most: usize) -> Vec<T> {
    let step = all.len().div_ceil(most).max(1);
    all.into_iter().step_by(step).collect()
}

/// Each element of the attitude's matrix times each number of a vector.
pub fn products(attitude: UnitQuaternion<f64>, vector: Vector3<f64>) -> [f64; 27] {
    let matrix = attitude.to_rotation_matrix();
    let columns = matrix.matrix().data.0;
    let numbers: [f64; 3] = vector.into();
    let mut products = [0.0; 27];
    for row in 0..3 {
        for column in 0..3 {
            for number in 0..3 {
                products[9 * row + 3 * column + number] = columns[column][row] * numbers[number];
            }
        }
    }
    products
}

/// The attitude's matrix times another one times the vector, out of their products.
pub fn contract(products: &[f64; 27], matrix: &Matrix3<f64>) -> Vector3<f64> {
    let columns = &matrix.data.0;
    let mut sum = [0.0; 3];
    for row in 0..3 {
        for column in 0..3 {
            for number in 0..3 {
                sum[row] += products[9 * row + 3 * column + number] * columns[number][column];
            }
        }
    }
    sum.into()
}
