//! What a log contains, before anything is written: which telemetry would be used, and what `enrich` would produce.
//!
//! Counts, times and gaps come from the log's summary and the telemetry's message indexes. Messages are read for
//! two things: which fields those of a JSON topic have, and what share of the telemetry is usable; for the latter
//! only a part of a long log. What viewers have trouble with is in the summary and in some message indexes.

mod first_sample;
mod sampled;
mod topics;
mod viewers;

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    path::{Path, PathBuf},
    sync::Arc,
};

use serde::{Serialize, Serializer};

use crate::{
    camera::{Camera, CameraError},
    clock::ClockStep,
    decode::{path::FieldPath, trial::UnmetFilter},
    derived::Quantity,
    error::Error,
    log::{Access, Log},
    messages::Format,
    options::Options,
    report::{CameraReport, MissingReason, MissingTopic, Note, ProfileReport, lossy},
    run::{Input, RunError},
    sample::{Kind, Tally, VelocityFrom},
    source::{
        Origin, ReadAs, RefusedFrames, RunnerUp, Source, UnmetCondition, error::Misfit,
        undecodable::UndecodableMessage,
    },
    text::Foreign,
    writer::original::Original,
};
pub use first_sample::FirstSample;
use sampled::Sampled;
pub use topics::{ListedTopic, TopicList, topics};
use viewers::viewer_warnings;
pub use viewers::{FarMessages, FastTopic, ViewerWarning};

/// What a log contains. Scripts read it as JSON, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// The log.
    #[serde(serialize_with = "lossy")]
    pub input: PathBuf,
    /// Its length in bytes.
    pub bytes: u64,
    /// How many messages it has.
    pub messages: u64,
    /// How many topics have messages.
    pub topics: usize,
    /// Log times of its first and last message, nanoseconds; absent if it has none.
    pub times: Option<[u64; 2]>,
    /// Whether all of it had to be read, because it has no summary that accounts for everything.
    pub scanned: bool,
    /// The telemetry, if `enrich` would find it.
    pub telemetry: Option<Telemetry>,
    /// Why `enrich` would fail, if it would.
    pub problem: Option<Problem>,
    /// The topics that are not telemetry, by kind.
    pub other_topics: Vec<TopicGroup>,
    /// What viewers such as Foxglove have trouble with in the log.
    pub viewer_warnings: Vec<ViewerWarning>,
    /// Other things the user should know.
    pub notes: Vec<Note>,
}

/// Why something would fail. In JSON it is the error's message.
#[derive(Debug, Clone)]
pub struct Problem(pub(crate) Arc<Error>);

impl Problem {
    /// The error that it would fail with.
    pub fn error(&self) -> &Error {
        &self.0
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl PartialEq for Problem {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl Serialize for Problem {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The telemetry that would be used.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Telemetry {
    /// How the log names it.
    pub profile: ProfileReport,
    /// The prefix of the vehicle's topics; empty if they have none.
    pub namespace: Foreign,
    /// The other profiles that were tried, the better ones first.
    pub runners_up: Vec<RunnerUp>,
    /// How the camera is mounted; absent if that is not known.
    pub camera: Option<CameraReport>,
    /// Where each kind of sample comes from, or why there is none.
    pub roles: BTreeMap<Kind, RoleReport>,
    /// What the velocity would be taken from.
    pub velocity_from: VelocityFrom,
    /// What `enrich` would write.
    pub would_write: Vec<Planned>,
    /// What it could not write.
    pub would_not_write: Vec<MissingTopic>,
}

/// One kind of sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum RoleReport {
    /// There are messages with it.
    Found(Box<FoundRole>),
    /// There are none.
    Missing {
        /// Why.
        missing: Misfit,
    },
}

/// The messages that one kind of sample is read from.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct FoundRole {
    /// Their topic.
    pub topic: Foreign,
    /// The fields that are read.
    pub fields: Vec<FieldPath>,
    /// How they are encoded.
    pub encoding: Foreign,
    /// Their type.
    pub schema: Foreign,
    /// How many there are.
    pub messages: u64,
    /// Log times of the first and the last, nanoseconds.
    pub times: [u64; 2],
    /// Messages per second between these; absent for a single moment.
    pub rate_hz: Option<f64>,
    /// The longest time between two, seconds; absent for a single message.
    pub largest_gap_s: Option<f64>,
    /// How many of them were read to learn whether they are usable: all, or an even sample of a long log.
    pub read: u64,
    /// How many of those were usable, how many were not, for which reason, and how many were of another source.
    #[serde(flatten)]
    pub tally: Tally,
    /// In which axes and units they were read, and why; more than one if messages differ.
    pub read_as: Vec<ReadAs>,
    /// The frames for which samples were dropped.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub refused_frames: Vec<RefusedFrames>,
    /// What conditions found in the messages that they left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unmet_conditions: Vec<UnmetCondition>,
    /// The earliest of those that could not be decoded.
    pub first_undecodable: Option<UndecodableMessage>,
    /// The filters that held for none of those, and what their fields have instead.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unmet_filters: Vec<UnmetFilter>,
    /// The share of the source's own that were not usable, 0 to 1.
    pub share_invalid: f64,
    /// The first usable one that was read.
    pub first: Option<FirstSample>,
}

impl FoundRole {
    /// Describes a role of a source whose messages were logged at these times, by channel, each channel's in order.
    fn new(
        log: &Log,
        source: &Source,
        (kind, role): (Kind, &Origin),
        times: &BTreeMap<u16, Vec<u64>>,
        sampled: &Sampled,
    ) -> Self {
        let tally = &sampled.tallies[kind];
        let of_topic = || {
            log.contents
                .channels_with_messages()
                .filter(|(channel, _)| role.topic == channel.topic)
        };
        let (channel, _) = of_topic().next().expect("a role has a channel");
        let schema = log.contents.schema_of(channel);
        let of_topic = of_topic().filter_map(|(channel, _)| times.get(&channel.id));
        let mut times: Vec<u64> = of_topic.flatten().copied().collect();
        times.sort_unstable();
        let [start, end] = [times.first(), times.last()].map(|time| time.copied().unwrap_or(0));
        let seconds = (end - start) as f64 / 1e9;
        let gaps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let read = tally.total_with_unselected();
        Self {
            topic: role.topic.clone(),
            fields: role.fields.clone(),
            encoding: (&channel.message_encoding).into(),
            schema: schema.map_or("", |schema| schema.name.as_str()).into(),
            messages: times.len() as u64,
            times: [start, end],
            rate_hz: (seconds > 0.0).then(|| (times.len() - 1) as f64 / seconds),
            largest_gap_s: gaps.max().map(|gap| gap as f64 / 1e9),
            read,
            tally: tally.clone(),
            read_as: source.read_as(kind),
            refused_frames: source.refused_frames(kind),
            unmet_conditions: source.unmet_conditions(kind).1,
            first_undecodable: source.undecodable(kind),
            unmet_filters: source.unmet_filters(kind),
            share_invalid: match tally.total() {
                0 => 0.0,
                total => (total - tally.used) as f64 / total as f64,
            },
            first: sampled.first.get(&kind).map(FirstSample::from),
        }
    }

    /// How many of the messages can be usable.
    fn usable_at_most(&self) -> u64 {
        // A damaged index may list fewer than there are.
        self.messages.saturating_sub(self.read - self.tally.used)
    }
}

/// A topic that `enrich` would write.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Planned {
    /// Its name.
    pub topic: &'static str,
    /// The full name of its message type.
    pub schema: &'static str,
    /// How its messages would be encoded.
    pub encoding: &'static str,
    /// How many there can be at most.
    pub at_most: u64,
}

/// Topics whose message types belong together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct TopicGroup {
    /// The package of their message types, or the only type.
    pub schemas: Foreign,
    /// How their messages are encoded.
    pub encoding: Foreign,
    /// How many messages they have.
    pub messages: u64,
    /// Their names.
    pub topics: BTreeSet<Foreign>,
}

/// Looks at a log as [`enrich`](crate::enrich()) would with these options.
///
/// # Errors
/// The log cannot be read or is changed meanwhile, or the options contradict each other. Telemetry that is not found is
/// not an error but a finding.
pub fn inspect<'a>(input: impl Into<Input<'a>>, options: &Options) -> Result<Inspection, Error> {
    let original = Original::of(Log::read(input.into().open(Access::Read, &options.watch)?)?)?;
    let mut problem = original
        .check_are_free(options.topics())
        .err()
        .map(Error::from);
    let log = original.log;
    let notes = [
        Note::on_recovery(&log),
        (original.undone.ok()).map(|earlier| Note::OriginalInspected { earlier }),
        Note::on_lost_end(&log),
    ];
    let mut notes: Vec<Note> = notes.into_iter().flatten().collect();
    let mut telemetry = None;
    match Source::compare(&log, &options.telemetry) {
        Ok(mut source) => {
            let (found, clock_steps) = Telemetry::describe(&log, &mut source, options)?;
            notes.extend(Note::on_clock_steps(&clock_steps));
            notes.extend(Note::on_passed_over(&source));
            notes.extend(Note::on_suspicious_angle(&source, &options.telemetry));
            notes.extend(Note::on_unmet_conditions(&source));
            let mixed = source.check_sources(&log, &options.telemetry);
            let mixed = mixed.and_then(|()| source.check_angles(&log, &options.telemetry));
            let mixed = mixed.err().map(Error::from);
            problem = problem
                .or(mixed)
                .or_else(|| found.why_nothing(log.file.path()));
            telemetry = Some(found);
        }
        Err(error) => problem = problem.or(Some(error.into())),
    }
    if let Some(error) = problem.take_if(|error| error.is_of_reading()) {
        return Err(error);
    }
    let viewer_warnings = viewer_warnings(&log)?;
    notes.extend(Note::on_growth(log.file.grown_by()?));
    let statistics = &log.contents.statistics;
    let names: BTreeSet<&str> = log
        .contents
        .channels_with_messages()
        .map(|(channel, _)| channel.topic.as_str())
        .collect();
    let used = telemetry.iter().flat_map(Telemetry::topics).collect();
    Ok(Inspection {
        input: log.file.path().into(),
        bytes: log.file.length(),
        messages: statistics.message_count,
        topics: names.len(),
        times: (statistics.message_count > 0)
            .then_some([statistics.message_start_time, statistics.message_end_time]),
        scanned: log.scanned.is_some(),
        other_topics: group_topics(&log, &used),
        telemetry,
        problem: problem.map(|error| Problem(Arc::new(error))),
        viewer_warnings,
        notes,
    })
}

impl Telemetry {
    /// Describes the telemetry, and says where its time goes back.
    fn describe(
        log: &Log,
        source: &mut Source,
        options: &Options,
    ) -> Result<(Self, Vec<ClockStep>), Error> {
        let camera = match options.camera(source) {
            Ok(camera) => Some(camera),
            Err(CameraError::Unknown) => None,
            Err(contradiction) => return Err(contradiction.into()),
        };
        let sampled = Sampled::read(log, source)?;
        let clock_steps = sampled.clock_steps(log, source)?;
        let times = log.message_times(&source.channel_ids())?;
        let roles = source.roles().into_iter();
        let roles = roles.filter(|(kind, _)| Kind::USUAL.contains(kind));
        let roles = roles.map(|(kind, role)| {
            let role = match role {
                Ok(role) => {
                    let found = FoundRole::new(log, source, (kind, role), &times, &sampled);
                    RoleReport::Found(Box::new(found))
                }
                Err(misfit) => RoleReport::Missing {
                    missing: misfit.clone(),
                },
            };
            (kind, role)
        });
        let mut telemetry = Self {
            profile: ProfileReport::new(source, options),
            namespace: source.namespace().into(),
            runners_up: source.runners_up.clone(),
            camera: camera.map(CameraReport::from),
            roles: roles.collect(),
            velocity_from: options.telemetry.velocity_from,
            would_write: Vec::new(),
            would_not_write: Vec::new(),
        };
        let encoding = Format::choose(options.encoding, source.attitude_channel(log)).encoding;
        for quantity in Quantity::ALL {
            let topic = quantity.topic();
            match telemetry.at_most(quantity, camera) {
                Ok(at_most) => telemetry.would_write.push(Planned {
                    topic,
                    schema: encoding.schema(quantity).name,
                    encoding: encoding.message_encoding(),
                    at_most,
                }),
                Err(reason) => (telemetry.would_not_write).push(MissingTopic {
                    topic,
                    positions: telemetry.positions_instead(&reason),
                    reason: *reason,
                }),
            }
        }
        Ok((telemetry, clock_steps))
    }

    /// How many messages of a quantity there can be, or why there can be none.
    fn at_most(
        &self,
        quantity: Quantity,
        camera: Option<Camera>,
    ) -> Result<u64, Box<MissingReason>> {
        if camera == Some(Camera::Gimbal) {
            self.usable(Kind::Gimbal, 1)?;
        }
        let mut at_most = 0;
        for &(kind, needed) in quantity.needs() {
            let (kind, needed) = match kind {
                Kind::Velocity => (self.velocity_from.kind(), self.velocity_from.needed()),
                kind => (kind, needed),
            };
            at_most = self.usable(kind, needed)? - (needed - 1);
        }
        Ok(at_most)
    }

    /// The topic of positions from which the velocity could be taken, if that is missing.
    fn positions_instead(&self, missing: &MissingReason) -> Option<Foreign> {
        let RoleReport::Found(positions) = &self.roles[&Kind::Position] else {
            return None;
        };
        let are_enough = positions.tally.used >= VelocityFrom::Position.needed();
        let is_missing = missing.is_about(Kind::Velocity);
        (is_missing && are_enough).then(|| positions.topic.clone())
    }

    /// How many samples of a kind can be usable, if that is enough.
    fn usable(&self, kind: Kind, needed: u64) -> Result<u64, Box<MissingReason>> {
        match &self.roles[&kind] {
            RoleReport::Found(found) if found.usable_at_most() >= needed => {
                Ok(found.usable_at_most())
            }
            RoleReport::Found(found) => Err(Box::new(MissingReason::TooFewUsable {
                sample: kind,
                needed,
                topic: found.topic.clone(),
                tally: found.tally.clone(),
                refused_frames: found.refused_frames.clone(),
                first_undecodable: found.first_undecodable.clone().map(Box::new),
                unmet_filters: found.unmet_filters.clone(),
                conditions: found.unmet_conditions.clone(),
            })),
            RoleReport::Missing { missing } => Err(Box::new(MissingReason::NoSamples {
                sample: kind,
                misfit: missing.clone(),
            })),
        }
    }

    /// The error of [`enrich`](crate::enrich()) if there would be nothing to write.
    fn why_nothing(&self, input: &Path) -> Option<Error> {
        (self.would_write.is_empty()).then(|| {
            RunError::NothingDerived {
                path: input.into(),
                missing: self.would_not_write.clone(),
            }
            .into()
        })
    }

    fn topics(&self) -> impl Iterator<Item = &str> {
        let is_read =
            |kind: Kind| kind != Kind::Velocity || self.velocity_from == VelocityFrom::Messages;
        let roles = self.roles.iter().filter(move |(kind, _)| is_read(**kind));
        roles.filter_map(|(_, role)| match role {
            RoleReport::Found(found) => Some(found.topic.as_str()),
            RoleReport::Missing { .. } => None,
        })
    }
}

fn group_topics(log: &Log, used: &BTreeSet<&str>) -> Vec<TopicGroup> {
    let mut groups: BTreeMap<(String, String), TopicGroup> = BTreeMap::new();
    for (channel, count) in log
        .contents
        .channels_with_messages()
        .filter(|(channel, _)| !used.contains(channel.topic.as_str()))
    {
        let name = log
            .contents
            .schema_of(channel)
            .map_or("", |schema| schema.name.as_str());
        let package = name
            .split_once(['.', '/'])
            .map_or(name, |(package, _)| package);
        let key = (package.to_owned(), channel.message_encoding.clone());
        let group = groups
            .entry(key)
            .or_insert_with_key(|(schemas, encoding)| TopicGroup {
                schemas: schemas.into(),
                encoding: encoding.into(),
                messages: 0,
                topics: BTreeSet::new(),
            });
        group.messages += count;
        group.topics.insert((&channel.topic).into());
    }
    groups.into_values().collect()
}
