//! What can be wrong with an argument.

use crate::{
    decode::path::NotAPath,
    sample::Kind,
    source::profile::{BadRole, convention::NotAConvention},
    text::Foreign,
};

/// What is wrong with an argument.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum BadArgument {
    #[error(transparent)]
    NotAPath(#[from] NotAPath),

    #[error(
        "{} and {} are different topics; every path begins with its topic (/imu.roll,/imu.pitch), \
         and what belongs to one sample must come in one message", topics[0], topics[1]
    )]
    SeveralTopics { topics: [Foreign; 2] },

    #[error(
        "not all of the paths on {topic} have the same filter; what belongs to one sample must come in one message, so \
         write the filter after the topic of every path"
    )]
    SeveralSelections { topic: Foreign },

    #[error(
        "`{word}` has no meaning here; after a colon there can be {}",
        in_words(known)
    )]
    UnknownWord {
        word: Foreign,
        /// The words that would have a meaning, in groups of which there can be one each.
        known: Vec<&'static [&'static str]>,
    },

    #[error("`{word}` does not go with the rest of the argument")]
    LeftOver { word: Foreign },

    #[error(
        "only a topic is given, which is read as the profile says; \
         name the fields that `{word}` is for, as in {topic}.field:{word}"
    )]
    NoFields { topic: Foreign, word: Foreign },

    #[error("{count} fields were given, but {}", takes(*role))]
    FieldCount { count: usize, role: Kind },

    #[error("roll, pitch and yaw need their unit: `:degrees` or `:radians` after the fields")]
    NoAngleUnit,

    #[error("an angle's unit goes with {}", angles(*role))]
    NoAngles { role: Kind },

    #[error(
        "a velocity needs its axes: `:ned`, `:enu`, `:body-frd` or `:body-flu` after the fields, or any other three \
         letters, one for each component"
    )]
    NoAxes,

    #[error(
        "angular rates and accelerations need the drone's axes: `:frd` or `:flu` after the fields"
    )]
    NoBodyAxes,

    #[error(
        "one field is a pitch angle, which needs its unit (`:degrees`, `:radians`), or a quaternion, \
         which needs what it is measured from (`:earth`, `:heading`, `:airframe`)"
    )]
    PitchOrQuaternion,

    #[error(
        "a gimbal's rotation needs what it is measured from: \
         `:earth`, `:heading` or `:airframe` after the fields"
    )]
    NoReference,

    #[error(
        "{}; latitude and longitude need their unit (`:degrees`, `:degE7`), \
         x, y and z their axes (`:ned`, `:enu`)",
        takes(Kind::Position)
    )]
    NotAPosition,

    #[error(transparent)]
    Convention(NotAConvention),

    #[error(transparent)]
    Role(#[from] BadRole),

    #[error(
        "`{path}` is not a time: write log, publish, or a field of the messages without their topic, \
         as in header.stamp or time_usec:us"
    )]
    NotATime { path: Foreign },
}

/// How many fields a role takes.
fn takes(role: Kind) -> &'static str {
    match role {
        Kind::Attitude => {
            "an attitude takes one (a quaternion), three (roll, pitch, yaw) or four (w, x, y, z)"
        }
        Kind::Velocity => "a velocity takes one (a vector) or three",
        Kind::Height => "a height takes one",
        Kind::AngularRate => "angular rates take one (a vector) or three",
        Kind::Acceleration => "accelerations take one (a vector) or three",
        Kind::Gimbal => {
            "a gimbal takes one (a pitch angle or a quaternion), three (roll, pitch, yaw) or four (w, x, y, z)"
        }
        Kind::Position => {
            "a position takes three: latitude, longitude, altitude or x, y, z, or one (a vector x, y, z)"
        }
    }
}

/// Which fields of a role can be angles.
fn angles(role: Kind) -> &'static str {
    match role {
        Kind::Gimbal => "one field, the pitch, or three: roll, pitch, yaw",
        _ => "three fields: roll, pitch, yaw",
    }
}

fn in_words(known: &[&[&str]]) -> String {
    let groups = known.iter().map(|group| match group {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        group => group.concat(),
    });
    groups.collect::<Vec<_>>().join("; ")
}
