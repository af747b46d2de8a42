//! What a run found and did, as data: for whoever called it, for scripts, and for the result's own Metadata record.

mod facts;
mod findings;
mod missing;
mod note;
mod ros2;
mod visuals;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use mcap::records::Channel;
use serde::{Serialize, Serializer};

use crate::{
    camera::Camera,
    log::Log,
    messages::{Encoding, EncodingChoice},
    options::Options,
    sample::{Kind, Tallies, Tally},
    source::{
        Origin, ReadAs, RefusedFrames, Source, profile::ProfileChoice, request::RoleArgument,
    },
    text::Foreign,
    transform::{Breaks, Motion, Outcome},
    writer::Layout,
};
pub(crate) use findings::{Derivation, Findings};
pub use missing::{MissingReason, MissingTopic};
pub use note::Note;
pub use visuals::{FieldOfViewReport, GroundBecause, GroundReport, Lack, VisualsReport};

/// What a run did. Scripts read it as JSON, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The log.
    #[serde(serialize_with = "lossy")]
    pub input: PathBuf,
    /// The result.
    #[serde(serialize_with = "lossy")]
    pub output: PathBuf,
    /// How the log names its telemetry.
    pub profile: ProfileReport,
    /// How the new messages are encoded.
    pub encoding: EncodingReport,
    /// How the camera is mounted.
    pub camera: CameraReport,
    /// The longest time between two attitude samples that belong together, seconds.
    pub max_gap_s: f64,
    /// What became of the samples of each kind that was read.
    #[serde(flatten, serialize_with = "by_kind")]
    pub samples: BTreeMap<Kind, SampleReport>,
    /// The shortest time between two attitude samples that were used, seconds.
    pub min_interval_s: f64,
    /// How often the chain of attitude samples broke.
    pub breaks: Breaks,
    /// Motion that no drone makes.
    pub motion: Motion,
    /// What viewers are shown beside that; absent unless it is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub visuals: Option<VisualsReport>,
    /// The topics that the result has and the log did not have.
    pub written: Vec<WrittenTopic>,
    /// The topics that could not be written.
    pub not_written: Vec<MissingTopic>,
    /// Where the new messages are.
    pub layout: Layout,
    /// Bytes of the log that are in the result unchanged.
    pub bytes_kept: u64,
    /// How many bytes longer the result is than the input; less than 0 if the input had a longer result of an earlier
    /// run.
    pub bytes_added: i64,
    /// Whether everything in the input could be read.
    pub complete: bool,
    /// Other things the user should know.
    pub notes: Vec<Note>,
}

/// What became of a log's samples, where no log was written.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DeriveReport {
    /// The samples that were used, and those that were not.
    pub tallies: Tallies,
    /// How often the chain of attitude samples broke.
    pub breaks: Breaks,
    /// Motion that no drone makes.
    pub motion: Motion,
    /// In which axes and units the samples of each kind were read, and why; more than one if messages differ.
    pub read_as: BTreeMap<Kind, Vec<ReadAs>>,
    /// Whether everything in the input could be read.
    pub complete: bool,
    /// What the user should know of the log besides.
    pub notes: Vec<Note>,
}

impl DeriveReport {
    /// Creates the report on a log to which other programs added `grown_by` bytes during the run.
    pub(crate) fn new(log: &Log, derivation: Derivation, grown_by: u64) -> Self {
        let Derivation {
            source,
            outcome,
            clock_steps,
            ..
        } = derivation;
        let Outcome {
            tallies,
            breaks,
            motion,
        } = outcome;
        let unreadable: u64 = Kind::ALL
            .map(|kind| tallies[kind].unreadable())
            .iter()
            .sum();
        let notes = [
            Note::on_recovery(log),
            Note::on_lost_end(log),
            Note::on_growth(grown_by),
            Note::on_clock_steps(&clock_steps),
        ];
        Self {
            tallies,
            breaks,
            motion,
            read_as: Kind::ALL.map(|kind| (kind, source.read_as(kind))).into(),
            complete: log.is_readable_to_its_end() && unreadable == 0 && grown_by == 0,
            notes: (notes.into_iter().flatten())
                .chain(Note::on_passed_over(&source))
                .collect(),
        }
    }
}

/// The profile that was used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ProfileReport {
    /// The profile's own name.
    pub name: Foreign,
    /// Who chose it.
    pub chosen: Chosen,
    /// Where it finds the attitude, by which profiles are chosen.
    pub attitude: Origin,
    /// Where it finds what it was chosen by instead, if the user gave the attitude.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside: Option<Origin>,
    /// Whether it is used only because no other fits.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub fallback: bool,
    /// Whether it says where the camera looks, because the user does not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub gives_camera: bool,
}

/// Who chose something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Chosen {
    /// The program, according to what the log contains.
    Automatically,
    /// The user.
    ByRequest,
}

impl ProfileReport {
    pub(crate) fn new(source: &Source, options: &Options) -> Self {
        let request = &options.telemetry;
        let by = source.chosen_by();
        let beside = (by != source.attitude()).then(|| by.clone());
        let is_given = matches!(
            request.roles.get(&Kind::Attitude),
            Some(RoleArgument::Fields(_))
        );
        let chosen = match request.profile {
            ProfileChoice::Automatic if is_given && beside.is_none() => Chosen::ByRequest,
            ProfileChoice::Automatic => Chosen::Automatically,
            ProfileChoice::Given(_) => Chosen::ByRequest,
        };
        Self {
            name: (&source.profile.name).into(),
            chosen,
            attitude: source.attitude().clone(),
            beside,
            fallback: source.profile.fallback && chosen == Chosen::Automatically,
            gives_camera: options.leaves_camera_to(&source.profile),
        }
    }
}

/// How the camera is mounted, with the angles in degrees as they were given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum CameraReport {
    /// The camera is on a gimbal that cancels the drone's roll and pitch.
    Stabilised {
        /// How far below the horizon it looks.
        depression_deg: f64,
        /// How far to the right of the drone's nose.
        yaw_offset_deg: f64,
    },
    /// The camera is bolted to the airframe.
    Fixed {
        /// Roll, pitch and yaw from the drone's axes.
        mount_deg: [f64; 3],
    },
    /// The camera is on a gimbal whose angles are in the log.
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
                // Round off the error of the conversion to radians and back.
                yaw_offset_deg: (yaw_offset.to_degrees() * 1e9).round() / 1e9,
            },
            Camera::Fixed(mount) => Self::Fixed {
                mount_deg: mount.degrees(),
            },
            Camera::Gimbal => Self::Gimbal,
        }
    }
}

/// The encoding that was used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct EncodingReport {
    /// The encoding.
    pub name: Encoding,
    /// Who chose it.
    pub chosen: Chosen,
    /// The topic of the attitude.
    pub telemetry_topic: Foreign,
    /// How the messages on that topic are encoded.
    pub telemetry_encoding: Foreign,
}

impl EncodingReport {
    pub(crate) fn new(choice: EncodingChoice, used: Encoding, telemetry: &Channel) -> Self {
        Self {
            name: used,
            chosen: match choice {
                EncodingChoice::Automatic => Chosen::Automatically,
                EncodingChoice::Given(_) => Chosen::ByRequest,
            },
            telemetry_topic: (&telemetry.topic).into(),
            telemetry_encoding: (&telemetry.message_encoding).into(),
        }
    }
}

/// What became of one kind of sample.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct SampleReport {
    /// Where the samples come from; absent if the log has none, or they are derived from others.
    pub topic: Option<Foreign>,
    /// The kind of sample that they are derived from, if they are not in messages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub derived_from: Option<Kind>,
    /// How many were used, and how many were not, for which reason.
    #[serde(flatten)]
    pub tally: Tally,
    /// In which axes and units they were read, and why; more than one if messages differ.
    pub read_as: Vec<ReadAs>,
    /// The frames for which samples were dropped.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub refused_frames: Vec<RefusedFrames>,
}

impl SampleReport {
    pub(crate) fn new(source: &Source, tallies: &Tallies, kind: Kind) -> Self {
        Self {
            derived_from: None,
            topic: source.role(kind).map(|role| role.topic.clone()),
            tally: tallies[kind].clone(),
            read_as: source.read_as(kind),
            refused_frames: source.refused_frames(kind),
        }
    }

    fn derived(from: Kind, tally: Tally) -> Self {
        Self {
            topic: None,
            derived_from: Some(from),
            tally,
            read_as: Vec::new(),
            refused_frames: Vec::new(),
        }
    }
}

/// A topic of the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct WrittenTopic {
    /// Its name.
    pub topic: &'static str,
    /// The full name of its message type.
    pub schema: &'static str,
    /// How many messages it has.
    pub messages: u64,
    /// The field of its messages that shows most at a glance, as viewers write its path; `None` if nothing of it can be
    /// plotted.
    #[serde(skip)]
    pub field_to_plot: Option<&'static str>,
}

/// Serialises a path for JSON, which cannot represent every file name that a system allows.
pub(crate) fn lossy<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}

/// Serialises what was found of each kind, under its name; null for a usual one that was not read.
fn by_kind<S: Serializer>(
    samples: &BTreeMap<Kind, SampleReport>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let kinds = Kind::LISTED.into_iter();
    let kinds = kinds.filter(|kind| Kind::USUAL.contains(kind) || samples.contains_key(kind));
    serializer.collect_map(kinds.map(|kind| (kind, samples.get(&kind))))
}
