//! JSON topics that share a schema, which lists fields that only some of them have: what their messages show decides.

use flightcam::{
    sample::Kind,
    source::{
        profile::{Profile, ProfileChoice},
        request::Request,
    },
};
use serde_json::{Value, json};

use crate::support::{enrich_bytes_with, folder::assert_reads, options, selecting::*, topics::*};

const ANGLES: [&str; 3] = ["roll", "pitch", "yaw"];
const FLAT: [&str; 6] = ["roll", "pitch", "yaw", "vx", "vy", "vz"];

/// A schema that lists numbers, some of which are required.
fn schema_of(fields: &[&str], required: &[&str]) -> Value {
    let number = |name: &&str| (name.to_string(), json!({ "type": "number" }));
    let properties: serde_json::Map<_, _> = fields.iter().map(number).collect();
    json!({ "type": "object", "properties": properties, "required": required })
}

/// A schema of everything that any of the topics has, as one type for all of them has it.
fn everything() -> Value {
    let others = ["battery", "temperature"];
    schema_of(&[&FLAT[..], &others].concat(), &[])
}

/// The same schema for all, so that the log has one record of it.
fn sharing<const N: usize>(schema: &Value, topics: [Topic; N]) -> Vec<Topic> {
    let of_schema = |topic: Topic| topic.with_schema("State", "jsonschema", schema.to_string());
    topics.into_iter().map(of_schema).collect()
}

fn battery(name: &'static str) -> Topic {
    twice(name, json!({ "battery": 0.8, "temperature": 31 }))
}

fn empty(name: &'static str) -> Topic {
    twice(name, json!({}))
}

/// All fields of the type, those that it does not have as null.
fn nulls(name: &'static str) -> Topic {
    let null = |name: &&str| (name.to_string(), Value::Null);
    twice(name, Value::Object(FLAT.iter().map(null).collect()))
}

fn angles_only(name: &'static str) -> Topic {
    let angle = |name: &&str| (name.to_string(), json!(0.1));
    twice(name, Value::Object(ANGLES.iter().map(angle).collect()))
}

#[test]
fn of_two_topics_the_one_whose_messages_have_the_fields_is_used() {
    for other in [battery, empty, nulls, angles_only] {
        for (first, second) in [("/a", "/b"), ("/b", "/a")] {
            let topics = sharing(&everything(), [flat(first), other(second)]);
            selects(&topics, &[], ("flat", first, first));
            selects(&topics, &[("--profile", "flat")], ("flat", first, first));
        }
    }
}

#[test]
fn of_three_topics_the_one_whose_messages_have_the_fields_is_used() {
    let topics = sharing(&everything(), [battery("/a"), flat("/b"), empty("/c")]);
    selects(&topics, &[], ("flat", "/b", "/b"));
}

#[test]
fn topics_that_really_have_the_fields_are_refused_and_only_those_are_named() {
    let both = sharing(&everything(), [flat("/a"), flat("/b")]);
    refuses(&both, &[], "/a and /b fit equally well");
    let topics = sharing(&everything(), [flat("/a"), battery("/b"), flat("/c")]);
    refuses(&topics, &[], "/a and /c fit equally well");
    selects(&topics, &[("--attitude", "/c")], ("flat", "/c", "/c"));
}

#[test]
fn topics_none_of_which_shows_the_fields_are_refused_as_the_schema_lists_them() {
    let topics = sharing(&everything(), [battery("/a"), empty("/b")]);
    refuses(&topics, &[], "/a and /b fit equally well");
}

#[test]
fn what_a_schema_requires_is_there() {
    let required = schema_of(&FLAT, &FLAT);
    let topics = sharing(&required, [flat("/a"), empty("/b")]);
    refuses(&topics, &[], "/a and /b fit equally well");
    // Of some fields the messages have to show that they are there, all the same.
    let partly = schema_of(&FLAT, &ANGLES);
    let topics = sharing(&partly, [flat("/a"), angles_only("/b")]);
    selects(&topics, &[], ("flat", "/a", "/a"));
}

#[test]
fn a_schema_without_properties_leaves_it_to_the_messages() {
    for schema in [
        json!({}),
        json!({ "type": "object" }),
        json!({ "properties": {} }),
    ] {
        for other in [battery, empty, nulls] {
            let topics = sharing(&schema, [flat("/a"), other("/b")]);
            selects(&topics, &[], ("flat", "/a", "/a"));
        }
    }
}

#[test]
fn a_field_that_only_a_later_message_of_the_first_has_is_there() {
    let messages = [json!({}), json!({ "battery": 0.8 })].into_iter();
    let topics = [topic("/a", messages.chain(states(3, 1.0))), battery("/b")];
    let topics = sharing(&everything(), topics);
    selects(&topics, &[], ("flat", "/a", "/a"));
}

#[test]
fn messages_that_are_not_json_show_nothing() {
    let mut torn = battery("/b");
    torn.messages = vec![b"{\"roll\": ".to_vec(); 3];
    let topics = sharing(&everything(), [flat("/a"), torn]);
    selects(&topics, &[], ("flat", "/a", "/a"));
}

#[test]
fn messages_too_long_to_be_looked_at_disprove_nothing() {
    let mut long = states(2, 1.0).next().expect("a state");
    long["note"] = "x".repeat(70_000).into();
    let topics = sharing(&everything(), [flat("/a"), twice("/b", long)]);
    refuses(&topics, &[], "/a and /b fit equally well");
}

/// For a profile that names no topics.
fn own(toml: &str) -> Request {
    let profile = Profile::parse(toml).expect("a profile");
    Request {
        profile: ProfileChoice::Given(Box::new(profile)),
        ..Request::default()
    }
}

#[test]
fn nested_fields_are_looked_for_where_they_are() {
    let profile = own(r#"
        name = "nested"
        attitude.orientation.quaternion = "pose.q"
        attitude.convention = "frd-ned"
        velocity = { vector = "pose.v", frame = "ned", required = true }"#);
    let coordinates = schema_of(&["x", "y", "z", "w"], &["x", "y", "z"]);
    let pose = json!({ "properties": { "q": coordinates, "v": coordinates } });
    let schema = json!({ "properties": { "pose": pose } });
    let whole = json!({ "pose": { "q": quaternion(), "v": vector() } });
    for other in [
        json!({}),
        json!({ "pose": null }),
        json!({ "pose": {} }),
        json!({ "pose": { "q": { "x": 0, "y": 0, "z": 0 }, "v": vector() } }),
        json!({ "pose": { "q": quaternion(), "v": null } }),
        json!({ "q": quaternion(), "v": vector() }),
    ] {
        let topics = [twice("/a", other), twice("/b", whole.clone())];
        let source = select_with(&sharing(&schema, topics), &profile).expect("a source");
        assert_eq!(used(&source), ("nested", "/b", "/b"));
    }
    let topics = ["/a", "/b"].map(|name| twice(name, whole.clone()));
    let error = select_with(&sharing(&schema, topics), &profile).expect_err("an error");
    assert_reads(&error.to_string(), "/a and /b fit equally well");
}

#[test]
fn elements_of_lists_are_looked_for() {
    let profile = own(r#"
        name = "lists"
        attitude.orientation.quaternion = ["q[0]", "q[1]", "q[2]", "q[3]"]
        attitude.convention = "frd-ned""#);
    let list = |least: u64| json!({ "items": { "type": "number" }, "minItems": least });
    let schema = |least| json!({ "properties": { "q": list(least) }, "required": ["q"] });
    let topics = [
        attitude("/a"),
        twice("/b", json!({ "q": [] })),
        twice("/c", json!({ "q": [1, 0, 0] })),
    ];
    let source = select_with(&sharing(&schema(0), topics.clone()), &profile).expect("a source");
    assert_eq!(used(&source), ("lists", "/a", ""));
    let error = select_with(&sharing(&schema(4), topics), &profile).expect_err("all have four");
    assert_reads(&error.to_string(), "/a and /b and /c fit equally well");
}

#[test]
fn a_vehicle_whose_messages_are_empty_is_none() {
    let vehicles = |second: [Topic; 2]| {
        let [pose_2, twist_2] = second;
        let first = [
            pose("/drone1/mavros/local_position/pose"),
            twist("/drone1/mavros/local_position/velocity_local"),
        ];
        let listing = json!({ "properties": { "pose": {}, "twist": {} } });
        let [pose_1, twist_1] = first;
        sharing(&listing, [pose_1, twist_1, pose_2, twist_2])
    };
    let (pose_2, twist_2) = (
        "/drone2/mavros/local_position/pose",
        "/drone2/mavros/local_position/velocity_local",
    );
    let silent = vehicles([empty(pose_2), empty(twist_2)]);
    let first = (
        "mavros",
        "/drone1/mavros/local_position/pose",
        "/drone1/mavros/local_position/velocity_local",
    );
    selects(&silent, &[], first);
    let both = vehicles([pose(pose_2), twist(twist_2)]);
    refuses(
        &both,
        &[],
        "telemetry of several vehicles … /drone1, /drone2",
    );
    selects(
        &both,
        &[("--namespace", "/drone2")],
        ("mavros", pose_2, twist_2),
    );
}

#[test]
fn of_the_topics_that_a_profile_names_the_first_that_shows_the_fields_is_used() {
    let profile = own(r#"
        name = "named"
        [attitude]
        topics = ["/a", "/b"]
        orientation.euler = { roll = "roll", pitch = "pitch", yaw = "yaw", unit = "radians" }
        [velocity]
        topics = ["/c", "/d"]
        vector = ["vx", "vy", "vz"]
        frame = "ned""#);
    let topics = [battery("/a"), flat("/b"), empty("/c"), flat("/d")];
    let source = select_with(&sharing(&everything(), topics), &profile).expect("a source");
    assert_eq!(used(&source), ("named", "/b", "/d"));
    let topics = [flat("/a"), flat("/b"), flat("/c"), flat("/d")];
    let source = select_with(&sharing(&everything(), topics), &profile).expect("a source");
    assert_eq!(used(&source), ("named", "/a", "/c"));
}

#[test]
fn of_the_alternatives_that_a_schema_lists_the_first_that_is_shown_is_used() {
    let profile = own(r#"
        name = "either"
        attitude = [
            { orientation.euler = { roll = "r", pitch = "p", yaw = "y", unit = "degrees" } },
            { orientation.euler = { roll = "roll", pitch = "pitch", yaw = "yaw", unit = "radians" } },
        ]"#);
    let schema = schema_of(&["r", "p", "y", "roll", "pitch", "yaw"], &[]);
    let topics = sharing(&schema, [flat("/a")]);
    let source = select_with(&topics, &profile).expect("a source");
    assert_eq!(source.attitude().to_string(), "/a has roll, pitch, yaw");
    let options = options().telemetry(profile);
    let (_, report) = enrich_bytes_with(&log(&topics), &options).expect("a result");
    assert_eq!(report.samples[&Kind::Attitude].tally.used, 2);
}

/// As the JSON form of protobuf does.
#[test]
fn a_velocity_that_is_left_out_while_it_is_zero_is_found_as_the_schema_lists_it() {
    let at_rest = (0..20).map(|_| json!({ "roll": 0.1, "pitch": 0.1, "yaw": 0.1 }));
    let drone = topic("/drone", at_rest.chain(states(5, 1.0)));
    let alone = sharing(&everything(), [drone.clone()]);
    selects(&alone, &[], ("flat", "/drone", "/drone"));
    let other = twice("/vio", json!({ "roll": 0, "pitch": 0, "yaw": 0 }));
    let topics = [&alone[..], &[other]].concat();
    selects(&topics, &[], ("flat", "/drone", "/drone"));
}

#[test]
fn a_gimbal_that_is_left_out_while_its_angle_is_zero_is_found_as_the_schema_lists_it() {
    let profile = own(r#"
        name = "gimballed"
        [attitude]
        topics = ["/a"]
        orientation.euler = { roll = "roll", pitch = "pitch", yaw = "yaw", unit = "radians" }
        [gimbal]
        topics = ["/gimbal"]
        orientation.pitch = { field = "tilt", unit = "degrees" }
        reference = "heading""#);
    let schema = schema_of(&["roll", "pitch", "yaw", "tilt"], &[]);
    let ahead = (0..20).map(|_| json!({}));
    let gimbal = topic("/gimbal", ahead.chain([json!({ "tilt": -30 })]));
    let topics = sharing(&schema, [flat("/a"), gimbal]);
    let source = select_with(&topics, &profile).expect("a source");
    assert_eq!(
        source.role(Kind::Gimbal).expect("a gimbal").topic,
        "/gimbal"
    );
}
