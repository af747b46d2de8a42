//! What viewers are shown of a flight, whatever the message types: transforms, poses, places, things to draw in 3D, and
//! numbers in the units that people read.
//!
//! Positions are metres, angles radians, except where a name says degrees.

use nalgebra::{UnitQuaternion, Vector3};

/// One message for viewers.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// Its log time in nanoseconds.
    pub time: u64,
    /// Its content.
    pub visual: Visual,
}

/// What is shown.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Visual {
    /// Where the frames that move are in their parents.
    Transforms(Vec<Transform>),
    /// Where the frames that never move are in their parents.
    StaticTransforms(Vec<Transform>),
    /// Where the camera is and how it moves.
    Odometry(Odometry),
    /// Where the camera is, for viewers that do not know odometry.
    Pose(Pose),
    /// Where the camera is on the globe.
    Location(Location),
    /// What is drawn of the drone and its camera, once.
    Model(Scene),
    /// What is drawn of one moment.
    Scene(Scene),
    /// The whole track, once.
    Path(Scene),
    /// How the camera projects, once.
    Calibration(Calibration),
    /// What all pictures cover on the ground, once.
    Footprint(Footprint),
    /// Something that happened, for viewers that know events.
    Event(Event),
    /// Something that happened, as a line of a log.
    Log(Event),
    /// Whether everything that is shown is known, each time that this changes.
    State(State),
    /// Numbers in the units that people read.
    Display(Display),
}

/// The topics for viewers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
// Each is the topic of the visual of the same name.
#[allow(missing_docs)]
pub enum VisualTopic {
    StaticTransforms,
    Transforms,
    Odometry,
    Pose,
    Location,
    Model,
    Scene,
    Path,
    Calibration,
    Footprint,
    Events,
    Log,
    State,
    Display,
    /// In ROS 2, that of [`Transforms`](Self::Transforms) if the log has none of this name.
    Tf,
    /// In ROS 2, that of [`StaticTransforms`](Self::StaticTransforms) if the log has none of this name.
    TfStatic,
}

impl VisualTopic {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 16] = [
        Self::StaticTransforms,
        Self::TfStatic,
        Self::Transforms,
        Self::Tf,
        Self::Odometry,
        Self::Pose,
        Self::Location,
        Self::Model,
        Self::Scene,
        Self::Path,
        Self::Calibration,
        Self::Footprint,
        Self::Events,
        Self::Log,
        Self::State,
        Self::Display,
    ];

    /// Whether all its messages are at the start of the flight and hold for all of it.
    pub fn is_written_once(self) -> bool {
        matches!(
            self,
            Self::StaticTransforms
                | Self::TfStatic
                | Self::Model
                | Self::Path
                | Self::Calibration
                | Self::Footprint
        )
    }

    /// Whether other programs write to a topic of this name, too.
    pub fn is_shared(self) -> bool {
        matches!(self, Self::Tf | Self::TfStatic)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::StaticTransforms => "/camera/transforms_static",
            Self::Transforms => "/camera/transforms",
            Self::Odometry => "/camera/odometry",
            Self::Pose => "/camera/pose",
            Self::Location => "/camera/location",
            Self::Model => "/camera/model",
            Self::Scene => "/camera/scene",
            Self::Path => "/camera/path",
            Self::Calibration => "/camera/calibration",
            Self::Footprint => "/camera/footprint",
            Self::Events => "/camera/events",
            Self::Log => "/camera/log",
            Self::State => "/camera/state",
            Self::Display => "/camera/display",
            Self::Tf => "/tf",
            Self::TfStatic => "/tf_static",
        }
    }
}

impl Visual {
    /// The topic that it is written to, unless the format has another one for it.
    pub fn topic(&self) -> VisualTopic {
        match self {
            Self::Transforms(_) => VisualTopic::Transforms,
            Self::StaticTransforms(_) => VisualTopic::StaticTransforms,
            Self::Odometry(_) => VisualTopic::Odometry,
            Self::Pose(_) => VisualTopic::Pose,
            Self::Location(_) => VisualTopic::Location,
            Self::Model(_) => VisualTopic::Model,
            Self::Scene(_) => VisualTopic::Scene,
            Self::Path(_) => VisualTopic::Path,
            Self::Calibration(_) => VisualTopic::Calibration,
            Self::Footprint(_) => VisualTopic::Footprint,
            Self::Event(_) => VisualTopic::Events,
            Self::Log(_) => VisualTopic::Log,
            Self::State(_) => VisualTopic::State,
            Self::Display(_) => VisualTopic::Display,
        }
    }
}

/// The frames that are shown. All are right-handed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Frame {
    /// East, north, up: what a viewer's 3D panel expects of the world.
    Map,
    /// North, east, down; its origin is that of [`Map`](Self::Map).
    Ned,
    /// The drone's front, right, down.
    Drone,
    /// East, north, up, at the drone: from here a viewer follows the drone without turning with it.
    DroneEnu,
    /// Where the camera looks, right, down.
    Camera,
    /// Right, down, where the camera looks: what image panels and calibrations expect.
    CameraOptical,
}

impl Frame {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Map,
        Self::Ned,
        Self::Drone,
        Self::DroneEnu,
        Self::Camera,
        Self::CameraOptical,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Map => "map",
            Self::Ned => "ned",
            Self::Drone => "drone",
            Self::DroneEnu => "drone_enu",
            Self::Camera => "camera",
            Self::CameraOptical => "camera_optical",
        }
    }
}

/// A place and an orientation in a frame: turns coordinates of what is there into those of the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Metres from the frame's origin.
    pub position: Vector3<f64>,
    /// The orientation in the frame.
    pub orientation: UnitQuaternion<f64>,
}

impl Pose {
    /// A place, in the orientation of the frame.
    pub fn at(position: Vector3<f64>) -> Self {
        Self {
            position,
            orientation: UnitQuaternion::identity(),
        }
    }
}

/// Where a frame is in another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// The other frame.
    pub parent: Frame,
    /// The frame.
    pub child: Frame,
    /// Its pose in the other one.
    pub pose: Pose,
}

/// Where the camera is and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odometry {
    /// Its pose in [`Frame::Map`].
    pub pose: Pose,
    /// Its velocity in its own axes, m/s.
    pub velocity: Vector3<f64>,
    /// How fast it turns about its own axes, rad/s.
    pub angular_velocity: Vector3<f64>,
}

/// Where the camera is on the globe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Location {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Metres above whatever the log takes for zero.
    pub altitude: f64,
    /// The direction of the optical axis, clockwise from north, 0 to 2π.
    pub heading: f64,
    /// East, north, up, m/s; `None` if it is not known.
    pub velocity_enu: Option<Vector3<f64>>,
}

/// Things to draw, and those of earlier scenes on the topic to remove.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// What is drawn; it replaces what had the same name.
    pub entities: Vec<Entity>,
    /// The names of what is removed.
    pub removed: Vec<&'static str>,
}

/// Something to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Entity {
    /// Its name.
    pub id: &'static str,
    /// The frame in which it is drawn.
    pub frame: Frame,
    /// Whether it moves with the frame; otherwise it stays where the frame was.
    pub is_frame_locked: bool,
    /// Its parts.
    pub shapes: Vec<Shape>,
}

/// A part of something to draw.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// An arrow along the x axis of its pose.
    Arrow {
        /// Where it begins, and its direction.
        pose: Pose,
        /// From its tail to its tip, metres.
        length: f64,
        /// The shaft's diameter in metres; the head's is twice that.
        diameter: f64,
        /// Its colour.
        colour: Colour,
    },
    /// Lines between points.
    Lines {
        /// Which points are joined.
        join: Join,
        /// The points.
        points: Vec<Vector3<f64>>,
        /// One colour for all, or one for each point.
        colours: Vec<Colour>,
        /// The thickness in pixels, for viewers that can draw such lines.
        pixels: f64,
        /// The thickness in metres, for the others.
        width: f64,
    },
    /// Triangles; each three points are one.
    Triangles {
        /// The points.
        points: Vec<Vector3<f64>>,
        /// Their colour.
        colour: Colour,
    },
    /// A text that always faces the viewer.
    Text {
        /// Where its middle is.
        position: Vector3<f64>,
        /// The text.
        text: String,
        /// The height of a line in pixels, for viewers that can draw such texts.
        pixels: f64,
        /// The height of a line in metres, for the others.
        height: f64,
        /// Its colour.
        colour: Colour,
    },
    /// A box.
    Cube {
        /// Where its middle is.
        pose: Pose,
        /// Its lengths along the axes of its pose, metres.
        size: Vector3<f64>,
        /// Its colour.
        colour: Colour,
    },
    /// A cylinder about the z axis of its pose.
    Cylinder {
        /// Where its middle is.
        pose: Pose,
        /// Its lengths along the axes of its pose, metres.
        size: Vector3<f64>,
        /// Its colour.
        colour: Colour,
    },
}

/// Which points of a line are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Join {
    /// Each with the next.
    Strip,
    /// Each with the next, and the last with the first.
    Loop,
    /// The first with the second, the third with the fourth, and so on.
    Pairs,
}

/// A colour: red, green, blue and opacity, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour(pub [f32; 4]);

/// A pinhole camera without distortion, in [`Frame::CameraOptical`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// Pixels in a row of a picture.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The focal length in pixels, along a row and along a column.
    pub focal: [f64; 2],
    /// The pixel on the optical axis, along a row and along a column.
    pub centre: [f64; 2],
}

impl Calibration {
    /// The corners of a picture at a distance of one along the optical axis, right and down of it: top left, top right,
    /// bottom right, bottom left.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        let [width, height] = [self.width, self.height].map(f64::from);
        let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        corners.map(|pixel| [0, 1].map(|i| (pixel[i] - self.centre[i]) / self.focal[i]))
    }

    /// The whole angles from left to right and from top to bottom, degrees.
    pub fn field_of_view_deg(&self) -> [f64; 2] {
        let [[left, top], _, [right, bottom], _] = self.corners();
        [right.atan() - left.atan(), bottom.atan() - top.atan()].map(f64::to_degrees)
    }
}

/// What all pictures cover on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Footprint {
    /// A GeoJSON FeatureCollection.
    pub geojson: String,
}

/// Something that happened during the flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// When it ended, nanoseconds of log time; it began at the time of the message.
    pub end: u64,
    /// Its kind in a word or two, such as `gap`.
    pub kind: &'static str,
    /// What happened, in a sentence.
    pub text: String,
}

/// Whether everything that is shown is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct State {
    /// In a word or two: `ok`, or what is missing.
    pub name: &'static str,
}

/// Numbers in the units that people read. Those that are not known are `None`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Display {
    /// The direction of the optical axis in degrees clockwise from north, 0 to 360.
    pub heading: f32,
    /// The same without steps from 360 to 0: it goes on beyond 360 and below 0.
    pub heading_unwrapped: f32,
    /// Degrees of the optical axis above the horizon; below it is negative, as a gimbal's pitch.
    pub tilt: f32,
    /// Degrees about the optical axis, positive when the image's right side is down.
    pub roll: f32,
    /// How fast the camera turns about its axes: where it looks, right, down; degrees per second.
    pub rates: Option<[f32; 3]>,
    /// The drone's speed, m/s.
    pub speed: Option<f32>,
    /// The horizontal part of it, m/s.
    pub ground_speed: Option<f32>,
    /// The vertical part of it, m/s, positive upwards.
    pub climb: Option<f32>,
    /// Metres above the ground.
    pub height: Option<f32>,
}
