//! The pipeline: reader → transform → writer → report.

use std::path::{Path, PathBuf};

use crate::{
    camera::Camera,
    derived::Quantity,
    error::Error,
    log::Log,
    messages::Format,
    options::Options,
    reader::Reader,
    report::{EncodingReport, Findings, Report},
    sample::Kind,
    source::Source,
    transform::Transform,
    writer::{Appender, destination::Destination, provenance},
};

/// How far a run is, in bytes: of the telemetry read, and of the log copied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Bytes done so far.
    pub done: u64,
    /// Bytes to do in all.
    pub total: u64,
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
    // Asked first, because opening a log that has no summary reads all of it.
    let destination = Destination::new(input, output, options.overwrite)?;
    let log = Log::open(input)?;
    provenance::check_topics_are_free(&log)?;
    let source = Source::select(&log, &options.telemetry)?;
    let camera = options.camera(&source)?;
    let kinds: &[Kind] = match camera {
        Camera::Gimbal => &[Kind::Attitude, Kind::Velocity, Kind::Gimbal],
        Camera::Stabilised { .. } | Camera::Fixed(_) => &[Kind::Attitude, Kind::Velocity],
    };
    let source = source.keep(&log, &options.telemetry, kinds)?;
    let telemetry = source.attitude_channel(&log);
    let format = Format::choose(options.encoding, telemetry);

    let mut reader = Reader::new(&log, source);
    let mut transform = Transform::new(camera, options.max_gap);
    // Begun with the first derived value, so that a log that yields none costs no copy.
    let mut appender: Option<Appender> = None;
    let mut derived = Vec::new();
    let total = log.data_end + reader.bytes_total();
    let mut copied = 0;
    let mut reported = 0;
    while let Some(sample) = reader.next() {
        transform.push(sample?, &mut derived);
        let read = reader.bytes_read();
        for value in derived.drain(..) {
            let appender = match &mut appender {
                Some(appender) => appender,
                none => {
                    let progress = |bytes| {
                        copied += bytes;
                        let done = copied + read;
                        progress(Progress { done, total });
                    };
                    none.insert(Appender::begin(
                        &log,
                        &destination,
                        format.clone(),
                        progress,
                    )?)
                }
            };
            appender.write(&value)?;
        }
        if copied + read != reported {
            reported = copied + read;
            let done = reported;
            progress(Progress { done, total });
        }
    }
    let outcome = transform.finish();
    let (source, dropped) = reader.finish();
    let encoding = EncodingReport::new(options.encoding, format.encoding, telemetry);
    let findings = Findings::new(&log, options, source, camera, encoding, &dropped, outcome);
    let Some(appender) = appender else {
        return Err(nothing_derived(input, &findings));
    };
    let appended = appender.finish(findings.facts())?;
    Ok(findings.report(output.into(), appended))
}

fn nothing_derived(input: &Path, findings: &Findings) -> Error {
    let reasons = Quantity::ALL.map(|quantity| {
        let reason = findings.why_missing(quantity);
        format!("  {}: {reason}", quantity.topic())
    });
    Error::NothingDerived {
        path: input.into(),
        details: reasons.join("\n"),
    }
}
