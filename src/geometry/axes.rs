//! The axes that components are given in: three perpendicular directions, of the world or of the drone.
//!
//! They are written as three letters, one for the direction in which each component grows: `ned` is north, east, down;
//! `enu` (ROS, REP 103, <https://www.ros.org/reps/rep-0103.html>) is east, north, up; `neu` is what DJI's raw
//! velocities are in. The drone's own are `frd` (front, right, down), `flu` (ROS) and the like.

use std::{fmt, str::FromStr};

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Three perpendicular directions, as signs and places among those of flightcam's own axes (NED, or FRD).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Triad([Direction; 3]);

/// A direction: one of flightcam's own axes, or its opposite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Direction {
    /// 0 is north or front, 1 is east or right, 2 is down.
    axis: usize,
    is_opposite: bool,
}

/// Axes of the world: three letters out of n or s, e or w, u or d, in any order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
pub struct WorldAxes(Triad);

/// Axes of the drone: three letters out of f or b, l or r, u or d, in any order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
pub struct BodyAxes(Triad);

/// The axes of a vector: the world's, or the drone's, which are written with `body-` before the letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
pub enum Axes {
    /// The world's.
    World(WorldAxes),
    /// The drone's.
    Body(BodyAxes),
}

/// A text that does not name axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "axes are three letters, one for each component: n or s, e or w, u or d, as in `ned`, `enu` or `neu`, or the \
     drone's own, f or b, l or r, u or d, as in `body-frd` or `body-flu`"
)]
pub struct NotAxes;

/// The letters of the world's directions, each with its opposite, in the order of flightcam's own axes.
const WORLD: [[char; 2]; 3] = [['n', 's'], ['e', 'w'], ['d', 'u']];

/// Those of the drone's.
const BODY: [[char; 2]; 3] = [['f', 'b'], ['r', 'l'], ['d', 'u']];

impl Triad {
    fn parse(text: &str, letters: [[char; 2]; 3]) -> Option<Self> {
        let direction = |letter: char| {
            let of_axis = |(axis, pair): (usize, &[char; 2])| {
                let place = pair.iter().position(|&one| one == letter)?;
                let is_opposite = place == 1;
                Some(Direction { axis, is_opposite })
            };
            letters.iter().enumerate().find_map(of_axis)
        };
        let directions: Option<Vec<Direction>> = text.chars().map(direction).collect();
        let directions: [Direction; 3] = directions?.try_into().ok()?;
        let has = |axis| directions.iter().any(|direction| direction.axis == axis);
        (0..3).all(has).then_some(Self(directions))
    }

    fn letters(self, letters: [[char; 2]; 3]) -> String {
        let letter =
            |direction: Direction| letters[direction.axis][usize::from(direction.is_opposite)];
        self.0.into_iter().map(letter).collect()
    }

    /// All 48.
    fn all() -> impl Iterator<Item = Self> {
        const ORDERS: [[usize; 3]; 6] = [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ];
        ORDERS.into_iter().flat_map(|order| {
            (0..8).map(move |signs| {
                Self([0, 1, 2].map(|place| Direction {
                    axis: order[place],
                    is_opposite: signs >> place & 1 == 1,
                }))
            })
        })
    }

    /// Turns components in these axes into flightcam's own.
    fn to_own(self, components: Vector3<f64>) -> Vector3<f64> {
        let mut own = Vector3::zeros();
        for (direction, &component) in self.0.iter().zip(&components) {
            own[direction.axis] = match direction.is_opposite {
                true => -component,
                false => component,
            };
        }
        own
    }

    /// Turns components in flightcam's own axes into these.
    fn components_of(self, own: Vector3<f64>) -> Vector3<f64> {
        Vector3::from(self.0.map(|direction| match direction.is_opposite {
            true => -own[direction.axis],
            false => own[direction.axis],
        }))
    }

    /// The matrix of [`to_own`](Self::to_own).
    fn matrix(self) -> Matrix3<f64> {
        let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|unit| self.to_own(unit));
        Matrix3::from_columns(&columns)
    }

    fn is_right_handed(self) -> bool {
        self.matrix().determinant() > 0.0
    }

    /// The rotation of [`to_own`](Self::to_own), if these axes are right-handed.
    fn rotation(self) -> Option<UnitQuaternion<f64>> {
        let rotation = Rotation3::from_matrix_unchecked(self.matrix());
        self.is_right_handed()
            .then(|| UnitQuaternion::from_rotation_matrix(&rotation))
    }
}

/// What world and body axes have in common.
macro_rules! axes {
    ($name:ident, $letters:ident, $own:literal) => {
        impl $name {
            /// All 48.
            pub fn all() -> impl Iterator<Item = Self> {
                Triad::all().map(Self)
            }

            #[doc = concat!("Turns components in these axes into ", $own, ".")]
            pub fn to_own(self, components: Vector3<f64>) -> Vector3<f64> {
                self.0.to_own(components)
            }

            #[doc = concat!("Turns components in ", $own, " into these axes.")]
            pub fn components_of(self, own: Vector3<f64>) -> Vector3<f64> {
                self.0.components_of(own)
            }

            /// Whether they are right-handed, without which there are no rotations between them and others.
            pub fn is_right_handed(self) -> bool {
                self.0.is_right_handed()
            }

            /// The rotation of [`to_own`](Self::to_own), if the axes are right-handed.
            pub fn rotation(self) -> Option<UnitQuaternion<f64>> {
                self.0.rotation()
            }
        }

        impl FromStr for $name {
            type Err = NotAxes;

            fn from_str(text: &str) -> Result<Self, NotAxes> {
                Triad::parse(text, $letters).map(Self).ok_or(NotAxes)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0.letters($letters))
            }
        }
    };
}

axes!(WorldAxes, WORLD, "north, east, down");
axes!(BodyAxes, BODY, "front, right, down");

impl WorldAxes {
    /// North, east, down.
    pub const NED: Self = Self(OWN);
    /// East, north, up.
    pub const ENU: Self = Self(Triad([along(1), along(0), against(2)]));
    /// North, west, up.
    pub const NWU: Self = Self(Triad([along(0), against(1), against(2)]));
}

impl BodyAxes {
    /// Front, right, down.
    pub const FRD: Self = Self(OWN);
    /// Front, left, up.
    pub const FLU: Self = Self(Triad([along(0), against(1), against(2)]));
}

const OWN: Triad = Triad([along(0), along(1), along(2)]);

const fn along(axis: usize) -> Direction {
    Direction {
        axis,
        is_opposite: false,
    }
}

const fn against(axis: usize) -> Direction {
    Direction {
        axis,
        is_opposite: true,
    }
}

impl FromStr for Axes {
    type Err = NotAxes;

    fn from_str(text: &str) -> Result<Self, NotAxes> {
        match text.strip_prefix("body-") {
            Some(letters) => Ok(Self::Body(letters.parse()?)),
            None => (text.parse().map(Self::World)).or_else(|NotAxes| text.parse().map(Self::Body)),
        }
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::World(axes) => axes.fmt(f),
            Self::Body(axes) => write!(f, "body-{axes}"),
        }
    }
}

/// As TOML has them: text.
macro_rules! as_text {
    ($($name:ident),*) => {$(
        impl TryFrom<String> for $name {
            type Error = NotAxes;

            fn try_from(text: String) -> Result<Self, NotAxes> {
                text.parse()
            }
        }

        impl From<$name> for String {
            fn from(axes: $name) -> Self {
                axes.to_string()
            }
        }
    )*};
}

as_text!(WorldAxes, BodyAxes, Axes);
