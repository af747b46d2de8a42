//! Readings as arguments say them.

use flightcam::{
    check::{
        reading::{AttitudeReading, Form},
        verdict::Reading,
    },
    profile::Axes,
};

/// What follows the fields in an argument, without the first colon, if an argument can say that they are read so.
///
/// The order of a quaternion's numbers is said only if they are listed, not if its message names them. `gimbal_unit` is
/// the unit of a gimbal's angles, which goes with their fields.
pub fn as_argument(
    reading: &Reading,
    is_listed: bool,
    gimbal_unit: Option<String>,
) -> Option<String> {
    let words = match reading {
        Reading::Velocity(vector) => match vector.unit.name {
            "m/s" => vec![vector.axes.to_string()],
            unit @ ("cm/s" | "mm/s") => vec![vector.axes.to_string(), unit.to_owned()],
            _ => return None,
        },
        Reading::AngularRate(vector) => {
            vec![own_axes(vector.axes), vector.unit.name.to_owned()]
        }
        Reading::Acceleration(vector) => match vector.unit.name {
            "m/s²" => vec![own_axes(vector.axes)],
            "g" => vec![own_axes(vector.axes), "g".to_owned()],
            _ => return None,
        },
        Reading::Attitude(attitude) => of_attitude(attitude, is_listed)?,
        Reading::Gimbal {
            reference,
            flipped: false,
        } => {
            let reference = reference.name().to_owned();
            gimbal_unit.into_iter().chain([reference]).collect()
        }
        _ => return None,
    };
    Some(words.join(":"))
}

/// The drone's axes, as options and profiles name them where no others are possible.
fn own_axes(axes: Axes) -> String {
    let axes = axes.to_string();
    axes.strip_prefix("body-").unwrap_or(&axes).to_owned()
}

fn of_attitude(attitude: &AttitudeReading, is_listed: bool) -> Option<Vec<String>> {
    let form = match attitude.form {
        Form::Quaternion { scalar_last: true } => is_listed.then(|| "xyzw".to_owned()),
        Form::Quaternion { scalar_last: false } => None,
        Form::Angles {
            unit,
            swapped: false,
            opposite: [false, false, false],
        } => Some(unit.name.to_owned()),
        Form::Angles { .. } | Form::OtherAngles => return None,
    };
    let is_plain = !attitude.inverse && attitude.north_deg == 0.0;
    let axes = format!("{}-{}", attitude.body, attitude.world);
    is_plain.then(|| form.into_iter().chain([axes]).collect())
}
