//! The pipeline: reader → transform → writer → report.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::{
    derived::Quantity,
    error::Error,
    geometry::DepressionAngle,
    log::{Log, ScanReason},
    messages,
    reader::Reader,
    sample::{DropReason, Tally},
    source::{Source, profile::ProfileChoice},
    transform::{Breaks, MaxGap, Transform},
    writer::{Appender, destination::Destination, provenance},
};

/// How to enrich a log.
#[derive(Debug, Clone)]
pub struct Options {
    /// How far below the horizon the camera looks.
    pub depression: DepressionAngle,
    /// The longest time between two attitude samples that still belong together.
    pub max_gap: MaxGap,
    /// How the log names its telemetry.
    pub profile: ProfileChoice,
    /// Whether an output that exists is replaced.
    pub overwrite: bool,
}

impl Options {
    /// With everything but the camera's angle left to the defaults.
    pub fn new(depression: DepressionAngle) -> Self {
        Self {
            depression,
            max_gap: MaxGap::default(),
            profile: ProfileChoice::Automatic,
            overwrite: false,
        }
    }
}

/// How far a run is, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    pub done: u64,
    pub total: u64,
}

/// What a run did. As JSON it is what scripts read, so its names are part of the interface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    pub input: PathBuf,
    pub output: PathBuf,
    pub profile: ProfileReport,
    pub depression_deg: f64,
    pub max_gap_s: f64,
    pub attitude: SampleReport,
    pub velocity: SampleReport,
    pub breaks: Breaks,
    pub written: Vec<WrittenTopic>,
    pub not_written: Vec<MissingTopic>,
    pub bytes_copied: u64,
    pub bytes_appended: u64,
    /// Whether everything in the input could be read.
    pub complete: bool,
    /// What the user should know besides.
    pub notes: Vec<String>,
}

/// The profile that was used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProfileReport {
    pub name: String,
    pub reason: String,
}

/// What became of one kind of sample.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SampleReport {
    /// Where the samples come from; absent where the log has none.
    pub topic: Option<String>,
    #[serde(flatten)]
    pub tally: Tally,
}

/// A topic of the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WrittenTopic {
    pub topic: &'static str,
    pub schema: &'static str,
    pub messages: u64,
}

/// A topic that the result does not have.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct MissingTopic {
    pub topic: &'static str,
    pub reason: String,
}

/// `NAME.enriched.mcap` beside the input.
pub fn default_output(input: &Path) -> PathBuf {
    let mut name = input.file_stem().unwrap_or_default().to_owned();
    name.push(".enriched.mcap");
    input.with_file_name(name)
}

/// Writes `input` with the camera's channels appended to `output`. `progress` is called now and then.
///
/// # Errors
/// Nothing is left at `output` then. The error says what was wrong and what to do about it.
pub fn enrich(
    input: &Path,
    output: &Path,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Report, Error> {
    let log = Log::open(input)?;
    let destination = Destination::new(input, output, options.overwrite)?;
    provenance::check_topics_are_free(&log)?;
    let source = Source::select(&log, &options.profile)?;
    let profile = ProfileReport {
        name: source.profile.name.clone(),
        reason: match options.profile {
            ProfileChoice::Automatic => format!("chosen because {}", source.reason()),
            ProfileChoice::Given(_) => format!("as asked for; {}", source.reason()),
        },
    };

    let mut reader = Reader::new(&log, source);
    let mut transform = Transform::new(options.depression, options.max_gap);
    // Begun with the first derived value, so that a log that yields none costs no copy.
    let mut appender: Option<Appender> = None;
    let mut derived = Vec::new();
    let mut copied = 0;
    while let Some(sample) = reader.next() {
        transform.push(sample?, &mut derived);
        let (read, unread) = reader.progress();
        let mut report = |copied| {
            progress(Progress {
                done: copied + read,
                total: log.data_end + read + unread,
            });
        };
        for value in derived.drain(..) {
            let appender = match &mut appender {
                Some(appender) => appender,
                None => {
                    let begun = Appender::begin(&log, &destination, |bytes| {
                        copied += bytes;
                        report(copied);
                    })?;
                    appender.insert(begun)
                }
            };
            appender.write(&value)?;
        }
        report(copied);
    }
    let outcome = transform.finish();
    let (source, dropped) = reader.finish();
    let mut attitude = SampleReport {
        topic: Some(source.attitude_topic.clone()),
        tally: outcome.attitude,
    };
    attitude.tally.merge(&dropped.attitude);
    let mut velocity = SampleReport {
        topic: source.velocity_topic.clone().ok(),
        tally: outcome.velocity,
    };
    velocity.tally.merge(&dropped.velocity);

    let missing = missing_topics(&source, &attitude.tally, &velocity.tally, outcome.breaks);
    let Some(appender) = appender else {
        let reasons: Vec<String> = missing
            .iter()
            .map(|topic| format!("  {}: {}", topic.topic, topic.reason))
            .collect();
        return Err(Error::NothingDerived {
            path: input.into(),
            details: reasons.join("\n"),
        });
    };
    let facts = facts(options, &source, &attitude, &velocity, outcome.breaks);
    let appended = appender.finish(facts)?;

    let undecodable = [&attitude.tally, &velocity.tally]
        .iter()
        .any(|tally| tally.dropped.contains_key(&DropReason::Undecodable));
    Ok(Report {
        input: input.into(),
        output: output.into(),
        profile,
        depression_deg: options.depression.degrees(),
        max_gap_s: options.max_gap.seconds(),
        attitude,
        velocity,
        breaks: outcome.breaks,
        written: (appended.messages.iter())
            .map(|(&quantity, &messages)| WrittenTopic {
                topic: quantity.topic(),
                schema: messages::schema(quantity).name,
                messages,
            })
            .collect(),
        not_written: missing
            .into_iter()
            .filter(|topic| {
                (appended.messages.keys()).all(|written| written.topic() != topic.topic)
            })
            .collect(),
        bytes_copied: appended.copied,
        bytes_appended: appended.appended,
        complete: log.breaks_off_at.is_none() && !undecodable,
        notes: notes(&log, &source),
    })
}

/// Why a quantity would not be in the result, for each.
fn missing_topics(
    source: &Source,
    attitude: &Tally,
    velocity: &Tally,
    breaks: Breaks,
) -> Vec<MissingTopic> {
    let rotation = if attitude.used < 2 {
        format!(
            "it takes two usable attitude samples, and {} has {}",
            source.attitude_topic,
            describe(attitude)
        )
    } else {
        format!(
            "no two attitude samples belong together ({} gaps, {} resets)",
            breaks.gaps, breaks.resets
        )
    };
    let velocity = match &source.velocity_topic {
        Ok(topic) => format!("of the velocity samples on {topic}, {}", describe(velocity)),
        Err(reason) => reason.clone(),
    };
    [
        (Quantity::RelativeRpy, rotation),
        (Quantity::CameraVelocity, velocity),
    ]
    .into_iter()
    .map(|(quantity, reason)| MissingTopic {
        topic: quantity.topic(),
        reason,
    })
    .collect()
}

/// A tally in words.
fn describe(tally: &Tally) -> String {
    let mut words = vec![format!("{} of {} usable", tally.used, tally.total())];
    for (reason, count) in &tally.dropped {
        words.push(format!("{count} {}", reason.describe()));
    }
    words.join(", ")
}

/// What the result's Metadata record says of how it was made.
fn facts(
    options: &Options,
    source: &Source,
    attitude: &SampleReport,
    velocity: &SampleReport,
    breaks: Breaks,
) -> BTreeMap<String, String> {
    let mut facts = BTreeMap::new();
    let mut say = |key: &str, value: String| facts.insert(key.to_owned(), value);
    say("depression_deg", options.depression.degrees().to_string());
    say("max_gap_s", options.max_gap.seconds().to_string());
    say("profile", source.profile.name.clone());
    say(
        "profile_toml",
        toml::to_string(&source.profile).expect("a profile was read from TOML"),
    );
    say("attitude_breaks_gaps", breaks.gaps.to_string());
    say("attitude_breaks_resets", breaks.resets.to_string());
    for (kind, samples) in [("attitude", attitude), ("velocity", velocity)] {
        if let Some(topic) = &samples.topic {
            say(&format!("{kind}_topic"), topic.clone());
        }
        say(&format!("{kind}_used"), samples.tally.used.to_string());
        for (reason, count) in &samples.tally.dropped {
            say(
                &format!("{kind}_dropped_{}", reason.name()),
                count.to_string(),
            );
        }
    }
    facts
}

fn notes(log: &Log, source: &Source) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(offset) = log.breaks_off_at {
        let lost = log.file.len() - offset;
        notes.push(if lost == 0 {
            "the log was never closed: it has no end record; all of its whole records were used".to_owned()
        } else {
            format!("the log breaks off at byte {offset}; the {lost} bytes from there on are not readable")
        });
    }
    match log.scanned {
        Some(ScanReason::IncompleteSummary) => notes.push(
            "the log's summary was incomplete or wrong; the result has a complete one".to_owned(),
        ),
        Some(ScanReason::NoSummary) => {
            notes.push("the log had no readable summary; the result has one".to_owned());
        }
        Some(ScanReason::NotClosed) if log.breaks_off_at.is_none() => notes.push(
            "the log's summary breaks off, its data is whole; the result has a complete one"
                .to_owned(),
        ),
        Some(ScanReason::NotClosed) | None => {}
    }
    if log.contents.has_loose_messages() {
        notes.push(
            "the log has messages outside chunks; the result has no chunk index, which would hide them"
                .to_owned(),
        );
    }
    notes.extend(source.suspicion());
    notes
}
