//! What all pictures cover, as one area on the map.

use flightcam::{
    camera::Camera,
    derived::visual::Visual,
    geometry::{DepressionAngle, geodetic::Geodetic, local_frame::LocalFrame},
    sample::Sample,
};
use geo::{Area, Contains, Coord, LineString, MultiPolygon, Point, Polygon};
use nalgebra::Vector3;
use proptest::prelude::*;
use serde_json::Value;

use crate::support::{cases, showing::*};

const HOME: [f64; 3] = [47.4, 8.5, 500.0];

fn home() -> LocalFrame {
    let [latitude, longitude, altitude] = HOME;
    let home = Geodetic::from_degrees(latitude, longitude, altitude);
    LocalFrame::at(&home.expect("a place"))
}

/// A sample of everything a tenth of a second apart, at these metres north, east, down of home.
fn flight(places: &[[f64; 3]], yaw: f64) -> Vec<Sample> {
    let frame = home();
    let places = [[0.0; 3]].iter().chain(places).enumerate();
    places
        .flat_map(|(number, &ned)| {
            let time = 100.0 + number as f64 / 10.0;
            let place = frame.to_geodetic(&Vector3::from(ned));
            let degrees = [place.latitude, place.longitude].map(f64::to_degrees);
            [
                attitude(time, [0.0, 0.0, yaw]),
                geodetic(time, [degrees[0], degrees[1], place.altitude]),
            ]
        })
        .collect()
}

fn nadir() -> Camera {
    Camera::Stabilised {
        depression: DepressionAngle::from_degrees(90.0).expect("it is in range"),
        yaw_offset: 0.0,
    }
}

/// The area in metres east and north of home.
fn area(showing: &Showing) -> Option<MultiPolygon> {
    let all = showing.all(|visual| match visual {
        Visual::Footprint(footprint) => Some(footprint.geojson.clone()),
        _ => None,
    });
    let (time, geojson) = all.first()?;
    assert_eq!((all.len(), *time), (1, nanoseconds(100.0)));
    let geojson: Value = serde_json::from_str(geojson).expect("JSON");
    assert_eq!(geojson["type"], "FeatureCollection");
    let geometry = &geojson["features"][0]["geometry"];
    assert_eq!(geometry["type"], "MultiPolygon");
    let list = |value: &Value| value.as_array().expect("a list").clone();
    let frame = home();
    let ring = |value: &Value| -> LineString {
        let points = list(value).into_iter().map(|point| {
            let [longitude, latitude] = [0, 1].map(|i| point[i].as_f64().expect("degrees"));
            let place = Geodetic::from_degrees(latitude, longitude, HOME[2]).expect("a place");
            let ned = frame.to_ned(&place);
            Coord { x: ned.y, y: ned.x }
        });
        LineString::new(points.collect())
    };
    let polygons = list(&geometry["coordinates"]).into_iter().map(|polygon| {
        let mut rings = list(&polygon).into_iter();
        let exterior = ring(&rings.next().expect("an outline"));
        assert!(exterior.is_closed());
        Polygon::new(exterior, rings.map(|hole| ring(&hole)).collect())
    });
    Some(MultiPolygon::new(polygons.collect()))
}

#[test]
fn one_picture_covers_its_footprint() {
    let showing = show(
        &flight(&[[0.0, 0.0, -100.0]], 0.0),
        nadir(),
        &with_field_of_view(),
    );
    let covered = area(&showing).expect("an area");
    let [wide, high] = [70.0, 50.0].map(|angle: f64| 200.0 * (angle / 2.0).to_radians().tan());
    assert_eq!(covered.0.len(), 1);
    let size = covered.unsigned_area();
    assert!((size / (wide * high) - 1.0).abs() < 1e-3, "{size}");
    // Heading north, the picture is wider from west to east.
    let inside = |east: f64, north: f64| covered.contains(&Point::new(east, north));
    assert!(inside(0.49 * wide, 0.0) && !inside(0.51 * wide, 0.0));
    assert!(inside(0.0, 0.49 * high) && !inside(0.0, 0.51 * high));
}

#[test]
fn a_strip_is_covered_once_and_without_holes() {
    let places: Vec<[f64; 3]> = (0..600).map(|i| [f64::from(i), 0.0, -50.0]).collect();
    let showing = show(&flight(&places, 0.0), nadir(), &with_field_of_view());
    let covered = area(&showing).expect("an area");
    let [wide, high] = [70.0, 50.0].map(|angle: f64| 100.0 * (angle / 2.0).to_radians().tan());
    assert_eq!((covered.0.len(), covered.0[0].interiors().len()), (1, 0));
    let expected = wide * (high + 599.0);
    let size = covered.unsigned_area();
    // The drone climbs in the first tenth of a second, and a picture that hardly moved is left out.
    assert!(
        (size / expected - 1.0).abs() < 0.01,
        "{size}, not {expected}"
    );
}

#[test]
fn a_camera_that_looks_up_covers_nothing() {
    let camera = Camera::Stabilised {
        depression: DepressionAngle::from_degrees(-60.0).expect("it is in range"),
        yaw_offset: 0.0,
    };
    let showing = show(
        &flight(&[[0.0, 0.0, -50.0]; 3], 0.0),
        camera,
        &with_field_of_view(),
    );
    assert!(area(&showing).is_none());
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn every_picture_is_in_the_area(
        places in prop::collection::vec([-300.0..300.0, -300.0..300.0, -120.0..-20.0], 1..40),
        yaw in -180.0..180.0,
    ) {
        let showing = show(&flight(&places, yaw), nadir(), &with_field_of_view());
        let covered = area(&showing).expect("an area");
        let mut sum = 0.0;
        for (_, scene) in showing.scenes() {
            let Some(outline) = outline(&scene, "footprint") else { continue };
            let middle = outline.iter().sum::<Vector3<f64>>() / outline.len() as f64;
            for corner in &outline {
                // A little inside, because outlines are simplified and small moves left out.
                let point = middle + (corner - middle) * 0.9;
                prop_assert!(covered.contains(&Point::new(point.x, point.y)));
            }
            let ring = LineString::from_iter(outline.iter().map(|corner| (corner.x, corner.y)));
            sum += Polygon::new(ring, Vec::new()).unsigned_area();
        }
        let size = covered.unsigned_area();
        prop_assert!(size <= sum * 1.001, "{size} of {sum}");
    }
}
