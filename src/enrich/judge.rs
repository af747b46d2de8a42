//! Whether what was read can be right, once all telemetry has been read.

use super::claims::claims;
use crate::{
    check::Oddity, error::Error, log::Log, options::Options, report::Derivation, run::RunError,
    sample::Kind,
};

/// Checks what a log's own numbers say about how they were read. Returns what is odd, but may be right.
///
/// # Errors
/// They come from several sources, or they were certainly read wrongly and that is not to be trusted regardless.
pub fn judge(derivation: &Derivation, log: &Log, options: &Options) -> Result<Vec<Oddity>, Error> {
    let source = &derivation.source;
    source.check_sources(log, &options.telemetry)?;
    if !options.trust {
        source.check_angles(log, &options.telemetry)?;
    }
    let findings = derivation.recorder.certain(&claims(log, source));
    match findings.is_contradicted() && !options.trust {
        false => Ok(findings.oddities),
        true => Err(RunError::Contradicted {
            path: log.file.path().into(),
            asked: [Kind::Attitude, Kind::Velocity, Kind::Gimbal]
                .map(|kind| (kind, options.telemetry.how_asked(kind, &source.profile)))
                .into(),
            findings: findings.into(),
        }
        .into()),
    }
}
