//! Layouts of viewers, and what they refer to in a log. The log is read without the program.

use std::collections::{BTreeMap, BTreeSet};

use flightcam::{Options, Viewer, Watch, layout, visuals::VisualOptions};
use mcap::{Channel, MessageStream, Summary};
use prost_reflect::{DescriptorPool, DynamicMessage, Kind, MessageDescriptor};
use serde_json::{Map, Value};
use std::sync::Arc;

use super::{enrich_bytes_with, folder::Folder, options, ros_walk, showing::with_field_of_view};

pub const VIEWERS: [Viewer; 2] = [Viewer::Lichtblick, Viewer::Foxglove];

/// A panel of a layout, whichever viewer that is for.
#[derive(Debug)]
pub struct Panel {
    /// As Lichtblick calls it.
    pub kind: String,
    pub title: String,
    pub settings: Value,
}

/// 30° below the horizon, with visuals.
pub fn with_visuals() -> Options {
    options().visuals(VisualOptions::new())
}

/// The same with a field of view.
pub fn with_view() -> Options {
    options().visuals(with_field_of_view())
}

/// Enriches a log.
pub fn enriched(log: &[u8], options: &Options) -> Vec<u8> {
    enrich_bytes_with(log, options).expect("a result").0
}

/// The layout for an enriched log.
pub fn layout_of(log: &[u8], viewer: Viewer) -> Value {
    let folder = Folder::with("log.mcap", log);
    let layout = layout(folder.path("log.mcap"), viewer, &Watch::default());
    serde_json::to_value(layout.expect("a layout")).expect("JSON")
}

/// The panels of both layouts for an enriched log, which must be the same ones and refer only to what the log has.
pub fn panels_of(log: &[u8]) -> BTreeMap<String, Panel> {
    let [lichtblick, foxglove] = VIEWERS.map(|viewer| {
        let layout = layout_of(log, viewer);
        let panels = panels(&layout);
        let contents = Contents::of(log);
        panels.iter().for_each(|panel| contents.check(panel));
        panels
    });
    let titles = |panels: &[Panel]| -> BTreeSet<(String, String)> {
        let titles = panels.iter();
        titles
            .map(|panel| (panel.kind.clone(), panel.title.clone()))
            .collect()
    };
    assert_eq!(titles(&lichtblick), titles(&foxglove));
    let panels = lichtblick.into_iter();
    panels.map(|panel| (panel.title.clone(), panel)).collect()
}

fn object(value: &Value) -> &Map<String, Value> {
    value
        .as_object()
        .unwrap_or_else(|| panic!("an object: {value}"))
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("a text: {value}"))
}

/// The panels of a layout, each of which is in its tree once.
pub fn panels(layout: &Value) -> Vec<Panel> {
    let mut panels = Vec::new();
    if layout["version"] == 1 {
        add_foxglove(&layout["content"], &mut panels);
        return panels;
    }
    let keys: Vec<&String> = object(layout).keys().collect();
    let expected = [
        "configById",
        "globalVariables",
        "layout",
        "playbackConfig",
        "userNodes",
    ];
    assert_eq!(keys, expected);
    assert_eq!(layout["playbackConfig"]["speed"], 1);
    let mut leaves = Vec::new();
    add_leaves(&layout["layout"], &mut leaves);
    let settings = object(&layout["configById"]);
    let ids: BTreeSet<&str> = leaves.iter().map(String::as_str).collect();
    assert_eq!(ids.len(), leaves.len(), "each panel is there once");
    assert_eq!(ids, settings.keys().map(String::as_str).collect());
    for (id, settings) in settings {
        let title = text(&settings["lichtblickPanelTitle"]);
        assert_eq!(title, text(&settings["foxglovePanelTitle"]));
        panels.push(Panel {
            kind: id.split('!').next().expect("a kind").to_owned(),
            title: title.to_owned(),
            settings: settings.clone(),
        });
    }
    panels
}

fn add_leaves(tree: &Value, leaves: &mut Vec<String>) {
    if let Value::String(leaf) = tree {
        return leaves.push(leaf.clone());
    }
    assert!(["row", "column"].contains(&text(&tree["direction"])));
    let share = tree["splitPercentage"].as_f64().expect("a number");
    assert!((1.0..=99.0).contains(&share), "{share} %");
    for part in ["first", "second"] {
        add_leaves(&tree[part], leaves);
    }
}

fn add_foxglove(tree: &Value, panels: &mut Vec<Panel>) {
    if tree["type"] == "split" {
        assert!(["row", "column"].contains(&text(&tree["direction"])));
        for item in tree["items"].as_array().expect("items") {
            assert!(item["proportion"].as_f64().is_some_and(|share| share > 0.0));
            add_foxglove(&item["content"], panels);
        }
        return;
    }
    assert_eq!(tree["type"], "panel");
    assert_eq!(tree["version"], 1);
    let kind = match text(&tree["panelType"]) {
        "ThreeDee" => "3D",
        "Map" => "map",
        "Log" => "RosOut",
        kind => kind,
    };
    panels.push(Panel {
        kind: kind.to_owned(),
        title: text(&tree["title"]).to_owned(),
        settings: tree["config"].clone(),
    });
}

impl Panel {
    /// The message paths of its series.
    pub fn paths(&self) -> Vec<&str> {
        let series = self.settings["paths"].as_array().into_iter().flatten();
        series.map(|series| text(&series["value"])).collect()
    }
}

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Holds {
    Number,
    /// One of 64 bits, which gauges do not show.
    LongInteger,
    Text,
}

/// What a log has that a layout may refer to.
struct Contents {
    channels: BTreeMap<String, Arc<Channel<'static>>>,
    frames: BTreeSet<String>,
    /// The first message of each topic.
    first: BTreeMap<String, Vec<u8>>,
}

impl Contents {
    fn of(log: &[u8]) -> Self {
        let summary = Summary::read(log).expect("readable").expect("a summary");
        let channels = summary.channels.values();
        let mut contents = Self {
            channels: channels
                .map(|channel| (channel.topic.clone(), Arc::clone(channel)))
                .collect(),
            frames: BTreeSet::new(),
            first: BTreeMap::new(),
        };
        for message in MessageStream::new(log).expect("a readable log") {
            let message = message.expect("a message");
            contents.add_frames(&message.channel, &message.data);
            let topic = message.channel.topic.clone();
            contents
                .first
                .entry(topic)
                .or_insert_with(|| message.data.to_vec());
        }
        contents
            .channels
            .retain(|topic, _| contents.first.contains_key(topic));
        contents
    }

    /// Adds the frames that a message with transforms names.
    fn add_frames(&mut self, channel: &Channel, payload: &[u8]) {
        let Some(schema) = &channel.schema else {
            return;
        };
        let message = match schema.name.as_str() {
            "foxglove.FrameTransforms" => {
                let message = DynamicMessage::decode(descriptor(channel), payload);
                serde_json::to_value(message.expect("a message")).expect("JSON")
            }
            "tf2_msgs/msg/TFMessage" if channel.message_encoding == "cdr" => {
                let types = ros_walk::types(&schema.name, as_text(&schema.data));
                ros_walk::deserialize(&types, "tf2_msgs/TFMessage", payload)
            }
            _ => return,
        };
        for transform in message["transforms"].as_array().expect("a list") {
            for frame in [
                &transform["parentFrameId"],
                &transform["childFrameId"],
                &transform["header"]["frame_id"],
                &transform["child_frame_id"],
            ] {
                self.frames.extend(frame.as_str().map(str::to_owned));
            }
        }
    }

    /// Checks that what a panel refers to is there, and is of a kind that it can show.
    fn check(&self, panel: &Panel) {
        let Panel {
            kind,
            title,
            settings,
        } = panel;
        match kind.as_str() {
            "3D" => {
                let followed = [&settings["followTf"], &settings["fixedFrame"]];
                let followed = followed.into_iter().filter_map(Value::as_str);
                let layers = object(&settings["layers"]).iter().map(|(id, layer)| {
                    assert_eq!(text(&layer["instanceId"]), id);
                    text(&layer["frameId"])
                });
                let hidden = object(&settings["transforms"]).keys();
                let hidden = hidden.map(|key| key.strip_prefix("frame:").unwrap_or(key));
                for frame in followed.chain(layers).chain(hidden) {
                    assert!(self.frames.contains(frame), "{title}: {frame}");
                }
                self.has_topics(title, object(&settings["topics"]).keys());
            }
            "map" => {
                self.has_topics(title, object(&settings["topicColors"]).keys());
                if let Value::Object(topics) = &settings["topicConfig"] {
                    self.has_topics(title, topics.keys());
                }
                let hidden = settings["disabledTopics"].as_array().expect("a list");
                self.has_topics(title, hidden.iter().map(text));
            }
            "Plot" => {
                let paths = panel.paths();
                assert!(!paths.is_empty(), "{title} is empty");
                for path in paths {
                    assert_ne!(self.holds(path), Holds::Text, "{title}: {path}");
                    let is_for_people = path.starts_with("/camera/display.");
                    assert!(is_for_people || !title.contains('°'), "{title}: {path}");
                    assert!(!(is_for_people && title.contains("rad")), "{title}: {path}");
                }
            }
            "Gauge" => {
                let path = text(&settings["path"]);
                assert_eq!(self.holds(path), Holds::Number, "{title}: {path}");
                assert!(settings["maxValue"].as_f64() > settings["minValue"].as_f64());
            }
            "Indicator" => {
                let path = text(&settings["path"]);
                assert_eq!(self.holds(path), Holds::Text, "{title}: {path}");
            }
            "StateTransitions" => {
                assert!(!panel.paths().is_empty(), "{title} is empty");
                panel.paths().into_iter().for_each(|path| {
                    self.holds(path);
                });
            }
            "RosOut" => self.has_topics(title, [text(&settings["topicToRender"])]),
            "Image" => {
                let picture = &settings["imageMode"];
                self.has_topics(title, [text(&picture["imageTopic"])]);
                self.has_topics(title, picture["calibrationTopic"].as_str());
            }
            other => panic!("a panel of an unknown kind: {other}"),
        }
    }

    fn has_topics(&self, title: &str, topics: impl IntoIterator<Item = impl AsRef<str>>) {
        for topic in topics {
            let topic = topic.as_ref();
            assert!(self.channels.contains_key(topic), "{title}: {topic}");
        }
    }

    /// What the field of a message path holds, by the schema of its topic.
    fn holds(&self, path: &str) -> Holds {
        let (topic, field) = match path.strip_prefix('"') {
            Some(quoted) => quoted.split_once("\".").expect("a field"),
            None => path.split_once('.').expect("a field"),
        };
        assert!(!field.contains('@'), "a modifier: {path}");
        let channel = self.channels.get(topic);
        let channel = channel.unwrap_or_else(|| panic!("no topic {topic}"));
        match channel.message_encoding.as_str() {
            "protobuf" => in_protobuf(descriptor(channel), field),
            "json" => in_json(channel, &self.first[topic], field),
            "cdr" => in_ros2(channel, field),
            other => panic!("{other}"),
        }
    }
}

fn as_text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

fn descriptor(channel: &Channel) -> MessageDescriptor {
    let schema = channel.schema.as_ref().expect("a schema");
    let pool = DescriptorPool::decode(&schema.data[..]).expect("descriptors");
    pool.get_message_by_name(&schema.name).expect("the type")
}

fn in_protobuf(mut message: MessageDescriptor, field: &str) -> Holds {
    let mut names = field.split('.').peekable();
    while let Some(name) = names.next() {
        let found = message.get_field_by_name(name);
        let found = found.unwrap_or_else(|| panic!("no {field} in {}", message.full_name()));
        assert!(!found.is_list() && !found.is_map(), "{field}");
        match (found.kind(), names.peek()) {
            (Kind::Message(within), Some(_)) => message = within,
            (Kind::String, None) => return Holds::Text,
            (Kind::Int64 | Kind::Uint64 | Kind::Sint64 | Kind::Fixed64 | Kind::Sfixed64, None) => {
                return Holds::LongInteger;
            }
            (Kind::Bytes | Kind::Message(_), None) | (_, Some(_)) => panic!("{field}"),
            (_, None) => return Holds::Number,
        }
    }
    panic!("an empty path")
}

/// By the schema or, if that lists no fields, by a message.
fn in_json(channel: &Channel, message: &[u8], field: &str) -> Holds {
    let parse = |json: &[u8]| serde_json::from_slice::<Value>(json).expect("JSON");
    let schema = channel.schema.as_ref().map(|schema| parse(&schema.data));
    if let Some(mut place) = schema.filter(|schema| schema["properties"].is_object()) {
        for name in field.split('.') {
            place = place["properties"][name].clone();
        }
        return match place["type"].as_str() {
            Some("number" | "integer") => Holds::Number,
            Some("string") => Holds::Text,
            _ => panic!("no {field}"),
        };
    }
    let place = format!("/{}", field.replace('.', "/"));
    match parse(message).pointer(&place) {
        Some(Value::Number(_)) => Holds::Number,
        Some(Value::String(_)) => Holds::Text,
        other => panic!("{field} is {other:?}"),
    }
}

fn in_ros2(channel: &Channel, field: &str) -> Holds {
    let schema = channel.schema.as_ref().expect("a schema");
    let types = ros_walk::types(&schema.name, as_text(&schema.data));
    match &*ros_walk::type_of(&types, &ros_walk::short(&schema.name), field) {
        "string" => Holds::Text,
        "int64" | "uint64" => Holds::LongInteger,
        "bool" | "int8" | "uint8" | "int16" | "uint16" | "int32" | "uint32" | "float32"
        | "float64" => Holds::Number,
        other => panic!("{field} is {other}"),
    }
}
