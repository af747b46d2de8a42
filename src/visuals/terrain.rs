//! Where the ground is below the drone: as the log's heights say, or as it is taken to be.

use super::{flight::Tick, options::Ground, stage::altitude};

/// The ground as the log's heights say it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terrain {
    /// The altitude of the lowest place below the drone, as the log counts altitudes, metres.
    pub lowest: f64,
    /// The altitude of the highest one.
    pub highest: f64,
    /// For which share of the flight the log says it, 0 to 1. For the rest, the ground is where it was last, or else where
    /// it is next.
    pub share: f64,
}

/// Decides where the ground is at every tick. Returns the terrain if the log says it, and the caller does not.
pub fn settle(ticks: &mut [Tick], given: Option<Ground>) -> Option<Terrain> {
    let is_measured = ticks.iter().any(|tick| tick.ground.is_some());
    let level = match given {
        None if is_measured => return Some(hold(ticks)),
        None | Some(Ground::TakeOff) => {
            let mut positions = ticks.iter().filter_map(|tick| tick.position);
            positions.next().map(|first| altitude(&first))
        }
        Some(Ground::Altitude(metres)) => Some(metres),
    };
    for tick in ticks {
        tick.ground = level;
    }
    None
}

/// Leaves the ground where it was last, or else where it is next, at ticks where the log does not say it.
fn hold(ticks: &mut [Tick]) -> Terrain {
    let measured = || ticks.iter().filter_map(|tick| tick.ground);
    let placed = ticks.iter().filter(|tick| tick.position.is_some()).count();
    let terrain = Terrain {
        lowest: measured().fold(f64::INFINITY, f64::min),
        highest: measured().fold(f64::NEG_INFINITY, f64::max),
        share: measured().count() as f64 / placed.max(1) as f64,
    };
    let mut last = measured().next();
    for tick in ticks {
        last = tick.ground.or(last);
        tick.ground = last;
    }
    terrain
}
