//! What is drawn in 3D: the drone and its camera, the line of sight and what is seen of the ground, the velocity, a label,
//! and the whole track.

use nalgebra::{UnitQuaternion, Vector2, Vector3};

use super::{
    flight::Flight,
    ground::{footprint, line_of_sight},
    stage::Stage,
    view::{View, map_of, rounded},
};
use crate::derived::visual::{Calibration, Colour, Entity, Frame, Join, Pose, Scene, Shape};

const FRUSTUM: Colour = Colour([0.97, 0.42, 0.08, 1.0]);
const BODY: Colour = Colour([0.2, 0.2, 0.22, 1.0]);
const NOSE: Colour = Colour([0.9, 0.28, 0.3, 1.0]);
const SIGHT: Colour = Colour([0.9, 0.28, 0.3, 1.0]);
const COVERED: Colour = Colour([0.9, 0.28, 0.3, 0.15]);
const VELOCITY: Colour = Colour([0.19, 0.64, 0.42, 1.0]);
const LABEL: Colour = Colour([0.1, 0.1, 0.12, 1.0]);
const SLOW: Colour = Colour([0.2, 0.45, 1.0, 1.0]);
const FAST: Colour = Colour([0.97, 0.6, 0.08, 1.0]);

/// The names of what is drawn of one moment.
const LINE_OF_SIGHT: &str = "line of sight";
const FOOTPRINT: &str = "footprint";
const SPEED: &str = "velocity";
const TEXT: &str = "label";

/// How many points the track has at most.
const MOST_POINTS: usize = 20_000;

/// Slower than this, in m/s, the direction of a velocity is noise.
const LEAST_SPEED: f64 = 0.05;

fn lines(join: Join, points: Vec<Vector3<f64>>, colour: Colour, pixels: f64, size: f64) -> Shape {
    Shape::Lines {
        join,
        points,
        colours: vec![colour],
        pixels,
        width: size * 0.1,
    }
}

/// The drone and what its camera sees, to be drawn once.
pub fn model(stage: &Stage) -> Scene {
    let size = stage.size;
    let mut entities = vec![drone(size)];
    entities.push(match &stage.calibration {
        Some(calibration) => frustum(size, calibration),
        None => optical_axis(size),
    });
    Scene {
        entities,
        removed: Vec::new(),
    }
}

/// A quadcopter as wide as `size`, with a coloured nose.
fn drone(size: f64) -> Entity {
    let at = |x: f64, y: f64, z: f64| Pose {
        position: Vector3::new(x, y, z) * size,
        orientation: UnitQuaternion::identity(),
    };
    let cube = |pose, [x, y, z]: [f64; 3], colour| Shape::Cube {
        pose,
        size: Vector3::new(x, y, z) * size,
        colour,
    };
    let mut shapes = vec![
        cube(at(0.0, 0.0, 0.0), [0.4, 0.2, 0.1], BODY),
        cube(at(0.2, 0.0, 0.0), [0.1, 0.15, 0.08], NOSE),
    ];
    for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)] {
        shapes.push(Shape::Cylinder {
            pose: at(0.3 * x, 0.3 * y, -0.08),
            size: Vector3::new(0.3, 0.3, 0.03) * size,
            colour: BODY,
        });
    }
    let arms = [(0.3, 0.3), (-0.3, -0.3), (0.3, -0.3), (-0.3, 0.3)];
    let arms = arms.map(|(x, y)| Vector3::new(x, y, -0.05) * size);
    shapes.push(lines(Join::Pairs, arms.into(), BODY, 3.0, size));
    Entity {
        id: "drone",
        frame: Frame::Drone,
        is_frame_locked: true,
        shapes,
    }
}

/// The edges of the pyramid that the camera sees.
fn frustum(size: f64, calibration: &Calibration) -> Entity {
    let depth = size * 1.5;
    let corners = calibration.corners();
    let corners = corners.map(|[right, down]| Vector3::new(1.0, right, down) * depth);
    let edges = corners
        .iter()
        .flat_map(|corner| [Vector3::zeros(), *corner]);
    // A triangle on the upper edge shows which side is up.
    let upper = (corners[0] + corners[1]) / 2.0;
    let up = upper + (corners[0] - corners[3]) * 0.15;
    Entity {
        id: "frustum",
        frame: Frame::Camera,
        is_frame_locked: true,
        shapes: vec![
            lines(Join::Pairs, edges.collect(), FRUSTUM, 2.0, size),
            lines(Join::Loop, corners.into(), FRUSTUM, 2.0, size),
            lines(
                Join::Strip,
                vec![corners[0], up, corners[1]],
                FRUSTUM,
                2.0,
                size,
            ),
        ],
    }
}

/// Where the camera looks, if it is not known how wide it sees.
fn optical_axis(size: f64) -> Entity {
    let axis = vec![Vector3::zeros(), Vector3::x() * (size * 1.5)];
    Entity {
        id: "optical axis",
        frame: Frame::Camera,
        is_frame_locked: true,
        shapes: vec![lines(Join::Strip, axis, FRUSTUM, 3.0, size)],
    }
}

/// What is drawn of one tick; of one at which nothing is known, nothing, so that nothing stays from the last.
pub fn scene(view: Option<&View>, stage: &Stage) -> Scene {
    let entities: Vec<Entity> = match view {
        None => Vec::new(),
        Some(view) => [
            sight(view, stage),
            covered(view, stage),
            velocity(view, stage),
            label(view, stage),
        ]
        .into_iter()
        .flatten()
        .collect(),
    };
    let mut removed = vec![LINE_OF_SIGHT, FOOTPRINT, SPEED, TEXT];
    removed.retain(|id| entities.iter().all(|entity| entity.id != *id));
    Scene { entities, removed }
}

fn sight(view: &View, stage: &Stage) -> Option<Entity> {
    let length = line_of_sight(view, stage.reach)?;
    let points = vec![Vector3::zeros(), Vector3::x() * rounded(length)];
    Some(Entity {
        id: LINE_OF_SIGHT,
        frame: Frame::Camera,
        is_frame_locked: true,
        shapes: vec![lines(Join::Strip, points, SIGHT, 2.0, stage.size)],
    })
}

fn covered(view: &View, stage: &Stage) -> Option<Entity> {
    let place = view.place?;
    let corners = footprint(view, stage.calibration.as_ref()?, stage.reach)?;
    if corners.len() < 3 {
        return None;
    }
    let on_map = |corner: &Vector2<f64>| {
        let offset = Vector3::new(corner.x, corner.y, place.height);
        map_of(&(place.ned + offset)).map(rounded)
    };
    let points: Vec<Vector3<f64>> = corners.iter().map(on_map).collect();
    // The polygon is convex, so that it is a fan of triangles.
    let fan = points[1..]
        .windows(2)
        .flat_map(|pair| [points[0], pair[0], pair[1]]);
    Some(Entity {
        id: FOOTPRINT,
        frame: Frame::Map,
        is_frame_locked: true,
        shapes: vec![
            Shape::Triangles {
                points: fan.collect(),
                colour: COVERED,
            },
            lines(Join::Loop, points, SIGHT, 2.0, stage.size),
        ],
    })
}

/// An arrow that is long enough at full speed to reach beyond the frustum.
fn velocity(view: &View, stage: &Stage) -> Option<Entity> {
    let place = view.place?;
    let velocity = map_of(&view.tick.velocity?);
    let speed = velocity.norm();
    if speed < LEAST_SPEED {
        return None;
    }
    let orientation = UnitQuaternion::rotation_between(&Vector3::x(), &velocity)
        .unwrap_or_else(|| UnitQuaternion::new(Vector3::z() * std::f64::consts::PI));
    Some(Entity {
        id: SPEED,
        frame: Frame::Map,
        is_frame_locked: true,
        shapes: vec![Shape::Arrow {
            pose: Pose {
                position: map_of(&place.ned),
                orientation,
            },
            length: stage.size * (1.0 + 3.0 * speed / stage.top_speed),
            diameter: stage.size * 0.1,
            colour: VELOCITY,
        }],
    })
}

fn label(view: &View, stage: &Stage) -> Option<Entity> {
    let speed = view
        .tick
        .velocity
        .map(|ned| format!("{:.1} m/s", ned.norm()));
    let height = view.place.map(|place| format!("{:.1} m", place.height));
    let parts: Vec<String> = [speed, height].into_iter().flatten().collect();
    if parts.is_empty() {
        return None;
    }
    Some(Entity {
        id: TEXT,
        frame: Frame::Drone,
        is_frame_locked: true,
        shapes: vec![Shape::Text {
            position: Vector3::new(0.0, 0.0, -stage.size),
            text: parts.join("  "),
            pixels: 14.0,
            height: stage.size * 0.75,
            colour: LABEL,
        }],
    })
}

/// The whole track, coloured by speed: a line for each part without a gap. `None` if it is not known where the drone was.
pub fn path(flight: &Flight, stage: &Stage) -> Option<Scene> {
    let step = flight.ticks.len().div_ceil(MOST_POINTS).max(1);
    let mut shapes = Vec::new();
    let (mut points, mut colours) = (Vec::new(), Vec::new());
    let mut end_line = |points: &mut Vec<_>, colours: &mut Vec<_>| {
        if points.len() > 1 {
            shapes.push(Shape::Lines {
                join: Join::Strip,
                points: std::mem::take(points),
                colours: std::mem::take(colours),
                pixels: 2.0,
                width: stage.size * 0.1,
            });
        }
        points.clear();
        colours.clear();
    };
    let mut epoch = 0;
    for tick in flight.ticks.iter().step_by(step) {
        match stage.place(tick) {
            Some(place) if tick.epoch == epoch => {
                points.push(map_of(&place.ned).map(rounded));
                colours.push(colour_of(tick.velocity, stage.top_speed));
            }
            _ => end_line(&mut points, &mut colours),
        }
        epoch = tick.epoch;
    }
    end_line(&mut points, &mut colours);
    (!shapes.is_empty()).then(|| Scene {
        entities: vec![Entity {
            id: "path",
            frame: Frame::Map,
            is_frame_locked: true,
            shapes,
        }],
        removed: Vec::new(),
    })
}

/// From blue, slow, to orange, as fast as the flight was; colours that most people can tell apart.
fn colour_of(velocity: Option<Vector3<f64>>, top_speed: f64) -> Colour {
    let part = velocity.map_or(0.0, |velocity| velocity.norm() / top_speed.max(LEAST_SPEED));
    let mix = |channel: usize| SLOW.0[channel] + (FAST.0[channel] - SLOW.0[channel]) * part as f32;
    Colour([mix(0), mix(1), mix(2), 1.0])
}
