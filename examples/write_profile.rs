//! Writes a profile in code, as for a tool that knows a logger's message definitions, and prints it as TOML.
//!
//! This one is for the demonstration flight:
//!
//! ```sh
//! cargo run --example write_profile > demonstration.toml
//! cargo run -- inspect fixtures/survey_flight.mcap --profile demonstration.toml
//! ```

use std::error::Error;

use flightcam::source::profile::{
    AttitudeSource, Components, Euler, Orientation, Place, Profile, VelocitySource,
    convention::{AngleUnit, Convention, SpeedUnit, VelocityFrame},
};

fn main() -> Result<(), Box<dyn Error>> {
    let place = Place {
        topics: vec!["/drone/state".to_owned()],
        schemas: vec!["demo.DroneState".to_owned()],
        ..Place::default()
    };
    let attitude = AttitudeSource {
        place: place.clone(),
        orientation: Orientation::Euler(Euler {
            roll: "roll".parse()?,
            pitch: "pitch".parse()?,
            yaw: "yaw".parse()?,
            unit: AngleUnit::Radians,
        }),
        convention: Convention::FrdNed,
        reset_counter: None,
    };
    let velocity = VelocitySource {
        place,
        vector: Components::Each(["vx".parse()?, "vy".parse()?, "vz".parse()?]),
        frame: VelocityFrame::Ned,
        unit: SpeedUnit::MetresPerSecond,
        required: true,
    };
    let profile = Profile {
        description: "flightcam's demonstration flight".to_owned(),
        velocity: vec![velocity],
        ..Profile::of_attitude("demonstration", attitude)
    };
    print!("{}", toml::to_string(&profile)?);
    Ok(())
}
