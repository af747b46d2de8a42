//! What the log itself has is shown beside the camera's motion: pictures, flight modes; and transforms and places of its own
//! do not get mixed with flightcam's.

use serde_json::json;

use crate::support::{
    flights::recording_for,
    options,
    panels::*,
    topics::{self, Topic},
    viewing::{enriched, panels_of, with_view, with_visuals},
};

/// A log and further topics.
fn with_topics(log: &[u8], more: &[Topic]) -> Vec<u8> {
    let added = topics::log(more);
    rewritten([log, &added], |metadata| metadata)
}

#[test]
fn pictures_have_the_calibration_that_is_in_their_frame() {
    let picture = |frame: &str| {
        let message = json!({ "frame_id": frame, "format": "jpeg", "data": "" });
        topics::twice("/fpv/picture", message).of_type("foxglove.CompressedImage")
    };
    let info = |name: &'static str, frame: &str| {
        let message = json!({ "header": { "frame_id": frame }, "width": 640 });
        topics::twice(name, message).of_type("sensor_msgs/msg/CameraInfo")
    };
    let others = [info("/fpv/info", "lens"), info("/rear/info", "rear")];
    for (frame, calibration) in [
        ("lens", Some("/fpv/info")),
        ("camera_optical", Some("/camera/calibration")),
        ("elsewhere", None),
    ] {
        let [ours, rear] = others.clone();
        let log = topics::log(&[states(), picture(frame), ours, rear]);
        let panels = panels_with(
            &enriched(&log, &with_view()),
            &and(&without_height(), &["Picture"]),
        );
        let mode = &panels["Picture"].settings["imageMode"];
        assert_eq!(mode["imageTopic"], "/fpv/picture");
        assert_eq!(mode["calibrationTopic"].as_str(), calibration, "{frame}");
    }
    // Even if nothing else is shown.
    let log = topics::log(&[states(), picture("lens")]);
    panels_with(
        &enriched(&log, &options()),
        &["Picture", TURN, ATTITUDE, VELOCITY],
    );
}

#[test]
fn every_type_of_picture_is_one() {
    for name in [
        "foxglove.RawImage",
        "foxglove_msgs/msg/CompressedVideo",
        "foxglove_msgs/CompressedImage",
        "sensor_msgs/Image",
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/CompressedImage",
    ] {
        let picture = topics::twice("/fpv", json!({ "data": "" })).of_type(name);
        let log = enriched(&topics::log(&[states(), picture]), &options());
        assert!(panels_of(&log).contains_key("Picture"), "{name}");
    }
}

/// A type of px4_msgs, as far as it matters.
fn vehicle_status(name: &'static str, field: &str) -> Topic {
    let message = [&[0, 1, 0, 0][..], &[3]].concat();
    Topic {
        name,
        encoding: "cdr",
        schema: None,
        messages: vec![message.clone(), message],
    }
    .with_schema(
        "px4_msgs/msg/VehicleStatus",
        "ros2msg",
        format!("uint8 {field}\n"),
    )
}

#[test]
fn flight_modes_are_states_too() {
    let mode = |mode: &str| json!({ "mode": mode, "armed": true });
    for (profile, status, path) in [
        (
            "px4-ulog",
            topics::twice("/vehicle_status", json!({ "nav_state": 3 })),
            "/vehicle_status.nav_state",
        ),
        (
            "px4-ros2",
            vehicle_status("/fmu/out/vehicle_status_v1", "nav_state"),
            "/fmu/out/vehicle_status_v1.nav_state",
        ),
        (
            "mavros",
            topics::twice("/mavros/state", mode("AUTO.MISSION")),
            "/mavros/state.mode",
        ),
    ] {
        let log = with_topics(&recording_for(profile).log(), &[status]);
        let panels = panels_of(&enriched(&log, &with_visuals()));
        let states = &panels["States"];
        assert_eq!(states.paths(), ["/camera/state.state", path], "{profile}");
        let panels = panels_of(&enriched(&log, &options()));
        assert_eq!(panels["States"].paths(), [path], "{profile}");
    }
}

#[test]
fn what_only_looks_like_flight_modes_is_none() {
    let log = topics::log(&[
        states(),
        topics::twice("/vehicle_status_flags", json!({ "nav_state": 3 })),
        topics::twice("/vehicle_status", json!({ "nav_state": "manual" })),
        topics::twice("/state/mode", json!({ "mode": "manual" })),
        topics::twice("/mavros/state", json!({ "mode": 3 })),
        vehicle_status("/fmu/out/vehicle_status", "arming_state"),
    ]);
    panels_with(&enriched(&log, &options()), &[TURN, ATTITUDE, VELOCITY]);
}

#[test]
fn the_flight_modes_are_those_of_the_vehicle() {
    let log = topics::log(&[
        topics::attitude("/two/fmu/out/vehicle_attitude"),
        topics::twice("/one/fmu/out/vehicle_status", json!({ "nav_state": 3 })),
        topics::twice("/two/fmu/out/vehicle_status", json!({ "nav_state": 3 })),
    ]);
    let panels = panels_of(&enriched(&log, &options()));
    assert_eq!(
        panels["States"].paths(),
        ["/two/fmu/out/vehicle_status.nav_state"]
    );
}

#[test]
fn frames_have_the_names_that_they_have_in_a_log_with_transforms_of_its_own() {
    let transforms = topics::twice("/tf", json!({ "transforms": [] }));
    let log = topics::log(&[states(), transforms.of_type("tf2_msgs/msg/TFMessage")]);
    let panels = panels_with(&enriched(&log, &with_view()), &without_height());
    let scene = &panels[SCENE].settings;
    assert_eq!(scene["followTf"], "flightcam/drone_enu");
    assert_eq!(scene["layers"]["ground"]["frameId"], "flightcam/map");
}

#[test]
fn the_log_s_own_places_are_not_drawn_over_the_track() {
    let fix = topics::twice("/gps", json!({ "latitude": 47.4, "longitude": 8.5 }));
    let log = topics::log(&[states_at_a_place(), fix.of_type("foxglove.LocationFix")]);
    let panels = panels_of(&enriched(&log, &with_view()));
    assert_eq!(panels["Map"].settings["disabledTopics"], json!(["/gps"]));
}
