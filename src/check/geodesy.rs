//! Latitude, longitude and height → metres north, east and down of a first place.

use nalgebra::Vector3;

/// Semi-major axis of the WGS 84 ellipsoid in metres, and the square of its eccentricity (NIMA TR8350.2, third edition,
/// tables 3.1 and 3.3).
const SEMI_MAJOR: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_14e-3;

/// The plane that touches the ellipsoid at a first place. Within ten kilometres of it, lengths are right to a part in a
/// thousand, which is much less than what is looked for.
#[derive(Debug, Clone, Copy)]
pub struct LocalPlane {
    /// Degrees, degrees, metres.
    origin: [f64; 3],
    metres_per_degree_north: f64,
    metres_per_degree_east: f64,
}

impl LocalPlane {
    /// The plane at a place: degrees north, degrees east, metres.
    pub fn at(origin: [f64; 3]) -> Self {
        let [latitude, _, height] = origin;
        let (sin, cos) = latitude.to_radians().sin_cos();
        let denominator = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
        // The radii of curvature along the meridian and across it.
        let across = SEMI_MAJOR / denominator.sqrt();
        let along = across * (1.0 - ECCENTRICITY_SQUARED) / denominator;
        Self {
            origin,
            metres_per_degree_north: (along + height).to_radians(),
            metres_per_degree_east: (across + height).to_radians() * cos,
        }
    }

    /// Metres north, east and down of the origin.
    pub fn metres(&self, [latitude, longitude, height]: [f64; 3]) -> Vector3<f64> {
        let east = (longitude - self.origin[1] + 540.0).rem_euclid(360.0) - 180.0;
        Vector3::new(
            (latitude - self.origin[0]) * self.metres_per_degree_north,
            east * self.metres_per_degree_east,
            self.origin[2] - height,
        )
    }
}
