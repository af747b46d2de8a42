//! One of each thing that viewers are shown, with content of every kind.

use flightcam::derived::visual::{
    Calibration, Colour, Display, Entity, Event, Footprint, Frame, Join, Location, Odometry, Pose,
    Scene, Shape, State, Transform, Visual,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// A turn by 120° about (-1, 1, -1); its numbers are exact. As x, y, z, w it is -0.5, 0.5, -0.5, 0.5.
pub fn turn() -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(0.5, -0.5, 0.5, -0.5))
}

pub fn pose() -> Pose {
    Pose {
        position: Vector3::new(1.5, -2.5, 30.25),
        orientation: turn(),
    }
}

/// The second one has negative zeros.
pub fn transforms() -> Vec<Transform> {
    vec![
        Transform {
            parent: Frame::Map,
            child: Frame::Drone,
            pose: pose(),
        },
        Transform {
            parent: Frame::Drone,
            child: Frame::Camera,
            pose: Pose::at(Vector3::new(-0.0, 0.25, -0.0)),
        },
    ]
}

pub fn static_transforms() -> Vec<Transform> {
    vec![Transform {
        parent: Frame::Map,
        child: Frame::Ned,
        pose: Pose::at(Vector3::zeros()),
    }]
}

pub fn odometry() -> Odometry {
    Odometry {
        pose: pose(),
        velocity: Vector3::new(12.5, -0.0, -1.25),
        angular_velocity: Vector3::new(0.125, -0.5, 0.75),
    }
}

pub fn location() -> Location {
    Location {
        latitude_deg: 47.25,
        longitude_deg: -8.5,
        altitude: 512.75,
        heading: 1.5,
        velocity_enu: Some(Vector3::new(3.0, -4.0, 0.5)),
    }
}

pub const RED: Colour = Colour([1.0, 0.0, 0.0, 0.5]);
pub const GREEN: Colour = Colour([0.0, 1.0, 0.25, 1.0]);

pub fn points(count: usize) -> Vec<Vector3<f64>> {
    let point = |number: usize| Vector3::new(number as f64, 0.5, -1.0);
    (0..count).map(point).collect()
}

pub fn lines(join: Join, colours: Vec<Colour>) -> Shape {
    Shape::Lines {
        join,
        points: points(4),
        colours,
        pixels: 2.0,
        width: 0.125,
    }
}

pub fn entity(id: &'static str, shapes: Vec<Shape>) -> Entity {
    Entity {
        id,
        frame: Frame::Drone,
        is_frame_locked: true,
        shapes,
    }
}

/// A scene with each shape.
pub fn scene() -> Scene {
    let body = entity(
        "body",
        vec![
            Shape::Arrow {
                pose: pose(),
                length: 2.0,
                diameter: 0.25,
                colour: RED,
            },
            Shape::Cube {
                pose: pose(),
                size: Vector3::new(0.5, 0.25, 0.125),
                colour: GREEN,
            },
            Shape::Cylinder {
                pose: pose(),
                size: Vector3::new(1.0, 1.0, 0.5),
                colour: RED,
            },
            Shape::Triangles {
                points: points(3),
                colour: GREEN,
            },
            Shape::Text {
                position: Vector3::new(0.0, 0.0, 5.0),
                text: "12 m/s – größer".to_owned(),
                pixels: 14.0,
                height: 0.75,
                colour: RED,
            },
        ],
    );
    let track = Entity {
        id: "track",
        frame: Frame::Map,
        is_frame_locked: false,
        shapes: vec![
            lines(Join::Strip, vec![RED]),
            lines(Join::Loop, vec![RED, GREEN, RED, GREEN]),
            lines(Join::Pairs, vec![GREEN]),
        ],
    };
    Scene {
        entities: vec![body, track],
        removed: vec!["footprint", "track"],
    }
}

pub fn calibration() -> Calibration {
    Calibration {
        width: 1920,
        height: 1080,
        focal: [1000.5, 1001.5],
        centre: [960.0, 540.0],
    }
}

pub fn geojson() -> &'static str {
    r#"{"type":"FeatureCollection","features":[]}"#
}

pub fn event() -> Event {
    Event {
        end: 7_000_000_009,
        kind: "gap",
        text: "No attitude for 5 s".to_owned(),
    }
}

pub fn display() -> Display {
    Display {
        heading: 359.5,
        heading_unwrapped: -0.5,
        tilt: -30.25,
        roll: -0.0,
        rates: Some([1.5, -2.5, 0.125]),
        speed: Some(12.5),
        ground_speed: Some(12.25),
        climb: Some(-0.0),
        height: Some(81.5),
    }
}

/// A display without the numbers that may be unknown.
pub fn display_of_little() -> Display {
    Display {
        heading: 90.0,
        ..Display::default()
    }
}

/// One of each kind, and a second display.
pub fn visuals() -> Vec<Visual> {
    let model = Scene {
        entities: vec![entity("drone", scene().entities[0].shapes.clone())],
        removed: Vec::new(),
    };
    let path = Scene {
        entities: vec![entity("path", vec![lines(Join::Strip, vec![GREEN])])],
        removed: Vec::new(),
    };
    vec![
        Visual::StaticTransforms(static_transforms()),
        Visual::Model(model),
        Visual::Path(path),
        Visual::Calibration(calibration()),
        Visual::Footprint(Footprint {
            geojson: geojson().to_owned(),
        }),
        Visual::Transforms(transforms()),
        Visual::Odometry(odometry()),
        Visual::Pose(pose()),
        Visual::Location(location()),
        Visual::Scene(scene()),
        Visual::Event(event()),
        Visual::Log(event()),
        Visual::State(State {
            name: "no attitude",
        }),
        Visual::Display(display()),
        Visual::Display(display_of_little()),
    ]
}
