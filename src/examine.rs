//! Whether a log's own numbers bear out how it is read: all of its telemetry is read, and its series are compared with
//! each other.

use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

use serde::{Serialize, Serializer};

use crate::{
    check::{Claims, Findings, Recorder},
    enrich::{claims::claims, stream},
    error::Error,
    geometry::DepressionAngle,
    inspect::Problem,
    log::Log,
    options::Options,
    reader::Reader,
    report::{Note, ProfileReport, SampleReport},
    run::{Input, Left, Run, Stopped},
    sample::{Kind, Tallies},
    source::{Origin, Source, WrittenQuaternion, request::HowAsked, stream_filter::StreamFilter},
};

/// What a log's own numbers say about how it is read. Scripts read it as JSON, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CheckReport {
    /// The log.
    #[serde(serialize_with = "crate::report::lossy")]
    pub input: PathBuf,
    /// How the log names its telemetry.
    pub profile: ProfileReport,
    /// What became of the samples of each kind that the log has.
    #[serde(flatten, serialize_with = "by_kind")]
    pub samples: BTreeMap<Kind, SampleReport>,
    /// Where each kind comes from.
    #[serde(skip)]
    pub origins: BTreeMap<Kind, Origin>,
    /// How each kind was asked for, which is where to change it.
    #[serde(skip)]
    pub asked: BTreeMap<Kind, HowAsked>,
    /// How the attitude is written, if it is a quaternion.
    #[serde(skip)]
    pub quaternion: Option<WrittenQuaternion>,
    /// Whether something is certainly read wrongly.
    pub contradicted: bool,
    /// What was found.
    #[serde(flatten)]
    pub findings: Findings,
    /// What makes `enrich` refuse the log, if something does.
    pub problem: Option<Problem>,
    /// Whether everything in the input could be read.
    pub complete: bool,
    /// Other things the user should know.
    pub notes: Vec<Note>,
}

/// Checks whether a log's own numbers bear out how it is read with these options. Nothing is written.
///
/// # Errors
/// The log cannot be read, its telemetry is not found or is ambiguous, or the options contradict each other.
pub fn check<'a>(input: impl Into<Input<'a>>, options: &Options) -> Result<CheckReport, Error> {
    let input = input.into();
    let run = Run::new(&options.watch, input.name().into(), Left::Nothing);
    run.run_watched(|| {
        let log = stream::telemetry(input, StreamFilter::for_check, options, &run)?;
        examine(&log, options, &run)
    })
}

/// The series of one epoch.
#[derive(Default)]
struct Epoch {
    number: u32,
    samples: u64,
    recorder: Recorder,
}

fn examine(log: &Log, options: &Options, run: &Run) -> Result<CheckReport, Stopped> {
    let source = Source::select_for_check(log, &options.telemetry)?;
    let reader = Reader::new(log, source)?;
    let total = reader.bytes_total();
    run.expect(total);
    let mut used = Tallies::default();
    // What the clock was set back between has nothing to do with each other: the longest epoch is judged.
    let (mut epoch, mut longest) = (Epoch::default(), Epoch::default());
    let read = reader.for_each(|arrival| {
        if arrival.epoch != epoch.number {
            let next = Epoch {
                number: arrival.epoch,
                ..Epoch::default()
            };
            let ended = std::mem::replace(&mut epoch, next);
            if ended.samples > longest.samples {
                longest = ended;
            }
        }
        epoch.samples += 1;
        used[arrival.sample.kind()].used += 1;
        epoch.recorder.push(&arrival.sample);
        run.read(arrival.bytes_read);
        run.go_on().map_err(Stopped::from)
    })?;
    if epoch.samples > longest.samples {
        longest = epoch;
    }
    run.read(total);
    let source = read.source;
    used.merge(&read.dropped);
    source.check_sources(log, &options.telemetry)?;
    let problem = source.check_angles(log, &options.telemetry).err();
    let claims = Claims {
        depression: (options.mounting(&source.profile).0).map(DepressionAngle::radians),
        ..claims(log, &source)
    };
    let findings = longest.recorder.judge(&claims);
    let kinds = || Kind::CHECKED.into_iter();
    let grown_by = log.file.grown_by()?;
    let unreadable: u64 = kinds().map(|kind| used[kind].unreadable()).sum();
    let notes = [
        Note::on_recovery(log),
        Note::on_lost_end(log),
        Note::on_growth(grown_by),
        Note::on_clock_steps(&read.clock_steps),
    ];
    Ok(CheckReport {
        input: log.file.path().into(),
        profile: ProfileReport::new(&source, options),
        samples: kinds()
            .map(|kind| (kind, SampleReport::new(&source, &used, kind)))
            .collect(),
        origins: kinds()
            .filter_map(|kind| Some((kind, source.role(kind)?.clone())))
            .collect(),
        asked: kinds()
            .map(|kind| (kind, options.telemetry.how_asked(kind, &source.profile)))
            .collect(),
        quaternion: source.quaternion(Kind::Attitude),
        contradicted: findings.is_contradicted() || problem.is_some(),
        findings,
        problem: problem.map(|problem| Problem(Arc::new(problem.into()))),
        complete: log.is_readable_to_its_end() && unreadable == 0 && grown_by == 0,
        notes: notes.into_iter().flatten().collect(),
    })
}

/// Serialises the kinds, each under its name; null for one that the log does not have.
fn by_kind<S: Serializer>(
    samples: &BTreeMap<Kind, SampleReport>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let of_log = |kind: &Kind| samples.get(kind).filter(|report| report.topic.is_some());
    serializer.collect_map(Kind::CHECKED.into_iter().map(|kind| (kind, of_log(&kind))))
}
