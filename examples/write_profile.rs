//! Writes a profile in code, as for a tool that knows a logger's message definitions, and prints it as TOML.
//!
//! This one is for the demonstration flight:
//!
//! ```sh
//! cargo run --example write_profile > demonstration.toml
//! cargo run -- inspect fixtures/survey_flight.mcap --profile demonstration.toml
//! ```

use std::error::Error;

use flightcam::profile::{
    Alternative, AngleUnit, AttitudeFields, Axes, Components, Convention, Euler, EulerOrder,
    Location, Orientation, Profile, RoleFields, SpeedUnit, VelocityFields, WorldAxes,
};

fn main() -> Result<(), Box<dyn Error>> {
    let location = Location {
        schemas: vec!["demo.DroneState".to_owned()],
        ..Location::on("/drone/state")
    };
    let attitude = AttitudeFields {
        orientation: Orientation::Euler(Euler {
            roll: "roll".parse()?,
            pitch: "pitch".parse()?,
            yaw: "yaw".parse()?,
            unit: AngleUnit::Radians,
            order: EulerOrder::YawPitchRoll,
        }),
        convention: Some(Convention::FRD_NED),
        reset_counter: None,
    };
    let velocity = VelocityFields {
        vector: Components::Each(["vx".parse()?, "vy".parse()?, "vz".parse()?]),
        frame: Axes::World(WorldAxes::NED),
        unit: SpeedUnit::MetresPerSecond,
        required: true,
    };
    let mut profile = Profile::new("demonstration")
        .with(Alternative {
            location: location.clone(),
            fields: RoleFields::Attitude(attitude),
        })
        .with(Alternative {
            location,
            fields: RoleFields::Velocity(velocity),
        });
    profile.description = "flightcam's demonstration flight".to_owned();
    print!("{}", toml::to_string(&profile)?);
    Ok(())
}
