//! What is the same for the whole flight: its origin, the ground, its size, and what the camera sees.

use nalgebra::Vector3;

use super::{
    flight::{Flight, Tick},
    options::Reach,
    terrain::Terrain,
};
use crate::{
    derived::visual::Calibration,
    geometry::{geodetic::Geodetic, local_frame::LocalFrame},
    sample::Position,
};

/// What is drawn is this part of the flight's extent, so that it is seen from where all of the flight is seen.
const PART_OF_EXTENT: f64 = 0.05;

/// The size of what is drawn, in metres: at least that of a small drone, and no larger than an airliner.
const SIZES: (f64, f64) = (0.5, 40.0);

/// What is the same for the whole flight.
#[derive(Debug)]
pub struct Stage {
    /// How places on the globe become positions; `None` if positions are local ones already, or if there are none.
    pub local_frame: Option<LocalFrame>,
    /// Whether there are positions.
    pub has_positions: bool,
    /// The altitude of the ground at the first position as the log counts altitudes, metres; `None` if there are no
    /// positions.
    pub ground: Option<f64>,
    /// The ground as the log's heights say it; `None` if it is taken to be level.
    pub terrain: Option<Terrain>,
    /// How far the flight reaches, from one corner of the box around its track to the other, metres.
    pub extent: f64,
    /// The middle of that box on the globe, if that is known.
    pub centre: Option<Geodetic>,
    /// The size of the drone as it is drawn, metres.
    pub size: f64,
    /// The highest speed, m/s.
    pub top_speed: f64,
    /// How the camera projects, if that is known.
    pub calibration: Option<Calibration>,
    /// How far what is seen of the ground is shown.
    pub reach: Reach,
}

/// Where the drone is at one time.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// North, east, down of the origin, metres.
    pub ned: Vector3<f64>,
    /// Metres above the ground.
    pub height: f64,
    /// On the globe, if that is known.
    pub geodetic: Option<Geodetic>,
}

impl Stage {
    /// Of a flight for which it is settled where the ground is.
    pub fn new(
        flight: &Flight,
        terrain: Option<Terrain>,
        calibration: Option<Calibration>,
        reach: Reach,
    ) -> Self {
        let mut placed = flight.ticks.iter();
        let first = placed.find(|tick| tick.position.is_some());
        let mut stage = Self {
            local_frame: first
                .and_then(|first| geodetic(&first.position?))
                .map(|origin| LocalFrame::at(&origin)),
            has_positions: first.is_some(),
            ground: first.and_then(|first| first.ground),
            terrain,
            extent: 0.0,
            centre: None,
            size: SIZES.0,
            top_speed: 0.0,
            calibration,
            reach,
        };
        let speeds = flight.ticks.iter().filter_map(|tick| tick.velocity);
        stage.top_speed = speeds.map(|velocity| velocity.norm()).fold(0.0, f64::max);
        let places = flight.ticks.iter().filter_map(|tick| stage.place(tick));
        let bounds = places.fold(
            None,
            |bounds: Option<(Vector3<f64>, Vector3<f64>)>, place| {
                let (low, high) = bounds.unwrap_or((place.ned, place.ned));
                Some((low.inf(&place.ned), high.sup(&place.ned)))
            },
        );
        if let Some((low, high)) = bounds {
            stage.extent = (high - low).norm();
            stage.centre =
                (stage.local_frame.as_ref()).map(|frame| frame.to_geodetic(&((low + high) / 2.0)));
            stage.size = (stage.extent * PART_OF_EXTENT).clamp(SIZES.0, SIZES.1);
        }
        stage
    }

    /// Where the drone is at a tick.
    pub fn place(&self, tick: &Tick) -> Option<Place> {
        let position = tick.position.as_ref()?;
        let geodetic = geodetic(position);
        let ned = match (position, &self.local_frame, &geodetic) {
            (Position::Local(ned), ..) => *ned,
            (_, Some(frame), Some(place)) => frame.to_ned(place),
            _ => return None,
        };
        Some(Place {
            ned,
            height: altitude(position) - tick.ground?,
            geodetic,
        })
    }
}

fn geodetic(position: &Position) -> Option<Geodetic> {
    match *position {
        Position::Local(_) => None,
        Position::Geodetic {
            latitude,
            longitude,
            altitude,
        } => Geodetic::from_degrees(latitude, longitude, altitude),
    }
}

/// Metres, as the log counts altitudes; of a local position, above its origin.
pub fn altitude(position: &Position) -> f64 {
    match *position {
        Position::Local(ned) => -ned.z,
        Position::Geodetic { altitude, .. } => altitude,
    }
}
