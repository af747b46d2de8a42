//! What else the numbers of a series may be, and which of it is likely.

use super::{
    reading::{Unit, VectorReading},
    residual::Part,
};
use crate::geometry::axes::{Axes, BodyAxes, WorldAxes};

/// The axes that are usual, the likeliest first.
fn usual() -> [Axes; 6] {
    [
        Axes::World(WorldAxes::NED),
        Axes::World(WorldAxes::ENU),
        Axes::World(WorldAxes::NWU),
        Axes::World("neu".parse().expect("these are axes")),
        Axes::Body(BodyAxes::FRD),
        Axes::Body(BodyAxes::FLU),
    ]
}

/// What a vector may be read as instead: in any of the axes, and in other units in the usual ones.
pub fn of_vector(
    claimed: VectorReading,
    units: &[Unit],
    axes: impl Iterator<Item = Axes>,
) -> Vec<VectorReading> {
    let usual = usual();
    let mut readings = Vec::new();
    for axes in axes {
        let is_usual = usual.contains(&axes) || axes == claimed.axes;
        let others = units
            .iter()
            .filter(|unit| **unit != claimed.unit && is_usual);
        let units = [claimed.unit].into_iter().chain(others.copied());
        readings.extend(units.map(|unit| VectorReading { axes, unit }));
    }
    readings.retain(|reading| *reading != claimed);
    readings
}

/// How likely a reading is, the likeliest first: in the claimed unit, in the usual axes, in right-handed ones.
pub fn rank(reading: &VectorReading, claimed: &VectorReading) -> (bool, usize) {
    let usual = usual();
    let is_left_handed = match reading.axes {
        Axes::World(axes) => !axes.is_right_handed(),
        Axes::Body(axes) => !axes.is_right_handed(),
    };
    let place = usual.iter().position(|axes| *axes == reading.axes);
    let place = place.unwrap_or(usual.len() + usize::from(is_left_handed));
    (reading.unit != claimed.unit, place)
}

/// Whether a reading is in the usual axes and the claimed unit.
pub fn is_usual(reading: &VectorReading, claimed: &VectorReading) -> bool {
    usual().contains(&reading.axes) && reading.unit == claimed.unit
}

/// Whether two readings of a velocity differ in a part of it.
pub fn differ(part: Part, a: &VectorReading, b: &VectorReading) -> bool {
    let rows = match part {
        // A drone that is level has its own down axis where the world has it.
        Part::Vertical { .. } | Part::Everywhere => 2..3,
        Part::Horizontal { .. } if a.is_body() != b.is_body() => return true,
        Part::Horizontal { .. } if !a.is_body() => 0..2,
        Part::Horizontal { .. } | Part::EachAxis { .. } => 0..3,
    };
    let (a, b) = (a.matrix(), b.matrix());
    rows.into_iter().any(|row| a.row(row) != b.row(row))
}
