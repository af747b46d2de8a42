//! What can be wrong with a profile.

use std::{io, path::PathBuf};

use crate::{
    decode::path::NotAPath,
    sample::Kind,
    similar,
    source::pattern::VEHICLE,
    text::{self, Foreign},
};

/// Why a profile cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum ProfileError {
    #[error(
        "unknown profile `{name}`; {}the built-in profiles are {}; \
         a profile of your own is given as the path of a .toml file",
        meant(name, built_in),
        text::join(built_in, ", ")
    )]
    Unknown {
        name: Foreign,
        built_in: Vec<Foreign>,
    },

    #[error("{}: not a profile: {source}", text::path(path))]
    Io { path: PathBuf, source: io::Error },

    #[error("{}: {source}", text::path(path))]
    Folder { path: PathBuf, source: io::Error },

    #[error(
        "{} and {} are both called `{name}`; give one of them another name",
        text::path(&paths[0]), text::path(&paths[1])
    )]
    SameName { name: Foreign, paths: [PathBuf; 2] },

    #[error("{}: not a profile: {problem}", text::path(path))]
    Bad {
        path: PathBuf,
        problem: Box<NotAProfile>,
    },
}

/// Why a text is not a profile.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum NotAProfile {
    #[error("{}", text::escaped_lines(.0.to_string().trim()))]
    Syntax(toml::de::Error),

    #[error("it is longer than 1 MiB")]
    TooLong,

    #[error("there is no `attitude`: a profile needs at least one alternative of it")]
    NoAttitude,

    #[error("line {line}: {problem}")]
    Content {
        /// Counted from 1.
        line: usize,
        problem: Problem,
    },
}

/// What is wrong with the content of a text that is TOML, but not a profile.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum Problem {
    #[error("{}{}", text::escaped(in_one_line(problem)), role.map_or_else(String::new, in_role))]
    Serde {
        role: Option<Kind>,
        problem: toml::de::Error,
    },

    #[error(
        "unknown key `{key}`; {}docs/profiles.md lists the keys of a profile",
        meant.as_ref().map_or_else(String::new, |meant| format!("did you mean `{meant}`? "))
    )]
    UnknownKey {
        key: Foreign,
        /// The key that was likely meant.
        meant: Option<Foreign>,
    },

    #[error(
        "this alternative of `attitude` has `topics` and the first one has not, or the other way round; \
         name the topics of each, or of none"
    )]
    TopicsOfSome,

    #[error(
        "a topic with {VEHICLE} takes `namespaced = true`: \
         a vehicle's number is part of its namespace"
    )]
    VehicleWithoutNamespace,

    #[error("{problem}{}", in_role(*role))]
    Role { role: Kind, problem: BadRole },
}

/// What is wrong with a role of a profile.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum BadRole {
    #[error("{what} needs one of `{}`", keys.join("`, `"))]
    NoneOf {
        what: &'static str,
        keys: &'static [&'static str],
    },

    #[error("{what} takes only one of `{}`", keys.join("`, `"))]
    SeveralOf {
        what: &'static str,
        keys: &'static [&'static str],
    },

    #[error(transparent)]
    NotAPath(#[from] NotAPath),

    #[error("`{path}` names no field")]
    NoField { path: Foreign },

    #[error(
        "a path names the topic {topic}, and there is `topics` as well; leave one of the two out"
    )]
    TopicTwice { topic: Foreign },

    #[error(
        "paths name the topics {} and {}; what belongs to one sample must come in one message",
        topics[0], topics[1]
    )]
    SeveralTopics { topics: [Foreign; 2] },

    #[error(
        "not all of the paths on {topic} have the same filter; what belongs to one sample must come in one message, so \
         write the filter after the topic of every path"
    )]
    SeveralSelections { topic: Foreign },

    #[error(
        "a path has the filter `{filter}`, and there is `select` as well; leave one of the two out"
    )]
    SelectTwice { filter: Foreign },

    #[error(
        "a pitch alone has no yaw that could be measured from north: it is measured from the horizon \
         under the drone's heading (`heading`), or from the airframe (`airframe`)"
    )]
    PitchFromNorth,

    #[error("a pitch alone has no convention; `positive` says its sign")]
    PitchWithConvention,
}

/// Says what is wrong with a value, and in which key.
fn in_one_line(error: &toml::de::Error) -> String {
    let text = error.to_string();
    let lines: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
    lines.join(", ")
}

/// Asks whether another profile was meant, if one has such a name.
fn meant(name: &str, built_in: &[Foreign]) -> String {
    let known = built_in.iter().map(Foreign::as_str);
    similar::misspelt(name, known).map_or_else(String::new, |meant| {
        format!("did you mean {}? ", Foreign::from(meant))
    })
}

fn in_role(role: Kind) -> String {
    format!(", in `{}`", role.name())
}
