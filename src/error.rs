//! What can go wrong, said so that the user knows what to do about it.

use std::{
    io,
    path::{Path, PathBuf},
};

/// Why a log could not be enriched. Every message names the file, the cause, and the way out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
// What each variant and field is, its message says.
#[allow(missing_docs)]
pub enum Error {
    #[error("{}: {action}: {source}", path.display())]
    Io {
        action: &'static str,
        path: PathBuf,
        source: io::Error,
    },

    #[error("{}: not a regular file; flightcam reads MCAP files", path.display())]
    NotAFile { path: PathBuf },

    #[error("{}: the file is empty; was the recording or the download interrupted?", path.display())]
    Empty { path: PathBuf },

    #[error("{}: not an MCAP file: {advice}", path.display())]
    NotMcap {
        path: PathBuf,
        /// What it seems to be instead, and what to do then.
        advice: &'static str,
    },

    #[error(
        "{}: damaged at byte {offset}: {what}; \
         `mcap recover` (https://mcap.dev) saves what can still be read into a new file", path.display()
    )]
    Corrupt {
        path: PathBuf,
        offset: u64,
        what: String,
    },

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

    #[error(
        "--depression DEG is missing: the angle of the camera's optical axis below the horizon, \
         which the log does not tell\n\n  \
         --depression 0    the camera looks ahead, at the horizon\n  \
         --depression 30   it looks 30° down: a gimbal pitch of -30°\n  \
         --depression 90   it looks straight down (nadir)\n\n\
         The angle is in degrees, greater than -90 and at most 90. For a camera that is bolted to the \
         airframe give --mount ROLL,PITCH,YAW instead; where the log has a gimbal's angles that no profile \
         knows of, --gimbal tells where."
    )]
    NoCamera,

    #[error(
        "a --mount with roll or pitch contradicts --depression: a gimballed camera does not tilt with the \
         drone. With --depression give only the yaw (--mount 0,0,90 looks to the right); without it the \
         camera is bolted to the airframe"
    )]
    TiltedMount,

    #[error(
        "--mount contradicts --gimbal: a camera that is bolted to the airframe follows no gimbal; \
         leave one of them out"
    )]
    GimbalAndMount,

    #[error(
        "--layout interleaved rewrites the whole log, so it cannot be done --in-place; \
         write the result to a new file (-o)"
    )]
    InterleavedInPlace,

    #[error(
        "{}: nothing can be derived from its telemetry\n{details}\n\
         check which topics and fields the profile names (--profile), and --max-gap", path.display()
    )]
    NothingDerived { path: PathBuf, details: String },

    #[error(
        "{}: has {topic} from an earlier run of flightcam ({made_by}), which cannot be replaced: {reason}; \
         enrich the original log instead", path.display()
    )]
    AlreadyEnriched {
        path: PathBuf,
        topic: &'static str,
        made_by: String,
        /// Why the original is not to be had from it.
        reason: Lost,
    },

    #[error("{}: cannot be restored: {reason}", path.display())]
    NotRestorable { path: PathBuf, reason: Lost },

    #[error(
        "{}: another run of flightcam is using it; try again when that has ended", path.display()
    )]
    Locked { path: PathBuf },

    #[error(
        "{}: cannot be changed in place, because it cannot be locked against other runs ({source}); \
         write the result to a new file (-o)", path.display()
    )]
    NoLocks { path: PathBuf, source: io::Error },

    #[error(
        "{}: {} beside it is left from an interrupted change of another log ({of}); \
         put that log back in its place, or remove the journal if that log is lost",
        path.display(), journal.display()
    )]
    ForeignJournal {
        path: PathBuf,
        journal: PathBuf,
        /// Where that log was.
        of: String,
    },

    #[error(
        "{}: {} beside it is left from an interrupted change of a log of that name; bring that log back with \
         `flightcam restore`, remove the journal if that log is lost, or choose another output with -o",
        path.display(), journal.display()
    )]
    JournalInTheWay { path: PathBuf, journal: PathBuf },

    #[error(
        "{cause}\n{}: moreover, the log could not be brought back to what it was ({rollback}); \
         when there is room again, `flightcam restore` does that", path.display()
    )]
    RollBack {
        path: PathBuf,
        cause: Box<Error>,
        rollback: Box<Error>,
    },

    #[error(
        "--layout interleaved needs the log as a file: from a stream it is known too late what follows from it"
    )]
    InterleavedStream,

    #[error("{cause}\nthe log was passed on as it came, without new channels")]
    PassedOn { cause: Box<Error> },

    #[error("{}: interrupted; {left}", path.display())]
    Interrupted {
        path: PathBuf,
        /// What is left, in words.
        left: &'static str,
    },

    #[error(
        "{}: already has a topic {topic}, which flightcam did not write ({schema}); \
         rename or remove that topic first, it would not be told apart from flightcam's",
        path.display()
    )]
    TopicTaken {
        path: PathBuf,
        topic: &'static str,
        schema: String,
    },

    #[error("{}: all {what} ids of the log are in use, so no topic can be added; \
             remove a topic that is not needed, for instance with `mcap filter` (https://mcap.dev)", path.display())]
    NoFreeId { path: PathBuf, what: &'static str },

    #[error(
        "{}: exists already; choose another output with -o, or replace it with --force", path.display()
    )]
    OutputExists { path: PathBuf },

    #[error("{}: is a folder; name the output's file with -o", path.display())]
    OutputIsFolder { path: PathBuf },

    #[error(
        "{}: the output would replace the input; choose another output with -o", path.display()
    )]
    OutputIsInput { path: PathBuf },

    #[error(
        "{}: there is no folder {} for the output; create it, or choose another output with -o",
        path.display(), folder.display()
    )]
    NoOutputFolder { path: PathBuf, folder: PathBuf },

    #[error("{}: cannot append to the log: {source}", path.display())]
    Append {
        path: PathBuf,
        source: mcap::McapError,
    },
}

/// Why the original log is not to be had from a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum Lost {
    #[error("it has nothing from flightcam")]
    NotEnriched,
    #[error("it was written with --layout interleaved, which keeps no way back")]
    Interleaved,
    #[error("it came through a pipe, which takes nothing back")]
    PassedOn,
    #[error("another program has rewritten it since, or it is damaged")]
    Rewritten,
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

impl Error {
    pub(crate) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io {
            action,
            path: path.into(),
            source,
        }
    }

    pub(crate) fn corrupt(path: &Path, offset: u64, what: impl Into<String>) -> Self {
        Self::Corrupt {
            path: path.into(),
            offset,
            what: what.into(),
        }
    }

    /// Whether the log could not be read, as opposed to not having what is looked for.
    pub fn is_of_reading(&self) -> bool {
        matches!(self, Self::Io { .. } | Self::Corrupt { .. })
    }

    /// Whether what was asked for was wrong, whatever the log holds.
    pub fn is_usage(&self) -> bool {
        match self {
            Self::PassedOn { cause } => cause.is_usage(),
            Self::UnknownProfile { .. }
            | Self::BadProfile { .. }
            | Self::OutputIsInput { .. }
            | Self::NoCamera
            | Self::TiltedMount
            | Self::GimbalAndMount
            | Self::InterleavedInPlace
            | Self::InterleavedStream => true,
            _ => false,
        }
    }
}
