//! The axes in which a reading's values are read: those that are said, and the fields whose names of frames may say
//! otherwise.

use super::{BindError, Binder, Slot};
use crate::{
    decode::path::FieldPath,
    sample::{DropReason, GimbalReference, Kind},
    source::{
        frames::{
            rules::{Frames, NotValid, TypeRule},
            taken::{Because, ReadAs, Reading},
        },
        profile::{
            Alternative, AttitudeFields, Coordinates, GimbalFields, Orientation, RoleFields,
            convention::{Convention, PositiveDirection},
        },
    },
};

/// Who says how a role is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SaidBy {
    /// The user, for this log.
    User,
    /// A profile for one recorder, by its topics.
    RecorderProfile,
    /// A profile for messages of some type, or with some fields, from any recorder.
    TypeProfile,
}

/// What a channel is, apart from the fields of its messages.
#[derive(Debug, Clone, Copy)]
pub struct ChannelName<'a> {
    /// Its topic.
    pub topic: &'a str,
    /// The name of its type of message; empty if it has none.
    pub schema: &'a str,
}

/// The axes of one reading.
#[derive(Debug)]
pub struct BoundFrames {
    /// How values are read if no frame's name says otherwise.
    pub usual: ReadAs,
    /// Where frames are named, and what becomes of a value whose frames say otherwise.
    pub names: Option<BoundNames>,
    /// What marks a value as not valid.
    pub not_valid: Vec<(Slot, &'static NotValid)>,
}

/// Where frames are named.
#[derive(Debug)]
pub struct BoundNames {
    /// The field that names the frame that a value is in, or that an orientation turns into.
    pub first: Option<(FieldPath, Slot)>,
    /// The field that names the frame that an orientation turns out of, or that of the pose beside a vector.
    pub second: Option<(FieldPath, Slot)>,
    /// What becomes of a value whose frames contradict what is said.
    pub contradiction: Contradiction,
}

/// What becomes of a value whose frames contradict what is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contradiction {
    /// It is read as its frames say.
    Converted,
    /// It is dropped.
    Refused,
    /// It is read as the user says, and the frames are reported.
    Kept,
}

/// Finds out in which axes an alternative's values are read from a channel's messages.
///
/// # Errors
/// Nothing says in which axes an orientation is, or it is known that nothing can.
pub fn bind_frames(
    binder: &mut Binder,
    Alternative { location, fields }: &Alternative,
    said_by: SaidBy,
) -> Result<BoundFrames, BindError> {
    let paths = fields.fields();
    let found = *paths.first().expect("every role has a field");
    let rule = TypeRule::find(binder.channel.schema, binder.channel.topic, found);
    let said = match said_by {
        SaidBy::User => Because::Given,
        SaidBy::RecorderProfile | SaidBy::TypeProfile => Because::Profile,
    };
    let (reading, because) = usual(fields, rule, said).ok_or_else(|| BindError::NoAxes {
        path: found.clone(),
    })?;
    let mut bound = BoundFrames {
        usual: ReadAs {
            reading,
            because,
            frames: Vec::new(),
        },
        names: None,
        not_valid: Vec::new(),
    };
    let Some(rule) = rule else { return Ok(bound) };
    for sign in rule.not_valid {
        // A profile that lists its own flags knows which count.
        let is_listed = sign.reason == DropReason::MarkedInvalid && !location.valid.is_empty();
        let path = rule.beside(found, sign.field).filter(|_| !is_listed);
        if let Some(slot) = path.and_then(|path| binder.number_if_there(&path)) {
            bound.not_valid.push((slot, sign));
        }
    }
    if location.ignore_frame_ids {
        return Ok(bound);
    }
    let (first, second) = match (rule.frames, fields.kind()) {
        (Frames::Orientation { world, body, .. }, Kind::Attitude) => (world, body),
        (Frames::Vector { frame, world }, Kind::Velocity) => (Some(frame), world),
        (Frames::Place { world }, Kind::Position) => (Some(world), None),
        (Frames::Broken, _) if said_by != SaidBy::User => {
            return Err(BindError::BrokenRule);
        }
        _ => return Ok(bound),
    };
    let mut name = |field: Option<&'static str>| {
        let path = rule.beside(found, field?)?;
        let slot = binder.text_if_there(&path)?;
        Some((path, slot))
    };
    bound.names = Some(BoundNames {
        first: name(first),
        second: name(second),
        contradiction: match (said_by, because) {
            (_, Because::Type | Because::Assumed) => Contradiction::Converted,
            (SaidBy::TypeProfile, _) => Contradiction::Converted,
            (SaidBy::RecorderProfile, _) => Contradiction::Refused,
            (SaidBy::User, _) => Contradiction::Kept,
        },
    });
    Ok(bound)
}

/// How a role's values are read if no name of a frame says otherwise, and why; `None` if nothing says.
fn usual(
    fields: &RoleFields,
    rule: Option<&TypeRule>,
    said: Because,
) -> Option<(Reading, Because)> {
    let convention = |given: Option<Convention>, orientation: &Orientation| {
        let of_type = || match rule?.frames {
            Frames::Orientation { usual, .. } => Some((usual, Because::Type)),
            _ => None,
        };
        // Roll, pitch and yaw have their names from the axes.
        let of_angles = || match orientation {
            Orientation::Euler(_) => Some((Convention::FRD_NED, Because::Assumed)),
            Orientation::Quaternion(_) | Orientation::Pitch(_) => None,
        };
        (given.map(|given| (given, said)))
            .or_else(of_type)
            .or_else(of_angles)
    };
    Some(match fields {
        RoleFields::Attitude(AttitudeFields {
            orientation,
            convention: given,
            ..
        }) => {
            let (axes, because) = convention(*given, orientation)?;
            (of_orientation(orientation, axes, None)?, because)
        }
        RoleFields::Gimbal(GimbalFields {
            orientation: Orientation::Pitch(pitch),
            reference,
            ..
        }) => {
            let reading = Reading::Pitch {
                unit: pitch.unit,
                is_positive_down: pitch.positive == PositiveDirection::Down,
                reference: *reference,
            };
            (reading, said)
        }
        RoleFields::Gimbal(GimbalFields {
            orientation,
            reference,
            convention: given,
        }) => {
            let (axes, because) = convention(*given, orientation)?;
            (
                of_orientation(orientation, axes, Some(*reference))?,
                because,
            )
        }
        RoleFields::Velocity(velocity) => {
            let reading = Reading::Velocity {
                axes: velocity.frame,
                unit: velocity.unit,
            };
            (reading, said)
        }
        RoleFields::Height(height) => (Reading::Height { unit: height.unit }, said),
        RoleFields::AngularRate(rate) => {
            let reading = Reading::AngularRate {
                axes: rate.frame,
                unit: rate.unit,
            };
            (reading, said)
        }
        RoleFields::Acceleration(acceleration) => {
            let reading = Reading::Acceleration {
                axes: acceleration.frame,
                unit: acceleration.unit,
            };
            (reading, said)
        }
        RoleFields::Position(Coordinates::Local { frame, unit, .. }) => {
            let reading = Reading::Local {
                axes: *frame,
                unit: *unit,
            };
            (reading, said)
        }
        RoleFields::Position(Coordinates::Geodetic {
            unit,
            altitude_unit,
            ..
        }) => {
            let reading = Reading::Geodetic {
                unit: *unit,
                altitude_unit: *altitude_unit,
            };
            (reading, said)
        }
    })
}

fn of_orientation(
    orientation: &Orientation,
    axes: Convention,
    reference: Option<GimbalReference>,
) -> Option<Reading> {
    Some(match orientation {
        Orientation::Quaternion(_) => Reading::Quaternion { axes, reference },
        Orientation::Euler(euler) => Reading::Angles {
            axes,
            unit: euler.unit,
            order: euler.order,
            reference,
        },
        Orientation::Pitch(_) => return None,
    })
}
