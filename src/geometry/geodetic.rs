//! Movement over the earth's ellipsoid, from the change of latitude, longitude and altitude.

use nalgebra::Vector3;

/// The WGS 84 ellipsoid: its semi-major axis in metres, and its flattening.
///
/// Source: NGA.STND.0036_1.0.0_WGS84 (2014), table 3.1.
pub(super) const SEMI_MAJOR_AXIS: f64 = 6_378_137.0;
pub(super) const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// A place on the globe: radians, and metres above the ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// North of the equator, at most a quarter turn.
    pub latitude: f64,
    /// East of Greenwich.
    pub longitude: f64,
    /// Above the ellipsoid. Above sea level it is less by up to 110 m, which changes a velocity by 0.002 %.
    pub altitude: f64,
}

impl Geodetic {
    /// The place from degrees and metres; `None` for a latitude or a longitude that there is not.
    pub fn from_degrees(latitude: f64, longitude: f64, altitude: f64) -> Option<Self> {
        (latitude.abs() <= 90.0 && longitude.abs() <= 360.0).then(|| Self {
            latitude: latitude.to_radians(),
            longitude: longitude.to_radians(),
            altitude,
        })
    }

    /// How the coordinates change up to another place: radians, radians, metres. The longitude changes the shorter way
    /// around the globe.
    pub fn change_to(&self, other: &Self) -> Vector3<f64> {
        use std::f64::consts::TAU;
        let east = other.longitude - self.longitude;
        Vector3::new(
            other.latitude - self.latitude,
            east - TAU * (east / TAU).round(),
            other.altitude - self.altitude,
        )
    }

    /// What a change of these coordinates is north, east and down, in metres; rates per second are a velocity in m/s. It
    /// is that of the plane which touches the ellipsoid here: within ten kilometres, lengths are right to a part in a
    /// thousand.
    ///
    /// Source: P. D. Groves, *Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems*, 2nd ed.
    /// (2013), equations 2.105, 2.106 (the radii of curvature) and 2.111.
    pub fn in_ned(&self, change: Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = self.latitude.sin_cos();
        let eccentricity_squared = FLATTENING * (2.0 - FLATTENING);
        let q = 1.0 - eccentricity_squared * sin * sin;
        // Along the parallel, and along the meridian.
        let transverse = SEMI_MAJOR_AXIS / q.sqrt();
        let meridian = transverse * (1.0 - eccentricity_squared) / q;
        Vector3::new(
            change.x * (meridian + self.altitude),
            change.y * (transverse + self.altitude) * cos,
            -change.z,
        )
    }
}
