//! The layout for each kind of flight has the panels that fit it, and refers only to what is in the log.

use std::fs;

use flightcam::{
    Encoding, EncodingChoice,
    visuals::{VisualOptions, VisualRate},
};
use serde_json::{Value, json};

use crate::support::{
    logbook::Logbook,
    options,
    panels::*,
    topics::{self, topic},
    viewing::{enriched, panels_of, with_view, with_visuals},
};

fn keys(value: &Value) -> Vec<&str> {
    let object = value.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

#[test]
fn a_flight_with_all_that_can_be_shown() {
    let log = enriched(&survey_flight(), &with_view());
    let panels = panels_with(&log, &and(&USUAL, &["Map"]));
    let scene = &panels[SCENE].settings;
    assert_eq!(scene["followTf"], "drone_enu");
    assert_eq!(scene["followMode"], "follow-position");
    assert_eq!(scene["scene"]["transforms"]["enablePreloading"], true);
    assert_eq!(scene["layers"]["ground"]["frameId"], "map");
    for (topic, visible) in [
        ("/camera/scene", true),
        ("/camera/model", true),
        ("/camera/path", true),
        ("/camera/calibration", false),
        ("/camera/pose", false),
    ] {
        assert_eq!(scene["topics"][topic]["visible"], visible, "{topic}");
    }
    // The flight reaches over 78 m.
    let distance = scene["cameraState"]["distance"].as_f64().expect("a number");
    assert!((80.0..200.0).contains(&distance), "{distance} m");
    let grid = scene["layers"]["ground"]["size"]
        .as_f64()
        .expect("a number");
    assert!((200.0..1000.0).contains(&grid), "{grid} m");
    let map = &panels["Map"].settings;
    assert_eq!(
        keys(&map["topicColors"]),
        ["/camera/footprint", "/camera/location"]
    );
    let [latitude, longitude] = ["lat", "lon"].map(|key| map["center"][key].as_f64());
    assert!((latitude.expect("a number") - 47.398).abs() < 0.001);
    assert!((longitude.expect("a number") - 8.546).abs() < 0.001);
    assert_eq!(map["zoomLevel"], 17.0);
    // The top speed is 8.1 m/s.
    assert_eq!(panels[GAUGE].settings["maxValue"], 9.0);
    let rules = panels["Data"].settings["rules"].as_array().expect("rules");
    assert_eq!(rules[0]["rawValue"], "ok");
    assert_eq!(rules[0]["color"], "#30a46c");
    assert_eq!(
        panels[SIGHT].paths(),
        ["/camera/display.heading_unwrapped", "/camera/display.tilt"]
    );
}

#[test]
fn the_encodings_differ_in_paths_and_not_in_panels() {
    for (encoding, turn, velocity) in [
        (
            Encoding::Protobuf,
            "/camera/relative_rpy.roll",
            "/camera/velocity.x",
        ),
        (
            Encoding::Json,
            "/camera/relative_rpy.roll",
            "/camera/velocity.x",
        ),
        (
            Encoding::Ros2,
            "/camera/relative_rpy.vector.x",
            "/camera/velocity.vector.x",
        ),
    ] {
        let log = enriched(&survey_flight(), &in_encoding(encoding));
        let panels = panels_with(&log, &and(&USUAL, &["Map"]));
        for (plot, series) in [(TURN, 3), (RATE, 3), (VELOCITY, 3), (SIGHT, 2), (FLIGHT, 2)] {
            assert_eq!(panels[plot].paths().len(), series, "{plot}");
        }
        assert_eq!(panels[TURN].paths()[0], turn);
        assert_eq!(panels[VELOCITY].paths()[0], velocity);
    }
}

#[test]
fn without_visuals_there_are_plots_of_the_channels_in_their_own_units() {
    for (encoding, attitude, series) in [
        (Encoding::Protobuf, ATTITUDE, 3),
        (Encoding::Json, ATTITUDE, 3),
        (Encoding::Ros2, "Attitude of the camera (quaternion)", 4),
    ] {
        let options = options().encoding(EncodingChoice::Given(encoding));
        let log = enriched(&survey_flight(), &options);
        let panels = panels_with(&log, &[TURN, attitude, VELOCITY]);
        assert_eq!(panels[attitude].paths().len(), series);
    }
}

#[test]
fn without_positions_there_is_neither_map_nor_height() {
    let log = enriched(&topics::log(&[states()]), &with_view());
    panels_with(&log, &without_height());
}

#[test]
fn without_velocities_there_is_no_speed() {
    let attitudes = (0..100).map(|_| json!({ "q": [1, 0, 0, 0] }));
    let log = topics::log(&[topic("/fmu/out/vehicle_attitude", attitudes)]);
    let log = enriched(&log, &with_view());
    panels_with(&log, &[SCENE, "Data", "States", TURN, RATE, SIGHT]);
}

#[test]
fn without_a_field_of_view_the_map_has_the_track_alone() {
    let log = enriched(&survey_flight(), &with_visuals());
    let panels = panels_with(&log, &and(&USUAL, &["Map"]));
    assert_eq!(
        keys(&panels["Map"].settings["topicColors"]),
        ["/camera/location"]
    );
    let topics = &panels[SCENE].settings["topics"];
    assert_eq!(
        keys(topics),
        [
            "/camera/model",
            "/camera/path",
            "/camera/pose",
            "/camera/scene"
        ]
    );
}

#[test]
fn without_velocities_there_may_still_be_a_height() {
    let attitudes = topic(
        "/fmu/out/vehicle_attitude",
        (0..100).map(|_| json!({ "q": [1, 0, 0, 0] })),
    );
    let place = json!({ "lat": 47.4, "lon": 8.5, "alt": 500 });
    let places = topic(
        "/fmu/out/vehicle_global_position",
        (0..100).map(|_| place.clone()),
    );
    let log = enriched(&topics::log(&[attitudes, places]), &with_visuals());
    panels_with(
        &log,
        &[
            SCENE,
            "Map",
            "Data",
            "States",
            TURN,
            RATE,
            SIGHT,
            "Height (m)",
        ],
    );
}

#[test]
fn time_axes_are_those_of_the_flight_where_that_is_but_a_part_of_the_log() {
    for (before, times) in [(Some(0), [100.0, 102.0].map(Some)), (None, [None; 2])] {
        let mut logbook = Logbook::new();
        let state = logbook.json("/state");
        let parameters = logbook.json("/parameters");
        if let Some(time) = before {
            logbook.put(parameters, time, b"{}");
        }
        for n in 0..=40 {
            logbook.put_flat(state, 100_000 + 50 * n, "0.5", "1");
        }
        let (_folder, path) = logbook.finish();
        let log = enriched(&fs::read(path).expect("the log"), &with_visuals());
        let panels = panels_of(&log);
        let number = |panel: &str, key: &str| panels[panel].settings[key].as_f64();
        for plot in [TURN, RATE, VELOCITY, SIGHT, ONLY_SPEED] {
            assert_eq!(
                ["minXValue", "maxXValue"].map(|key| number(plot, key)),
                times
            );
        }
        let of_states = ["xAxisMinValue", "xAxisMaxValue"].map(|key| number("States", key));
        assert_eq!(of_states, times);
    }
}

/// A flight with a gap, which is an event.
fn flight_with_a_gap() -> Vec<u8> {
    let mut logbook = Logbook::new();
    let channel = logbook.json("/state");
    for n in (0..40).chain(400..440) {
        logbook.put_flat(channel, 50 * n, "0.5", "1");
    }
    let (_folder, path) = logbook.finish();
    fs::read(path).expect("the log")
}

#[test]
fn what_happened_is_in_a_log_panel() {
    for (encoding, topic) in [
        (Encoding::Protobuf, "/camera/log"),
        (Encoding::Ros2, "/camera/events"),
    ] {
        let log = enriched(&flight_with_a_gap(), &in_encoding(encoding));
        let panels = panels_with(&log, &and(&without_height(), &["What happened"]));
        let shown = &panels["What happened"].settings["topicToRender"];
        assert_eq!(shown, topic);
    }
}

#[test]
fn the_grid_is_on_the_ground() {
    use flightcam::visuals::Ground;
    let log = topics::log(&[states_at_a_place()]);
    for (ground, height) in [(None, 0.0), (Some(Ground::Altitude(480.0)), -20.0)] {
        let options = options().visuals(VisualOptions::new().ground(ground));
        let panels = panels_of(&enriched(&log, &options));
        let grid = &panels[SCENE].settings["layers"]["ground"];
        let z = grid["position"][2].as_f64().expect("a number");
        assert!((z - height).abs() < 1e-6, "{z} m");
    }
}

#[test]
fn as_many_transforms_are_read_in_advance_as_there_are() {
    let mut logbook = Logbook::with_chunks_of(1 << 20);
    let channel = logbook.json("/state");
    for n in 0..=360 {
        logbook.put_flat(channel, 500 * n, "0.5", "1");
    }
    let (_folder, path) = logbook.finish();
    let log = fs::read(path).expect("the log");
    let rate = VisualRate::from_hertz(60.0).expect("a rate");
    let options = options().visuals(VisualOptions::new().rate(rate));
    let panels = panels_of(&enriched(&log, &options));
    let transforms = &panels[SCENE].settings["scene"]["transforms"];
    // One is static; the others are 60 a second for 180 s.
    assert_eq!(transforms["maxPreloadMessages"], 10_802);
}
