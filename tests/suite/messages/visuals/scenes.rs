//! Scenes: each shape as viewers are to draw it, and what is removed.

use flightcam::derived::visual::{Join, Pose, Scene, Shape, Visual};
use serde_json::{Value, json};

use super::{PROTOBUF_TIME, assert_same, header, pose, pose_at, read_both, vector};
use crate::support::shown as content;

/// The colours of [`content`].
fn red() -> Value {
    json!({ "r": 1.0, "g": 0.0, "b": 0.0, "a": 0.5 })
}

fn green() -> Value {
    json!({ "r": 0.0, "g": 1.0, "b": 0.25, "a": 1.0 })
}

fn points(numbers: &[usize]) -> Value {
    let point = |&number: &usize| vector([number as f64, 0.5, -1.0]);
    numbers.iter().map(point).collect()
}

/// The scene with only these shapes.
fn scene_of(shapes: Vec<Shape>) -> Visual {
    Visual::Scene(Scene {
        entities: vec![content::entity("thing", shapes)],
        removed: Vec::new(),
    })
}

/// The lists of a Foxglove entity that have something, without that.
fn entity(id: &str, frame_id: &str, is_frame_locked: bool, shapes: Value) -> Value {
    let mut entity = json!({
        "timestamp": PROTOBUF_TIME,
        "frame_id": frame_id,
        "id": id,
        "frame_locked": is_frame_locked,
        "metadata": [],
        "arrows": [],
        "cubes": [],
        "spheres": [],
        "cylinders": [],
        "lines": [],
        "triangles": [],
        "texts": [],
        "models": [],
    });
    for (kind, list) in shapes.as_object().expect("lists") {
        entity[kind] = list.clone();
    }
    entity
}

fn line(kind: &str, colour: Option<Value>, colours: Value) -> Value {
    let mut line = json!({
        "type": kind,
        "pose": pose_at([0.0; 3]),
        "thickness": 2.0,
        "scale_invariant": true,
        "points": points(&[0, 1, 2, 3]),
        "colors": colours,
        "indices": [],
    });
    if let Some(colour) = colour {
        line["color"] = colour;
    }
    line
}

#[test]
fn foxglove_gets_primitives_in_pixels() {
    let [found, _] = read_both(Visual::Scene(content::scene()));
    let deletion =
        |id: &str| json!({ "timestamp": PROTOBUF_TIME, "type": "MATCHING_ID", "id": id });
    let body = json!({
        "arrows": [{
            "pose": pose(),
            "shaft_length": 1.5,
            "shaft_diameter": 0.25,
            "head_length": 0.5,
            "head_diameter": 0.5,
            "color": red(),
        }],
        "cubes": [{ "pose": pose(), "size": vector([0.5, 0.25, 0.125]), "color": green() }],
        "cylinders": [{
            "pose": pose(),
            "size": vector([1.0, 1.0, 0.5]),
            "bottom_scale": 1.0,
            "top_scale": 1.0,
            "color": red(),
        }],
        "triangles": [{
            "pose": pose_at([0.0; 3]),
            "points": points(&[0, 1, 2]),
            "color": green(),
            "colors": [],
            "indices": [],
        }],
        "texts": [{
            "pose": pose_at([0.0, 0.0, 5.0]),
            "billboard": true,
            "font_size": 14.0,
            "scale_invariant": true,
            "color": red(),
            "text": "12 m/s – größer",
        }],
    });
    let track = json!({
        "lines": [
            line("LINE_STRIP", Some(red()), json!([])),
            line("LINE_LOOP", None, json!([red(), green(), red(), green()])),
            line("LINE_LIST", Some(green()), json!([])),
        ],
    });
    let expected = json!({
        "deletions": [deletion("footprint"), deletion("track")],
        "entities": [
            entity("body", "drone", true, body),
            entity("track", "map", false, track),
        ],
    });
    assert_same(&found, &expected);
}

#[test]
fn an_arrows_head_is_a_quarter_of_it_but_at_most_four_diameters() {
    for (length, head) in [(2.0, 0.5), (4.0, 1.0), (10.0, 1.0)] {
        let arrow = Shape::Arrow {
            pose: Pose::at(Default::default()),
            length,
            diameter: 0.25,
            colour: content::RED,
        };
        let [foxglove, _] = read_both(scene_of(vec![arrow]));
        let arrow = &foxglove["entities"][0]["arrows"][0];
        assert_eq!(arrow["head_length"], json!(head));
        assert_eq!(arrow["shaft_length"], json!(length - head));
    }
}

/// A marker whose fields are those of one that draws nothing, or else as given.
fn marker(frame_id: &str, namespace: &str, id: i32, fields: Value) -> Value {
    let no_time = json!({ "sec": 0, "nanosec": 0 });
    let no_texture =
        json!({ "header": { "stamp": no_time, "frame_id": "" }, "format": "", "data": [] });
    let mut marker = json!({
        "header": header(frame_id),
        "ns": namespace,
        "id": id,
        "type": 0,
        "action": 0,
        "pose": pose_at([0.0; 3]),
        "scale": vector([0.0; 3]),
        "color": { "r": 0.0, "g": 0.0, "b": 0.0, "a": 0.0 },
        "lifetime": no_time,
        "frame_locked": false,
        "points": [],
        "colors": [],
        "texture_resource": "",
        "texture": no_texture,
        "uv_coordinates": [],
        "text": "",
        "mesh_resource": "",
        "mesh_file": { "filename": "", "data": [] },
        "mesh_use_embedded_materials": false,
    });
    for (name, value) in fields.as_object().expect("fields") {
        marker[name] = value.clone();
    }
    marker
}

const DELETE_ALL: i32 = 3;

#[test]
fn ros_2_gets_markers_in_metres() {
    let [_, found] = read_both(Visual::Scene(content::scene()));
    let deletion = |frame: &str, id: &str| marker(frame, id, -1, json!({ "action": DELETE_ALL }));
    let body = |id, mut fields: Value| {
        fields["frame_locked"] = true.into();
        marker("drone", "body", id, fields)
    };
    let track = |id, mut fields: Value| {
        fields["scale"] = vector([0.125, 0.0, 0.0]);
        marker("map", "track", id, fields)
    };
    let all = points(&[0, 1, 2, 3]);
    let closed = points(&[0, 1, 2, 3, 0]);
    let colours = json!([red(), green(), red(), green(), red()]);
    let expected = [
        // The track is drawn again, so it is removed with its own marker.
        deletion("map", "footprint"),
        deletion("drone", "body"),
        body(
            0,
            json!({ "type": 0, "pose": pose(), "scale": vector([2.0, 0.25, 0.25]), "color": red() }),
        ),
        body(
            1,
            json!({ "type": 1, "pose": pose(), "scale": vector([0.5, 0.25, 0.125]), "color": green() }),
        ),
        body(
            2,
            json!({ "type": 3, "pose": pose(), "scale": vector([1.0, 1.0, 0.5]), "color": red() }),
        ),
        body(
            3,
            json!({ "type": 11, "points": points(&[0, 1, 2]), "scale": vector([1.0; 3]), "color": green() }),
        ),
        body(
            4,
            json!({ "type": 9, "pose": pose_at([0.0, 0.0, 5.0]), "text": "12 m/s – größer", "scale": vector([0.0, 0.0, 0.75]), "color": red() }),
        ),
        deletion("map", "track"),
        track(0, json!({ "type": 4, "points": all, "color": red() })),
        track(
            1,
            json!({ "type": 4, "points": closed, "color": red(), "colors": colours }),
        ),
        track(2, json!({ "type": 5, "points": all, "color": green() })),
    ];
    assert_same(&found, &json!({ "markers": expected }));
}

#[test]
fn no_two_markers_of_a_message_have_the_same_name() {
    let [_, found] = read_both(Visual::Scene(content::scene()));
    let markers = found["markers"].as_array().expect("a list");
    let mut names: Vec<String> = (markers.iter())
        .map(|marker| format!("{} {}", marker["ns"], marker["id"]))
        .collect();
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count);
}

#[test]
fn a_loop_without_points_has_none_in_ros_2() {
    let lines = Shape::Lines {
        join: Join::Loop,
        points: Vec::new(),
        colours: Vec::new(),
        pixels: 1.0,
        width: 1.0,
    };
    let [_, found] = read_both(scene_of(vec![lines]));
    let marker = &found["markers"][1];
    assert_eq!([&marker["points"], &marker["colors"]], [&json!([]); 2]);
}
