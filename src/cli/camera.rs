//! The options that say how the camera is mounted; `enrich` and `inspect` share them.

use clap::Args;
use flightcam::{camera::Mount, geometry::DepressionAngle};

use super::number;

/// How the camera is mounted on the drone
#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArguments {
    /// How far the camera looks below the horizon, in degrees: 0 ahead, 30 for a gimbal pitch of -30,
    /// 90 straight down. Required if the log has no gimbal angles; if it has, this takes precedence
    #[arg(long, value_name = "DEG", value_parser = depression_angle, allow_negative_numbers = true)]
    pub depression: Option<DepressionAngle>,

    /// How a camera without a gimbal is mounted on the airframe, in degrees from the drone's axes: with
    /// 0,-30,0 it looks ahead and 30 down. With --depression, 0,0,YAW turns a gimballed camera YAW to the right
    #[arg(long, value_name = "ROLL,PITCH,YAW", value_parser = mount, allow_hyphen_values = true)]
    pub mount: Option<Mount>,
}

fn depression_angle(degrees: &str) -> Result<DepressionAngle, String> {
    let degrees: f64 = number(degrees)?;
    DepressionAngle::from_degrees(degrees).map_err(|error| error.to_string())
}

fn mount(angles: &str) -> Result<Mount, String> {
    let angles: Vec<f64> = angles
        .split(',')
        .map(|angle| number(angle.trim()))
        .collect::<Result<_, _>>()?;
    let [roll, pitch, yaw] = angles[..] else {
        return Err("write roll, pitch and yaw in degrees, as in 0,-30,0".to_owned());
    };
    Mount::from_degrees(roll, pitch, yaw).map_err(|error| error.to_string())
}
