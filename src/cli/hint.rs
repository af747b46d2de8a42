//! Hints: what to do about an error, in terms of the command line.

mod contradiction;
mod foreign;
mod telemetry;

use std::path::Path;

use flightcam::{
    Error, LayoutError,
    camera::CameraError,
    error::{JournalError, JournalFault, SpecialFile},
    log::ReadError,
    report::MissingTopic,
    run::RunError,
    text::is_escaped,
    writer::WriteError,
};

use super::words;

const NO_CAMERA: &str = "\
give --depression DEG, the angle of the camera's optical axis below the horizon

  --depression 0    the camera looks ahead, at the horizon
  --depression 30   it looks 30° down: a gimbal pitch of -30°
  --depression 90   it looks straight down (nadir)

The angle is in degrees, greater than -90 and at most 90. For a camera that is bolted to the airframe give --mount \
ROLL,PITCH,YAW instead; where the log has a gimbal's angles that no profile knows of, --gimbal says where.";

const AGAIN: &str = "try again when nothing writes to the log any more";

/// What the user can do about an error, if that does not follow from the error itself.
pub fn hint(error: &Error) -> Option<String> {
    let hint = match error {
        Error::Read(ReadError::NotMcap { path, format }) => {
            return Some(foreign::hint(path, *format));
        }
        Error::Read(error) => of_reading(error)?,
        Error::Camera(error) => of_the_camera(*error)?,
        Error::Write(error) => of_writing(error)?,
        Error::Journal(error) => of_the_journal(error)?,
        Error::Telemetry(error) => return telemetry::hint(error),
        Error::Layout(LayoutError::NotEnriched { path }) => return Some(not_enriched(path)),
        Error::Run(RunError::PassedOn { cause }) => return hint(cause),
        Error::Run(RunError::NothingDerived { missing, .. }) => return Some(of_nothing(missing)),
        Error::Run(RunError::Contradicted {
            findings, asked, ..
        }) => return Some(contradiction::hint(findings, asked)),
        Error::Run(error) => of_the_run(error)?,
        _ => return None,
    };
    Some(hint.to_owned())
}

fn of_reading(error: &ReadError) -> Option<&'static str> {
    Some(match error {
        ReadError::NotAFile { .. } => "flightcam reads MCAP files",
        ReadError::Empty { .. } => "was the recording or the download interrupted?",
        ReadError::Damaged { .. } => {
            "`mcap recover` (https://mcap.dev) saves what can still be read into a new file"
        }
        ReadError::BecameShorter { .. } | ReadError::Changed { .. } => AGAIN,
        ReadError::Locked { .. } => "try again when that has ended",
        ReadError::NoLocks { .. } => "write the result to a new file (-o)",
        _ => return None,
    })
}

fn of_the_journal(error: &JournalError) -> Option<&'static str> {
    Some(match error {
        JournalError::Changed { .. } => AGAIN,
        JournalError::Foreign { .. } => {
            "put that log back in its place, or remove the journal if that log is lost"
        }
        JournalError::Distrusted {
            fault: JournalFault::OtherVersion,
            ..
        } => "`flightcam restore` of that version undoes the change",
        JournalError::Distrusted { .. } => {
            "copy both somewhere safe. If the log is as it should be, remove the journal; if not, replace the log by a \
             copy of it first"
        }
        JournalError::NotRolledBack { .. } => {
            "when there is room again, `flightcam restore` does that"
        }
        _ => return None,
    })
}

fn of_the_camera(error: CameraError) -> Option<&'static str> {
    Some(match error {
        CameraError::Unknown => NO_CAMERA,
        CameraError::TiltedMount => {
            "with --depression give only the yaw (--mount 0,0,90 looks to the right); without it the camera is \
             bolted to the airframe"
        }
        CameraError::GimbalAndMount => "leave out --mount or --gimbal",
        _ => return None,
    })
}

fn of_writing(error: &WriteError) -> Option<&'static str> {
    Some(match error {
        WriteError::NoFreeId { .. } => {
            "remove a topic that is not needed, for instance with `mcap filter` (https://mcap.dev)"
        }
        WriteError::TopicTaken { .. } => {
            "rename or remove that topic first; it could not be told apart from flightcam's"
        }
        WriteError::AlreadyEnriched { .. } | WriteError::UntrustedOriginal { .. } => {
            "enrich the original log instead"
        }
        WriteError::OutputExists { .. } => {
            "choose another output with -o, or replace it with --force"
        }
        WriteError::OutputIsFolder { .. } => "name the output's file with -o",
        WriteError::OutputIsJournal { .. } => "choose another output with -o",
        WriteError::OutputIsSpecial {
            kind: SpecialFile::OpenFile,
            ..
        } => "write to standard output with -o -",
        WriteError::OutputIsSpecial { .. }
        | WriteError::OutputIsInput { .. }
        | WriteError::CannotCreate { .. } => "choose another output with -o",
        WriteError::NoFolder { .. } => "create it, or choose another output with -o",
        WriteError::JournalInTheWay { .. } => {
            "recover that log with `flightcam restore`, remove the journal if that log is lost, or choose another \
             output with -o"
        }
        _ => return None,
    })
}

fn not_enriched(log: &Path) -> String {
    let log = log.to_str().and_then(in_shell);
    let log = log.as_deref().unwrap_or("LOG");
    format!(
        "first run `flightcam enrich {log} --visuals`, with --depression or --mount if the log has no gimbal angles, \
         and then this on the result"
    )
}

fn of_nothing(missing: &[MissingTopic]) -> String {
    let check = "check which topics and fields the profile names (--profile), and --max-gap";
    let positions = missing.iter().find_map(|topic| topic.positions.as_ref());
    match positions.map(words::velocity_from_position) {
        None => check.to_owned(),
        Some(instead) => format!("{check}; for the velocity, {instead}"),
    }
}

fn of_the_run(error: &RunError) -> Option<&'static str> {
    Some(match error {
        RunError::InterleavedInPlace => {
            "with --layout interleaved leave out --in-place, and write the result to a new file (-o)"
        }
        RunError::Stream { .. } => {
            "save the log as a file first; only `enrich` reads one from a pipe"
        }
        RunError::FlightTooLong { .. } => {
            "--visual-rate 5 writes fewer of them; without --visuals flights can be of any length"
        }
        RunError::InterleavedStream => "leave out --layout interleaved, or give the log as a file",
        _ => return None,
    })
}

/// An argument as a shell reads it; `None` for one that cannot be seen in full, or looks like an option.
pub(super) fn in_shell(argument: &str) -> Option<String> {
    let is_plain = |c: char| c.is_alphanumeric() || "/_-.,:".contains(c);
    if argument.contains(is_escaped) || argument.starts_with('-') {
        return None;
    }
    Some(match argument.chars().all(is_plain) {
        true => argument.to_owned(),
        false => format!("'{}'", argument.replace('\'', r"'\''")),
    })
}

/// Whether the request itself is wrong, whatever the log contains.
pub fn is_usage(error: &Error) -> bool {
    match error {
        Error::Camera(_)
        | Error::Write(WriteError::OutputIsInput { .. })
        | Error::Run(
            RunError::InterleavedInPlace
            | RunError::InterleavedStream
            | RunError::NotAFileInPlace
            | RunError::Stream { .. },
        )
        | Error::Profile(_) => true,
        Error::Run(RunError::PassedOn { cause }) => is_usage(cause),
        _ => false,
    }
}
