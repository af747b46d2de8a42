//! The options of `enrich` that say what viewers are shown.

use clap::Args;
use flightcam::{
    camera::FieldOfView,
    visuals::{Ground, Reach, VisualOptions, VisualRate},
};

use super::number;

/// What viewers such as Foxglove are shown
#[derive(Debug, Args)]
#[command(next_help_heading = "Visuals")]
pub struct VisualArguments {
    /// Add what viewers draw: drone and camera in 3D, the line of sight and what the camera saw of the ground, the track
    /// on a map, and numbers in degrees and m/s
    #[arg(long)]
    visuals: bool,

    /// How wide the camera sees, from left to right, in degrees
    #[arg(long, value_name = "DEG", requires_all = ["visuals", "vfov"], value_parser = angle, allow_negative_numbers = true)]
    hfov: Option<f64>,

    /// How high the camera sees, from top to bottom, in degrees
    #[arg(long, value_name = "DEG", requires_all = ["visuals", "hfov"], value_parser = angle, allow_negative_numbers = true)]
    vfov: Option<f64>,

    /// Where the ground is, which is taken to be level: its altitude in metres, as the log counts altitudes, or takeoff
    /// for that of the first position [default: as the heights above it say that the log has, or else takeoff]
    #[arg(long, value_name = "ALTITUDE", requires = "visuals", value_parser = ground, allow_negative_numbers = true)]
    ground: Option<Ground>,

    /// How far what the camera sees of the ground is shown, as a multiple of the height: near the horizon it has no end
    #[arg(long, value_name = "HEIGHTS", requires = "visuals", value_parser = reach, default_value = "5", allow_negative_numbers = true)]
    reach: Reach,

    /// How often scenes, transforms and numbers are written [default: 10 Hz for scenes, 30 Hz for the others]
    #[arg(long, value_name = "HZ", requires = "visuals", value_parser = rate, allow_negative_numbers = true)]
    visual_rate: Option<VisualRate>,
}

impl VisualArguments {
    /// What viewers are shown, if they are shown anything.
    pub fn options(&self) -> Option<VisualOptions> {
        let angles = self.hfov.zip(self.vfov);
        let field_of_view = angles.and_then(|(h, v)| FieldOfView::from_degrees(h, v).ok());
        self.visuals.then(|| {
            VisualOptions::new()
                .rate(self.visual_rate)
                .field_of_view(field_of_view)
                .ground(self.ground)
                .reach(self.reach)
        })
    }
}

fn angle(degrees: &str) -> Result<f64, String> {
    let degrees = number(degrees)?;
    match FieldOfView::from_degrees(degrees, degrees) {
        Ok(_) => Ok(degrees),
        Err(_) => Err("it must be from 0.1 to 170 degrees".to_owned()),
    }
}

fn ground(text: &str) -> Result<Ground, String> {
    match text {
        "takeoff" => Ok(Ground::TakeOff),
        _ => match number(text) {
            Ok(altitude) if altitude.is_finite() => Ok(Ground::Altitude(altitude)),
            _ => Err("write an altitude in metres, or takeoff".to_owned()),
        },
    }
}

fn reach(heights: &str) -> Result<Reach, String> {
    Reach::from_heights(number(heights)?).map_err(|error| error.to_string())
}

fn rate(hertz: &str) -> Result<VisualRate, String> {
    VisualRate::from_hertz(number(hertz)?).map_err(|error| error.to_string())
}
