//! Message types that viewers draw, by the names that they know them by.

/// What a panel can do with the messages of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drawn {
    /// Move frames.
    Transforms,
    /// Draw them in 3D.
    Scene,
    /// Draw a pose in 3D.
    Pose,
    /// Draw them on a map.
    Place,
    /// Show a picture.
    Picture,
    /// Say how a camera projects.
    Calibration,
    /// List them as the lines of a log.
    LogLine,
}

impl Drawn {
    /// Of messages whose schema has this name.
    pub fn of(schema: &str) -> Option<Self> {
        Some(match package_and_name(schema)? {
            ("foxglove", "FrameTransform" | "FrameTransforms")
            | ("tf2_msgs", "TFMessage")
            | ("tf", "tfMessage")
            | ("geometry_msgs", "TransformStamped") => Self::Transforms,
            ("foxglove", "SceneUpdate") | ("visualization_msgs", "Marker" | "MarkerArray") => {
                Self::Scene
            }
            ("foxglove", "PoseInFrame") | ("geometry_msgs", "PoseStamped") => Self::Pose,
            ("foxglove", "LocationFix" | "GeoJSON") | ("sensor_msgs", "NavSatFix") => Self::Place,
            ("foxglove", "CompressedImage" | "CompressedVideo" | "RawImage")
            | ("sensor_msgs", "CompressedImage" | "Image") => Self::Picture,
            ("foxglove", "CameraCalibration") | ("sensor_msgs", "CameraInfo") => Self::Calibration,
            ("foxglove", "Log") | ("rcl_interfaces" | "rosgraph_msgs", "Log") => Self::LogLine,
            _ => return None,
        })
    }
}

/// The package of a type and its name in it, however they are joined: `foxglove.Log`, `foxglove_msgs/msg/Log`,
/// `sensor_msgs/Image`, `ros.sensor_msgs.Image`.
fn package_and_name(schema: &str) -> Option<(&str, &str)> {
    let schema = schema.strip_prefix("ros.").unwrap_or(schema);
    let (package, name) = (schema.split_once("/msg/"))
        .or_else(|| schema.split_once("::"))
        .or_else(|| schema.split_once(['/', '.']))?;
    match package {
        "foxglove_msgs" => Some(("foxglove", name)),
        package => Some((package, name)),
    }
}
