//! The layout files that Lichtblick imports and exports. Foxglove's app has files of the same kind.
//!
//! Source: <https://github.com/lichtblick-suite/lichtblick/tree/66adecb9/packages/suite-base/src>, `util/layout.ts` and
//! `panels/`.

use serde_json::{Map, Value, json};

use super::{
    panel::{Area, Direction, MapView, Panel, SceneView, Series, StateSeries, Times, View},
    settings,
};

/// So many messages with transforms are read in advance by default.
const TRANSFORMS_BY_DEFAULT: u64 = 10_000;

/// The width of a plot's legend in pixels: enough for a label.
const LEGEND: u32 = 110;

/// The layout file.
pub fn file(content: &Area) -> Value {
    let mut panels = Map::new();
    let layout = arrange(content, &mut panels);
    json!({
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": { "speed": 1 },
        "layout": layout,
    })
}

/// The tree of an area, in which everything is divided in two. The settings of its panels go to `panels`.
fn arrange(area: &Area, panels: &mut Map<String, Value>) -> Value {
    match area {
        Area::Panel(panel) => {
            let id = format!("{}!{}", kind(&panel.view), panel.id);
            panels.insert(id.clone(), panel_settings(panel));
            id.into()
        }
        Area::Split(direction, parts) => divide(*direction, parts, panels),
    }
}

fn divide(direction: Direction, parts: &[(u32, Area)], panels: &mut Map<String, Value>) -> Value {
    let total: u32 = parts.iter().map(|(share, _)| share).sum();
    match parts {
        [] => Value::Null,
        [(_, only)] => arrange(only, panels),
        [(share, first), rest @ ..] => json!({
            "direction": settings::direction(direction),
            "first": arrange(first, panels),
            "second": divide(direction, rest, panels),
            "splitPercentage": 100.0 * f64::from(*share) / f64::from(total),
        }),
    }
}

fn kind(view: &View) -> &'static str {
    match view {
        View::Scene(_) => "3D",
        View::Map(_) => "map",
        View::Plot { .. } => "Plot",
        View::Gauge { .. } => "Gauge",
        View::Indicator(_) => "Indicator",
        View::States { .. } => "StateTransitions",
        View::Log { .. } => "RosOut",
        View::Picture { .. } => "Image",
    }
}

fn panel_settings(panel: &Panel) -> Value {
    let mut settings = match &panel.view {
        View::Scene(view) => scene(view),
        View::Map(view) => map(view),
        View::Plot { series, times } => plot(series, *times),
        View::Gauge { path, highest } => settings::gauge(path, *highest),
        View::Indicator(state) => settings::indicator(state),
        View::States { series, times } => states(series, *times),
        View::Log { topic } => settings::log(topic),
        View::Picture { topic, calibration } => json!({
            "imageMode": settings::picture(topic, calibration.as_deref()),
            // Without it the viewer warns of transforms, here too.
            "scene": { "transforms": { "enablePreloading": true } },
        }),
    };
    // Each viewer reads its own.
    for key in ["foxglovePanelTitle", "lichtblickPanelTitle"] {
        settings[key] = panel.title.into();
    }
    settings
}

fn scene(view: &SceneView) -> Value {
    let frames = view.hidden_frames.iter();
    let frames = frames.map(|frame| settings::visible(&format!("frame:{frame}"), false));
    json!({
        "followTf": view.followed,
        "followMode": "follow-position",
        "cameraState": settings::camera(view),
        "scene": {
            "backgroundColor": view.background,
            "transforms": {
                "enablePreloading": true,
                "maxPreloadMessages": view.transforms.max(TRANSFORMS_BY_DEFAULT),
            },
        },
        "topics": settings::topics(view),
        "transforms": frames.collect::<Map<_, _>>(),
        "layers": settings::layers(view.grid, &view.world),
    })
}

fn map(view: &MapView) -> Value {
    let mut map = json!({
        "zoomLevel": view.zoom,
        "maxNativeZoom": 19,
        "topicColors": settings::colours(&view.shown),
        "disabledTopics": view.hidden,
    });
    if let Some([latitude, longitude]) = view.centre {
        map["center"] = json!({ "lat": latitude, "lon": longitude });
    }
    map
}

fn plot(series: &[Series], times: Times) -> Value {
    let mut plot = json!({
        "paths": settings::paths(series),
        "xAxisVal": "timestamp",
        "isSynced": true,
        "showXAxisLabels": true,
        "showYAxisLabels": true,
        "showLegend": true,
        "legendDisplay": "left",
        // Values are not rounded there, so they would be cut off, and with them their exponents.
        "showPlotValuesInLegend": false,
        "sidebarDimension": LEGEND,
    });
    if let Some([from, to]) = times {
        plot["minXValue"] = from.into();
        plot["maxXValue"] = to.into();
    }
    plot
}

fn states(series: &[StateSeries], times: Times) -> Value {
    let mut states = json!({
        "isSynced": true,
        "paths": series.iter().map(settings::states).collect::<Value>(),
    });
    if let Some([from, to]) = times {
        states["xAxisMinValue"] = from.into();
        states["xAxisMaxValue"] = to.into();
    }
    states
}
