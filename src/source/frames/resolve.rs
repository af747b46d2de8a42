//! What was said about axes, and what the names of frames stand for → the axes in which a value is read.

use super::names::{FrameName, Owner};
use crate::{
    geometry::axes::{Axes, BodyAxes, WorldAxes},
    source::profile::convention::Convention,
};

/// Why the names of frames leave no axes to read a value in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unclear {
    /// The orientation is measured from the drone's own frame.
    OwnFrame,
    /// It is measured from a frame that cannot be placed in north, east, down, or only one of its two frames is known.
    Unplaced,
}

/// The convention of an orientation that turns out of `body` into `world`, if those are named. `usual` is that of a
/// message whose names say nothing.
pub fn orientation(world: &str, body: &str, usual: Convention) -> Result<Convention, Unclear> {
    let (in_world, of_body) = (FrameName::read(world), FrameName::read(body));
    if in_world.of == Some(Owner::Drone) {
        return Err(Unclear::OwnFrame);
    }
    let (body, world) = match (of_body.body(), in_world.world()) {
        (None, None) if in_world.of == Some(Owner::Planet) => return Err(Unclear::Unplaced),
        (None, None) => return Ok(usual),
        (Some(body), Some(world)) => (body, world),
        (None, Some(world)) => (with(world), world),
        (Some(body), None) if body == usual.body() => return Ok(usual),
        (Some(_), None) => return Err(Unclear::Unplaced),
    };
    Convention::new(body, world).map_err(|_| Unclear::Unplaced)
}

/// The axes of a vector in a frame. `world` names the frame of the pose beside it, if there is one: equal names mean that
/// the vector is in the world too. `usual` is for names that say nothing.
pub fn vector(frame: &str, world: &str, usual: Axes) -> Result<Axes, Unclear> {
    let (name, of_pose) = (FrameName::read(frame), FrameName::read(world));
    let in_world = |name: FrameName| {
        Axes::World(name.world().unwrap_or(match usual {
            Axes::World(axes) => axes,
            Axes::Body(_) => WorldAxes::ENU,
        }))
    };
    let in_body = |name: FrameName| {
        let beside = || of_pose.world().map(with);
        Axes::Body(name.body().or_else(beside).unwrap_or(match usual {
            Axes::Body(axes) => axes,
            Axes::World(_) => BodyAxes::FLU,
        }))
    };
    Ok(match name.of {
        _ if !frame.is_empty() && frame == world => in_world(name),
        Some(Owner::Planet) if name.world().is_none() => return Err(Unclear::Unplaced),
        _ if name.is_drones() => in_body(name),
        _ if name.is_worlds() || name.of == Some(Owner::Planet) => in_world(name),
        _ if matches!(usual, Axes::Body(_)) => in_body(name),
        _ => usual,
    })
}

/// The axes of a place in a frame. `usual` is for a name that says nothing.
pub fn place(world: &str, usual: WorldAxes) -> Result<WorldAxes, Unclear> {
    let name = FrameName::read(world);
    match name.of {
        Some(Owner::Planet) if name.world().is_none() => Err(Unclear::Unplaced),
        Some(Owner::Drone) => Err(Unclear::OwnFrame),
        _ => Ok(name.world().unwrap_or(usual)),
    }
}

/// The drone's axes that go with the world's: z is up or down in both.
fn with(world: WorldAxes) -> BodyAxes {
    match world == WorldAxes::NED {
        true => BodyAxes::FRD,
        false => BodyAxes::FLU,
    }
}
