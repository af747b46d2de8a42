//! What a run found and did, for people, for scripts, and for the result's own Metadata record.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::{Serialize, Serializer};

use crate::{
    derived::Quantity,
    log::{Log, ScanReason},
    messages,
    options::Options,
    sample::{Kind, Tallies, Tally},
    source::{RoleSource, Source, profile::ProfileChoice},
    transform::{Breaks, Outcome},
    writer::Appended,
};

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
    /// The depression angle, degrees below the horizon.
    pub depression_deg: f64,
    /// The longest time between two attitude samples that belong together, seconds.
    pub max_gap_s: f64,
    /// What became of the attitude samples.
    pub attitude: SampleReport,
    /// What became of the velocity samples.
    pub velocity: SampleReport,
    /// How often the chain of attitude samples broke.
    pub breaks: Breaks,
    /// The topics that the result has and the log had not.
    pub written: Vec<WrittenTopic>,
    /// The topics that it could have had.
    pub not_written: Vec<MissingTopic>,
    /// Bytes taken over from the log as they were.
    pub bytes_copied: u64,
    /// Bytes behind them.
    pub bytes_appended: u64,
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

/// What was found in a log, once all of its telemetry was read.
pub(crate) struct Findings<'a> {
    log: &'a Log,
    options: &'a Options,
    source: Source,
    attitude: SampleReport,
    velocity: SampleReport,
    breaks: Breaks,
}

impl<'a> Findings<'a> {
    pub fn new(
        log: &'a Log,
        options: &'a Options,
        source: Source,
        dropped: &Tallies,
        outcome: Outcome,
    ) -> Self {
        let mut tallies = outcome.tallies;
        tallies.merge(dropped);
        Self {
            log,
            options,
            attitude: SampleReport::new(&source, &tallies, Kind::Attitude),
            velocity: SampleReport::new(&source, &tallies, Kind::Velocity),
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
                describe(&self.attitude.tally)
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
                    describe(&self.velocity.tally)
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
                ("depression_deg", options.depression.degrees().to_string()),
                ("max_gap_s", options.max_gap.seconds().to_string()),
                ("profile", source.profile.name.clone()),
                (
                    "profile_toml",
                    profile_toml.expect("a profile was read from TOML"),
                ),
                ("attitude_gaps", self.breaks.gaps.to_string()),
                ("attitude_resets", self.breaks.resets.to_string()),
            ]
            .map(|(key, fact)| (key.to_owned(), fact)),
        );
        for (kind, samples) in [("attitude", &self.attitude), ("velocity", &self.velocity)] {
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
    pub fn report(self, output: PathBuf, appended: Appended) -> Report {
        let has_messages = |quantity: &Quantity| appended.messages.contains_key(quantity);
        let (written, missing): (Vec<Quantity>, Vec<Quantity>) =
            Quantity::ALL.into_iter().partition(has_messages);
        let reason = self.source.role(Kind::Attitude).map(RoleSource::reason);
        let reason = reason.unwrap_or_default();
        Report {
            input: self.log.file.path().into(),
            output,
            profile: ProfileReport {
                name: self.source.profile.name.clone(),
                reason: match self.options.telemetry.profile {
                    ProfileChoice::Automatic => format!("chosen because {reason}"),
                    ProfileChoice::Given(_) => format!("as asked for; {reason}"),
                },
            },
            depression_deg: self.options.depression.degrees(),
            max_gap_s: self.options.max_gap.seconds(),
            written: written
                .into_iter()
                .map(|quantity| WrittenTopic {
                    topic: quantity.topic(),
                    schema: messages::schema(quantity).name,
                    messages: appended.messages[&quantity],
                })
                .collect(),
            not_written: missing
                .into_iter()
                .map(|quantity| MissingTopic {
                    topic: quantity.topic(),
                    reason: self.why_missing(quantity),
                })
                .collect(),
            bytes_copied: appended.copied,
            bytes_appended: appended.appended,
            complete: self.log.is_readable_to_its_end() && self.undecodable() == 0,
            notes: self.notes(),
            attitude: self.attitude,
            velocity: self.velocity,
            breaks: self.breaks,
        }
    }

    /// Readings whose messages did not decode.
    fn undecodable(&self) -> u64 {
        [&self.attitude.tally, &self.velocity.tally]
            .into_iter()
            .flat_map(|tally| &tally.dropped)
            .filter(|(reason, _)| reason.is_unreadable())
            .map(|(_, count)| count)
            .sum()
    }

    fn notes(&self) -> Vec<String> {
        let log = self.log;
        let end = match (log.breaks_off_at, log.scanned) {
            (Some(offset), _) if offset == log.file.len() => Some(
                "the log was never closed; all of its records were used, and the result is closed"
                    .to_owned(),
            ),
            (Some(offset), _) => {
                let lost = log.file.len() - offset;
                Some(format!(
                    "the log breaks off at byte {offset}; the {lost} bytes from there on are not readable"
                ))
            }
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
            "the log has messages outside chunks, which a chunk index would hide; \
             the result has none, so seeking in it takes longer"
                .to_owned()
        });
        let undecodable = (self.undecodable() > 0)
            .then(|| "some messages do not decode as their schema says".to_owned());
        let notes = [end, loose, undecodable, self.source.suspicion()];
        notes.into_iter().flatten().collect()
    }
}

/// A path for JSON, which cannot hold every file name that a system allows.
fn lossy<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}

/// A tally in words.
fn describe(tally: &Tally) -> String {
    let mut words = vec![format!("{} of {} usable", tally.used, tally.total())];
    for (reason, count) in &tally.dropped {
        words.push(format!("{count} {}", reason.describe()));
    }
    words.join(", ")
}
