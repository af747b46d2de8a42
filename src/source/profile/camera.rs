//! How a drone's camera is built, which no log says and a profile of the user's own may.

use serde::{Deserialize, Serialize};

use crate::{
    camera::{FieldOfView, FieldOfViewOutOfRange, Mount, MountOutOfRange},
    geometry::{DepressionAngle, DepressionOutOfRange},
};

/// How a drone's camera is built, as far as a profile says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "Degrees", into = "Degrees")]
pub struct CameraSetup {
    /// How far below the horizon it looks, on a gimbal that cancels the drone's roll and pitch.
    pub depression: Option<DepressionAngle>,
    /// How it is turned from the drone's axes.
    pub mount: Option<Mount>,
    /// How wide and how high it sees.
    pub field_of_view: Option<FieldOfView>,
}

impl CameraSetup {
    /// Whether it says where the camera looks.
    pub fn says_where_it_looks(&self) -> bool {
        self.depression.is_some() || self.mount.is_some()
    }
}

/// The same as it is written.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Degrees {
    #[serde(skip_serializing_if = "Option::is_none")]
    depression: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mount: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hfov: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    vfov: Option<f64>,
}

/// What is wrong with a camera of a profile.
#[derive(Debug, thiserror::Error)]
pub(super) enum BadCamera {
    #[error(transparent)]
    Depression(#[from] DepressionOutOfRange),
    #[error(transparent)]
    Mount(#[from] MountOutOfRange),
    #[error(transparent)]
    FieldOfView(#[from] FieldOfViewOutOfRange),
    #[error("`hfov` and `vfov` belong together: give both, or neither")]
    HalfAFieldOfView,
}

impl TryFrom<Degrees> for CameraSetup {
    type Error = BadCamera;

    fn try_from(degrees: Degrees) -> Result<Self, BadCamera> {
        let Degrees {
            depression,
            mount,
            hfov,
            vfov,
        } = degrees;
        let mount = mount.map(|[roll, pitch, yaw]| Mount::from_degrees(roll, pitch, yaw));
        Ok(Self {
            depression: depression.map(DepressionAngle::from_degrees).transpose()?,
            mount: mount.transpose()?,
            field_of_view: match (hfov, vfov) {
                (Some(wide), Some(high)) => Some(FieldOfView::from_degrees(wide, high)?),
                (None, None) => None,
                _ => return Err(BadCamera::HalfAFieldOfView),
            },
        })
    }
}

impl From<CameraSetup> for Degrees {
    fn from(setup: CameraSetup) -> Self {
        let field_of_view = setup.field_of_view.map(FieldOfView::degrees);
        Self {
            depression: setup.depression.map(DepressionAngle::degrees),
            mount: setup.mount.map(Mount::degrees),
            hfov: field_of_view.map(|[wide, _]| wide),
            vfov: field_of_view.map(|[_, high]| high),
        }
    }
}
