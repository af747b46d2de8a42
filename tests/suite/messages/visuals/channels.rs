//! The channels that a log gets for what viewers are shown.

use std::collections::BTreeMap;

use flightcam::{
    derived::{
        Quantity,
        visual::{Visual, VisualTopic},
    },
    messages::{Encoding, Format, Topic},
};
use mcap::records::Channel;

use super::{format, shown, topic_and_type};
use crate::support::{shown as content, shown_log};

const QOS: &str = "offered_qos_profiles";

#[test]
fn every_new_channel_says_which_version_wrote_it() {
    for encoding in Encoding::ALL {
        for topic in Topic::all() {
            let metadata = format(encoding).channel_metadata(topic);
            assert_eq!(metadata["flightcam"], env!("CARGO_PKG_VERSION"));
            assert_eq!(metadata.contains_key(QOS), encoding == Encoding::Ros2);
        }
    }
}

#[test]
fn what_is_written_once_is_kept_for_late_subscribers() {
    let telemetry = Channel {
        id: 1,
        schema_id: 0,
        topic: "/attitude".to_owned(),
        message_encoding: "cdr".to_owned(),
        metadata: BTreeMap::from([(QOS.to_owned(), "- history: 1\n  reliability: 2".to_owned())]),
    };
    let format = Format::choose(Default::default(), &telemetry);
    let settings = |topic| format.channel_metadata(topic)[QOS].clone();
    let once = [
        VisualTopic::StaticTransforms,
        VisualTopic::TfStatic,
        VisualTopic::Model,
        VisualTopic::Path,
        VisualTopic::Calibration,
        VisualTopic::Footprint,
    ];
    for topic in VisualTopic::ALL {
        let found = settings(Topic::Visual(topic));
        match once.contains(&topic) {
            true => assert!(found.contains("\n  durability: 1\n"), "{found}"),
            // ROS 2's default. Of what is best effort, as this telemetry is, tf2 receives nothing.
            false => assert_eq!(found, ""),
        }
    }
    let motion = settings(Topic::Derived(Quantity::RelativeRpy));
    assert_eq!(motion, telemetry.metadata[QOS]);
}

#[test]
fn transforms_are_on_the_topics_of_ros_2_unless_the_log_has_its_own() {
    for (encoding, has_transforms, expected) in [
        (
            Encoding::Protobuf,
            false,
            ["/camera/transforms", "/camera/transforms_static"],
        ),
        (
            Encoding::Json,
            false,
            ["/camera/transforms", "/camera/transforms_static"],
        ),
        (Encoding::Ros2, false, ["/tf", "/tf_static"]),
        (
            Encoding::Ros2,
            true,
            ["/camera/transforms", "/camera/transforms_static"],
        ),
    ] {
        let format = Format {
            has_transforms,
            ..format(encoding)
        };
        let visuals = [
            Visual::Transforms(content::transforms()),
            Visual::StaticTransforms(content::static_transforms()),
        ];
        let topics = visuals.map(|visual| topic_and_type(&format, &shown(visual)).0.name());
        assert_eq!(topics, expected);
    }
}

#[test]
fn a_log_has_all_topics_and_in_ros_2_events_but_no_log() {
    for encoding in Encoding::ALL {
        let log = shown_log::write(&format(encoding));
        let summary = mcap::Summary::read(&log)
            .expect("readable")
            .expect("a summary");
        let mut found: Vec<&str> = (summary.channels.values())
            .map(|channel| channel.topic.as_str())
            .collect();
        found.sort_unstable();
        let mut expected: Vec<&str> = (VisualTopic::ALL.iter())
            .filter(|topic| match encoding {
                Encoding::Ros2 => !matches!(
                    topic,
                    VisualTopic::Log | VisualTopic::Transforms | VisualTopic::StaticTransforms
                ),
                _ => !topic.is_shared(),
            })
            .map(|topic| topic.name())
            .collect();
        expected.sort_unstable();
        assert_eq!(found, expected);
        let messages = mcap::MessageStream::new(&log).expect("a stream").count();
        // The display has two.
        assert_eq!(messages, expected.len() + 1);
    }
}
