//! What was found in a log, and what the user is told of it.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use mcap::records::Statistics;

use super::{
    CameraReport, EncodingReport, MissingTopic, ProfileReport, RECOVERED, Report, SampleReport,
    WrittenTopic, ros2, unread_end,
};
use crate::{
    camera::Camera,
    derived::Quantity,
    log::ScanReason,
    options::Options,
    sample::{Kind, Tallies},
    source::Source,
    transform::{Breaks, Outcome},
    writer::{Layout, Written, original::Original},
};

/// What was found in a log, once all of its telemetry was read.
pub struct Findings<'a> {
    original: &'a Original,
    options: &'a Options,
    source: Source,
    encoding: EncodingReport,
    attitude: SampleReport,
    velocity: SampleReport,
    gimbal: Option<SampleReport>,
    camera: Camera,
    breaks: Breaks,
}

impl<'a> Findings<'a> {
    pub fn new(
        original: &'a Original,
        options: &'a Options,
        source: Source,
        camera: Camera,
        encoding: EncodingReport,
        dropped: &Tallies,
        outcome: Outcome,
    ) -> Self {
        let mut tallies = outcome.tallies;
        tallies.merge(dropped);
        Self {
            original,
            options,
            encoding,
            attitude: SampleReport::new(&source, &tallies, Kind::Attitude),
            velocity: SampleReport::new(&source, &tallies, Kind::Velocity),
            gimbal: (camera == Camera::Gimbal)
                .then(|| SampleReport::new(&source, &tallies, Kind::Gimbal)),
            camera,
            breaks: outcome.breaks,
            source,
        }
    }

    /// Why a quantity has no messages, if it has none.
    pub fn why_missing(&self, quantity: Quantity) -> String {
        match quantity {
            Quantity::RelativeRpy if self.attitude.tally.used < 2 => format!(
                "it takes two usable attitude samples, and {} has {}",
                self.attitude.topic.as_deref().unwrap_or_default(),
                self.attitude.tally.describe()
            ),
            Quantity::RelativeRpy => format!(
                "no two attitude samples belong together (gaps between them: {}, resets: {})",
                self.breaks.gaps, self.breaks.resets
            ),
            Quantity::CameraVelocity => match self.source.why_missing(Kind::Velocity) {
                Some(reason) => reason.to_owned(),
                None => format!(
                    "of the velocity samples on {}, {}",
                    self.velocity.topic.as_deref().unwrap_or_default(),
                    self.velocity.tally.describe()
                ),
            },
        }
    }

    /// How the result was made, as its Metadata record says it.
    pub fn facts(&self) -> BTreeMap<String, String> {
        let Self {
            options, source, ..
        } = self;
        let profile_toml = toml::to_string(&source.profile);
        let mut facts = BTreeMap::from(
            [
                ("camera", CameraReport::from(self.camera).to_string()),
                ("max_gap_s", options.max_gap.seconds().to_string()),
                ("profile", source.profile.name.clone()),
                ("namespace", source.namespace.clone()),
                (
                    "profile_toml",
                    profile_toml.expect("a profile was read from TOML"),
                ),
                ("encoding", self.encoding.name.name().to_owned()),
                ("encoding_reason", self.encoding.reason.clone()),
                ("attitude_gaps", self.breaks.gaps.to_string()),
                ("attitude_resets", self.breaks.resets.to_string()),
            ]
            .map(|(key, fact)| (key.to_owned(), fact)),
        );
        match CameraReport::from(self.camera) {
            CameraReport::Stabilised {
                depression_deg,
                yaw_offset_deg,
            } => {
                facts.insert("depression_deg".to_owned(), depression_deg.to_string());
                facts.insert("yaw_offset_deg".to_owned(), yaw_offset_deg.to_string());
            }
            CameraReport::Fixed { mount_deg } => {
                let mount = mount_deg.map(|angle| angle.to_string()).join(",");
                facts.insert("mount_deg".to_owned(), mount);
            }
            CameraReport::Gimbal => {}
        }
        for (kind, samples) in self.samples() {
            let kind = kind.name();
            if let Some(topic) = &samples.topic {
                facts.insert(format!("{kind}_topic"), topic.clone());
            }
            facts.insert(format!("{kind}_used"), samples.tally.used.to_string());
            for (reason, count) in &samples.tally.dropped {
                let key = format!("{kind}_dropped_{}", reason.name());
                facts.insert(key, count.to_string());
            }
        }
        facts
    }

    /// The report on a result that was written to `output`.
    pub fn report(self, output: PathBuf, written: Written) -> Report {
        let log = &self.original.log;
        let has_messages = |quantity: &Quantity| written.messages.contains_key(quantity);
        let (present, missing): (Vec<Quantity>, Vec<Quantity>) =
            Quantity::ALL.into_iter().partition(has_messages);
        Report {
            notes: self.notes(&output, &written),
            input: log.file.path().into(),
            output,
            profile: ProfileReport::new(&self.source, &self.options.telemetry.profile),
            camera: self.camera.into(),
            max_gap_s: self.options.max_gap.seconds(),
            written: present
                .into_iter()
                .map(|quantity| WrittenTopic {
                    topic: quantity.topic(),
                    schema: self.encoding.name.schema(quantity).name,
                    messages: written.messages[&quantity],
                })
                .collect(),
            not_written: missing
                .into_iter()
                .map(|quantity| MissingTopic {
                    topic: quantity.topic(),
                    reason: self.why_missing(quantity),
                })
                .collect(),
            layout: self.options.layout,
            bytes_kept: written.kept,
            bytes_added: written.length - written.kept,
            complete: log.is_readable_to_its_end() && self.undecodable() == 0,
            encoding: self.encoding,
            attitude: self.attitude,
            velocity: self.velocity,
            gimbal: self.gimbal,
            breaks: self.breaks,
        }
    }

    /// What was read, by kind.
    fn samples(&self) -> impl Iterator<Item = (Kind, &SampleReport)> {
        let always = [
            (Kind::Attitude, &self.attitude),
            (Kind::Velocity, &self.velocity),
        ];
        let gimbal = self.gimbal.iter().map(|gimbal| (Kind::Gimbal, gimbal));
        always.into_iter().chain(gimbal)
    }

    /// Readings whose messages could not be read.
    fn undecodable(&self) -> u64 {
        self.samples()
            .flat_map(|(_, samples)| &samples.tally.dropped)
            .filter(|(reason, _)| reason.is_unreadable())
            .map(|(_, count)| count)
            .sum()
    }

    fn notes(&self, output: &Path, written: &Written) -> Vec<String> {
        let log = &self.original.log;
        let recovered = log.file.was_recovered().then(|| RECOVERED.to_owned());
        let replaced = self.original.undone.as_ref().ok();
        let replaced = replaced.map(|earlier| {
            format!("the log was enriched already ({earlier}); this result replaces that one")
        });
        let one_way = (self.options.layout == Layout::Interleaved)
            .then(|| "`flightcam restore` cannot undo the interleaved layout".to_owned());
        let end = match (log.breaks_off_at, log.scanned) {
            (Some(offset), _) if offset == log.file.length() => Some(
                "the log was never closed; all of its records were used, and the result is closed"
                    .to_owned(),
            ),
            (Some(_), _) => unread_end(log),
            (None, Some(ScanReason::NotClosed)) => Some(
                "the log does not end as a closed log does, but its data is whole; the result is closed"
                    .to_owned(),
            ),
            (None, Some(ScanReason::NoSummary)) => {
                Some("the log had no readable summary; the result has one".to_owned())
            }
            (None, Some(ScanReason::IncompleteSummary)) => Some(
                "the log's summary was incomplete or wrong; the result's is complete".to_owned(),
            ),
            (None, None) => None,
        };
        let loose = log.contents.has_loose_messages().then(|| {
            match self.options.layout {
                Layout::Append => {
                    "the log has messages outside chunks, which a chunk index would hide; \
                     the result has none, so seeking in it takes longer"
                }
                Layout::Interleaved => {
                    "the log has messages outside chunks; the result has them in chunks"
                }
            }
            .to_owned()
        });
        let undecodable = (self.undecodable() > 0)
            .then(|| "some messages do not decode as their schema says".to_owned());
        let unsure = written.checksum_was_wrong.then(|| {
            "the log's data does not have the checksum that the log says it has; the result has none"
                .to_owned()
        });
        let gimbal = self.source.role(Kind::Gimbal);
        let ignored = gimbal.filter(|_| self.gimbal.is_none()).map(|gimbal| {
            let (given, camera) = match self.camera {
                Camera::Fixed(_) => ("--mount", "bolted to the airframe"),
                _ => ("--depression", "held at that angle"),
            };
            format!(
                "the log has the gimbal's angles on {}; {given} was given and wins: the camera is {camera}",
                gimbal.topic
            )
        });
        let Statistics {
            message_start_time: start,
            message_end_time: end_time,
            ..
        } = log.contents.statistics;
        let is_elsewhere = |(earliest, latest): (u64, u64)| latest < start || earliest > end_time;
        let elsewhere = written.times.is_some_and(is_elsewhere).then(|| {
            "the times of the samples lie outside those of the log, so its player shows the new topics elsewhere; \
             --time says what the time of a sample is"
                .to_owned()
        });
        let suspicion = self.source.suspicion();
        let notes = [
            recovered,
            replaced,
            one_way,
            end,
            loose,
            undecodable,
            unsure,
            ignored,
            elsewhere,
            suspicion,
        ];
        let ros2 = ros2::notes(log, output, self.options.encoding, self.encoding.name);
        notes.into_iter().flatten().chain(ros2).collect()
    }
}
