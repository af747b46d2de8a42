//! What the caller decides about a run.

use std::{collections::BTreeSet, ops::ControlFlow};

use crate::{
    camera::{Camera, CameraError, FieldOfView, Mount},
    derived::{Quantity, visual::VisualTopic},
    geometry::DepressionAngle,
    messages::{EncodingChoice, Topic},
    sample::Kind,
    source::{Source, profile::Profile, request::Request},
    transform::{MaxGap, MinInterval},
    visuals::VisualOptions,
    watch::{Progress, Watch},
    writer::{
        Layout,
        journal::{Interrupted, JournalStep},
    },
};

/// How to enrich a log.
///
/// By default the camera follows the gimbal whose angles are in the log, and everything else is found automatically.
///
/// ```
/// use flightcam::{DepressionAngle, Layout, Options};
///
/// let options = Options::new()
///     .depression(DepressionAngle::from_degrees(30.0)?)
///     .layout(Layout::Interleaved);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Options {
    pub(crate) depression: Option<DepressionAngle>,
    pub(crate) mount: Option<Mount>,
    pub(crate) max_gap: MaxGap,
    pub(crate) min_interval: MinInterval,
    pub(crate) trust: bool,
    pub(crate) telemetry: Request,
    pub(crate) encoding: EncodingChoice,
    pub(crate) layout: Layout,
    pub(crate) visuals: Option<VisualOptions>,
    pub(crate) watch: Watch,
}

impl Options {
    /// The defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// How far below the horizon the camera looks, on a gimbal that cancels the drone's roll and pitch. It takes
    /// precedence over the angles of a gimbal that the log has.
    pub fn depression(self, depression: impl Into<Option<DepressionAngle>>) -> Self {
        Self {
            depression: depression.into(),
            ..self
        }
    }

    /// How the camera is turned from the drone's axes: all of it for a camera that is bolted to the airframe;
    /// together with a depression angle the yaw alone, for a gimballed camera that looks sideways.
    pub fn mount(self, mount: impl Into<Option<Mount>>) -> Self {
        Self {
            mount: mount.into(),
            ..self
        }
    }

    /// The longest time between two attitude samples that still belong together; 5 s by default.
    pub fn max_gap(self, max_gap: MaxGap) -> Self {
        Self { max_gap, ..self }
    }

    /// The shortest time between two attitude samples, which thins bursts; by default nothing is left out.
    pub fn min_interval(self, min_interval: MinInterval) -> Self {
        Self {
            min_interval,
            ..self
        }
    }

    /// Whether to go on although it is certain from the log's own numbers that it was read wrongly; by default that is an
    /// error.
    pub fn trust(self, trust: bool) -> Self {
        Self { trust, ..self }
    }

    /// How the log's telemetry is found; by default by the built-in profile that fits best.
    pub fn telemetry(self, telemetry: Request) -> Self {
        Self { telemetry, ..self }
    }

    /// How the new messages are encoded; by default as the telemetry is.
    pub fn encoding(self, encoding: EncodingChoice) -> Self {
        Self { encoding, ..self }
    }

    /// Where in the log the new messages are; by default they are appended.
    pub fn layout(self, layout: Layout) -> Self {
        Self { layout, ..self }
    }

    /// What viewers are shown beside the camera's motion; by default nothing.
    pub fn visuals(self, visuals: impl Into<Option<VisualOptions>>) -> Self {
        Self {
            visuals: visuals.into(),
            ..self
        }
    }

    /// Calls `watch` with the progress of the run, about twenty times a second or more. If it returns `Break`, the run
    /// ends with an error and leaves everything as it was.
    ///
    /// It is called from several threads, perhaps at the same time.
    pub fn watch(
        self,
        watch: impl Fn(Progress) -> ControlFlow<()> + Send + Sync + 'static,
    ) -> Self {
        Self {
            watch: Watch::new(watch),
            ..self
        }
    }

    /// See [`Watch::on_recovery`].
    pub fn on_recovery(self, announce: impl Fn(&Interrupted) + Send + Sync + 'static) -> Self {
        Self {
            watch: self.watch.on_recovery(announce),
            ..self
        }
    }

    /// See [`Watch::on_step`].
    #[doc(hidden)]
    pub fn on_step(self, reached: impl Fn(JournalStep) + Send + Sync + 'static) -> Self {
        Self {
            watch: self.watch.on_step(reached),
            ..self
        }
    }

    /// The topics that a run may write, and that the log therefore must not have.
    pub(crate) fn topics(&self) -> Vec<Topic> {
        let quantities = Quantity::ALL.into_iter().map(Topic::Derived);
        let visuals = self.visuals.iter().flat_map(|_| VisualTopic::ALL);
        // If the log has transforms, its own topics of them are left alone.
        let ours = visuals
            .filter(|topic| !topic.is_shared())
            .map(Topic::Visual);
        quantities.chain(ours).collect()
    }

    /// The kinds of sample that a run reads.
    pub(crate) fn needed_kinds(&self, camera: Camera) -> BTreeSet<Kind> {
        let kinds = camera.needed_kinds().into_iter();
        let kinds = kinds.map(|kind| match kind {
            Kind::Velocity => self.telemetry.velocity_from.kind(),
            other => other,
        });
        kinds.chain(self.shown_kinds().iter().copied()).collect()
    }

    /// Those of them that viewers are shown: where the drone was and, unless the caller says where the ground is, how high
    /// above that.
    pub(crate) fn shown_kinds(&self) -> &'static [Kind] {
        match &self.visuals {
            None => &[],
            Some(visuals) if visuals.says_where_the_ground_is() => &[Kind::Position],
            Some(_) => &[Kind::Position, Kind::Height],
        }
    }

    /// Whether the profile says where the camera looks, and the caller does not.
    pub(crate) fn leaves_camera_to(&self, profile: &Profile) -> bool {
        let is_given = self.depression.is_some() || self.mount.is_some();
        !is_given && profile.camera.says_where_it_looks()
    }

    /// What the profile says that the camera sees, if the caller does not.
    pub(crate) fn field_of_view_from(&self, profile: &Profile) -> Option<FieldOfView> {
        let is_given = |visuals: &VisualOptions| visuals.says_what_the_camera_sees();
        match self.visuals.as_ref().is_some_and(is_given) {
            true => None,
            false => profile.camera.field_of_view,
        }
    }

    /// How the camera is mounted as the caller says or, if they do not, the profile.
    pub(crate) fn mounting(&self, profile: &Profile) -> (Option<DepressionAngle>, Option<Mount>) {
        match self.leaves_camera_to(profile) {
            true => (profile.camera.depression, profile.camera.mount),
            false => (self.depression, self.mount),
        }
    }

    /// How the camera is mounted, given what the log says.
    ///
    /// # Errors
    /// Neither the options nor the log say, or the options contradict each other.
    pub(crate) fn camera(&self, source: &Source) -> Result<Camera, CameraError> {
        let (depression, mount) = self.mounting(&source.profile);
        match (depression, mount) {
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
