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
        let source = Source::select_to_show(log, &options.telemetry, options.shown_kinds())?;
        let camera = options.camera(&source)?;
        let source = source.keep(log, &options.telemetry, &options.needed_kinds(camera))?;
        let attitude = source.attitude_channel(log);
        let format =
            Format::choose(options.encoding, attitude).beside_transforms(has_transforms(log));
        Ok(Self {
            encoding: EncodingReport::new(options.encoding, format.encoding, attitude),
            source,
            camera,
            format,
        })
    }
}

/// Whether a log has transforms between frames, in one of the types that viewers know.
fn has_transforms(log: &Log) -> bool {
    const TYPES: [&str; 6] = [
        "foxglove.FrameTransform",
        "foxglove.FrameTransforms",
        "tf2_msgs/msg/TFMessage",
        "tf2_msgs/TFMessage",
        "tf/tfMessage",
        "geometry_msgs/msg/TransformStamped",
    ];
    let mut schemas = (log.contents.channels_with_messages())
        .filter_map(|(channel, _)| log.contents.schema_of(channel));
    schemas.any(|schema| TYPES.contains(&schema.name.as_str()))
}
