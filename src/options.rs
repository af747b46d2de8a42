//! What the user decides about a run.

use crate::{
    camera::{Camera, CameraError, Mount},
    geometry::DepressionAngle,
    messages::EncodingChoice,
    sample::Kind,
    source::{Source, request::Request},
    transform::MaxGap,
    writer::Layout,
};

/// How to enrich a log.
///
/// By default the camera follows the gimbal whose angles the log has, and all else is found out.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// How far below the horizon the camera looks, on a gimbal that cancels the drone's roll and pitch. It wins
    /// over the angles of a gimbal that the log has.
    pub depression: Option<DepressionAngle>,
    /// How the camera is turned from the drone's axes: all of it for a camera bolted to the airframe; together
    /// with a depression angle the yaw alone, for a gimballed camera that looks sideways.
    pub mount: Option<Mount>,
    /// The longest time between two attitude samples that still belong together.
    pub max_gap: MaxGap,
    /// How the log's telemetry is found.
    pub telemetry: Request,
    /// In which language the new messages are written.
    pub encoding: EncodingChoice,
    /// Where the new messages lie.
    pub layout: Layout,
    /// Whether an output that exists is replaced.
    pub overwrite: bool,
}

impl Options {
    /// For a camera that looks so far below the horizon, with everything else left to the defaults.
    pub fn new(depression: DepressionAngle) -> Self {
        Self {
            depression: Some(depression),
            ..Self::default()
        }
    }

    /// How the camera hangs, given what the log tells.
    ///
    /// # Errors
    /// Neither the options nor the log tell, or the options contradict each other.
    pub fn camera(&self, source: &Source) -> Result<Camera, CameraError> {
        match (self.depression, self.mount) {
            (Some(depression), None) => Ok(Camera::Stabilised {
                depression,
                yaw_offset: 0.0,
            }),
            (Some(depression), Some(mount)) => match mount.degrees() {
                [0.0, 0.0, yaw] => Ok(Camera::Stabilised {
                    depression,
                    yaw_offset: yaw.to_radians(),
                }),
                _ => Err(CameraError::TiltedMount),
            },
            (None, Some(_)) if self.telemetry.roles.contains_key(&Kind::Gimbal) => {
                Err(CameraError::GimbalAndMount)
            }
            (None, Some(mount)) => Ok(Camera::Fixed(mount)),
            (None, None) if source.role(Kind::Gimbal).is_some() => Ok(Camera::Gimbal),
            (None, None) => Err(CameraError::Unknown),
        }
    }
}
