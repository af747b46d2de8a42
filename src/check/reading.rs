//! Readings: how numbers of a log may be meant, and what follows for samples that were read in another way.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::Serialize;

use crate::geometry::{
    RollPitchYaw,
    axes::{Axes, BodyAxes, WorldAxes},
};

/// A unit: its name, and how many of it make one of flightcam's own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Unit {
    /// The name.
    pub name: &'static str,
    /// How many make one metre per second, one radian per second, one metre per second squared.
    #[serde(skip)]
    pub per_own: f64,
}

const fn unit(name: &'static str, per_own: f64) -> Unit {
    Unit { name, per_own }
}

/// The units that velocities come in.
pub const SPEED_UNITS: [Unit; 5] = [
    unit("m/s", 1.0),
    unit("cm/s", 1e2),
    unit("mm/s", 1e3),
    unit("km/h", 3.6),
    unit("knots", 3600.0 / 1852.0),
];

/// The units that angular rates come in.
pub const RATE_UNITS: [Unit; 2] = [
    unit("rad/s", 1.0),
    unit("deg/s", 180.0 / std::f64::consts::PI),
];

/// The units that accelerations come in; g is that of the SI.
pub const ACCELERATION_UNITS: [Unit; 3] = [
    unit("m/s²", 1.0),
    unit("g", 1.0 / 9.806_65),
    unit("mg", 1e3 / 9.806_65),
];

/// The units that angles come in, the largest first.
pub const ANGLE_UNITS: [Unit; 4] = [
    unit("radians", 1.0),
    unit("degrees", 180.0 / std::f64::consts::PI),
    unit("centidegrees", 18e3 / std::f64::consts::PI),
    unit("degE7", 180e7 / std::f64::consts::PI),
];

/// How the three numbers of a vector are read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VectorReading {
    /// The axes in which it is given.
    pub axes: Axes,
    /// Its unit.
    pub unit: Unit,
}

impl VectorReading {
    /// The log's own numbers of a vector that was read so.
    pub(super) fn numbers(&self, own: Vector3<f64>) -> Vector3<f64> {
        let components = match self.axes {
            Axes::World(axes) => axes.components_of(own),
            Axes::Body(axes) => axes.components_of(own),
        };
        components * self.unit.per_own
    }

    /// Turns the log's numbers into NED, or into the drone's FRD.
    pub(super) fn matrix(&self) -> Matrix3<f64> {
        let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|unit| match self.axes {
            Axes::World(axes) => axes.to_own(unit),
            Axes::Body(axes) => axes.to_own(unit),
        });
        Matrix3::from_columns(&columns) / self.unit.per_own
    }

    pub(super) fn is_body(&self) -> bool {
        matches!(self.axes, Axes::Body(_))
    }
}

/// How an attitude is read.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AttitudeReading {
    /// What its numbers are.
    pub form: Form,
    /// The drone's axes.
    pub body: BodyAxes,
    /// The world's axes.
    pub world: WorldAxes,
    /// Whether it turns the world's coordinates into the drone's, instead of the drone's into the world's.
    pub inverse: bool,
    /// How far north is turned from where the log has it, in degrees to the right.
    pub north_deg: f64,
}

/// The numbers of an attitude.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// A quaternion.
    Quaternion {
        /// Whether the scalar part is the last of the four numbers.
        scalar_last: bool,
    },
    /// Roll, pitch and yaw.
    Angles {
        /// Their unit.
        unit: Unit,
        /// Whether what is called roll is the pitch, and the other way round.
        swapped: bool,
        /// Which of roll, pitch and yaw have the opposite sign.
        opposite: [bool; 3],
    },
    /// Angles in another order than yaw, pitch, roll, of which nothing else is tried.
    OtherAngles,
}

impl AttitudeReading {
    /// A quaternion or angles, read as usual.
    pub fn new(form: Form, body: BodyAxes, world: WorldAxes) -> Self {
        Self {
            form,
            body,
            world,
            inverse: false,
            north_deg: 0.0,
        }
    }

    /// The form of a quaternion.
    pub const WXYZ: Form = Form::Quaternion { scalar_last: false };
    /// The form of a quaternion whose scalar part is the last number.
    pub const XYZW: Form = Form::Quaternion { scalar_last: true };
    /// The form of angles in radians.
    pub const ANGLES: Form = Self::angles_in(ANGLE_UNITS[0]);

    /// The form of angles.
    pub const fn angles_in(unit: Unit) -> Form {
        Form::Angles {
            unit,
            swapped: false,
            opposite: [false; 3],
        }
    }

    /// What makes attitudes of this reading out of those that were read as `claimed`; `None` for axes between which
    /// there is no rotation.
    pub(super) fn instead_of(&self, claimed: &Self) -> Option<Reread> {
        let outer = self.world.rotation()?;
        let inner = self.body.rotation()?.inverse();
        let north = self.north_deg - claimed.north_deg;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), north.to_radians());
        Some(Reread {
            before: (
                claimed.world.rotation()?.inverse(),
                claimed.body.rotation()?,
            ),
            forms: (claimed.form, self.form),
            is_inverse: claimed.inverse != self.inverse,
            after: (turn * outer, inner),
        })
    }

    /// What else an attitude that was read as this one may be, and the body's axes may be any.
    pub(super) fn alternatives(&self) -> Vec<Self> {
        let usual = [
            (BodyAxes::FRD, WorldAxes::NED),
            (BodyAxes::FLU, WorldAxes::ENU),
            (BodyAxes::FLU, WorldAxes::NWU),
            (BodyAxes::FLU, WorldAxes::NED),
            (BodyAxes::FRD, WorldAxes::ENU),
        ];
        let frames = [(self.body, self.world)].into_iter().chain(
            usual
                .into_iter()
                .filter(|&pair| pair != (self.body, self.world)),
        );
        let forms: Vec<Form> = match self.form {
            Form::Quaternion { scalar_last } => [scalar_last, !scalar_last]
                .map(|scalar_last| Form::Quaternion { scalar_last })
                .into(),
            Form::OtherAngles => vec![Form::OtherAngles],
            Form::Angles { unit, .. } => (0..16)
                .map(|bits: u8| Form::Angles {
                    unit,
                    swapped: bits & 8 != 0,
                    opposite: [0, 1, 2].map(|angle| bits >> angle & 1 != 0),
                })
                .collect(),
        };
        let of_angles = !matches!(self.form, Form::Quaternion { .. });
        let mut readings = Vec::new();
        for (body, world) in frames {
            for &form in &forms {
                for inverse in [false, true] {
                    if of_angles && inverse {
                        continue;
                    }
                    readings.push(Self {
                        form,
                        body,
                        world,
                        inverse,
                        ..*self
                    });
                }
            }
        }
        let turned = [90.0, 180.0, 270.0].map(|north_deg| Self { north_deg, ..*self });
        let axes = BodyAxes::all().filter(|body| body.is_right_handed() && *body != self.body);
        readings.extend(turned);
        if let Form::Angles { unit, .. } = self.form {
            // Of smaller units, only the remainder of a turn was kept.
            let larger = ANGLE_UNITS.into_iter();
            let larger = larger.filter(|other| other.per_own < unit.per_own);
            readings.extend(larger.map(|unit| Self {
                form: Self::angles_in(unit),
                ..*self
            }));
        }
        readings.extend(axes.map(|body| Self { body, ..*self }));
        let mut different: Vec<Self> = Vec::new();
        for reading in readings {
            if reading != *self && !different.contains(&reading) {
                different.push(reading);
            }
        }
        different.sort_by_key(|reading| reading.changes_from(self));
        different
    }

    /// How much has to be changed to get from another reading to this one. The frames of ROS and those of aerospace
    /// count as one change, others as two.
    pub(super) fn changes_from(&self, other: &Self) -> usize {
        let frames = (self.body, self.world);
        let usual = [
            (BodyAxes::FRD, WorldAxes::NED),
            (BodyAxes::FLU, WorldAxes::ENU),
        ];
        let frames = match () {
            () if frames == (other.body, other.world) => 0,
            () if usual.contains(&frames) => 1,
            () => 2,
        };
        let form = match (self.form, other.form) {
            (
                Form::Angles {
                    unit,
                    swapped,
                    opposite,
                },
                Form::Angles {
                    unit: other_unit,
                    swapped: other_swapped,
                    opposite: other_opposite,
                },
            ) => {
                let signs = opposite.iter().zip(&other_opposite).filter(|(a, b)| a != b);
                usize::from(unit != other_unit)
                    + usize::from(swapped != other_swapped)
                    + signs.count()
            }
            (a, b) => usize::from(a != b),
        };
        let inverse = usize::from(self.inverse != other.inverse);
        let north = usize::from(self.north_deg != other.north_deg);
        frames + form + inverse + north
    }
}

/// Turns attitudes that were read in one way into those of another.
#[derive(Debug, Clone, Copy)]
pub struct Reread {
    before: (UnitQuaternion<f64>, UnitQuaternion<f64>),
    forms: (Form, Form),
    is_inverse: bool,
    after: (UnitQuaternion<f64>, UnitQuaternion<f64>),
}

impl Reread {
    /// `q_ned_frd` in the other reading.
    pub fn apply(&self, own: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let read = self.before.0 * own * self.before.1;
        let read = match self.forms {
            (Form::Quaternion { scalar_last: from }, Form::Quaternion { scalar_last: to }) => {
                reordered(read, from, to)
            }
            (from @ Form::Angles { .. }, to @ Form::Angles { .. }) if from != to => {
                with_angles(read, from, to)
            }
            _ => read,
        };
        let read = match self.is_inverse {
            true => read.inverse(),
            false => read,
        };
        self.after.0 * read * self.after.1
    }
}

fn reordered(q: UnitQuaternion<f64>, from: bool, to: bool) -> UnitQuaternion<f64> {
    if from == to {
        return q;
    }
    let [x, y, z, w]: [f64; 4] = q.coords.into();
    let quaternion = match to {
        // It was w, x, y, z and is read as x, y, z, w.
        true => nalgebra::Quaternion::new(z, w, x, y),
        false => nalgebra::Quaternion::new(x, y, z, w),
    };
    UnitQuaternion::new_unchecked(quaternion)
}

fn with_angles(q: UnitQuaternion<f64>, from: Form, to: Form) -> UnitQuaternion<f64> {
    let (
        Form::Angles {
            unit: from_unit,
            swapped: from_swapped,
            opposite: from,
        },
        Form::Angles {
            unit,
            swapped,
            opposite: to,
        },
    ) = (from, to)
    else {
        return q;
    };
    let scale = from_unit.per_own / unit.per_own;
    let factors = [0, 1, 2].map(|angle| {
        if from[angle] != to[angle] {
            -scale
        } else {
            scale
        }
    });
    let RollPitchYaw { roll, pitch, yaw } = RollPitchYaw::from_rotation(&Rotation3::from(q));
    let (roll, pitch) = match from_swapped != swapped {
        true => (pitch, roll),
        false => (roll, pitch),
    };
    RollPitchYaw {
        roll: factors[0] * roll,
        pitch: factors[1] * pitch,
        yaw: factors[2] * yaw,
    }
    .to_quaternion()
}
