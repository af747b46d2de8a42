//! The attitude against the velocity: a drone leans where it accelerates.
//!
//! Rotors pull, and wings lift, along the drone's own upward axis. In flight that is level or nearly so, the vertical part
//! carries the weight, so the horizontal part is g times the tangent of the lean. It accelerates the drone and overcomes
//! the drag, which is nearly proportional to the speed through the air (Mahony, Kumar and Corke, "Multirotor aerial
//! vehicles", IEEE Robotics & Automation Magazine 19, 2012):
//!
//! ```text
//! g tan(lean) = a + k (v − wind)
//! ```
//!
//! k and the wind are not known and are fitted; k is not negative and at most 1/s.

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    inertia::{GRAVITY, starts},
    reading::{Reread, VectorReading},
    residual::Pair,
    track::{self, Timed},
};

/// How long a window is, in seconds.
const WINDOW: f64 = 1.0;

/// How many windows are used at most.
const MOST_WINDOWS: usize = 240;

/// The largest drag: speed that is lost each second, as a share of the speed.
const LARGEST_DRAG: f64 = 1.0;

/// A drone that leans further has no lift to speak of.
const LEAST_UPRIGHT: f64 = 0.1;

/// How many attitudes are looked at in each.
const ATTITUDES: usize = 4;

/// The velocity at the ends of windows, and attitudes between them.
pub struct Lean<'a> {
    windows: Vec<Window>,
    velocities: &'a [Timed<Vector3<f64>>],
}

/// What a window has of the attitude.
struct Window {
    from: f64,
    /// At the ends.
    ends: [UnitQuaternion<f64>; 2],
    between: [UnitQuaternion<f64>; ATTITUDES],
}

/// What is known of one window.
struct Observed {
    lean: Vector3<f64>,
    acceleration: Vector3<f64>,
    velocity: Vector3<f64>,
}

impl<'a> Lean<'a> {
    /// Compares the log's numbers of the velocity with the attitude as it was read.
    pub fn new(
        velocities: &'a [Timed<Vector3<f64>>],
        attitudes: &[Timed<UnitQuaternion<f64>>],
    ) -> Self {
        let starts = starts(velocities, WINDOW, MOST_WINDOWS).into_iter();
        let windows = starts.filter_map(|from| {
            let at = |time: f64| track::at(attitudes, time);
            let mut between = [UnitQuaternion::identity(); ATTITUDES];
            for (place, attitude) in between.iter_mut().enumerate() {
                *attitude = at(from + (place as f64 + 0.5) / ATTITUDES as f64 * WINDOW)?;
            }
            Some(Window {
                from,
                ends: [at(from)?, at(from + WINDOW)?],
                between,
            })
        });
        Self {
            windows: windows.collect(),
            velocities,
        }
    }

    /// The lean, and what the velocity says that it must be, in each window. `attitude` is another reading of it.
    pub fn pairs(
        &self,
        velocity: &VectorReading,
        attitude: Option<&Reread>,
        late_by: f64,
    ) -> Vec<Option<Pair>> {
        let matrix = velocity.matrix();
        let reread = |q: UnitQuaternion<f64>| attitude.map_or(q, |reread| reread.apply(q));
        let velocity_at = |time: f64, orientation: UnitQuaternion<f64>| {
            let own = matrix * track::at(self.velocities, time + late_by)?;
            Some(match velocity.is_body() {
                true => reread(orientation) * own,
                false => own,
            })
        };
        let observed = self.windows.iter().map(|window| {
            let start = velocity_at(window.from, window.ends[0])?;
            let end = velocity_at(window.from + WINDOW, window.ends[1])?;
            let leans = window
                .between
                .iter()
                .map(|&attitude| lean(reread(attitude)));
            Some(Observed {
                lean: leans.sum::<Vector3<f64>>() / ATTITUDES as f64,
                acceleration: (end - start) / WINDOW,
                velocity: (start + end) / 2.0,
            })
        });
        compare(&observed.collect::<Vec<_>>())
    }
}

/// The horizontal acceleration that the upward axis of an attitude gives.
fn lean(attitude: UnitQuaternion<f64>) -> Vector3<f64> {
    let down = attitude * Vector3::z();
    let lean = -down * (GRAVITY / down.z.max(LEAST_UPRIGHT));
    Vector3::new(lean.x, lean.y, 0.0)
}

/// Both sides of the equation, with the drag that fits best and without the wind: as differences from their means.
fn compare(windows: &[Option<Observed>]) -> Vec<Option<Pair>> {
    let observed = || windows.iter().flatten();
    let count = observed().count() as f64;
    let mean = |of: fn(&Observed) -> Vector3<f64>| observed().map(of).sum::<Vector3<f64>>() / count;
    let lean = mean(|one| one.lean);
    let acceleration = mean(|one| one.acceleration);
    let velocity = mean(|one| one.velocity);
    let (mut product, mut square) = (0.0, 0.0);
    for one in observed() {
        let rest = (one.lean - lean) - (one.acceleration - acceleration);
        let (rest, speed) = (rest.xy(), (one.velocity - velocity).xy());
        product += rest.dot(&speed);
        square += speed.norm_squared();
    }
    let drag = match square > 0.0 {
        true => (product / square).clamp(0.0, LARGEST_DRAG),
        false => 0.0,
    };
    let pairs = windows.iter().map(|window| {
        window.as_ref().map(|one| Pair {
            witness: one.lean - lean,
            account: (one.acceleration - acceleration) + (one.velocity - velocity) * drag,
        })
    });
    pairs.collect()
}
