//! What was found in a log, and the report on it.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use mcap::records::Statistics;

use super::{
    CameraReport, EncodingReport, MissingReason, MissingTopic, Note, ProfileReport, Report,
    SampleReport, VisualsReport, WrittenTopic, ros2,
};
use crate::{
    camera::Camera,
    check::{Oddity, Recorder},
    clock::ClockStep,
    derived::Quantity,
    log::{Log, ScanReason},
    messages::{Format, Topic},
    options::Options,
    reader::ReadOut,
    sample::{Kind, Tally, VelocityFrom},
    source::{Source, calibration::LogCalibration, undecodable::UndecodableMessage},
    text::Foreign,
    transform::{Breaks, Motion, Outcome},
    visuals::{Flight, StagedFlight},
    writer::{Layout, Written, original::Original},
};

/// What is known when all telemetry has been read and all values derived from it.
pub struct Derivation {
    /// Where the telemetry is, and what was noticed in its messages.
    pub source: Source,
    /// What became of all samples.
    pub outcome: Outcome,
    /// Where the times of messages go back.
    pub clock_steps: Vec<ClockStep>,
    /// What is needed of the samples to judge how they were read.
    pub recorder: Box<Recorder>,
    /// The flight at regular times, if it was to be recorded.
    pub flight: Option<Flight>,
}

impl Derivation {
    /// Of what was read, and what the transform made of it.
    pub fn new(
        read: ReadOut,
        mut outcome: Outcome,
        recorder: Box<Recorder>,
        flight: Option<Flight>,
    ) -> Self {
        outcome.tallies.merge(&read.dropped);
        Self {
            source: read.source,
            outcome,
            clock_steps: read.clock_steps,
            recorder,
            flight,
        }
    }
}

/// What was found in a log, once all of its telemetry was read.
pub struct Findings<'a> {
    original: &'a Original,
    pub(super) options: &'a Options,
    pub(super) source: Source,
    pub(super) encoding: EncodingReport,
    pub(super) format: Format,
    pub(super) samples: BTreeMap<Kind, SampleReport>,
    pub(super) camera: Camera,
    pub(super) breaks: Breaks,
    pub(super) motion: Motion,
    clock_steps: Vec<ClockStep>,
    /// The topic of usable positions, if there is no usable velocity.
    positions: Option<Foreign>,
    oddities: Vec<Oddity>,
    /// The flight that viewers are shown.
    pub(super) staged: Option<Arc<StagedFlight>>,
    /// The log's calibration, if that says what the camera sees.
    pub(super) calibration: Option<LogCalibration>,
}

impl<'a> Findings<'a> {
    pub fn new(
        original: &'a Original,
        options: &'a Options,
        camera: Camera,
        encoding: EncodingReport,
        format: Format,
        derivation: Derivation,
    ) -> Self {
        let Derivation {
            source,
            outcome:
                Outcome {
                    tallies,
                    breaks,
                    motion,
                },
            clock_steps,
            ..
        } = derivation;
        let kinds = options.needed_kinds(camera).into_iter();
        let read = kinds.map(|kind| (kind, SampleReport::new(&source, &tallies, kind)));
        let mut samples: BTreeMap<Kind, SampleReport> = read.collect();
        samples.entry(Kind::Velocity).or_insert_with(|| {
            let from = options.telemetry.velocity_from.kind();
            SampleReport::derived(from, tallies[Kind::Velocity].clone())
        });
        Self {
            original,
            options,
            encoding,
            format,
            staged: None,
            calibration: None,
            samples,
            camera,
            breaks,
            motion,
            clock_steps,
            oddities: Vec::new(),
            source,
            positions: None,
        }
    }

    /// Looks whether the log has usable positions, if it has no usable velocity. If they cannot be read, it has none.
    pub fn with_positions(self, telemetry: &Log) -> Self {
        let request = &self.options.telemetry;
        let velocities = &self.samples[&Kind::Velocity].tally;
        let mut reasons = velocities.dropped.keys();
        let positions = match request.velocity_from {
            VelocityFrom::Messages
                if velocities.used == 0 && !reasons.any(|reason| reason.is_for_want_of_pose()) =>
            {
                let positions = self.source.usable_positions(telemetry, request);
                positions.ok().flatten()
            }
            _ => None,
        };
        Self { positions, ..self }
    }

    /// A quantity that has no messages.
    pub fn missing(&self, quantity: Quantity) -> MissingTopic {
        let reason = self.why_missing(quantity);
        MissingTopic {
            topic: quantity.topic(),
            positions: (self.positions.clone()).filter(|_| reason.is_about(Kind::Velocity)),
            reason,
        }
    }

    /// The same with what is odd about the samples, but may be right.
    pub fn with(self, oddities: Vec<Oddity>) -> Self {
        Self { oddities, ..self }
    }

    /// The same with the flight that viewers are shown, and what became of the samples that are only shown.
    pub fn showing(
        mut self,
        staged: Option<Arc<StagedFlight>>,
        calibration: Option<LogCalibration>,
    ) -> Self {
        let derived_from = self.options.telemetry.velocity_from.kind();
        let flight = staged.iter().map(|staged| &staged.flight);
        let shown = flight.flat_map(|flight| {
            [
                (Kind::Position, &flight.positions),
                (Kind::Height, &flight.heights),
            ]
        });
        for (kind, tally) in shown.filter(|(kind, _)| *kind != derived_from) {
            if let Some(samples) = self.samples.get_mut(&kind) {
                samples.tally.merge(tally);
            }
        }
        Self {
            staged,
            calibration,
            ..self
        }
    }

    /// Why a quantity has no messages, if it has none.
    fn why_missing(&self, quantity: Quantity) -> MissingReason {
        // Check the last kind first: each value comes from one of its samples.
        for &(kind, needed) in quantity.needs().iter().rev() {
            if let Some(from) = self.samples[&kind].derived_from {
                if let Some(misfit) = self.source.why_missing(from) {
                    return MissingReason::NoSamples {
                        sample: from,
                        misfit: misfit.clone(),
                    };
                }
                if self.samples[&from].tally.used == 0 {
                    let needed = self.options.telemetry.velocity_from.needed();
                    return self.too_few_usable(from, needed);
                }
            } else if let Some(misfit) = self.source.why_missing(kind) {
                return MissingReason::NoSamples {
                    sample: kind,
                    misfit: misfit.clone(),
                };
            }
            if self.samples[&kind].tally.used < needed {
                return self.too_few_usable(kind, needed);
            }
        }
        MissingReason::NoneAdjacent {
            gaps: self.breaks.gaps,
            resets: self.breaks.resets,
            clock_steps: self.breaks.clock_steps,
        }
    }

    fn too_few_usable(&self, kind: Kind, needed: u64) -> MissingReason {
        let samples = &self.samples[&kind];
        MissingReason::TooFewUsable {
            sample: kind,
            needed,
            topic: samples.topic.clone().unwrap_or_default(),
            tally: samples.tally.clone(),
            refused_frames: samples.refused_frames.clone(),
            first_undecodable: self.source.undecodable(kind).map(Box::new),
            unmet_filters: self.source.unmet_filters(kind),
            conditions: self.source.unmet_conditions(kind).1,
        }
    }

    /// The report on a result that was written to `output`, while the log grew by that many bytes.
    pub fn report(self, output: PathBuf, written: Written, grown_by: u64) -> Report {
        let log = &self.original.log;
        let written_topic = |(&topic, &messages): (&Topic, &u64)| {
            let definition = self.format.definition(topic)?;
            Some(WrittenTopic {
                topic: topic.name(),
                schema: definition.name,
                messages,
                field_to_plot: definition.field_to_plot,
            })
        };
        let missing = (Quantity::ALL.into_iter())
            .filter(|&quantity| !written.messages.contains_key(&Topic::Derived(quantity)));
        let mut not_written: Vec<MissingTopic> =
            missing.map(|quantity| self.missing(quantity)).collect();
        let visuals = self.staged.as_deref().zip(self.options.visuals.as_ref());
        if let Some((staged, _)) = visuals {
            not_written.extend(self.not_shown(staged, &written));
        }
        Report {
            notes: self.notes(&output, &written, grown_by),
            visuals: visuals.map(|(staged, options)| {
                let heights = self.source.topic_of(Kind::Height);
                let of_profile = self.options.field_of_view_from(&self.source.profile);
                VisualsReport::new(
                    options,
                    staged,
                    heights,
                    of_profile.is_some(),
                    self.calibration.as_ref(),
                )
            }),
            written: written.messages.iter().filter_map(written_topic).collect(),
            not_written,
            input: log.file.path().into(),
            output,
            profile: ProfileReport::new(&self.source, self.options),
            camera: self.camera.into(),
            max_gap_s: self.options.max_gap.seconds(),
            layout: self.options.layout,
            bytes_kept: written.kept,
            bytes_added: written.length.cast_signed() - log.file.own_length().cast_signed(),
            complete: log.is_readable_to_its_end() && self.undecodable() == 0 && grown_by == 0,
            encoding: self.encoding,
            samples: self.samples,
            breaks: self.breaks,
            motion: self.motion,
            min_interval_s: self.options.min_interval.seconds(),
        }
    }

    /// Samples whose messages could not be read.
    fn undecodable(&self) -> u64 {
        let tallies = self.samples.values().map(|samples| &samples.tally);
        tallies.map(Tally::unreadable).sum()
    }

    /// The earliest message that could not be read.
    fn first_undecodable(&self) -> Option<UndecodableMessage> {
        let kinds = self.samples.keys();
        let of_kinds = kinds.filter_map(|&kind| self.source.undecodable(kind));
        of_kinds.min_by_key(|message| message.log_time)
    }

    fn notes(&self, output: &Path, written: &Written, grown_by: u64) -> Vec<Note> {
        let log = &self.original.log;
        let layout = self.options.layout;
        let replaced = self.original.undone.as_ref().ok();
        let undecodable = self.undecodable();
        let notes = [
            Note::on_recovery(log),
            replaced.map(|earlier| Note::Replaced {
                earlier: earlier.clone(),
            }),
            (layout == Layout::Interleaved).then_some(Note::CannotBeUndone),
            self.note_on_end(),
            Note::on_growth(grown_by),
            (log.contents.has_loose_messages()).then_some(Note::LooseMessages { layout }),
            (undecodable > 0).then_some(Note::Undecodable {
                samples: undecodable,
                first: self.first_undecodable(),
            }),
            written.checksum_was_wrong.then_some(Note::ChecksumWrong),
            self.note_on_ignored_gimbal(),
            self.note_on_times(written),
            Note::on_clock_steps(&self.clock_steps),
            Note::on_suspicious_angle(&self.source, &self.options.telemetry),
        ];
        let odd = self.oddities.iter().filter_map(Note::on_oddity);
        let unmet = Note::on_unmet_conditions(&self.source);
        let passed_over = Note::on_passed_over(&self.source);
        let ros2 = ros2::notes(log, output, self.options.encoding, self.encoding.name);
        notes
            .into_iter()
            .flatten()
            .chain(odd)
            .chain(unmet)
            .chain(passed_over)
            .chain(ros2)
            .collect()
    }

    fn note_on_end(&self) -> Option<Note> {
        let log = &self.original.log;
        match (log.breaks_off_at, log.scanned) {
            (Some(offset), _) if offset == log.file.length() => Some(Note::NeverClosed),
            (Some(_), _) => Note::on_lost_end(log),
            (None, Some(ScanReason::NotClosed)) => Some(Note::NotClosedButWhole),
            (None, Some(ScanReason::NoSummary)) => Some(Note::SummaryMissing),
            (None, Some(ScanReason::IncompleteSummary)) => Some(Note::SummaryIncomplete),
            (None, None) => None,
        }
    }

    fn note_on_ignored_gimbal(&self) -> Option<Note> {
        if self.camera == Camera::Gimbal {
            return None;
        }
        let gimbal = self.source.role(Kind::Gimbal)?;
        Some(Note::GimbalIgnored {
            topic: gimbal.topic.clone(),
            camera: CameraReport::from(self.camera),
            by_profile: self.options.leaves_camera_to(&self.source.profile),
        })
    }

    fn note_on_times(&self, written: &Written) -> Option<Note> {
        let (earliest, latest) = written.times?;
        let Statistics {
            message_start_time: start,
            message_end_time: end,
            ..
        } = self.original.log.contents.statistics;
        (latest < start || earliest > end).then_some(Note::TimesOutsideLog)
    }
}
