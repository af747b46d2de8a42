//! Where things are: in 3D, and on a map.

use super::{
    colours::{BLUE, LIGHT, RED},
    panel::{Grid, MapView, Panel, SceneView, View},
    survey::Survey,
    types::Drawn,
};
use crate::{
    derived::visual::{Frame, VisualTopic},
    log::ReadError,
};

/// How far the flight is taken to reach if that is not known, metres.
const USUAL_EXTENT: f64 = 200.0;

/// Seen from this many times the extent of the flight away, most of what the camera sees of the ground is in sight, too.
const DISTANCE: f64 = 1.5;

/// From nearer, the drone would fill the panel; metres. It is never drawn smaller than half a metre.
const NEAREST: f64 = 8.0;

/// How far one sees at least, metres.
const LEAST_REACH: f64 = 5000.0;

/// About how many lines of the grid a flight reaches over, and how many there are in all, because the camera sees
/// beyond that.
const CELLS_OF_FLIGHT: f64 = 8.0;
const CELLS: u32 = 40;

/// Pixels of the map that the track is to fill: most of the panel's height on a small screen.
const PIXELS: f64 = 180.0;

/// How many metres a pixel is at the equator on a web map of zoom level 0.
const METRES_OF_PIXEL: f64 = 156_543.03;

/// The zoom levels between which viewers show web maps; pictures of level 19 are made larger.
const ZOOM: (f64, f64) = (2.0, 21.0);

/// The zoom level where the extent of the flight is not known.
const USUAL_ZOOM: f64 = 16.0;

/// Drone and camera, and what they are drawn with.
pub fn scene(survey: &Survey) -> Result<Option<Panel>, ReadError> {
    let Some(prefix) = prefix(survey)? else {
        return Ok(None);
    };
    let drawn = |topics: [(VisualTopic, Drawn); 3]| {
        let topics = topics.into_iter();
        topics
            .filter_map(|(topic, drawn)| survey.drawn(topic, drawn))
            .collect()
    };
    let frame = |frame: Frame| format!("{prefix}{}", frame.name());
    let extent = extent(survey).unwrap_or(USUAL_EXTENT);
    let distance = rounded((DISTANCE * extent).max(NEAREST), 10.0);
    let is_of_transforms = |drawn| drawn == Some(Drawn::Transforms);
    let transforms = survey
        .channels()
        .filter(|(_, _, drawn)| is_of_transforms(*drawn));
    let view = SceneView {
        followed: frame(Frame::DroneEnu),
        world: frame(Frame::Map),
        hidden_frames: Frame::ALL.map(frame).into(),
        shown: drawn([
            (VisualTopic::Scene, Drawn::Scene),
            (VisualTopic::Model, Drawn::Scene),
            (VisualTopic::Path, Drawn::Scene),
        ]),
        hidden: drawn([
            (VisualTopic::Calibration, Drawn::Calibration),
            (VisualTopic::Pose, Drawn::Pose),
            (VisualTopic::Odometry, Drawn::Pose),
        ]),
        background: LIGHT,
        distance,
        reach: (20.0 * distance).max(LEAST_REACH),
        grid: Grid {
            cell: scale(extent / CELLS_OF_FLIGHT),
            cells: CELLS,
            height: (survey.numbers("visuals_ground_in_map_m"))
                .map_or(0.0, |[height]| rounded(height, 1000.0)),
        },
        transforms: transforms.map(|(_, count, _)| count).sum(),
    };
    Ok(Some(Panel {
        id: "scene",
        title: "Drone and camera",
        view: View::Scene(view),
    }))
}

/// What stands before the names of frames in this log.
fn prefix(survey: &Survey) -> Result<Option<String>, ReadError> {
    for topic in [VisualTopic::Transforms, VisualTopic::Tf] {
        let frame = survey.first_moving_frame(topic)?;
        let prefix = frame.and_then(|frame| {
            let prefix = frame.strip_suffix(Frame::Drone.name())?;
            Some(prefix.to_owned())
        });
        if prefix.is_some() {
            return Ok(prefix);
        }
    }
    Ok(None)
}

/// The camera's track on a map, and what its pictures cover.
pub fn map(survey: &Survey) -> Option<Panel> {
    let track = survey.drawn(VisualTopic::Location, Drawn::Place)?;
    let footprint = survey.drawn(VisualTopic::Footprint, Drawn::Place);
    let centre = survey.numbers("visuals_centre_deg");
    let centre = centre.map(|degrees: [f64; 2]| degrees.map(|angle| rounded(angle, 1e7)));
    let zoom = centre.zip(extent(survey));
    let shown = [(track.clone(), BLUE)].into_iter();
    let shown: Vec<_> = shown.chain(footprint.map(|topic| (topic, RED))).collect();
    let others = survey.channels().filter(|(channel, _, drawn)| {
        *drawn == Some(Drawn::Place) && shown.iter().all(|(topic, _)| *topic != channel.topic)
    });
    Some(Panel {
        id: "map",
        title: "Map",
        view: View::Map(MapView {
            hidden: others.map(|(channel, ..)| channel.topic.clone()).collect(),
            shown,
            track,
            centre,
            zoom: zoom.map_or(USUAL_ZOOM, |([latitude, _], extent)| {
                zoom_level(latitude, extent)
            }),
        }),
    })
}

/// The zoom level at which a flight fills a map.
fn zoom_level(latitude: f64, extent: f64) -> f64 {
    let metres_of_pixel = METRES_OF_PIXEL * latitude.to_radians().cos();
    let level = (metres_of_pixel * PIXELS / extent).log2().floor();
    level.clamp(ZOOM.0, ZOOM.1)
}

/// How far the flight reaches, metres, if that is known.
fn extent(survey: &Survey) -> Option<f64> {
    let [extent] = survey.numbers("visuals_extent_m")?;
    // No flight reaches further than around the earth.
    Some(extent.clamp(1.0, 4e7))
}

/// The nearest of so many parts of one, so that there are no digits that nobody sees.
fn rounded(number: f64, parts: f64) -> f64 {
    (number * parts).round() / parts
}

/// The nearest of 1, 2, 5, 10, 20, 50, …
fn scale(number: f64) -> f64 {
    let power = 10_f64.powf(number.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    let distance = |step: &f64| (step / number).ln().abs();
    let nearest = (steps.into_iter()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.unwrap_or(power)
}
