//! What the camera sees of level ground.

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, Vector2, Vector3};

use super::{options::Reach, view::View};
use crate::derived::visual::Calibration;

/// Lower than this, in metres, there is nothing to show: the height is not known better.
const LOWEST: f64 = 0.5;

/// How many corners stand for the circle of the reach.
const CIRCLE: usize = 32;

/// The steepest rays that count as reaching the horizon: they go this far, as a multiple of the height.
const HORIZON: f64 = 1000.0;

/// Height above the ground, if there is enough of it to show anything.
fn height(view: &View) -> Option<f64> {
    let height = view.place?.height;
    (height >= LOWEST && height.is_finite()).then_some(height)
}

/// How far along the optical axis the ground is, in metres, or, if the axis does not meet it within reach, the reach. `None`
/// if it is not known how high the camera is.
pub fn line_of_sight(view: &View, reach: Reach) -> Option<f64> {
    let height = height(view)?;
    let axis = view.attitudes.q_ned_camera * Vector3::x();
    let is_in_reach = axis.z > 0.0 && axis.xy().norm() <= reach.heights() * axis.z;
    Some(match is_in_reach {
        true => height / axis.z,
        false => height * reach.heights(),
    })
}

/// The corners of what a picture covers of the ground, as far as it is within reach, in metres north and east of the
/// drone; empty if it covers none, and `None` if it is not known how high the camera is.
pub fn footprint(
    view: &View,
    calibration: &Calibration,
    reach: Reach,
) -> Option<Vec<Vector2<f64>>> {
    let height = height(view)?;
    let rays = corner_rays(&view.attitudes.q_ned_camera, calibration);
    // What is above the horizon is cut off first, because it has no place on the ground.
    let below = clip(&rays, |ray| ray.z - ray.norm() / HORIZON);
    let on_ground = below.iter().map(|ray| ray.xy() * (height / ray.z));
    let corners: Vec<Vector2<f64>> = on_ground.collect();
    let reach = reach.heights() * height;
    Some(match corners.iter().all(|corner| corner.norm() <= reach) {
        true => corners,
        false => within_circle(corners, reach),
    })
}

/// The rays through the corners of a picture, north, east, down: top left, top right, bottom right, bottom left.
fn corner_rays(q_ned_camera: &UnitQuaternion<f64>, calibration: &Calibration) -> Vec<Vector3<f64>> {
    let corners = calibration.corners().into_iter();
    let rays = corners.map(|[right, down]| q_ned_camera * Vector3::new(1.0, right, down));
    rays.collect()
}

/// The part of a convex polygon where a linear function of its points is not negative (Sutherland and Hodgman,
/// "Reentrant polygon clipping", 1974).
fn clip<V>(polygon: &[V], inside: impl Fn(&V) -> f64) -> Vec<V>
where
    V: Copy + std::ops::Add<Output = V> + std::ops::Mul<f64, Output = V>,
{
    let mut clipped = Vec::with_capacity(polygon.len() + 1);
    for (number, &here) in polygon.iter().enumerate() {
        let before = polygon[(number + polygon.len() - 1) % polygon.len()];
        let (at_before, at_here) = (inside(&before), inside(&here));
        if (at_before < 0.0) != (at_here < 0.0) {
            let part = at_before / (at_before - at_here);
            clipped.push(before * (1.0 - part) + here * part);
        }
        if at_here >= 0.0 {
            clipped.push(here);
        }
    }
    clipped
}

/// The part of a convex polygon that is within a circle around the drone.
fn within_circle(polygon: Vec<Vector2<f64>>, radius: f64) -> Vec<Vector2<f64>> {
    (0..CIRCLE).fold(polygon, |polygon, side| {
        let (sin, cos) = (side as f64 / CIRCLE as f64 * TAU).sin_cos();
        let outwards = Vector2::new(cos, sin);
        clip(&polygon, |point| radius - outwards.dot(point))
    })
}
