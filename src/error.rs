//! What can go wrong: the errors of all layers.

use std::path::PathBuf;

use crate::{
    camera::CameraError,
    log::{JournalError, ReadError},
    run::RunError,
    writer::WriteError,
};

/// Why a log could not be enriched, inspected or restored. Every message says what is wrong, and where.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// What each variant and field is, its message says.
#[allow(missing_docs)]
pub enum Error {
    /// The log cannot be opened or read.
    #[error(transparent)]
    Read(#[from] ReadError),

    /// How the camera is mounted is not known.
    #[error(transparent)]
    Camera(#[from] CameraError),

    /// The result cannot be written.
    #[error(transparent)]
    Write(WriteError),

    /// The log cannot be changed in place, or not be brought back to what it was.
    #[error(transparent)]
    Journal(#[from] JournalError),

    /// The run has no result.
    #[error(transparent)]
    Run(#[from] RunError),

    #[error(
        "{}: no usable telemetry\nlooked for:{looked_for}\n{topics}\n\
         say where it is with --attitude and --velocity (explained by `flightcam enrich --help`), \
         or in a profile of your own (--profile FILE.toml, explained in the README)", path.display()
    )]
    NoTelemetry {
        path: PathBuf,
        /// Each profile and why it does not fit.
        looked_for: String,
        /// What the log has instead.
        topics: String,
    },

    #[error(
        "{}: {} fit equally well; choose one, for instance with --attitude {}",
        path.display(), topics.join(" and "), topics[0]
    )]
    SeveralTopicsFit { path: PathBuf, topics: Vec<String> },

    #[error(
        "{}: several profiles fit equally well; choose one, for instance with --profile {}{}",
        path.display(), fits[0].0,
        fits.iter().map(|(profile, topic)| format!("\n  {profile}: {topic}")).collect::<String>()
    )]
    SeveralProfilesFit {
        path: PathBuf,
        /// Each profile and the topic where it finds the attitude.
        fits: Vec<(String, String)>,
    },

    #[error(
        "{}: has the telemetry of several vehicles, in the namespaces {}; choose one, \
         for instance with --namespace {}{}",
        path.display(), names_of(namespaces).join(", "), names_of(namespaces)[0],
        if namespaces.iter().any(String::is_empty) { " (/ is the one without a namespace)" } else { "" }
    )]
    SeveralVehicles {
        path: PathBuf,
        /// The prefixes of their topics; empty for the one without.
        namespaces: Vec<String>,
    },

    #[error("{}: there is no topic in the namespace {namespace}\n{topics}", path.display())]
    NoSuchNamespace {
        path: PathBuf,
        namespace: String,
        topics: String,
    },

    #[error("{}: --{role} does not fit: {problem}\n{topics}", path.display())]
    RoleDoesNotFit {
        path: PathBuf,
        role: &'static str,
        problem: String,
        topics: String,
    },

    #[error("{}: the profile `{profile}` does not fit: {problem}", path.display())]
    ProfileDoesNotFit {
        path: PathBuf,
        profile: String,
        problem: String,
    },

    #[error(
        "unknown profile `{name}`: the built-in profiles are {}; \
         a profile of your own is given as the path of a .toml file", builtin.join(", ")
    )]
    UnknownProfile { name: String, builtin: Vec<String> },

    #[error("{}: not a profile: {problem}", path.display())]
    BadProfile { path: PathBuf, problem: String },
}

/// Namespaces as they are given on the command line.
fn names_of(namespaces: &[String]) -> Vec<&str> {
    (namespaces.iter())
        .map(|namespace| match namespace.as_str() {
            "" => "/",
            namespace => namespace,
        })
        .collect()
}

impl From<WriteError> for Error {
    fn from(error: WriteError) -> Self {
        match error {
            // Whoever reads the log, that it cannot be read is the same error.
            WriteError::Read(error) => Self::Read(error),
            other => Self::Write(other),
        }
    }
}

impl Error {
    /// Whether the log could not be read, as opposed to not having what is looked for.
    pub(crate) fn is_of_reading(&self) -> bool {
        matches!(
            self,
            Self::Read(ReadError::Io { .. } | ReadError::Damaged { .. })
        )
    }
}
