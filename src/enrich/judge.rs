//! Whether what was read can be right, once all telemetry has been read.

use crate::{error::Error, log::Log, options::Options, report::Derivation};

/// Checks what a log's own numbers say about how they were read.
///
/// # Errors
/// They come from several sources, or they were certainly read wrongly and that is not to be trusted regardless.
pub fn judge(derivation: &Derivation, log: &Log, options: &Options) -> Result<(), Error> {
    let source = &derivation.source;
    source.check_sources(log, &options.telemetry)?;
    if !options.trust {
        source.check_angles(log, &options.telemetry)?;
    }
    Ok(())
}
