//! Other things the user should know about a log or a result.

use std::path::PathBuf;

use serde::Serialize;

use super::{CameraReport, lossy};
use crate::{
    check::Oddity,
    clock::ClockStep,
    log::Log,
    sample::Kind,
    source::{
        PassedOver, Source, UnmetCondition,
        profile::convention::AngleUnit,
        request::{HowAsked, Request},
        undecodable::UndecodableMessage,
    },
    text::Foreign,
    writer::{Layout, provenance::EarlierRun},
};

/// Other things the user should know about a log or a result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Note {
    /// An earlier run that changed the log was interrupted; the log was restored first.
    Recovered,
    /// The log was already enriched, and the result replaces the earlier one.
    Replaced {
        /// How the earlier one was made.
        earlier: EarlierRun,
    },
    /// The log is already enriched, and its original was inspected.
    OriginalInspected {
        /// How it was enriched.
        earlier: EarlierRun,
    },
    /// The layout of the result cannot be undone.
    CannotBeUndone,
    /// The log was never closed. All of its records were used, and the result is closed.
    NeverClosed,
    /// The log breaks off in the middle of a record, or it was closed and something else follows.
    BreaksOff {
        /// Where the last whole record ends.
        offset: u64,
        /// How many bytes follow, which cannot be read.
        lost_bytes: u64,
    },
    /// Another program wrote to the end of the log's file during the run. Everything is about what was there at the
    /// start.
    Grew {
        /// How many bytes were added until the end of the run, of which nothing was read.
        added_bytes: u64,
    },
    /// The log does not end like one that was closed, but its data is whole. The result is closed.
    NotClosedButWhole,
    /// The log has no readable summary. The result has one.
    SummaryMissing,
    /// The log's summary is incomplete or wrong. The result's is complete.
    SummaryIncomplete,
    /// The log has messages outside chunks, which a chunk index would hide.
    LooseMessages {
        /// [`Append`](Layout::Append): the result has no chunk index, so seeking in it takes longer.
        /// [`Interleaved`](Layout::Interleaved): they are in chunks there.
        layout: Layout,
    },
    /// Messages could not be decoded by their schemas.
    Undecodable {
        /// How many samples they would have given.
        samples: u64,
        /// The earliest of these messages.
        first: Option<UndecodableMessage>,
    },
    /// The log's data does not match its checksum. The result has no checksum.
    ChecksumWrong,
    /// The log has a gimbal's angles, but the options describe another camera.
    GimbalIgnored {
        /// Where they are.
        topic: Foreign,
        /// How the camera is mounted.
        camera: CameraReport,
        /// Whether the profile says so, and not the caller.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        by_profile: bool,
    },
    /// The time of messages goes back although the file goes on, as where a clock was set or a recorder was restarted.
    /// What comes after such a step is processed by itself.
    ClockSteps {
        /// Each of them, in the order of the file.
        steps: Vec<ClockStep>,
    },
    /// The samples have times before the log's first message or after its last.
    TimesOutsideLog,
    /// An angle is larger than one of the unit in which it was read usually is.
    SuspiciousAngle {
        /// What it is of.
        sample: Kind,
        /// Where it is.
        topic: Foreign,
        /// The largest.
        angle: f64,
        /// The unit.
        unit: AngleUnit,
        /// How the user asked for these angles.
        asked: HowAsked,
    },
    /// The drone leans by more than 60° most of the time, as a tailsitter does; or it is another thing's attitude.
    OnItsSide {
        /// In which share of the samples.
        share: f64,
    },
    /// The gimbal points up nearly all the time, as under a bridge; or its sign is wrong.
    GimbalUp {
        /// In which share of the samples.
        share: f64,
    },
    /// Samples were left out because no condition of the profile holds for their messages.
    UnmetConditions {
        /// Samples of what.
        sample: Kind,
        /// Where they are.
        topic: Foreign,
        /// How many.
        samples: u64,
        /// What was found, and what was wanted.
        conditions: Vec<UnmetCondition>,
    },
    /// What comes first in a profile, or another profile, was passed over because of what its messages hold.
    PassedOver(PassedOver),
    /// All channels of the log are ROS 2, and the new ones are not, so that ROS 2 tools refuse the result.
    NewChannelsNotRos2,
    /// A channel of the log is not ROS 2, so that ROS 2 tools refuse the result although the new ones are.
    ChannelNotRos2 {
        /// The channel's topic.
        topic: Foreign,
        /// How its messages are encoded.
        message_encoding: Foreign,
    },
    /// The log continues after January 2038, when ROS 2 stamps overflow. Later stamps are clamped; log times are still
    /// right.
    Ros2StampOverflow,
    /// The result, or the log, is in the folder of a ROS 2 bag, whose description does not list the new topics.
    BagMetadataOutdated {
        /// The description.
        #[serde(serialize_with = "lossy")]
        path: PathBuf,
    },
}

impl Note {
    /// A note for a log whose in-place change was interrupted.
    pub(crate) fn on_recovery(log: &Log) -> Option<Self> {
        log.file.was_recovered().then_some(Self::Recovered)
    }

    /// A note for a log that breaks off, if anything is lost.
    pub(crate) fn on_lost_end(log: &Log) -> Option<Self> {
        let offset = log.breaks_off_at?;
        let lost_bytes = log.file.length() - offset;
        (lost_bytes > 0).then_some(Self::BreaksOff { offset, lost_bytes })
    }

    /// A note on what is odd about samples, but may be right.
    pub(crate) fn on_oddity(oddity: &Oddity) -> Option<Self> {
        match *oddity {
            Oddity::OnItsSide { share } => Some(Self::OnItsSide { share }),
            Oddity::GimbalUp { share } => Some(Self::GimbalUp { share }),
            Oddity::OneTime { .. }
            | Oddity::ToAndFro { .. }
            | Oddity::ScalarElsewhere { .. }
            | Oddity::NotAtDepression { .. } => None,
        }
    }

    /// A note for a log whose file has become longer since it was opened.
    pub(crate) fn on_growth(added_bytes: u64) -> Option<Self> {
        (added_bytes > 0).then_some(Self::Grew { added_bytes })
    }

    /// A note for telemetry whose times go back.
    pub(crate) fn on_clock_steps(steps: &[ClockStep]) -> Option<Self> {
        (!steps.is_empty()).then(|| Self::ClockSteps {
            steps: steps.to_vec(),
        })
    }

    /// Notes for places that come first and were passed over.
    pub(crate) fn on_passed_over(source: &Source) -> Vec<Self> {
        let passed_over = source.passed_over.iter().cloned();
        passed_over.map(Self::PassedOver).collect()
    }

    /// A note for telemetry whose angles are too large for their unit, once all messages have been read.
    pub(crate) fn on_suspicious_angle(source: &Source, request: &Request) -> Option<Self> {
        let (sample, found) = source.oversized_angle()?;
        Some(Self::SuspiciousAngle {
            sample,
            topic: source.topic_of(sample),
            angle: found.angle,
            unit: found.unit,
            asked: request.how_asked(sample, &source.profile),
        })
    }

    /// Notes for samples that conditions left out, as far as messages have been read.
    pub(crate) fn on_unmet_conditions(source: &Source) -> impl Iterator<Item = Self> {
        Kind::LISTED.into_iter().filter_map(|sample| {
            let (samples, conditions) = source.unmet_conditions(sample);
            let topic = source.role(sample)?.topic.clone();
            (samples > 0).then_some(Self::UnmetConditions {
                sample,
                topic,
                samples,
                conditions,
            })
        })
    }
}
