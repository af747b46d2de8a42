//! The axes of each message of a channel, by the names of its frames.

use std::fmt;

use nalgebra::{UnitQuaternion, Vector3};

use crate::{
    decode::value::FieldValue,
    geometry::axes::{Axes, WorldAxes},
    sample::{DropReason, Velocity},
    source::{
        bind::{BoundFrames, BoundNames, Contradiction},
        frames::{
            resolve::{self, Unclear},
            taken::{Because, NamedFrame, ReadAs, Reading},
        },
        profile::convention::FrameChange,
    },
    text::Foreign,
};

/// The most ways of reading that are remembered for a report.
const REMEMBERED: usize = 10;

/// How values are converted to flightcam's own axes.
#[derive(Debug, Clone, Copy)]
pub struct Conversion {
    /// What becomes of an orientation.
    turn: FrameChange,
    /// The axes of a vector or a local position.
    axes: Axes,
}

impl Conversion {
    fn new(reading: Reading) -> Self {
        let same = Self {
            turn: FrameChange::default(),
            axes: Axes::World(WorldAxes::NED),
        };
        match reading {
            Reading::Quaternion { axes, reference }
            | Reading::Angles {
                axes, reference, ..
            } => {
                let turn = match reference {
                    None => axes.attitude(),
                    Some(reference) => axes.gimbal(reference),
                };
                Self { turn, ..same }
            }
            Reading::Velocity { axes, .. } => Self { axes, ..same },
            Reading::Local { axes, .. } => Self {
                axes: Axes::World(axes),
                ..same
            },
            Reading::AngularRate { axes, .. } | Reading::Acceleration { axes, .. } => Self {
                axes: Axes::Body(axes),
                ..same
            },
            Reading::Pitch { .. } | Reading::Geodetic { .. } | Reading::Height { .. } => same,
        }
    }

    /// Converts an orientation.
    pub fn orientation(&self, orientation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        self.turn.apply(orientation)
    }

    /// Converts a velocity, m/s.
    pub fn velocity(&self, components: Vector3<f64>) -> Velocity {
        Velocity::in_axes(self.axes, components)
    }

    /// Converts a vector, whatever it is of.
    pub fn vector(&self, components: Vector3<f64>) -> Vector3<f64> {
        match self.axes {
            Axes::World(axes) => axes.to_own(components),
            Axes::Body(axes) => axes.to_own(components),
        }
    }
}

/// What one reading of a channel has found in its messages.
#[derive(Debug, Clone, Default)]
pub struct FrameTracker {
    /// What the names in the last message stand for.
    last: Option<Learnt>,
    /// How values were read.
    pub taken: Vec<ReadAs>,
    /// Frames whose values were dropped.
    pub refused: Vec<RefusedFrames>,
}

/// What names of frames stand for.
#[derive(Debug, Clone)]
struct Learnt {
    names: [Vec<u8>; 2],
    conversion: Result<Conversion, DropReason>,
}

impl Learnt {
    fn is_of(&self, names: [&[u8]; 2]) -> bool {
        self.names[0] == names[0] && self.names[1] == names[1]
    }
}

/// Frames whose values were dropped.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct RefusedFrames {
    /// Why.
    pub reason: DropReason,
    /// How they are named.
    pub frames: Vec<NamedFrame>,
    /// How the profile says that the values are to be read.
    pub said: Reading,
}

impl fmt::Display for RefusedFrames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, frame) in self.frames.iter().enumerate() {
            let separator = if place == 0 { "" } else { ", " };
            write!(f, "{separator}`{}` is {}", frame.field, frame.name)?;
        }
        Ok(())
    }
}

impl FrameTracker {
    /// How a message's values are converted, or why they are dropped.
    pub fn conversion(
        &mut self,
        bound: &BoundFrames,
        values: &[FieldValue],
    ) -> Result<Conversion, DropReason> {
        for (slot, sign) in &bound.not_valid {
            if values[*slot]
                .number()
                .is_some_and(|number| sign.holds.is_so(number))
            {
                return Err(sign.reason);
            }
        }
        let Some(names) = &bound.names else {
            return match &self.last {
                Some(known) => known.conversion,
                None => self.learn([&[], &[]], Found::Taken(bound.usual.clone())),
            };
        };
        let texts = [&names.first, &names.second].map(|name| {
            let text = name.as_ref().and_then(|(_, slot)| values[*slot].text());
            text.unwrap_or_default()
        });
        match &self.last {
            Some(known) if known.is_of(texts) => known.conversion,
            _ => self.learn(texts, resolve(&bound.usual, names, texts)),
        }
    }

    fn learn(&mut self, texts: [&[u8]; 2], found: Found) -> Result<Conversion, DropReason> {
        let conversion = match found {
            Found::Taken(read_as) => {
                let conversion = Conversion::new(read_as.reading);
                remember(&mut self.taken, read_as);
                Ok(conversion)
            }
            Found::Refused(refused) => {
                let reason = refused.reason;
                remember(&mut self.refused, refused);
                Err(reason)
            }
        };
        self.last = Some(Learnt {
            names: texts.map(<[u8]>::to_vec),
            conversion,
        });
        conversion
    }

    /// Adds what a clone has found in other messages.
    pub fn merge(&mut self, clone: &Self) {
        clone
            .taken
            .iter()
            .for_each(|one| remember(&mut self.taken, one.clone()));
        clone
            .refused
            .iter()
            .for_each(|one| remember(&mut self.refused, one.clone()));
    }
}

/// What the names in a message lead to.
enum Found {
    Taken(ReadAs),
    Refused(RefusedFrames),
}

fn remember<T: PartialEq>(known: &mut Vec<T>, one: T) {
    if known.len() < REMEMBERED && !known.contains(&one) {
        known.push(one);
    }
}

fn resolve(usual: &ReadAs, names: &BoundNames, texts: [&[u8]; 2]) -> Found {
    let [first, second] = texts.map(String::from_utf8_lossy);
    let by_name = by_name(usual.reading, &first, &second);
    let frames = || {
        let fields = [&names.first, &names.second]
            .into_iter()
            .zip([&first, &second]);
        let named = fields.filter_map(|(field, name)| {
            let (field, _) = field.as_ref()?;
            Some(NamedFrame {
                field: field.clone(),
                name: Foreign::from(&**name),
            })
        });
        named.collect()
    };
    let read_as = |reading, because, frames| {
        Found::Taken(ReadAs {
            reading,
            because,
            frames,
        })
    };
    let refused = |reason| {
        Found::Refused(RefusedFrames {
            reason,
            frames: frames(),
            said: usual.reading,
        })
    };
    match (by_name, names.contradiction) {
        (Ok(reading), _) if reading == usual.reading => read_as(reading, usual.because, Vec::new()),
        (Ok(reading), Contradiction::Converted) => read_as(reading, Because::FrameNames, frames()),
        (Ok(_) | Err(_), Contradiction::Kept) => read_as(usual.reading, usual.because, frames()),
        (Ok(_), Contradiction::Refused) => refused(DropReason::OtherFrame),
        (Err(Unclear::OwnFrame), _) => refused(DropReason::OwnFrame),
        (Err(Unclear::Unplaced), _) => refused(DropReason::UnknownFrame),
    }
}

/// How values are read by the names of their frames.
fn by_name(usual: Reading, first: &str, second: &str) -> Result<Reading, Unclear> {
    Ok(match usual {
        Reading::Quaternion { axes, reference } => Reading::Quaternion {
            axes: resolve::orientation(first, second, axes)?,
            reference,
        },
        Reading::Angles {
            axes,
            unit,
            order,
            reference,
        } => Reading::Angles {
            axes: resolve::orientation(first, second, axes)?,
            unit,
            order,
            reference,
        },
        Reading::Velocity { axes, unit } => Reading::Velocity {
            axes: resolve::vector(first, second, axes)?,
            unit,
        },
        Reading::Local { axes, unit } => Reading::Local {
            axes: resolve::place(first, axes)?,
            unit,
        },
        Reading::Pitch { .. }
        | Reading::Geodetic { .. }
        | Reading::Height { .. }
        | Reading::AngularRate { .. }
        | Reading::Acceleration { .. } => usual,
    })
}
