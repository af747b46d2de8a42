//! Places on the globe as metres from an origin, and back.

use flightcam::geometry::{geodetic::Geodetic, local_frame::LocalFrame};
use nalgebra::Vector3;
use proptest::prelude::*;

use crate::support::cases;

fn place(latitude: f64, longitude: f64, altitude: f64) -> Geodetic {
    Geodetic::from_degrees(latitude, longitude, altitude).expect("a place")
}

/// Metres from one place to another in a straight line, from their distances along the axes through the earth's centre:
/// B. Hofmann-Wellenhof et al., *GNSS* (2008), equation 8.9, written out anew.
fn from_centre(place: &Geodetic) -> Vector3<f64> {
    let (a, b) = (6_378_137.0f64, 6_356_752.314_245_179);
    let (sin, cos) = place.latitude.sin_cos();
    let n = a * a / (a * a * cos * cos + b * b * sin * sin).sqrt();
    Vector3::new(
        (n + place.altitude) * cos * place.longitude.cos(),
        (n + place.altitude) * cos * place.longitude.sin(),
        (b * b / (a * a) * n + place.altitude) * sin,
    )
}

#[test]
fn a_thousandth_of_a_degree_is_as_long_as_it_should_be() {
    let frame = LocalFrame::at(&place(47.0, 8.0, 0.0));
    // A degree of latitude at 47° is 111,168 m and one of longitude 76,056 m on WGS 84.
    let north = frame.to_ned(&place(47.001, 8.0, 0.0));
    assert!(
        (north.x - 111.173).abs() < 0.01 && north.y.abs() < 1e-6,
        "{north}"
    );
    let east = frame.to_ned(&place(47.0, 8.001, 0.0));
    assert!(
        (east.y - 76.056).abs() < 0.01 && east.x.abs() < 1e-3,
        "{east}"
    );
    let up = frame.to_ned(&place(47.0, 8.0, 12.5));
    assert!((up - Vector3::new(0.0, 0.0, -12.5)).norm() < 1e-8, "{up}");
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn there_and_back_is_the_same_place(
        // Nearer to a pole a curved step in longitude is not a straight one any more.
        latitude in -85.0..85.0,
        longitude in -180.0..180.0,
        altitude in -100.0..5000.0,
        ned in [-20e3..20e3, -20e3..20e3, -3e3..3e3],
    ) {
        let origin = place(latitude, longitude, altitude);
        let frame = LocalFrame::at(&origin);
        let ned = Vector3::from(ned);
        let there = frame.to_geodetic(&ned);
        prop_assert!((frame.to_ned(&there) - ned).norm() < 1e-5);
        let straight = (from_centre(&there) - from_centre(&origin)).norm();
        prop_assert!((straight - ned.norm()).abs() < 1e-5);
        // Close by it is what the curvature of the ellipsoid there says.
        let near = frame.to_geodetic(&(ned / 1e4));
        let expected = origin.in_ned(origin.change_to(&near));
        prop_assert!((expected - ned / 1e4).norm() < 1e-4);
    }
}
