//! What a run found and did, for people, for scripts, and for the result's own Metadata record.

mod findings;
mod ros2;

use std::{
    fmt,
    path::{Path, PathBuf},
};

use mcap::records::Channel;
use serde::{Serialize, Serializer};

use crate::{
    camera::Camera,
    log::Log,
    messages::{Encoding, EncodingChoice},
    sample::{Kind, Tallies, Tally},
    source::{Source, profile::ProfileChoice},
    transform::Breaks,
    writer::Layout,
};
pub(crate) use findings::Findings;

/// What a run did. As JSON it is what scripts read, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The log.
    #[serde(serialize_with = "lossy")]
    pub input: PathBuf,
    /// The result.
    #[serde(serialize_with = "lossy")]
    pub output: PathBuf,
    /// How the log names its telemetry.
    pub profile: ProfileReport,
    /// In which language the new messages are written.
    pub encoding: EncodingReport,
    /// How the camera hangs on the drone.
    pub camera: CameraReport,
    /// The longest time between two attitude samples that belong together, seconds.
    pub max_gap_s: f64,
    /// What became of the attitude samples.
    pub attitude: SampleReport,
    /// What became of the velocity samples.
    pub velocity: SampleReport,
    /// What became of the gimbal's angles, if the camera follows them.
    pub gimbal: Option<SampleReport>,
    /// How often the chain of attitude samples broke.
    pub breaks: Breaks,
    /// The topics that the result has and the log had not.
    pub written: Vec<WrittenTopic>,
    /// The topics that it could have had.
    pub not_written: Vec<MissingTopic>,
    /// Where the new messages lie.
    pub layout: Layout,
    /// Bytes of the log that are in the result as they were.
    pub bytes_kept: u64,
    /// Bytes of the result besides.
    pub bytes_added: u64,
    /// Whether everything in the input could be read.
    pub complete: bool,
    /// What the user should know besides.
    pub notes: Vec<String>,
}

/// The profile that was used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProfileReport {
    /// As the profile calls itself.
    pub name: String,
    /// Why this one, in words.
    pub reason: String,
}

impl ProfileReport {
    pub(crate) fn new(source: &Source, choice: &ProfileChoice) -> Self {
        let found = source.attitude().reason();
        Self {
            name: source.profile.name.clone(),
            reason: match choice {
                ProfileChoice::Automatic => format!("chosen because {found}"),
                ProfileChoice::Given(_) => format!("as asked for; {found}"),
            },
        }
    }
}

/// How the camera hangs on the drone, with the angles in degrees as they were given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum CameraReport {
    /// On a gimbal that cancels the drone's roll and pitch.
    Stabilised {
        /// How far below the horizon it looks.
        depression_deg: f64,
        /// How far to the right of the drone's nose.
        yaw_offset_deg: f64,
    },
    /// Bolted to the airframe.
    Fixed {
        /// Roll, pitch and yaw from the drone's axes.
        mount_deg: [f64; 3],
    },
    /// On a gimbal whose angles the log has.
    Gimbal,
}

impl From<Camera> for CameraReport {
    fn from(camera: Camera) -> Self {
        match camera {
            Camera::Stabilised {
                depression,
                yaw_offset,
            } => Self::Stabilised {
                depression_deg: depression.degrees(),
                // Given in degrees: what the way there and back changed is rounded off.
                yaw_offset_deg: (yaw_offset.to_degrees() * 1e9).round() / 1e9,
            },
            Camera::Fixed(mount) => Self::Fixed {
                mount_deg: mount.degrees(),
            },
            Camera::Gimbal => Self::Gimbal,
        }
    }
}

impl fmt::Display for CameraReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Stabilised {
                depression_deg,
                yaw_offset_deg,
            } => {
                match depression_deg {
                    0.0 => f.write_str("looks at the horizon")?,
                    up if up < 0.0 => write!(f, "looks {}° above the horizon", -up)?,
                    down => write!(f, "looks {down}° below the horizon")?,
                }
                match yaw_offset_deg {
                    0.0 => Ok(()),
                    left if left < 0.0 => write!(f, ", {}° to the left of the nose", -left),
                    right => write!(f, ", {right}° to the right of the nose"),
                }
            }
            Self::Fixed {
                mount_deg: [roll, pitch, yaw],
            } => write!(
                f,
                "bolted to the airframe at roll {roll}°, pitch {pitch}°, yaw {yaw}°"
            ),
            Self::Gimbal => f.write_str("follows the gimbal"),
        }
    }
}

/// The encoding that was used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct EncodingReport {
    /// The encoding.
    pub name: Encoding,
    /// Why this one, in words.
    pub reason: String,
}

impl EncodingReport {
    pub(crate) fn new(choice: EncodingChoice, used: Encoding, telemetry: &Channel) -> Self {
        let found = format!("{} is {}", telemetry.topic, telemetry.message_encoding);
        Self {
            name: used,
            reason: match choice {
                EncodingChoice::Automatic => format!("chosen because {found}"),
                EncodingChoice::Given(_) => format!("as asked for; {found}"),
            },
        }
    }
}

/// What became of one kind of sample.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SampleReport {
    /// Where the samples come from; absent where the log has none.
    pub topic: Option<String>,
    /// How many were used, and how many were not, for which reason.
    #[serde(flatten)]
    pub tally: Tally,
}

impl SampleReport {
    fn new(source: &Source, tallies: &Tallies, kind: Kind) -> Self {
        Self {
            topic: source.role(kind).map(|role| role.topic.clone()),
            tally: tallies[kind].clone(),
        }
    }
}

/// A topic of the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WrittenTopic {
    /// Its name.
    pub topic: &'static str,
    /// The full name of its message type.
    pub schema: &'static str,
    /// How many it has.
    pub messages: u64,
}

/// A topic that the result does not have.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct MissingTopic {
    /// Its name.
    pub topic: &'static str,
    /// Why not, in words.
    pub reason: String,
}

/// What is said of a log of which a change in place had been cut short.
pub(crate) const RECOVERED: &str = "an earlier run that changed the log had been cut short; the log was first brought back to what it was before";

/// What is lost of a log that breaks off, if anything is.
pub(crate) fn unread_end(log: &Log) -> Option<String> {
    let offset = log.breaks_off_at?;
    let lost = log.file.length() - offset;
    (lost > 0).then(|| {
        format!(
            "the log breaks off at byte {offset}; the {lost} bytes from there on are not readable"
        )
    })
}

/// A path for JSON, which cannot hold every file name that a system allows.
pub(crate) fn lossy<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}
