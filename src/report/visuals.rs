//! What viewers are shown, and why they are not shown more.

use serde::Serialize;

use super::{Findings, MissingReason, MissingTopic};
use crate::{
    derived::visual::{Frame, VisualTopic},
    messages::Topic,
    source::calibration::LogCalibration,
    text::Foreign,
    visuals::{Ground, StagedFlight, VisualOptions},
    writer::Written,
};

/// What viewers are shown, and what was taken for granted.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct VisualsReport {
    /// Transforms, poses and numbers per second.
    pub transforms_hz: f64,
    /// Scenes per second.
    pub scenes_hz: f64,
    /// How far what the camera sees of the ground is shown, as a multiple of the height.
    pub reach_heights: f64,
    /// Where the ground is; absent if it is not known where the drone was.
    pub ground: Option<GroundReport>,
    /// What the camera sees; absent if that is not known.
    pub field_of_view: Option<FieldOfViewReport>,
}

/// How wide and how high the camera sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct FieldOfViewReport {
    /// The whole angles from left to right and from top to bottom.
    pub degrees: [f64; 2],
    /// Whether the profile says it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub by_profile: bool,
    /// The topic of the log's calibration that says it; absent if the caller or the profile does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<Foreign>,
    /// How many topics of the log have one that differs from it.
    pub others: usize,
}

/// Where the ground is taken to be.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct GroundReport {
    /// Its altitude at the first position, as the log counts altitudes, metres. Unless it was measured, it is level.
    pub altitude_m: f64,
    /// Why it is there.
    #[serde(flatten)]
    pub because: GroundBecause,
}

/// Why the ground is taken to be where it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "because", rename_all = "snake_case")]
#[non_exhaustive]
pub enum GroundBecause {
    /// The caller gave its altitude.
    Given,
    /// The caller said that it is at the height of the take-off.
    TakeOff,
    /// The log has heights above it.
    Measured {
        /// The topic of the heights.
        topic: Foreign,
        /// How many of them were used.
        samples: u64,
        /// The altitude of the lowest place below the drone, as the log counts altitudes, metres.
        lowest_m: f64,
        /// The altitude of the highest one.
        highest_m: f64,
        /// For which share of the flight the heights say it, 0 to 1. For the rest, the ground is taken to be where it was
        /// last, or else where it is next.
        share: f64,
    },
    /// Nobody said where it is: the height of the take-off is assumed.
    Assumed,
}

/// What a topic for viewers needs and the flight does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
// Each variant's message explains it.
#[allow(missing_docs)]
pub enum Lack {
    #[error("the log has no usable position")]
    Position,
    #[error("the log has no latitude and longitude")]
    PlaceOnGlobe,
    #[error("the log has no usable velocity")]
    Velocity,
    #[error("the field of view is not known")]
    FieldOfView,
    #[error("the camera saw no ground")]
    Ground,
    #[error("nothing happened")]
    Incident,
    #[error("where the camera looked is never known")]
    Attitude,
}

impl VisualsReport {
    pub(super) fn new(
        options: &VisualOptions,
        staged: &StagedFlight,
        heights: Foreign,
        by_profile: bool,
        in_log: Option<&LogCalibration>,
    ) -> Self {
        let StagedFlight { flight, stage, .. } = staged;
        let because = match (options.ground, stage.terrain) {
            (Some(Ground::TakeOff), _) => GroundBecause::TakeOff,
            (Some(Ground::Altitude(_)), _) => GroundBecause::Given,
            (None, Some(terrain)) => GroundBecause::Measured {
                topic: heights,
                samples: flight.heights.used,
                lowest_m: terrain.lowest,
                highest_m: terrain.highest,
                share: terrain.share,
            },
            (None, None) => GroundBecause::Assumed,
        };
        Self {
            transforms_hz: options.tick_rate(),
            scenes_hz: options.scene_rate(),
            reach_heights: options.reach.heights(),
            ground: stage.ground.map(|altitude_m| GroundReport {
                altitude_m,
                because,
            }),
            field_of_view: stage.calibration.map(|calibration| FieldOfViewReport {
                degrees: calibration.field_of_view_deg(),
                by_profile,
                calibration: in_log.map(|in_log| in_log.topic.clone()),
                others: in_log.map_or(0, |in_log| in_log.others),
            }),
        }
    }
}

impl Findings<'_> {
    /// How what viewers are shown was made, and what a layout has to know of it.
    pub(super) fn visual_facts(&self) -> Vec<(&'static str, String)> {
        let Some((staged, options)) = self.staged.as_deref().zip(self.options.visuals.as_ref())
        else {
            return Vec::new();
        };
        let stage = &staged.stage;
        let mut facts = vec![
            ("visuals_transforms_hz", options.tick_rate().to_string()),
            ("visuals_scenes_hz", options.scene_rate().to_string()),
            ("visuals_reach_heights", options.reach.heights().to_string()),
            (
                "visuals_map_frame",
                self.format.frame_id(Frame::Map).to_owned(),
            ),
            (
                "visuals_drone_frame",
                self.format.frame_id(Frame::Drone).to_owned(),
            ),
            ("visuals_extent_m", stage.extent.to_string()),
            ("visuals_top_speed", stage.top_speed.to_string()),
        ];
        if let Some(ground) = stage.ground {
            facts.push(("visuals_ground_m", ground.to_string()));
        }
        // Where a viewer has to draw it.
        let places = staged.flight.ticks.iter();
        if let Some(first) = places.filter_map(|tick| stage.place(tick)).next() {
            let height = -first.ned.z - first.height;
            facts.push(("visuals_ground_in_map_m", height.to_string()));
        }
        if let Some(centre) = &stage.centre {
            let degrees = [centre.latitude, centre.longitude].map(|angle| angle.to_degrees());
            facts.push((
                "visuals_centre_deg",
                degrees.map(|angle| angle.to_string()).join(","),
            ));
        }
        if let Some(calibration) = &stage.calibration {
            let degrees = calibration
                .field_of_view_deg()
                .map(|angle| angle.to_string());
            facts.push(("visuals_field_of_view_deg", degrees.join(",")));
        }
        facts
    }

    /// The topics for viewers that have no messages, and why.
    pub(super) fn not_shown(&self, staged: &StagedFlight, written: &Written) -> Vec<MissingTopic> {
        let topics = VisualTopic::ALL.into_iter();
        let missing = topics.filter(|&topic| {
            self.format.writes(topic) && !written.messages.contains_key(&Topic::Visual(topic))
        });
        missing
            .map(|topic| MissingTopic {
                topic: topic.name(),
                reason: MissingReason::NotShown {
                    lack: lack(topic, staged),
                },
                positions: None,
            })
            .collect()
    }
}

/// Why a topic for viewers has no messages.
fn lack(topic: VisualTopic, staged: &StagedFlight) -> Lack {
    let StagedFlight { flight, stage, .. } = staged;
    let has_velocities = flight.ticks.iter().any(|tick| tick.velocity.is_some());
    let has_attitudes = flight.ticks.iter().any(|tick| tick.attitudes.is_ok());
    match topic {
        VisualTopic::Events | VisualTopic::Log => Lack::Incident,
        VisualTopic::Calibration => Lack::FieldOfView,
        _ if !has_attitudes => Lack::Attitude,
        _ if !stage.has_positions => Lack::Position,
        VisualTopic::Odometry if !has_velocities => Lack::Velocity,
        VisualTopic::Footprint if stage.calibration.is_none() => Lack::FieldOfView,
        VisualTopic::Footprint if stage.local_frame.is_some() => Lack::Ground,
        VisualTopic::Footprint | VisualTopic::Location => Lack::PlaceOnGlobe,
        // A position and an attitude are known, though never at the same time.
        _ => Lack::Position,
    }
}
