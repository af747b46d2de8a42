//! A scene as a `visualization_msgs/MarkerArray`: a marker for each shape, in the namespace of its entity.

use nalgebra::Vector3;

use super::super::{
    super::{Format, Header, cdr::Cdr, ros2},
    to_ros2,
};
use crate::derived::visual::{Colour, Entity, Frame, Join, Pose, Scene, Shape};

/// Writes the message. An entity replaces what had its name, which may have had more shapes. So before its markers comes
/// one that deletes all others of its namespace.
pub fn write(format: &Format, time: u64, scene: &Scene, out: &mut Vec<u8>) {
    // An entity that is drawn is removed anyway, and rviz complains if that is said twice.
    let is_drawn = |id: &str| scene.entities.iter().any(|entity| entity.id == id);
    let removed = scene.removed.iter().filter(|id| !is_drawn(id));
    let drawn = scene.entities.iter().map(|entity| 1 + entity.shapes.len());

    let mut cdr = Cdr::begin(out);
    cdr.put_length(removed.clone().count() + drawn.sum::<usize>());
    for id in removed {
        let header = format.header(time, Frame::Map);
        Marker::deleting(id, header).write(&mut cdr);
    }
    for entity in &scene.entities {
        let header = format.header(time, entity.frame);
        Marker::deleting(entity.id, header).write(&mut cdr);
        for (shape, id) in entity.shapes.iter().zip(0..) {
            Marker::of(shape, id, entity, header).write(&mut cdr);
        }
    }
}

/// A `visualization_msgs/Marker`.
struct Marker<'a> {
    header: Header,
    namespace: &'a str,
    id: i32,
    kind: i32,
    action: i32,
    pose: Pose,
    scale: Vector3<f64>,
    colour: Colour,
    is_frame_locked: bool,
    points: &'a [Vector3<f64>],
    /// That of each point; empty if all have the same.
    colours: &'a [Colour],
    /// Whether the first point is also the last.
    is_closed: bool,
    text: &'a str,
}

// Its constants.

const ARROW: i32 = 0;
const CUBE: i32 = 1;
const CYLINDER: i32 = 3;
const LINE_STRIP: i32 = 4;
const LINE_LIST: i32 = 5;
const TEXT_VIEW_FACING: i32 = 9;
const TRIANGLE_LIST: i32 = 11;

const ADD: i32 = 0;
/// Deletes those of its namespace, if it has one.
const DELETE_ALL: i32 = 3;

impl<'a> Marker<'a> {
    /// Deletes all markers of an entity.
    fn deleting(entity: &'a str, header: Header) -> Self {
        Self {
            header,
            namespace: entity,
            // No shape has it, so that no two markers of a message have the same id, for which rviz shows an error.
            id: -1,
            kind: ARROW,
            action: DELETE_ALL,
            pose: Pose::at(Vector3::zeros()),
            scale: Vector3::zeros(),
            colour: Colour([0.0; 4]),
            is_frame_locked: false,
            points: &[],
            colours: &[],
            is_closed: false,
            text: "",
        }
    }

    /// Draws a shape.
    fn of(shape: &'a Shape, id: i32, entity: &'a Entity, header: Header) -> Self {
        let marker = Self {
            id,
            action: ADD,
            is_frame_locked: entity.is_frame_locked,
            ..Self::deleting(entity.id, header)
        };
        match shape {
            Shape::Arrow {
                pose,
                length,
                diameter,
                colour,
            } => Self {
                kind: ARROW,
                pose: *pose,
                scale: Vector3::new(*length, *diameter, *diameter),
                colour: *colour,
                ..marker
            },
            Shape::Lines {
                join,
                points,
                colours,
                pixels: _,
                width,
            } => {
                let (colour, colours) = colours_of_lines(colours);
                Self {
                    kind: line_kind(*join),
                    scale: Vector3::new(*width, 0.0, 0.0),
                    colour,
                    points,
                    colours,
                    is_closed: *join == Join::Loop,
                    ..marker
                }
            }
            Shape::Triangles { points, colour } => Self {
                kind: TRIANGLE_LIST,
                scale: Vector3::repeat(1.0),
                colour: *colour,
                points,
                ..marker
            },
            Shape::Text {
                position,
                text,
                pixels: _,
                height,
                colour,
            } => Self {
                kind: TEXT_VIEW_FACING,
                pose: Pose::at(*position),
                scale: Vector3::new(0.0, 0.0, *height),
                colour: *colour,
                text,
                ..marker
            },
            Shape::Cube { pose, size, colour } => Self {
                kind: CUBE,
                pose: *pose,
                scale: *size,
                colour: *colour,
                ..marker
            },
            Shape::Cylinder { pose, size, colour } => Self {
                kind: CYLINDER,
                pose: *pose,
                scale: *size,
                colour: *colour,
                ..marker
            },
        }
    }

    fn write(&self, cdr: &mut Cdr) {
        ros2::put_header(cdr, self.header);
        cdr.put_string(self.namespace);
        for number in [self.id, self.kind, self.action] {
            cdr.put(number.to_le_bytes());
        }
        to_ros2::put_pose(cdr, &self.pose);
        to_ros2::put_vector(cdr, self.scale);
        put_colour(cdr, self.colour);
        put_no_lifetime(cdr);
        cdr.put_bool(self.is_frame_locked);
        put_list(cdr, self.points, self.is_closed, to_ros2::put_vector);
        put_list(cdr, self.colours, self.is_closed, put_colour);
        put_no_texture(cdr);
        cdr.put_string(self.text);
        put_no_mesh(cdr);
    }
}

/// The colour of all points, or of the first one, and those of each point if they differ.
fn colours_of_lines(colours: &[Colour]) -> (Colour, &[Colour]) {
    match colours {
        [] => (Colour([0.0; 4]), &[]),
        [colour] => (*colour, &[]),
        [first, ..] => (*first, colours),
    }
}

fn line_kind(join: Join) -> i32 {
    match join {
        Join::Strip | Join::Loop => LINE_STRIP,
        Join::Pairs => LINE_LIST,
    }
}

fn put_colour(cdr: &mut Cdr, Colour(channels): Colour) {
    for channel in channels {
        cdr.put(channel.to_le_bytes());
    }
}

/// Writes a list, and at its end its first element again if it is closed.
fn put_list<T: Copy>(cdr: &mut Cdr, list: &[T], is_closed: bool, put: impl Fn(&mut Cdr, T)) {
    let closing = list.first().filter(|_| is_closed);
    cdr.put_length(list.len() + usize::from(closing.is_some()));
    for &element in list.iter().chain(closing) {
        put(cdr, element);
    }
}

/// A `builtin_interfaces/Duration` that says that the marker stays.
fn put_no_lifetime(cdr: &mut Cdr) {
    cdr.put(0_i32.to_le_bytes());
    cdr.put(0_u32.to_le_bytes());
}

/// The name of a texture, the texture itself as a `sensor_msgs/CompressedImage`, and where points are in it.
fn put_no_texture(cdr: &mut Cdr) {
    cdr.put_string("");
    let no_header = Header {
        time: 0,
        frame_id: "",
    };
    ros2::put_header(cdr, no_header);
    cdr.put_string("");
    cdr.put_length(0);
    cdr.put_length(0);
}

/// The name of a mesh, the mesh itself as a `visualization_msgs/MeshFile`, and whether its materials are used.
fn put_no_mesh(cdr: &mut Cdr) {
    cdr.put_string("");
    cdr.put_string("");
    cdr.put_length(0);
    cdr.put_bool(false);
}
