//! Each kind of content but scenes, read field by field.

use flightcam::{
    derived::visual::{Display, Footprint, Location, State, Transform, Visual},
    messages::{Encoding, Format, LAST_SECOND},
};
use serde_json::{Value, json};

use super::{
    PROTOBUF_TIME, assert_same, format, header, not_turned, pose, quaternion, read, read_both,
    shown, topic_and_type, vector,
};
use crate::support::shown as content;

#[test]
fn transforms_are_the_poses_of_frames_in_their_parents() {
    for visual in [Visual::Transforms, Visual::StaticTransforms] {
        let [foxglove, ros2] = read_both(visual(content::transforms()));
        let turned = quaternion([-0.5, 0.5, -0.5, 0.5]);
        let expected = [
            ("map", "drone", [1.5, -2.5, 30.25], &turned),
            ("drone", "camera", [0.0, 0.25, 0.0], &not_turned()),
        ];
        let in_foxglove = expected.map(|(parent, child, translation, rotation)| {
            json!({
                "timestamp": PROTOBUF_TIME,
                "parent_frame_id": parent,
                "child_frame_id": child,
                "translation": vector(translation),
                "rotation": rotation,
            })
        });
        assert_same(&foxglove, &json!({ "transforms": in_foxglove }));
        let in_ros2 = expected.map(|(parent, child, translation, rotation)| {
            json!({
                "header": header(parent),
                "child_frame_id": child,
                "transform": { "translation": vector(translation), "rotation": rotation },
            })
        });
        assert_same(&ros2, &json!({ "transforms": in_ros2 }));
    }
}

#[test]
fn odometry_is_of_the_camera_in_the_map() {
    let [foxglove, ros2] = read_both(Visual::Odometry(content::odometry()));
    let (linear, angular) = (vector([12.5, 0.0, -1.25]), vector([0.125, -0.5, 0.75]));
    let expected = json!({
        "timestamp": PROTOBUF_TIME,
        "frame_id": "map",
        "body_frame_id": "camera",
        "pose": pose(),
        "linear_velocity": linear,
        "angular_velocity": angular,
        "pose_covariance": [],
        "velocity_covariance": [],
        "metadata": [],
    });
    assert_same(&foxglove, &expected);
    let unknown = vec![0.0; 36];
    let expected = json!({
        "header": header("map"),
        "child_frame_id": "camera",
        "pose": { "pose": pose(), "covariance": unknown },
        "twist": { "twist": { "linear": linear, "angular": angular }, "covariance": unknown },
    });
    assert_same(&ros2, &expected);
}

#[test]
fn a_pose_is_in_the_map() {
    let [foxglove, ros2] = read_both(Visual::Pose(content::pose()));
    let expected = json!({ "timestamp": PROTOBUF_TIME, "frame_id": "map", "pose": pose() });
    assert_same(&foxglove, &expected);
    assert_same(&ros2, &json!({ "header": header("map"), "pose": pose() }));
}

#[test]
fn a_location_has_a_heading_and_perhaps_a_velocity() {
    let without_velocity = Location {
        velocity_enu: None,
        ..content::location()
    };
    for (location, velocity) in [
        (content::location(), Some(vector([3.0, -4.0, 0.5]))),
        (without_velocity, None),
    ] {
        let [foxglove, ros2] = read_both(Visual::Location(location));
        let mut expected = json!({
            "timestamp": PROTOBUF_TIME,
            "frame_id": "camera",
            "latitude": 47.25,
            "longitude": -8.5,
            "altitude": 512.75,
            "position_covariance": [],
            "position_covariance_type": "UNKNOWN",
            "heading": 1.5,
            "metadata": [],
        });
        if let Some(velocity) = velocity {
            expected["velocity"] = velocity;
        }
        assert_same(&foxglove, &expected);
        let expected = json!({
            "header": header("camera"),
            "status": { "status": 0, "service": 0 },
            "latitude": 47.25,
            "longitude": -8.5,
            "altitude": 512.75,
            "position_covariance": vec![0.0; 9],
            "position_covariance_type": 0,
        });
        assert_same(&ros2, &expected);
    }
}

#[test]
fn a_calibration_is_that_of_a_pinhole_camera() {
    let [foxglove, ros2] = read_both(Visual::Calibration(content::calibration()));
    let k = json!([1000.5, 0.0, 960.0, 0.0, 1001.5, 540.0, 0.0, 0.0, 1.0]);
    let r = json!([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let p = json!([
        1000.5, 0.0, 960.0, 0.0, 0.0, 1001.5, 540.0, 0.0, 0.0, 0.0, 1.0, 0.0
    ]);
    let expected = json!({
        "timestamp": PROTOBUF_TIME,
        "frame_id": "camera_optical",
        "width": 1920,
        "height": 1080,
        "distortion_model": "plumb_bob",
        "D": vec![0.0; 5],
        "K": k,
        "R": r,
        "P": p,
    });
    assert_same(&foxglove, &expected);
    let whole =
        json!({ "x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": false });
    let expected = json!({
        "header": header("camera_optical"),
        "height": 1080,
        "width": 1920,
        "distortion_model": "plumb_bob",
        "d": vec![0.0; 5],
        "k": k,
        "r": r,
        "p": p,
        "binning_x": 0,
        "binning_y": 0,
        "roi": whole,
    });
    assert_same(&ros2, &expected);
}

#[test]
fn a_footprint_is_geojson() {
    let footprint = Footprint {
        geojson: content::geojson().to_owned(),
    };
    for found in read_both(Visual::Footprint(footprint)) {
        assert_same(&found, &json!({ "geojson": content::geojson() }));
    }
}

#[test]
fn an_event_is_a_warning_in_ros_2() {
    let [foxglove, ros2] = read_both(Visual::Event(content::event()));
    let expected = json!({
        "start_time": PROTOBUF_TIME,
        "end_time": "1970-01-01T00:00:07.000000009Z",
        "metadata": [
            { "key": "kind", "value": "gap" },
            { "key": "text", "value": "No attitude for 5 s" },
        ],
    });
    assert_same(&foxglove, &expected);
    let expected = json!({
        "stamp": { "sec": 2, "nanosec": 3 },
        "level": 30,
        "name": "flightcam",
        "msg": "No attitude for 5 s",
        "file": "",
        "function": "",
        "line": 0,
    });
    assert_same(&ros2, &expected);
}

#[test]
fn a_line_of_the_log_is_a_warning() {
    let shown = shown(Visual::Log(content::event()));
    let expected = json!({
        "timestamp": PROTOBUF_TIME,
        "level": "WARNING",
        "message": "No attitude for 5 s",
        "name": "flightcam",
        "file": "",
        "line": 0,
    });
    for encoding in [Encoding::Protobuf, Encoding::Json] {
        assert_same(&read(&format(encoding), &shown), &expected);
    }
}

/// The program's own types in each encoding, without the time.
fn read_own(visual: Visual) -> [Value; 3] {
    let shown = shown(visual);
    Encoding::ALL.map(|encoding| {
        let mut message = read(&format(encoding), &shown);
        let fields = message.as_object_mut().expect("fields");
        let time = fields.remove("timestamp").or(fields.remove("header"));
        let expected = match encoding {
            Encoding::Protobuf => json!(PROTOBUF_TIME),
            Encoding::Json => json!({ "sec": 2, "nsec": 3 }),
            _ => header("camera"),
        };
        assert_eq!(time, Some(expected));
        message
    })
}

#[test]
fn a_state_is_a_word_or_two() {
    let name = "no attitude";
    for found in read_own(Visual::State(State { name })) {
        assert_same(&found, &json!({ "state": name }));
    }
}

#[test]
fn a_display_has_all_numbers_that_are_known() {
    let expected = json!({
        "heading": 359.5,
        "heading_unwrapped": -0.5,
        "tilt": -30.25,
        "roll": 0.0,
        "roll_rate": 1.5,
        "pitch_rate": -2.5,
        "yaw_rate": 0.125,
        "speed": 12.5,
        "ground_speed": 12.25,
        "climb": 0.0,
        "height": 81.5,
    });
    for found in read_own(Visual::Display(content::display())) {
        assert_same(&found, &expected);
    }
}

#[test]
fn a_number_that_is_not_known_is_absent_and_nan_in_ros_2() {
    let display = Display {
        speed: Some(0.0),
        ..content::display_of_little()
    };
    let [protobuf, json, ros2] = read_own(Visual::Display(display));
    let mut expected = json!({
        "heading": 90.0,
        "heading_unwrapped": 0.0,
        "tilt": 0.0,
        "roll": 0.0,
        "speed": 0.0,
    });
    assert_same(&protobuf, &expected);
    assert_same(&json, &expected);
    for name in [
        "roll_rate",
        "pitch_rate",
        "yaw_rate",
        "ground_speed",
        "climb",
        "height",
    ] {
        expected[name] = Value::Null;
    }
    assert_same(&ros2, &expected);
}

/// The names of frames anywhere in a message.
fn frames(message: &Value) -> Vec<String> {
    let fields: Vec<(&str, &Value)> = match message {
        Value::Object(fields) => fields
            .iter()
            .map(|(name, value)| (&**name, value))
            .collect(),
        Value::Array(list) => list.iter().map(|value| ("", value)).collect(),
        _ => Vec::new(),
    };
    let names = fields
        .iter()
        .flat_map(|(name, value)| match value.as_str() {
            // A marker has a texture in no frame.
            Some("") => Vec::new(),
            Some(frame) if name.ends_with("frame_id") => vec![frame.to_owned()],
            _ => frames(value),
        });
    names.collect()
}

#[test]
fn frames_have_a_prefix_in_a_log_that_has_transforms_of_its_own() {
    for encoding in Encoding::ALL {
        let alone = format(encoding);
        let beside_others = Format {
            has_transforms: true,
            ..alone.clone()
        };
        let mut count = 0;
        for visual in content::visuals() {
            let shown = shown(visual);
            let (_, Some(_)) = topic_and_type(&alone, &shown) else {
                continue;
            };
            let without = frames(&read(&alone, &shown));
            let with = frames(&read(&beside_others, &shown));
            let expected: Vec<String> = without
                .iter()
                .map(|frame| format!("flightcam/{frame}"))
                .collect();
            assert_eq!(with, expected);
            count += usize::from(!with.is_empty());
        }
        let expected = match encoding {
            // The state and the displays, too.
            Encoding::Ros2 => 12,
            _ => 9,
        };
        assert_eq!(count, expected);
    }
}

#[test]
fn every_frame_has_a_name() {
    use flightcam::derived::visual::Frame::{Camera, CameraOptical, Drone, DroneEnu, Map, Ned};
    let transforms = [
        (Map, Ned),
        (Map, Drone),
        (Map, DroneEnu),
        (Drone, Camera),
        (Camera, CameraOptical),
    ];
    let transforms = transforms.map(|(parent, child)| Transform {
        parent,
        child,
        pose: content::pose(),
    });
    let shown = shown(Visual::StaticTransforms(transforms.into()));
    for (has_transforms, prefix) in [(false, ""), (true, "flightcam/")] {
        let format = Format {
            has_transforms,
            ..format(Encoding::Protobuf)
        };
        let message = read(&format, &shown);
        let children: Vec<&str> = (message["transforms"].as_array().expect("a list").iter())
            .map(|transform| transform["child_frame_id"].as_str().expect("a name"))
            .collect();
        let expected = ["ned", "drone", "drone_enu", "camera", "camera_optical"];
        assert_eq!(children, expected.map(|name| format!("{prefix}{name}")));
    }
}

#[test]
fn times_that_a_type_does_not_have_become_its_last() {
    let state = Visual::State(State { name: "ok" });
    let seconds = |second: u64| second * 1_000_000_000 + 5;
    let read_at = |encoding, second, visual: &Visual| {
        let mut shown = shown(visual.clone());
        shown.time = seconds(second);
        read(&format(encoding), &shown)
    };
    let stamp = |second| read_at(Encoding::Ros2, second, &state)["header"]["stamp"].clone();
    assert_eq!(stamp(LAST_SECOND), json!({ "sec": i32::MAX, "nanosec": 5 }));
    let last = json!({ "sec": i32::MAX, "nanosec": 999_999_999 });
    assert_eq!(stamp(LAST_SECOND + 1), last);

    let pose = Visual::Pose(content::pose());
    let timestamp = |second| read_at(Encoding::Protobuf, second, &pose)["timestamp"].clone();
    let last_second = u64::from(u32::MAX);
    assert_eq!(timestamp(last_second), "2106-02-07T06:28:15.000000005Z");
    assert_eq!(timestamp(last_second + 1), "2106-02-07T06:28:15.999999999Z");
    // The program's own types go further.
    let own = read_at(Encoding::Protobuf, last_second + 1, &state);
    assert_eq!(own["timestamp"], "2106-02-07T06:28:16.000000005Z");
}
