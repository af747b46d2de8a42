//! How a result was made, as its Metadata record states it.
//!
//! The record is part of the log: other programs read it, and a later run quotes it. So its text is the
//! library's, apart from the words that reports use, and does not change with them.

use std::collections::BTreeMap;

use super::{CameraReport, Chosen, EncodingReport, Findings};
use crate::text::Foreign;

impl Findings<'_> {
    /// How the result was made.
    pub fn facts(&self) -> BTreeMap<String, String> {
        let mut facts = BTreeMap::new();
        let mut add = |key: &str, fact: String| {
            facts.insert(key.to_owned(), fact);
        };
        let camera = CameraReport::from(self.camera);
        add("camera", camera_fact(camera));
        match camera {
            CameraReport::Stabilised {
                depression_deg,
                yaw_offset_deg,
            } => {
                add("depression_deg", depression_deg.to_string());
                add("yaw_offset_deg", yaw_offset_deg.to_string());
            }
            CameraReport::Fixed { mount_deg } => {
                let mount = mount_deg.map(|angle| angle.to_string()).join(",");
                add("mount_deg", mount);
            }
            CameraReport::Gimbal => {}
        }
        let profile = &self.source.profile;
        let profile_toml = toml::to_string(&self.source.profile_as_read());
        add("max_gap_s", self.options.max_gap.seconds().to_string());
        add(
            "min_interval_s",
            self.options.min_interval.seconds().to_string(),
        );
        add("profile", profile.name.clone());
        add("namespace", self.source.namespace().to_owned());
        add(
            "profile_toml",
            profile_toml.expect("a profile was read from TOML"),
        );
        let velocity_from = self.options.telemetry.velocity_from;
        add("velocity_from", velocity_from.name().to_owned());
        add("encoding", self.encoding.name.name().to_owned());
        add("encoding_reason", encoding_fact(&self.encoding));
        add("attitude_gaps", self.breaks.gaps.to_string());
        add("attitude_resets", self.breaks.resets.to_string());
        add("attitude_clock_steps", self.breaks.clock_steps.to_string());
        for (key, fact) in self.visual_facts() {
            add(key, fact);
        }
        for (kind, samples) in &self.samples {
            let kind = kind.name();
            if let Some(topic) = &samples.topic {
                add(&format!("{kind}_topic"), topic.as_str().to_owned());
            }
            let read_as = serde_json::to_string(&samples.read_as);
            add(
                &format!("{kind}_read_as"),
                read_as.expect("plain data is JSON"),
            );
            add(&format!("{kind}_used"), samples.tally.used.to_string());
            if samples.tally.unselected > 0 {
                let unselected = samples.tally.unselected.to_string();
                add(&format!("{kind}_unselected"), unselected);
            }
            for (reason, count) in &samples.tally.dropped {
                let key = format!("{kind}_dropped_{}", reason.name());
                add(&key, count.to_string());
            }
        }
        facts
    }
}

fn camera_fact(camera: CameraReport) -> String {
    match camera {
        CameraReport::Stabilised {
            depression_deg,
            yaw_offset_deg,
        } => {
            let looks = match depression_deg {
                0.0 => "looks at the horizon".to_owned(),
                up if up < 0.0 => format!("looks {}° above the horizon", -up),
                down => format!("looks {down}° below the horizon"),
            };
            match yaw_offset_deg {
                0.0 => looks,
                left if left < 0.0 => format!("{looks}, {}° to the left of the nose", -left),
                right => format!("{looks}, {right}° to the right of the nose"),
            }
        }
        CameraReport::Fixed {
            mount_deg: [roll, pitch, yaw],
        } => format!("bolted to the airframe at roll {roll}°, pitch {pitch}°, yaw {yaw}°"),
        CameraReport::Gimbal => "follows the gimbal".to_owned(),
    }
}

fn encoding_fact(encoding: &EncodingReport) -> String {
    let chosen = match encoding.chosen {
        Chosen::Automatically => "chosen because",
        Chosen::ByRequest => "as asked for;",
    };
    let EncodingReport {
        telemetry_topic,
        telemetry_encoding,
        ..
    } = encoding;
    // Not as they are displayed: the record has names as the log has them.
    let [topic, encoding] = [telemetry_topic, telemetry_encoding].map(Foreign::as_str);
    format!("{chosen} {topic} is {encoding}")
}
