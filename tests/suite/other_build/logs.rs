//! The logs that both builds enrich, the same in every run.

use std::{fs, path::Path};

use flightcam::source::profile::Profile;
use mcap::{Compression, WriteOptions};
use proptest::{
    strategy::{Strategy, ValueTree},
    test_runner::TestRunner,
};

use crate::support::{
    Shape,
    flights::{self, Recording, flight::Flight},
    folder::{Folder, LOG},
    mixed_log, numbered,
    piping::rewritten,
    random_topics::{REQUESTS, any_log},
    real_logs, repository,
    shapes::*,
    telemetry::{Kind, Language, write},
};

/// A log, and where its telemetry is.
pub struct Input {
    pub name: String,
    pub arguments: String,
    log: Vec<u8>,
    /// For `profile.toml` in the log's folder.
    profile: Option<String>,
}

impl Input {
    fn new(name: impl Into<String>, log: Vec<u8>) -> Self {
        Self {
            name: name.into(),
            arguments: String::new(),
            log,
            profile: None,
        }
    }

    fn with_arguments(self, arguments: impl Into<String>) -> Self {
        let arguments = arguments.into();
        Self { arguments, ..self }
    }

    fn with_profile(self, profile: impl Into<String>) -> Self {
        let profile = Some(profile.into());
        Self { profile, ..self }.with_arguments("--profile profile.toml")
    }

    /// A folder that has the log and no other.
    pub fn folder(&self) -> Folder {
        let folder = Folder::with(LOG, &self.log);
        if let Some(profile) = &self.profile {
            folder.add("profile.toml", profile);
        }
        folder
    }
}

/// As many values as asked for, which are the same every time.
fn draw<T>(strategy: impl Strategy<Value = T>, count: usize) -> Vec<T> {
    let mut runner = TestRunner::deterministic();
    let mut draw = || strategy.new_tree(&mut runner).expect("a value").current();
    (0..count).map(|_| draw()).collect()
}

pub fn of_any_shape() -> impl Iterator<Item = Input> {
    let shapes = draw(any_shape(), 100).into_iter();
    shapes.map(|shape| Input::new(format!("{shape:?}"), shape.write()))
}

/// Logs that break off, each at another place.
pub fn torn() -> impl Iterator<Item = Input> {
    let logs = draw((any_shape(), 0.0..1.0), 40).into_iter();
    logs.map(|(shape, at): (Shape, f64)| {
        let mut log = shape.write();
        log.truncate((at * log.len() as f64) as usize);
        Input::new(format!("{at} of {shape:?}"), log)
    })
}

pub fn unusual() -> impl Iterator<Item = Input> {
    let flipped = |at: usize| {
        let mut log = Shape::default().write();
        let length = log.len();
        log[length / 10 * at] ^= 4;
        Input::new(format!("a bit flipped at {at}/10"), log)
    };
    let logs = [
        ("mixed", mixed_log()),
        ("repeated schemas", with_repeated_schemas()),
        ("zeros at the end", with_zeros_at_the_end()),
        ("long", long_log()),
        ("nothing", Vec::new()),
        ("no log", b"not a log at all".to_vec()),
    ];
    logs.map(|(name, log)| Input::new(name, log))
        .into_iter()
        .chain((1..10).map(flipped))
}

/// Also such as no profile fits, or several.
pub fn of_random_topics() -> impl Iterator<Item = Input> {
    let logs = draw(any_log(), 100)
        .into_iter()
        .zip(REQUESTS.iter().cycle());
    logs.enumerate().map(|(n, (log, request))| {
        let options = request.iter().map(|(name, value)| match value.is_empty() {
            true => format!("{name} /"),
            false => format!("{name} {value}"),
        });
        let arguments = options.collect::<Vec<_>>().join(" ");
        Input::new(format!("random topics, number {n}"), log).with_arguments(arguments)
    })
}

/// Each recording in a log as it was, without chunks, and in small chunks, and in one log with all others.
pub fn of_every_publisher() -> impl Iterator<Item = Input> {
    let input = |recording: Recording| {
        let profile = Profile::load(recording.profile).expect("a built-in profile");
        let arguments = match profile.automatic {
            true => String::new(),
            false => format!("--profile {}", profile.name),
        };
        let name = recording.name.clone();
        let log = recording.flying(Flight::beginning).log();
        let without_chunks = rewritten(&log, WriteOptions::new().use_chunks(false));
        let small_chunks = rewritten(&log, numbered::chunks_of(200, Some(Compression::Lz4)));
        [
            Input::new(format!("{name}, as it was"), log),
            Input::new(format!("{name}, without chunks"), without_chunks),
            Input::new(format!("{name}, in small chunks"), small_chunks),
        ]
        .map(|input| input.with_arguments(&arguments))
    };
    let together = || {
        let mut log = flights::recorder::Recorder::new();
        for (number, recording) in (0..).zip(flights::recordings()) {
            log.rename(move |topic| format!("/drone{}{topic}", number % 3));
            recording.flying(Flight::beginning).write(&mut log);
        }
        log.finish()
    };
    let chosen = [
        "",
        "--profile mavros --namespace /drone1",
        "--namespace /drone2",
    ];
    let together = chosen.map(|arguments| Input::new("all", together()).with_arguments(arguments));
    let recordings = flights::recordings().into_iter();
    recordings.flat_map(input).chain(together)
}

/// The same flight in messages of every encoding, with a profile of one's own; and one that says itself when it was.
pub fn in_every_encoding() -> impl Iterator<Item = Input> {
    let kinds = Kind::ALL.into_iter();
    let logs = kinds.flat_map(|kind| Language::ALL.map(|language| (kind, language)));
    let logs = logs.map(|(kind, language)| {
        let (_folder, path) = write(kind, language, 300).finish();
        let log = fs::read(path).expect("the log");
        Input::new(format!("{} in {language}", kind.name()), log).with_profile(kind.profile())
    });
    let compressions = [None, Some(Compression::Zstd)].into_iter();
    let measured = compressions.map(|compression| {
        let messages = numbered::flight(400, 1000);
        let log = numbered::write(numbered::chunks_of(4096, compression), &messages);
        let profile = [numbered::MEASURED, numbered::PROFILE].concat();
        Input::new("numbered messages", log).with_profile(profile)
    });
    logs.chain(measured)
}

/// The demonstration flight, and the real ones where there are any.
pub fn flown() -> impl Iterator<Item = Input> {
    let read = |path: &Path| Input::new(path.display().to_string(), fs::read(path).expect("a log"));
    let fixture = read(&repository("fixtures/survey_flight.mcap"));
    let entries = real_logs().map(|folder| fs::read_dir(folder).expect("a folder"));
    let paths = entries
        .into_iter()
        .flatten()
        .map(|entry| entry.expect("an entry").path());
    let real = paths.filter(|path| {
        path.extension()
            .is_some_and(|extension| extension == "mcap")
    });
    std::iter::once(fixture).chain(real.map(move |path| read(&path)))
}
