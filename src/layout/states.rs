//! States: that of the camera's data, and the autopilot's flight modes.

use mcap::records::Channel;

use super::{
    colours::{GREEN, ORANGE, RED},
    panel::{Panel, StateSeries, View},
    survey::Survey,
};
use crate::{
    derived::visual::VisualTopic,
    log::ReadError,
    visuals::states::{NO_ATTITUDE, OK, POSITION_INVALID, VELOCITY_INVALID},
};

/// The state of the camera's data now.
pub fn indicator(survey: &Survey) -> Result<Option<Panel>, ReadError> {
    Ok(camera(survey)?.map(|state| Panel {
        id: "state",
        title: "Data",
        view: View::Indicator(state),
    }))
}

/// All states over time.
pub fn over_time(survey: &Survey) -> Result<Vec<StateSeries>, ReadError> {
    let states = [camera(survey)?, flight_modes(survey)?];
    Ok(states.into_iter().flatten().collect())
}

/// Whether everything about the camera is known.
fn camera(survey: &Survey) -> Result<Option<StateSeries>, ReadError> {
    let fields = survey.own_fields(VisualTopic::State)?;
    let path = fields.map(|fields| fields.text("state")).transpose()?;
    let partly = [VELOCITY_INVALID, POSITION_INVALID].map(|state| (state, ORANGE));
    let colours = [(OK, GREEN)].into_iter().chain(partly);
    Ok(path.flatten().map(|path| StateSeries {
        path,
        label: "data",
        colours: colours
            .chain(NO_ATTITUDE.map(|state| (state, RED)))
            .collect(),
    }))
}

/// The autopilot's flight modes, of the vehicle that the camera is on.
fn flight_modes(survey: &Survey) -> Result<Option<StateSeries>, ReadError> {
    for (channel, ..) in survey.channels() {
        let is_of_vehicle = channel.topic.starts_with(survey.namespace());
        let Some(path) = flight_mode(survey, channel)?.filter(|_| is_of_vehicle) else {
            continue;
        };
        return Ok(Some(StateSeries {
            path,
            label: "flight mode",
            colours: Vec::new(),
        }));
    }
    Ok(None)
}

/// The path of the flight mode, if a channel has it.
fn flight_mode(survey: &Survey, channel: &Channel) -> Result<Option<String>, ReadError> {
    let mut names = channel.topic.rsplit('/');
    match [names.next(), names.next()] {
        // PX4; its ROS 2 topics have a version since 1.16: vehicle_status_v1.
        [Some(name), _] if is_vehicle_status(name) => survey.fields(channel)?.number("nav_state"),
        [Some("state"), Some("mavros")] => survey.fields(channel)?.text("mode"),
        _ => Ok(None),
    }
}

fn is_vehicle_status(name: &str) -> bool {
    let Some(version) = name.strip_prefix("vehicle_status") else {
        return false;
    };
    let number = version.strip_prefix("_v");
    version.is_empty() || number.is_some_and(|number| number.parse::<u32>().is_ok())
}
