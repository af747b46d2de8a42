//! Types and their definitions.

use std::collections::BTreeSet;

use flightcam::{
    derived::visual::VisualTopic,
    messages::{Encoding, MessageDefinition, Topic},
};
use prost_reflect::{DescriptorPool, FieldDescriptor};
use serde_json::json;

use super::format;
use crate::support::ros_walk;

/// The types on each topic: in a protobuf log and in a ROS 2 log.
const TYPES: [(VisualTopic, &str, Option<&str>); 16] = {
    const TRANSFORMS: (&str, Option<&str>) =
        ("foxglove.FrameTransforms", Some("tf2_msgs/msg/TFMessage"));
    const SCENE: (&str, Option<&str>) = (
        "foxglove.SceneUpdate",
        Some("visualization_msgs/msg/MarkerArray"),
    );
    [
        (VisualTopic::StaticTransforms, TRANSFORMS.0, TRANSFORMS.1),
        (VisualTopic::TfStatic, TRANSFORMS.0, TRANSFORMS.1),
        (VisualTopic::Transforms, TRANSFORMS.0, TRANSFORMS.1),
        (VisualTopic::Tf, TRANSFORMS.0, TRANSFORMS.1),
        (
            VisualTopic::Odometry,
            "foxglove.Odometry",
            Some("nav_msgs/msg/Odometry"),
        ),
        (
            VisualTopic::Pose,
            "foxglove.PoseInFrame",
            Some("geometry_msgs/msg/PoseStamped"),
        ),
        (
            VisualTopic::Location,
            "foxglove.LocationFix",
            Some("sensor_msgs/msg/NavSatFix"),
        ),
        (VisualTopic::Model, SCENE.0, SCENE.1),
        (VisualTopic::Scene, SCENE.0, SCENE.1),
        (VisualTopic::Path, SCENE.0, SCENE.1),
        (
            VisualTopic::Calibration,
            "foxglove.CameraCalibration",
            Some("sensor_msgs/msg/CameraInfo"),
        ),
        (
            VisualTopic::Footprint,
            "foxglove.GeoJSON",
            Some("foxglove_msgs/msg/GeoJSON"),
        ),
        (
            VisualTopic::Events,
            "foxglove.Event",
            Some("rcl_interfaces/msg/Log"),
        ),
        (VisualTopic::Log, "foxglove.Log", None),
        (
            VisualTopic::State,
            "flightcam.v1.CameraState",
            Some("flightcam_msgs/msg/CameraState"),
        ),
        (
            VisualTopic::Display,
            "flightcam.v1.CameraDisplay",
            Some("flightcam_msgs/msg/CameraDisplay"),
        ),
    ]
};

fn definition(encoding: Encoding, topic: VisualTopic) -> Option<MessageDefinition> {
    format(encoding).definition(Topic::Visual(topic))
}

/// The topics whose types are the program's own.
const OWN: [VisualTopic; 2] = [VisualTopic::State, VisualTopic::Display];

#[test]
fn each_topic_has_a_type_that_viewers_know() {
    assert_eq!(TYPES.map(|(topic, _, _)| topic), VisualTopic::ALL);
    for (topic, protobuf, ros2) in TYPES {
        let found = Encoding::ALL.map(|encoding| {
            let definition = definition(encoding, topic)?;
            let MessageDefinition { name, encoding, .. } = definition;
            Some((name, definition.message_encoding, encoding))
        });
        let in_json = match OWN.contains(&topic) {
            true => (protobuf, "json", "jsonschema"),
            false => (protobuf, "protobuf", "protobuf"),
        };
        let expected = [
            Some((protobuf, "protobuf", "protobuf")),
            Some(in_json),
            ros2.map(|name| (name, "cdr", "ros2msg")),
        ];
        assert_eq!(found, expected, "{topic:?}");
    }
}

#[test]
fn each_definition_has_the_types_that_it_refers_to_and_no_others() {
    for (topic, protobuf, ros2) in TYPES {
        let definition_in = |encoding| definition(encoding, topic);
        let data = definition_in(Encoding::Protobuf).expect("a type").data;
        // It refuses to resolve a type that is not there.
        let pool = DescriptorPool::decode(data).expect("whole");
        assert!(pool.get_message_by_name(protobuf).is_some(), "{protobuf}");

        let Some(name) = ros2 else { continue };
        let data = definition_in(Encoding::Ros2).expect("a type").data;
        let text = std::str::from_utf8(data).expect("UTF-8");
        assert!(!text.contains('\r'));
        let types = ros_walk::types(name, text);
        let referred_to = ros_walk::referred_to(&types, &ros_walk::short(name));
        let defined: BTreeSet<String> = types.0.into_keys().collect();
        assert_eq!(defined, referred_to, "{name}");
    }
}

/// The type of a field in protobuf, of a path like `pose.position.x`.
fn protobuf_type_of(definition: &MessageDefinition, path: &str) -> String {
    let pool = DescriptorPool::decode(definition.data).expect("descriptors");
    let mut message = pool.get_message_by_name(definition.name);
    let mut found = String::new();
    for name in path.split('.') {
        let field = message.expect("a message").get_field_by_name(name);
        let kind = field.unwrap_or_else(|| panic!("no {path}")).kind();
        found = format!("{kind:?}");
        message = kind.as_message().cloned();
    }
    found
}

#[test]
fn a_field_to_plot_is_a_number_of_its_type() {
    let mut count = 0;
    for topic in VisualTopic::ALL {
        let definitions = [Encoding::Protobuf, Encoding::Ros2].map(|each| definition(each, topic));
        for definition in definitions.into_iter().flatten() {
            let Some(path) = definition.field_to_plot else {
                continue;
            };
            let kind = match definition.encoding {
                "protobuf" => protobuf_type_of(&definition, path),
                _ => {
                    let text = std::str::from_utf8(definition.data).expect("UTF-8");
                    let types = ros_walk::types(definition.name, text);
                    ros_walk::type_of(&types, &ros_walk::short(definition.name), path)
                }
            };
            let numbers = ["double", "float", "float64", "float32"];
            assert!(numbers.contains(&&*kind), "{path} in {topic:?}: {kind}");
            count += 1;
        }
    }
    assert_eq!(count, 8);
}

#[test]
fn json_schemas_explain_every_field_of_the_programs_own_messages() {
    for topic in OWN {
        let protobuf = definition(Encoding::Protobuf, topic).expect("a type");
        let pool = DescriptorPool::decode(protobuf.data).expect("descriptors");
        let message = pool.get_message_by_name(protobuf.name).expect("the type");
        let names = |wanted: &dyn Fn(&FieldDescriptor) -> bool| -> Vec<String> {
            let fields = message.fields().filter(|field| wanted(field));
            fields.map(|field| field.name().to_owned()).collect()
        };
        let always = names(&|field| field.name() == "timestamp" || !field.supports_presence());

        let json = definition(Encoding::Json, topic).expect("a type");
        let schema: serde_json::Value = serde_json::from_slice(json.data).expect("JSON");
        assert_eq!(schema["title"], json.name);
        assert_eq!(schema["required"], json!(always));
        let properties = schema["properties"].as_object().expect("properties");
        let explained: BTreeSet<String> = properties.keys().cloned().collect();
        assert_eq!(explained, names(&|_| true).into_iter().collect());
        for (name, property) in properties {
            assert!(property["description"].is_string(), "{name}");
            let kind = match name.as_str() {
                "timestamp" => "object",
                "state" => "string",
                _ => "number",
            };
            assert_eq!(property["type"], kind, "{name}");
        }
    }
}
