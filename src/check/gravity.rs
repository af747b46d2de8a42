//! The attitude against the accelerations: over some seconds a drone's mean acceleration is small, so that an
//! accelerometer shows what holds the drone up: one g upwards.

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    inertia::{Felt, GRAVITY, Window, felt, starts, turned, windows},
    reading::{Reread, VectorReading},
    residual::Pair,
    track::Timed,
};

/// How long a window is, in seconds.
const WINDOW: f64 = 5.0;

/// How many windows are used at most.
const MOST_WINDOWS: usize = 100;

/// The mean specific force of windows.
pub struct Gravity {
    windows: Vec<Window>,
    felt: Vec<Felt>,
}

impl Gravity {
    /// Compares the log's numbers of the accelerations with the attitude as it was read.
    pub fn new(
        attitudes: &[Timed<UnitQuaternion<f64>>],
        accelerations: &[Timed<Vector3<f64>>],
    ) -> Self {
        let felt = felt(attitudes, accelerations);
        Self {
            windows: windows(&felt, starts(accelerations, WINDOW, MOST_WINDOWS), WINDOW),
            felt,
        }
    }

    /// What holds the drone up, and the mean specific force, in m/s².
    pub fn pairs(
        &self,
        acceleration: &VectorReading,
        attitude: Option<&Reread>,
    ) -> Vec<Option<Pair>> {
        let matrix = acceleration.matrix();
        let reread = attitude.map(|reread| turned(&self.felt, reread, &matrix));
        let pairs = self.windows.iter().map(|window| {
            let force = window.force(reread.as_ref(), WINDOW, &matrix)?;
            Some(Pair {
                witness: -GRAVITY * Vector3::z(),
                account: force / WINDOW,
            })
        });
        pairs.collect()
    }
}
