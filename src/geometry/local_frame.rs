//! The plane that touches the earth's ellipsoid at a place: positions north, east and down of it, and back.

use geodesy::prelude::*;
use nalgebra::{Matrix3, Vector3};

use super::geodetic::{FLATTENING, Geodetic, SEMI_MAJOR_AXIS};

/// North, east, down of an origin on the globe.
#[derive(Debug, Clone)]
pub struct LocalFrame {
    ellipsoid: Ellipsoid,
    /// The origin, from the earth's centre, metres.
    origin: Vector3<f64>,
    /// Turns north, east, down into the axes from the earth's centre.
    r_earth_ned: Matrix3<f64>,
}

impl LocalFrame {
    /// The frame with this origin.
    pub fn at(origin: &Geodetic) -> Self {
        let ellipsoid = Ellipsoid::new(SEMI_MAJOR_AXIS, FLATTENING);
        let (sin_lat, cos_lat) = origin.latitude.sin_cos();
        let (sin_lon, cos_lon) = origin.longitude.sin_cos();
        Self {
            origin: from_centre(&ellipsoid, origin),
            ellipsoid,
            // Source: P. D. Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd ed.
            // (2013), equation 2.150, transposed.
            r_earth_ned: Matrix3::new(
                -sin_lat * cos_lon,
                -sin_lon,
                -cos_lat * cos_lon,
                -sin_lat * sin_lon,
                cos_lon,
                -cos_lat * sin_lon,
                cos_lat,
                0.0,
                -sin_lat,
            ),
        }
    }

    /// A place in metres north, east and down of the origin.
    pub fn to_ned(&self, place: &Geodetic) -> Vector3<f64> {
        self.r_earth_ned
            .tr_mul(&(from_centre(&self.ellipsoid, place) - self.origin))
    }

    /// The place at some metres north, east and down of the origin.
    pub fn to_geodetic(&self, ned: &Vector3<f64>) -> Geodetic {
        let [x, y, z] = (self.origin + self.r_earth_ned * ned).into();
        let place = self.ellipsoid.geographic(&Coor3D::raw(x, y, z));
        let (longitude, latitude, altitude) = place.xyz();
        Geodetic {
            latitude,
            longitude,
            altitude,
        }
    }
}

/// A place in metres from the earth's centre.
fn from_centre(ellipsoid: &Ellipsoid, place: &Geodetic) -> Vector3<f64> {
    let place = Coor3D::raw(place.longitude, place.latitude, place.altitude);
    let (x, y, z) = ellipsoid.cartesian(&place).xyz();
    Vector3::new(x, y, z)
}
