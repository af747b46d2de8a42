//! The layouts that Foxglove's SDK writes, for its viewer in notebooks. Foxglove says that its app does not take them.
//!
//! Source: the module `foxglove.layouts` of the Python package `foxglove-sdk` 0.30.3, version 0.62.0 of its types.

use serde_json::{Map, Value, json};

use super::{
    panel::{Area, MapView, Panel, SceneView, Series, StateSeries, Times, View},
    settings,
};

/// The layout.
pub fn file(content: &Area) -> Value {
    json!({ "version": 1, "content": arrange(content) })
}

fn arrange(area: &Area) -> Value {
    let item =
        |(share, part): &(u32, Area)| json!({ "proportion": share, "content": arrange(part) });
    match area {
        Area::Panel(panel) => self::panel(panel),
        Area::Split(direction, parts) => json!({
            "type": "split",
            "direction": settings::direction(*direction),
            "items": parts.iter().map(item).collect::<Value>(),
        }),
    }
}

fn panel(panel: &Panel) -> Value {
    let (kind, config) = match &panel.view {
        View::Scene(view) => ("ThreeDee", scene(view)),
        View::Map(view) => ("Map", map(view)),
        View::Plot { series, times } => ("Plot", plot(series, *times)),
        View::Gauge { path, highest } => ("Gauge", settings::gauge(path, *highest)),
        View::Indicator(state) => ("Indicator", settings::indicator(state)),
        View::States { series, times } => ("StateTransitions", states(series, *times)),
        View::Log { topic } => ("Log", settings::log(topic)),
        View::Picture { topic, calibration } => {
            let picture = settings::picture(topic, calibration.as_deref());
            ("Image", json!({ "imageMode": picture }))
        }
    };
    json!({
        "type": "panel",
        "panelType": kind,
        "title": panel.title,
        "config": config,
        "version": 1,
    })
}

fn scene(view: &SceneView) -> Value {
    let frames = view.hidden_frames.iter();
    let frames = frames.map(|frame| settings::visible(frame, false));
    json!({
        "followTf": view.followed,
        "fixedFrame": view.world,
        "followMode": "follow-position",
        "cameraState": settings::camera(view),
        "scene": {
            "backgroundColor": view.background,
            "transforms": { "enablePreloading": true },
        },
        "topics": settings::topics(view),
        "transforms": frames.collect::<Map<_, _>>(),
        "layers": settings::layers(view.grid, &view.world),
    })
}

/// The middle of the map cannot be set.
fn map(view: &MapView) -> Value {
    json!({
        "zoomLevel": view.zoom,
        "topicColors": settings::colours(&view.shown),
        "topicConfig": { view.track.as_str(): { "historyMode": "all" } },
        "disabledTopics": view.hidden,
    })
}

fn plot(series: &[Series], times: Times) -> Value {
    let mut plot = json!({
        "paths": settings::paths(series),
        "xAxisVal": "timestamp",
        "isSynced": true,
        "showLegend": true,
        "legendDisplay": "left",
    });
    if let Some([from, to]) = times {
        plot["timeWindowMode"] = "fixed".into();
        plot["minXValue"] = from.into();
        plot["maxXValue"] = to.into();
    }
    plot
}

fn states(series: &[StateSeries], times: Times) -> Value {
    let mut states = json!({
        "isSynced": true,
        "paths": series.iter().map(state_series).collect::<Value>(),
    });
    if let Some([from, to]) = times {
        states["timeWindowMode"] = "fixed".into();
        states["xAxisMinValue"] = from.into();
        states["xAxisMaxValue"] = to.into();
    }
    states
}

fn state_series(series: &StateSeries) -> Value {
    let state =
        |(name, colour): &(&str, &str)| json!({ "value": name, "label": name, "color": colour });
    let mut settings = settings::states(series);
    if !series.colours.is_empty() {
        settings["customStates"] = json!({
            "type": "discrete",
            "states": series.colours.iter().map(state).collect::<Value>(),
        });
    }
    settings
}
