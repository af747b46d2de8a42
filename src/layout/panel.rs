//! What a layout consists of, whichever viewer it is for.

/// A part of the window.
#[derive(Debug, Clone, PartialEq)]
pub enum Area {
    /// A panel fills it.
    Panel(Panel),
    /// It is divided; each part gets room in proportion to its number.
    Split(Direction, Vec<(u32, Area)>),
}

/// How an area is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Side by side.
    Row,
    /// One above the other.
    Column,
}

impl Area {
    /// Divides an area among those parts that there are; `None` if there are none.
    pub fn split(
        direction: Direction,
        parts: impl IntoIterator<Item = (u32, Option<Self>)>,
    ) -> Option<Self> {
        let parts = parts.into_iter();
        let mut parts: Vec<(u32, Self)> = parts
            .filter_map(|(share, part)| Some((share, part?)))
            .collect();
        match parts.len() {
            0 | 1 => parts.pop().map(|(_, part)| part),
            _ => Some(Self::Split(direction, parts)),
        }
    }
}

/// A panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// By which it is told from other panels of its kind.
    pub id: &'static str,
    /// What stands above it.
    pub title: &'static str,
    /// What it shows.
    pub view: View,
}

/// What a panel shows. Texts with a topic and a field are message paths.
#[derive(Debug, Clone, PartialEq)]
pub enum View {
    /// Things in 3D.
    Scene(SceneView),
    /// Places on a map.
    Map(MapView),
    /// Numbers over time.
    Plot {
        /// The numbers.
        series: Vec<Series>,
        /// The times that are shown.
        times: Times,
    },
    /// A number between zero and a highest one.
    Gauge {
        /// The number.
        path: String,
        /// The end of the scale.
        highest: f64,
    },
    /// A state, in its colour.
    Indicator(StateSeries),
    /// States over time.
    States {
        /// The states.
        series: Vec<StateSeries>,
        /// The times that are shown.
        times: Times,
    },
    /// The lines of a log.
    Log {
        /// The topic of the lines.
        topic: String,
    },
    /// Pictures.
    Picture {
        /// Their topic.
        topic: String,
        /// The topic that says how the camera projects.
        calibration: Option<String>,
    },
}

/// The part of a log that is shown, from when to when in seconds since the log's start; `None` for all of it.
pub type Times = Option<[f64; 2]>;

/// Things in 3D, seen from a point that moves with a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneView {
    /// The frame that is followed.
    pub followed: String,
    /// The frame in which the ground is level.
    pub world: String,
    /// The frames whose axes are not drawn.
    pub hidden_frames: Vec<String>,
    /// The topics that are drawn.
    pub shown: Vec<String>,
    /// Topics that could be drawn, and are not at first.
    pub hidden: Vec<String>,
    /// The colour behind everything: a light one, because texts are dark.
    pub background: &'static str,
    /// How far away the point of view is, metres.
    pub distance: f64,
    /// How far one sees from there, metres.
    pub reach: f64,
    /// The lines on the ground.
    pub grid: Grid,
    /// How many messages with transforms the log has.
    pub transforms: u64,
}

/// Level lines, as many in both directions, around the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Metres between two lines.
    pub cell: f64,
    /// How many cells there are in each direction.
    pub cells: u32,
    /// Its height in its frame, metres.
    pub height: f64,
}

/// Places on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapView {
    /// The topics that are drawn, and their colours.
    pub shown: Vec<(String, &'static str)>,
    /// The topic of the camera's places, which are drawn as a track.
    pub track: String,
    /// Topics that could be drawn, and are not at first.
    pub hidden: Vec<String>,
    /// Latitude and longitude of the middle, degrees, if they are known.
    pub centre: Option<[f64; 2]>,
    /// The zoom level of web maps: each doubles the scale, and at 0 the whole world is 256 pixels wide.
    pub zoom: f64,
}

/// A number over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The number.
    pub path: String,
    /// Its name in the legend.
    pub label: &'static str,
    /// The colour of its line.
    pub colour: &'static str,
}

/// A state over time.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSeries {
    /// The state.
    pub path: String,
    /// What it is the state of.
    pub label: &'static str,
    /// The states that have a colour.
    pub colours: Vec<(&'static str, &'static str)>,
}
