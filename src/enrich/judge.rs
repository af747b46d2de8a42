//! Whether what was read can be right, once all telemetry has been read.

use crate::{
    check::{
        Claims, Oddity,
        reading::{AttitudeReading, SPEED_UNITS, VectorReading},
    },
    error::Error,
    log::Log,
    options::Options,
    report::Derivation,
    run::RunError,
    sample::Kind,
    source::{Reading, Source, profile::convention::SpeedUnit},
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
    let findings = derivation.recorder.certain(&claims(source));
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

/// How the samples of each kind were read. Those that were read in several ways are not judged.
fn claims(source: &Source) -> Claims {
    let reading = |kind| match &source.read_as(kind)[..] {
        [one] => Some(one.reading),
        _ => None,
    };
    Claims {
        velocity: match reading(Kind::Velocity) {
            Some(Reading::Velocity { axes, unit }) => Some(VectorReading {
                axes,
                unit: SPEED_UNITS[match unit {
                    SpeedUnit::MetresPerSecond => 0,
                    SpeedUnit::CentimetresPerSecond => 1,
                    SpeedUnit::MillimetresPerSecond => 2,
                }],
            }),
            _ => None,
        },
        attitude: match reading(Kind::Attitude) {
            Some(Reading::Quaternion { axes, .. }) => Some(AttitudeReading::new(
                AttitudeReading::WXYZ,
                axes.body(),
                axes.world(),
            )),
            Some(Reading::Angles { axes, .. }) => Some(AttitudeReading::new(
                AttitudeReading::ANGLES,
                axes.body(),
                axes.world(),
            )),
            _ => None,
        },
        ..Claims::default()
    }
}
