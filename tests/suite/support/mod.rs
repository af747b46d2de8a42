//! What the tests share.

pub mod expected;
pub mod flights;
pub mod folder;
pub mod forging;
pub mod help;
pub mod inspection;
pub mod interrupted;
pub mod judge;
pub mod judged_flight;
pub mod layout;
pub mod logbook;
pub mod manoeuvres;
pub mod markdown;
pub mod message;
pub mod numbered;
pub mod orientations;
pub mod panels;
pub mod parts;
pub mod piping;
pub mod random_topics;
pub mod rewriting;
pub mod ros;
pub mod ros_walk;
pub mod selecting;
pub mod shapes;
pub mod showing;
pub mod shown;
pub mod shown_log;
pub mod shown_reading;
pub mod small_disk;
pub mod small_logs;
pub mod steering;
pub mod telemetry;
pub mod topics;
pub mod viewing;

pub use judge::*;
pub use message::ReadMessage;
pub use parts::{Parts, whole_records};
pub use shapes::{MESSAGES, Shape, TELEMETRY, mixed_log};

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use flightcam::{Error, Options, Report, enrich::enrich, geometry::DepressionAngle};
use proptest::prelude::ProptestConfig;

/// A file of this repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The folder of real logs; `None`, with a message, where there is none.
pub fn real_logs() -> Option<PathBuf> {
    let folder = match env::var_os("FLIGHTCAM_REAL_LOGS") {
        Some(folder) => PathBuf::from(folder),
        None => repository("../shared/real-logs"),
    };
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!(
        "skipped: no real logs in {}; name their folder in FLIGHTCAM_REAL_LOGS",
        folder.display()
    );
    None
}

/// A log that was made to go wrong; `None`, with a message, where there are none.
pub fn hostile_log(name: &str) -> Option<Vec<u8>> {
    let folder = match env::var_os("FLIGHTCAM_HOSTILE_LOGS") {
        Some(folder) => PathBuf::from(folder),
        None => repository("../shared/hostile"),
    };
    let log = fs::read(folder.join(name)).ok();
    if log.is_none() {
        eprintln!(
            "skipped: no {name} in {}; name its folder in FLIGHTCAM_HOSTILE_LOGS",
            folder.display()
        );
    }
    log
}

/// 30° below the horizon, all else by default.
pub fn options() -> Options {
    options_at(30.0)
}

/// Another angle below the horizon, all else by default.
pub fn options_at(degrees: f64) -> Options {
    Options::new().depression(DepressionAngle::from_degrees(degrees).expect("it is in range"))
}

/// Enriches a log in memory; returns the result's bytes and the report.
pub fn enrich_bytes(log: &[u8]) -> Result<(Vec<u8>, Report), Error> {
    enrich_bytes_with(log, &options())
}

pub fn enrich_bytes_with(log: &[u8], options: &Options) -> Result<(Vec<u8>, Report), Error> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let input = folder.path().join("log.mcap");
    let output = folder.path().join("result.mcap");
    fs::write(&input, log).expect("the log is written");
    let report = enrich(&input, &output, options)?;
    Ok((fs::read(output).expect("the result is read"), report))
}

/// How many random cases a property is tried with: that many, times `FLIGHTCAM_CASES` where that is set.
pub fn cases(count: u32) -> ProptestConfig {
    let factor = env::var("FLIGHTCAM_CASES").ok();
    let factor = factor.map_or(1, |factor| {
        factor.parse().expect("FLIGHTCAM_CASES is a number")
    });
    ProptestConfig::with_cases(count * factor)
}
