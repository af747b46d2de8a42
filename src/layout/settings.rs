//! Settings of panels that are the same in both viewers. Lichtblick has its own from Foxglove.

use serde_json::{Map, Value, json};

use super::{
    colours::{FAST, GREY, SLOW},
    panel::{Direction, Grid, SceneView, Series, StateSeries},
};

pub fn direction(direction: Direction) -> &'static str {
    match direction {
        Direction::Row => "row",
        Direction::Column => "column",
    }
}

/// Where a 3D view is seen from, in the axes of the followed frame: east, north, up.
pub fn camera(view: &SceneView) -> Value {
    json!({
        "distance": view.distance,
        // The drone is in the upper half, so that the ground that it sees is in sight, too.
        "targetOffset": [0.0, 0.0, -view.distance / 5.0],
        "phi": 62,
        "thetaOffset": 40,
        "far": view.reach,
    })
}

/// What a 3D view draws, and what not: a topic that is not named is not drawn.
pub fn topics(view: &SceneView) -> Value {
    let shown = view.shown.iter().map(|topic| visible(topic, true));
    let hidden = view.hidden.iter().map(|topic| visible(topic, false));
    shown.chain(hidden).collect::<Map<_, _>>().into()
}

pub fn visible(name: &str, visible: bool) -> (String, Value) {
    (name.to_owned(), json!({ "visible": visible }))
}

/// The lines on the ground, as the only layer of a 3D view.
pub fn layers(grid: Grid, world: &str) -> Value {
    const ID: &str = "ground";
    json!({
        ID: {
            "layerId": "foxglove.Grid",
            "instanceId": ID,
            "label": "Ground",
            "frameId": world,
            "size": grid.cell * f64::from(grid.cells),
            "divisions": grid.cells,
            "lineWidth": 1,
            "color": "#7d8590aa",
            "position": [0, 0, grid.height],
            "rotation": [0, 0, 0],
            "visible": true,
            "order": 1,
        },
    })
}

/// The colours of topics.
pub fn colours(topics: &[(String, &'static str)]) -> Map<String, Value> {
    let colour = |(topic, colour): &(String, &str)| (topic.clone(), (*colour).into());
    topics.iter().map(colour).collect()
}

/// The series of a plot.
pub fn paths(series: &[Series]) -> Value {
    let path = |series: &Series| {
        json!({
            "value": series.path,
            "label": series.label,
            "color": series.colour,
            "enabled": true,
            "timestampMethod": "receiveTime",
            "lineSize": 1.5,
            "showLine": true,
        })
    };
    series.iter().map(path).collect()
}

/// A series of states, in colours that the viewer chooses.
pub fn states(states: &StateSeries) -> Value {
    json!({
        "value": states.path,
        "label": states.label,
        "enabled": true,
        "timestampMethod": "receiveTime",
    })
}

pub fn gauge(path: &str, highest: f64) -> Value {
    json!({
        "path": path,
        "minValue": 0,
        "maxValue": highest,
        "colorMode": "gradient",
        "gradient": [SLOW, FAST],
    })
}

pub fn indicator(state: &StateSeries) -> Value {
    let rule = |(name, colour): &(&str, &str)| json!({ "operator": "=", "rawValue": name, "label": name, "color": colour });
    json!({
        "path": state.path,
        "style": "background",
        "rules": state.colours.iter().map(rule).collect::<Value>(),
        "fallbackColor": GREY,
        "fallbackLabel": "not known",
    })
}

pub fn log(topic: &str) -> Value {
    json!({ "topicToRender": topic, "minLogLevel": 1 })
}

pub fn picture(topic: &str, calibration: Option<&str>) -> Value {
    let mut picture = json!({ "imageTopic": topic });
    if let Some(calibration) = calibration {
        picture["calibrationTopic"] = calibration.into();
    }
    picture
}
