//! What can go wrong when a result is written.

use std::{
    io,
    path::{Path, PathBuf},
};

use super::{original::Lost, provenance::EarlierRun};
use crate::{
    log::ReadError,
    text::{self, Foreign},
};

/// Why a result cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum WriteError {
    #[error("{}: {action}: {source}", text::path(path))]
    Io {
        action: &'static str,
        path: PathBuf,
        source: io::Error,
    },

    /// The log that is written anew, or added to, cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),

    /// The progress callback cancelled the copy.
    #[error("cancelled")]
    Cancelled,

    #[error(
        "{}: all {kind} ids of the log are in use, so no topic can be added",
        text::path(path)
    )]
    NoFreeId { path: PathBuf, kind: IdKind },

    #[error(
        "{}: already has a topic {topic}, which flightcam did not write ({})",
        text::path(path),
        describe(schema)
    )]
    TopicTaken {
        path: PathBuf,
        topic: &'static str,
        /// The name of its schema, if it has one.
        schema: Option<Foreign>,
    },

    #[error(
        "{}: has {topic} from an earlier run of flightcam ({earlier}), which cannot be replaced: {reason}",
        text::path(path)
    )]
    AlreadyEnriched {
        path: PathBuf,
        topic: &'static str,
        earlier: Box<EarlierRun>,
        /// Why the original cannot be recovered from it.
        reason: Lost,
    },

    #[error(
        "{}: says what its original was before an earlier run of flightcam ({earlier}), which cannot be trusted: \
         {reason}",
        text::path(path)
    )]
    UntrustedOriginal {
        path: PathBuf,
        earlier: Box<EarlierRun>,
        reason: Lost,
    },

    #[error("{}: exists already", text::path(path))]
    OutputExists { path: PathBuf },

    #[error(
        "{}: has the name of a journal, which belongs to a log that is being changed",
        text::path(path)
    )]
    OutputIsJournal { path: PathBuf },

    #[error("{}: is a folder", text::path(path))]
    OutputIsFolder { path: PathBuf },

    #[error("{}: is {kind}, to which no log can be written", text::path(path))]
    OutputIsSpecial { path: PathBuf, kind: SpecialFile },

    #[error("{}: the output would replace the input", text::path(path))]
    OutputIsInput { path: PathBuf },

    #[error(
        "{}: there is no folder {} for the output",
        text::path(path),
        text::path(folder)
    )]
    NoFolder { path: PathBuf, folder: PathBuf },

    #[error(
        "{}: cannot create a file in the output's folder: {source}",
        text::path(path)
    )]
    CannotCreate { path: PathBuf, source: io::Error },

    #[error(
        "{}: {} beside it is left from an interrupted change of a log of that name",
        text::path(path),
        text::path(journal)
    )]
    JournalInTheWay { path: PathBuf, journal: PathBuf },
}

/// What the ids of a log are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum IdKind {
    #[error("schema")]
    Schema,
    #[error("channel")]
    Channel,
}

/// A kind of file that is neither a regular file nor anything that a stream of bytes can be written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum SpecialFile {
    #[error("a block device")]
    BlockDevice,
    #[error("a socket")]
    Socket,
    #[error("a terminal")]
    Terminal,
    #[error("another name of an open file")]
    OpenFile,
}

impl WriteError {
    pub(crate) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io {
            action,
            path: path.into(),
            source,
        }
    }

    /// The error for an output that cannot be written.
    pub(crate) fn output(path: &Path, source: io::Error) -> Self {
        Self::io("cannot write the output", path, source)
    }
}

fn describe(schema: &Option<Foreign>) -> String {
    match schema {
        Some(name) => format!("schema `{name}`"),
        None => "no schema".to_owned(),
    }
}
