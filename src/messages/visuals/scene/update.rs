//! A scene as a `foxglove.SceneUpdate`.

use foxglove::messages::{
    ArrowPrimitive, Color, CubePrimitive, CylinderPrimitive, LinePrimitive, SceneEntity,
    SceneEntityDeletion, SceneUpdate, TextPrimitive, TriangleListPrimitive, line_primitive::Type,
    scene_entity_deletion,
};
use nalgebra::Vector3;

use super::super::{super::Format, to_foxglove};
use crate::derived::visual::{Colour, Entity, Join, Pose, Scene, Shape};

pub fn scene_update(format: &Format, time: u64, scene: &Scene) -> SceneUpdate {
    let deletion = |&id: &&str| SceneEntityDeletion {
        timestamp: Some(to_foxglove::timestamp(time)),
        r#type: scene_entity_deletion::Type::MatchingId.into(),
        id: id.to_owned(),
    };
    let entity = |entity| scene_entity(format, time, entity);
    SceneUpdate {
        deletions: scene.removed.iter().map(deletion).collect(),
        entities: scene.entities.iter().map(entity).collect(),
    }
}

fn scene_entity(format: &Format, time: u64, entity: &Entity) -> SceneEntity {
    let mut scene_entity = SceneEntity {
        timestamp: Some(to_foxglove::timestamp(time)),
        frame_id: format.frame_id(entity.frame).to_owned(),
        id: entity.id.to_owned(),
        frame_locked: entity.is_frame_locked,
        ..SceneEntity::default()
    };
    for shape in &entity.shapes {
        add(shape, &mut scene_entity);
    }
    scene_entity
}

fn add(shape: &Shape, entity: &mut SceneEntity) {
    match shape {
        Shape::Arrow {
            pose,
            length,
            diameter,
            colour,
        } => {
            let head_length = (length / 4.0).min(4.0 * diameter);
            entity.arrows.push(ArrowPrimitive {
                pose: Some(to_foxglove::pose(pose)),
                shaft_length: length - head_length,
                shaft_diameter: *diameter,
                head_length,
                head_diameter: 2.0 * diameter,
                color: Some(to_foxglove::colour(*colour)),
            });
        }
        Shape::Lines {
            join,
            points,
            colours,
            pixels,
            width: _,
        } => {
            let (color, colors) = colours_of_lines(colours);
            entity.lines.push(LinePrimitive {
                r#type: line_type(*join).into(),
                pose: Some(to_foxglove::pose(&Pose::at(Vector3::zeros()))),
                thickness: *pixels,
                scale_invariant: true,
                points: points.iter().copied().map(to_foxglove::point).collect(),
                color,
                colors,
                indices: Vec::new(),
            });
        }
        Shape::Triangles { points, colour } => entity.triangles.push(TriangleListPrimitive {
            pose: Some(to_foxglove::pose(&Pose::at(Vector3::zeros()))),
            points: points.iter().copied().map(to_foxglove::point).collect(),
            color: Some(to_foxglove::colour(*colour)),
            colors: Vec::new(),
            indices: Vec::new(),
        }),
        Shape::Text {
            position,
            text,
            pixels,
            height: _,
            colour,
        } => entity.texts.push(TextPrimitive {
            pose: Some(to_foxglove::pose(&Pose::at(*position))),
            billboard: true,
            font_size: *pixels,
            scale_invariant: true,
            color: Some(to_foxglove::colour(*colour)),
            text: text.clone(),
        }),
        Shape::Cube { pose, size, colour } => entity.cubes.push(CubePrimitive {
            pose: Some(to_foxglove::pose(pose)),
            size: Some(to_foxglove::vector(*size)),
            color: Some(to_foxglove::colour(*colour)),
        }),
        Shape::Cylinder { pose, size, colour } => entity.cylinders.push(CylinderPrimitive {
            pose: Some(to_foxglove::pose(pose)),
            size: Some(to_foxglove::vector(*size)),
            bottom_scale: 1.0,
            top_scale: 1.0,
            color: Some(to_foxglove::colour(*colour)),
        }),
    }
}

/// The colour of all points, or that of each.
fn colours_of_lines(colours: &[Colour]) -> (Option<Color>, Vec<Color>) {
    match colours {
        [colour] => (Some(to_foxglove::colour(*colour)), Vec::new()),
        colours => {
            let colours = colours.iter().copied().map(to_foxglove::colour);
            (None, colours.collect())
        }
    }
}

fn line_type(join: Join) -> Type {
    match join {
        Join::Strip => Type::LineStrip,
        Join::Loop => Type::LineLoop,
        Join::Pairs => Type::LineList,
    }
}
