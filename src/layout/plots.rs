//! Numbers over time.

use super::{
    colours::{BLUE, GREEN, GREY, ORANGE, PURPLE, RED},
    panel::{Panel, Series, View},
    survey::Survey,
};
use crate::{
    derived::{Quantity, visual::VisualTopic},
    log::ReadError,
    messages::Topic,
};

const TURN: Topic = Topic::Derived(Quantity::RelativeRpy);
const ORIENTATION: Topic = Topic::Derived(Quantity::Orientation);
const VELOCITY: Topic = Topic::Derived(Quantity::CameraVelocity);
const DISPLAY: Topic = Topic::Visual(VisualTopic::Display);
const POSE: Topic = Topic::Visual(VisualTopic::Pose);

/// A plot that a log may have.
struct Plot {
    id: &'static str,
    title: &'static str,
    series: &'static [Line],
}

/// A series that a log may have.
struct Line {
    label: &'static str,
    colour: &'static str,
    topic: Topic,
    /// The field in the messages of each encoding.
    fields: &'static [&'static str],
    /// The topic without which the field has no values, though the messages may have it.
    needs: Topic,
}

const fn line(
    label: &'static str,
    colour: &'static str,
    topic: Topic,
    fields: &'static [&'static str],
) -> Line {
    Line {
        label,
        colour,
        topic,
        fields,
        needs: topic,
    }
}

const RELATIVE_ROTATION: Plot = Plot {
    id: "turn",
    title: "Turn since the sample before (rad)",
    series: &[
        line("roll", RED, TURN, &["roll", "vector.x"]),
        line("pitch", GREEN, TURN, &["pitch", "vector.y"]),
        line("yaw", BLUE, TURN, &["yaw", "vector.z"]),
    ],
};

const ATTITUDE: Plot = Plot {
    id: "attitude",
    title: "Attitude of the camera (rad)",
    series: &[
        line("roll", RED, ORIENTATION, &["roll"]),
        line("pitch", GREEN, ORIENTATION, &["pitch"]),
        line("yaw", BLUE, ORIENTATION, &["yaw"]),
    ],
};

/// In ROS 2 there are no angles.
const ATTITUDE_IN_ROS: Plot = Plot {
    id: "attitude",
    title: "Attitude of the camera (quaternion)",
    series: &[
        line("x", RED, ORIENTATION, &["quaternion.x"]),
        line("y", GREEN, ORIENTATION, &["quaternion.y"]),
        line("z", BLUE, ORIENTATION, &["quaternion.z"]),
        line("w", GREY, ORIENTATION, &["quaternion.w"]),
    ],
};

const CAMERA_VELOCITY: Plot = Plot {
    id: "velocity",
    title: "Velocity in the camera's axes (m/s)",
    series: &[
        line("ahead", RED, VELOCITY, &["x", "vector.x"]),
        line("right", GREEN, VELOCITY, &["y", "vector.y"]),
        line("down", BLUE, VELOCITY, &["z", "vector.z"]),
    ],
};

const TURN_RATES: Plot = Plot {
    id: "rates",
    title: "Turn rate of the camera (°/s)",
    series: &[
        line("roll", RED, DISPLAY, &["roll_rate"]),
        line("pitch", GREEN, DISPLAY, &["pitch_rate"]),
        line("yaw", BLUE, DISPLAY, &["yaw_rate"]),
    ],
};

const SIGHT: Plot = Plot {
    id: "sight",
    title: "Where the camera looks (°)",
    series: &[
        line("heading", BLUE, DISPLAY, &["heading_unwrapped"]),
        line("tilt", ORANGE, DISPLAY, &["tilt"]),
    ],
};

const SPEED: Line = Line {
    needs: VELOCITY,
    ..line("speed", GREY, DISPLAY, &["speed"])
};

const HEIGHT: Line = Line {
    needs: POSE,
    ..line("height", PURPLE, DISPLAY, &["height"])
};

const HEIGHT_AND_SPEED: Plot = Plot {
    id: "flight",
    title: "Height (m) and speed (m/s)",
    series: &[HEIGHT, SPEED],
};

const HEIGHT_ALONE: Plot = Plot {
    id: "flight",
    title: "Height (m)",
    series: &[HEIGHT],
};

const SPEED_ALONE: Plot = Plot {
    id: "flight",
    title: "Speed over time (m/s)",
    series: &[SPEED],
};

/// For each plot those that can take its place; the first for which the log has all series is the one.
const WITH_VISUALS: [&[Plot]; 5] = [
    &[RELATIVE_ROTATION],
    &[TURN_RATES],
    &[CAMERA_VELOCITY],
    &[SIGHT],
    &[HEIGHT_AND_SPEED, HEIGHT_ALONE, SPEED_ALONE],
];
const WITHOUT_VISUALS: [&[Plot]; 3] = [
    &[RELATIVE_ROTATION],
    &[ATTITUDE, ATTITUDE_IN_ROS],
    &[CAMERA_VELOCITY],
];

/// The plots that fit a log; none if it is not enriched.
pub fn fitting(survey: &Survey) -> Result<Vec<Panel>, ReadError> {
    // The names of topics for viewers are so common that they do not show that a log is enriched.
    let without = find(survey, &WITHOUT_VISUALS)?;
    if without.is_empty() || survey.own_fields(DISPLAY)?.is_none() {
        return Ok(without);
    }
    find(survey, &WITH_VISUALS)
}

/// The path of the drone's speed.
pub fn speed(survey: &Survey) -> Result<Option<String>, ReadError> {
    path(survey, &SPEED)
}

fn find(survey: &Survey, wanted: &[&[Plot]]) -> Result<Vec<Panel>, ReadError> {
    let times = survey.times_of_flight()?;
    let mut found = Vec::new();
    for alternatives in wanted {
        for Plot { id, title, series } in *alternatives {
            if let Some(series) = all_of(survey, series)? {
                let view = View::Plot { series, times };
                found.push(Panel { id, title, view });
                break;
            }
        }
    }
    Ok(found)
}

/// The series, if the log has all of them.
fn all_of(survey: &Survey, wanted: &[Line]) -> Result<Option<Vec<Series>>, ReadError> {
    let series = wanted.iter().map(|line| {
        let path = path(survey, line)?;
        Ok(path.map(|path| Series {
            path,
            label: line.label,
            colour: line.colour,
        }))
    });
    series.collect()
}

fn path(survey: &Survey, line: &Line) -> Result<Option<String>, ReadError> {
    let Some(fields) = survey.own_fields(line.topic)? else {
        return Ok(None);
    };
    if survey.own_fields(line.needs)?.is_none() {
        return Ok(None);
    }
    for field in line.fields {
        let path = fields.number(field)?;
        if path.is_some() {
            return Ok(path);
        }
    }
    Ok(None)
}
