//! What has to be decided before a log's telemetry is read.

use crate::{
    camera::Camera, error::Error, log::Log, messages::Format, options::Options,
    report::EncodingReport, source::Source,
};

/// Where the telemetry is, what is derived from it, and how that is written.
pub struct Plan {
    /// Where the telemetry is.
    pub source: Source,
    /// How the camera is mounted.
    pub camera: Camera,
    /// How derived values are written.
    pub format: Format,
    /// Why this encoding.
    pub encoding: EncodingReport,
}

impl Plan {
    /// Finds the telemetry of a log, and chooses the camera and the encoding.
    ///
    /// # Errors
    /// There is no telemetry, it is ambiguous, or it contradicts the options.
    pub fn new(log: &Log, options: &Options) -> Result<Self, Error> {
        let source = Source::select(log, &options.telemetry)?;
        let camera = options.camera(&source)?;
        let source = source.keep(log, &options.telemetry, &options.needed_kinds(camera))?;
        let attitude = source.attitude_channel(log);
        let format = Format::choose(options.encoding, attitude);
        Ok(Self {
            encoding: EncodingReport::new(options.encoding, format.encoding, attitude),
            source,
            camera,
            format,
        })
    }
}
