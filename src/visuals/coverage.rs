//! What all pictures of a flight cover on the ground, as one area: viewers add up all areas that they are given.

use geo::{
    ConvexHull, LineString, MultiPoint, MultiPolygon, Polygon, Simplify,
    algorithm::{
        bool_ops::unary_union,
        orient::{Direction, Orient},
    },
};
use nalgebra::{Vector2, Vector3};
use serde_json::json;

use super::stage::{Place, Stage};
use crate::derived::visual::Footprint;

/// Footprints are taken together as long as none of their corners has moved by more than this part of the height. What
/// they cover together is then hardly more than what each covers.
const TOGETHER: f64 = 0.2;

/// How far the outline may be simplified, as a part of the lowest height.
const TOLERANCE: f64 = 0.01;

/// The area, which grows.
#[derive(Debug)]
pub struct Coverage {
    /// Areas of twice as many footprints each, like the digits of a binary number: areas of about the same size are joined,
    /// which is quick, while joining one footprint after the other with all before it takes a time that grows with the
    /// square of their number.
    areas: Vec<Option<MultiPolygon>>,
    /// The corners of the footprints that are taken together, east and north of the origin.
    corners: Vec<(f64, f64)>,
    /// Those of the first of them, north and east.
    first: Vec<Vector2<f64>>,
    /// The lowest height, metres.
    lowest: f64,
    /// Where the ground is below the origin, metres down.
    ground: f64,
}

impl Default for Coverage {
    fn default() -> Self {
        Self {
            areas: Vec::new(),
            corners: Vec::new(),
            first: Vec::new(),
            lowest: f64::INFINITY,
            ground: 0.0,
        }
    }
}

impl Coverage {
    /// Adds what a picture covers, in metres north and east of the drone.
    pub fn add(&mut self, footprint: &[Vector2<f64>], place: &Place) {
        if footprint.len() < 3 {
            return;
        }
        let corners = footprint.iter().map(|corner| corner + place.ned.xy());
        let corners: Vec<Vector2<f64>> = corners.collect();
        let limit = TOGETHER * place.height;
        let is_near = self.first.len() == corners.len()
            && (self.first.iter().zip(&corners)).all(|(first, here)| (here - first).norm() < limit);
        if !is_near {
            self.end_group();
            self.first.clone_from(&corners);
        }
        // East before north, as x before y.
        (self.corners).extend(corners.iter().map(|corner| (corner.y, corner.x)));
        self.lowest = self.lowest.min(place.height);
        self.ground = place.ned.z + place.height;
        if self.corners.len() > 1024 {
            self.end_group();
        }
    }

    /// Joins what the footprints that are taken together cover with the rest.
    fn end_group(&mut self) {
        let corners: MultiPoint = self.corners.drain(..).collect();
        self.first.clear();
        if corners.0.is_empty() {
            return;
        }
        // Areas that run round the other way would count as holes.
        let hull = corners.convex_hull().orient(Direction::Default);
        let mut area = MultiPolygon::new(vec![hull]);
        for place in &mut self.areas {
            match place.take() {
                None => {
                    *place = Some(area);
                    return;
                }
                Some(other) => area = unary_union(&[other, area]),
            }
        }
        self.areas.push(Some(area));
    }

    /// The area as GeoJSON; `None` if there is none, or if it is not known where on the globe it is.
    pub fn finish(mut self, stage: &Stage) -> Option<Footprint> {
        self.end_group();
        let frame = stage.local_frame.as_ref()?;
        let areas: Vec<MultiPolygon> = self.areas.into_iter().flatten().collect();
        let area = unary_union(&areas).simplify(TOLERANCE * self.lowest);
        if area.0.is_empty() {
            return None;
        }
        let degrees = |point: &geo::Coord| {
            let ned = Vector3::new(point.y, point.x, self.ground);
            let place = frame.to_geodetic(&ned);
            // To a millimetre.
            [place.longitude, place.latitude].map(|angle| (angle.to_degrees() * 1e8).round() / 1e8)
        };
        let ring = |ring: &LineString| -> Vec<[f64; 2]> { ring.coords().map(degrees).collect() };
        let polygon = |polygon: &Polygon| -> Vec<Vec<[f64; 2]>> {
            let rings = [polygon.exterior()].into_iter().chain(polygon.interiors());
            rings.map(ring).collect()
        };
        let coordinates: Vec<Vec<Vec<[f64; 2]>>> = area.iter().map(polygon).collect();
        let geojson = json!({
            "type": "FeatureCollection",
            "features": [{
                "type": "Feature",
                "properties": {
                    "name": "what the camera saw of the ground",
                    // As viewers that draw maps with Leaflet read it: the track has to be seen through the area.
                    "style": { "color": "#e5484d", "weight": 2, "fillOpacity": 0.12 },
                },
                "geometry": { "type": "MultiPolygon", "coordinates": coordinates },
            }],
        });
        Some(Footprint {
            geojson: geojson.to_string(),
        })
    }
}
