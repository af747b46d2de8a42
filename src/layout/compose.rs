//! Which panels fit a log, and where they are in the window.

use super::{
    panel::{Area, Direction, Panel, StateSeries, View},
    plots,
    space::{map, scene},
    states,
    survey::Survey,
    types::Drawn,
};
use crate::{derived::visual::VisualTopic, log::ReadError};

/// The end of the gauge's scale where the top speed is not known, m/s.
const USUAL_SPEED: f64 = 20.0;

/// Arranges what can be shown of a log: on the left where things are, on the right how they change. `None` if it is not
/// enriched.
pub fn compose(survey: &Survey) -> Result<Option<Area>, ReadError> {
    let plots = plots::fitting(survey)?;
    if plots.is_empty() {
        return Ok(None);
    }
    let area = |panel: Option<Panel>| panel.map(Area::Panel);
    let left = [
        (54, area(scene(survey)?)),
        below(survey)?,
        (14, area(log(survey))),
    ];
    let plots = plots.into_iter().map(|plot| (17, Some(Area::Panel(plot))));
    let states = states::over_time(survey)?;
    // Each bar needs so much room, and so do the times below them.
    let share = 6 + 10 * states.len() as u32;
    let states = states_panel(survey, states)?;
    let halves = [
        (50, Area::split(Direction::Column, left)),
        (
            50,
            Area::split(Direction::Column, plots.chain([(share, area(states))])),
        ),
    ];
    Ok(Area::split(Direction::Row, halves))
}

/// What is below the 3D view: map and pictures with meters beside them, or meters alone, which need less room.
fn below(survey: &Survey) -> Result<(u32, Option<Area>), ReadError> {
    let area = |panel: Option<Panel>| panel.map(Area::Panel);
    let meters = [
        (62, area(gauge(survey)?)),
        (38, area(states::indicator(survey)?)),
    ];
    let seen = [(45, area(map(survey))), (35, area(picture(survey)?))];
    if seen.iter().all(|(_, panel)| panel.is_none()) {
        return Ok((20, Area::split(Direction::Row, meters)));
    }
    let meters = (25, Area::split(Direction::Column, meters));
    let all = seen.into_iter().chain([meters]);
    Ok((32, Area::split(Direction::Row, all)))
}

fn states_panel(survey: &Survey, series: Vec<StateSeries>) -> Result<Option<Panel>, ReadError> {
    let times = survey.times_of_flight()?;
    Ok((!series.is_empty()).then_some(Panel {
        id: "states",
        title: "States",
        view: View::States { series, times },
    }))
}

fn gauge(survey: &Survey) -> Result<Option<Panel>, ReadError> {
    let highest = survey.numbers("visuals_top_speed");
    let highest = highest.map_or(USUAL_SPEED, |[speed]| round_up(speed));
    Ok(plots::speed(survey)?.map(|path| Panel {
        id: "speed",
        title: "Speed (m/s)",
        view: View::Gauge { path, highest },
    }))
}

/// The next number that looks well at the end of a scale.
fn round_up(speed: f64) -> f64 {
    let step = match speed {
        ..10.0 => 1.0,
        ..50.0 => 5.0,
        _ => 10.0,
    };
    (speed / step).ceil().max(1.0) * step
}

/// The pictures of which the log has most. Viewers take a calibration only if it is in the same frame.
fn picture(survey: &Survey) -> Result<Option<Panel>, ReadError> {
    let of_kind = |wanted: Drawn| {
        let channels = survey.channels();
        channels.filter(move |(_, _, drawn)| *drawn == Some(wanted))
    };
    let pictures = of_kind(Drawn::Picture).max_by_key(|(_, count, _)| *count);
    let Some((pictures, ..)) = pictures else {
        return Ok(None);
    };
    let frame = survey.first_frame(pictures)?;
    let mut calibration = None;
    for (channel, ..) in of_kind(Drawn::Calibration).filter(|_| frame.is_some()) {
        if calibration.is_none() && survey.first_frame(channel)? == frame {
            calibration = Some(channel.topic.clone());
        }
    }
    Ok(Some(Panel {
        id: "picture",
        title: "Picture",
        view: View::Picture {
            topic: pictures.topic.clone(),
            calibration,
        },
    }))
}

/// What happened. In ROS 2 events are lines of a log themselves.
fn log(survey: &Survey) -> Option<Panel> {
    let topics = [VisualTopic::Log, VisualTopic::Events];
    let mut topics = topics.into_iter();
    let topic = topics.find_map(|topic| survey.drawn(topic, Drawn::LogLine))?;
    Some(Panel {
        id: "log",
        title: "What happened",
        view: View::Log { topic },
    })
}
