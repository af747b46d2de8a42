//! Errors of a run as a whole.

use std::{collections::BTreeMap, path::PathBuf};

use crate::{
    check::Findings, error::Error, report::MissingTopic, sample::Kind, source::request::HowAsked,
    text, writer::original::Lost,
};

/// Why a run has no result, apart from problems with its input and its output.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it and its fields.
#[allow(missing_docs)]
pub enum RunError {
    #[error(
        "{}: nothing can be derived from its telemetry{}",
        text::path(path),
        list(missing)
    )]
    NothingDerived {
        path: PathBuf,
        missing: Vec<MissingTopic>,
    },

    #[error(
        "{}: its own numbers show that it was read wrongly{findings}",
        text::path(path)
    )]
    Contradicted {
        path: PathBuf,
        findings: Box<Findings>,
        /// How the user asked for each kind of sample.
        asked: BTreeMap<Kind, HowAsked>,
    },

    #[error(
        "{}: the flight has more than {moments} moments, too many to be shown",
        text::path(path)
    )]
    FlightTooLong {
        path: PathBuf,
        /// How many there can be.
        moments: usize,
    },

    #[error("{}: cannot be restored: {reason}", text::path(path))]
    NotRestorable { path: PathBuf, reason: Lost },

    #[error(
        "{}: cannot be read from front to back; the log must be a file",
        text::path(name)
    )]
    Stream { name: PathBuf },

    #[error("only a log in a file can be changed in place")]
    NotAFileInPlace,

    #[error("the interleaved layout rewrites the whole log, so it cannot be written in place")]
    InterleavedInPlace,

    #[error(
        "the interleaved layout needs the log as a file: a chunk of a stream has passed before it is known what \
         belongs after it"
    )]
    InterleavedStream,

    #[error("{cause}\nthe log was passed on as it came, without new channels")]
    PassedOn { cause: Box<Error> },

    #[error("{}: interrupted; {left}", text::path(path))]
    Interrupted { path: PathBuf, left: Left },
}

/// What an interrupted run leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum Left {
    #[error("nothing was written")]
    Nothing,
    #[error("the log is as it was")]
    Unchanged,
    #[error("what was written is incomplete")]
    Incomplete,
}

fn list(missing: &[MissingTopic]) -> String {
    let lines = missing.iter();
    lines
        .map(|MissingTopic { topic, reason, .. }| format!("\n  {topic}: {reason}"))
        .collect()
}
