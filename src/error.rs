//! What can go wrong: the errors of all layers.

pub use crate::{
    camera::CameraError,
    decode::{
        fault::{Content, Fault},
        path::NotAPath,
    },
    layout::LayoutError,
    log::{ChunkFault, Damage, ForeignFormat, ReadError, RecordKind},
    run::{Left, RunError},
    source::{
        error::{
            Candidate, Instead, LogTopic, Misfit, OtherTopics, PathReading, TelemetryError,
            TopicMisfit,
        },
        profile::{BadRole, NotAProfile, Problem as ProfileProblem, ProfileError, WrongCount},
    },
    writer::{
        IdKind, SpecialFile, WriteError,
        journal::{JournalError, JournalFault},
        original::Lost,
    },
};

/// Why a log could not be enriched, inspected or restored, or has no layout. Every message says what is wrong, and where.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The log cannot be opened or read.
    #[error(transparent)]
    Read(#[from] ReadError),

    /// The log's telemetry is not found.
    #[error(transparent)]
    Telemetry(TelemetryError),

    /// There is no such profile, or it is wrong.
    #[error(transparent)]
    Profile(#[from] ProfileError),

    /// How the camera is mounted is not known.
    #[error(transparent)]
    Camera(#[from] CameraError),

    /// The result cannot be written.
    #[error(transparent)]
    Write(WriteError),

    /// The log cannot be changed in place, or cannot be restored.
    #[error(transparent)]
    Journal(JournalError),

    /// There is no layout for the log.
    #[error(transparent)]
    Layout(#[from] LayoutError),

    /// The run has no result.
    #[error(transparent)]
    Run(#[from] RunError),
}

// A read failure is the same error in every layer.

impl From<TelemetryError> for Error {
    fn from(error: TelemetryError) -> Self {
        match error {
            TelemetryError::Read(error) => Self::Read(error),
            other => Self::Telemetry(other),
        }
    }
}

impl From<JournalError> for Error {
    fn from(error: JournalError) -> Self {
        match error {
            JournalError::Read(error) => Self::Read(error),
            other => Self::Journal(other),
        }
    }
}

impl From<WriteError> for Error {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Read(error) => Self::Read(error),
            other => Self::Write(other),
        }
    }
}

impl Error {
    /// Whether the log could not be read, as opposed to not containing what is looked for.
    pub(crate) fn is_of_reading(&self) -> bool {
        matches!(
            self,
            Self::Read(
                ReadError::Io { .. }
                    | ReadError::Damaged { .. }
                    | ReadError::BecameShorter { .. }
                    | ReadError::Changed { .. }
            )
        )
    }
}
