//! Derives the camera's motion from a log without writing a log, and prints it as a table:
//!
//! ```sh
//! cargo run --example derive_values -- flight.mcap
//! ```

use std::{env, error::Error, ops::ControlFlow};

use flightcam::{DepressionAngle, Options, Value, derive, geometry::RollPitchYaw};

fn main() -> Result<(), Box<dyn Error>> {
    let input = env::args().nth(1).ok_or("the argument is a log")?;
    let options = Options::new().depression(DepressionAngle::from_degrees(30.0)?);
    let outcome = derive(input, &options, |values| {
        for derived in values {
            let time = derived.stamp.log_time as f64 / 1e9;
            match derived.value {
                Value::RelativeRpy { rpy, .. } => {
                    println!("{time:.3} rotation {} {} {}", rpy.roll, rpy.pitch, rpy.yaw);
                }
                Value::Orientation(r_ned_camera) => {
                    let rpy = RollPitchYaw::from_rotation(&r_ned_camera);
                    println!(
                        "{time:.3} orientation {} {} {}",
                        rpy.roll, rpy.pitch, rpy.yaw
                    );
                }
                Value::CameraVelocity(velocity) => {
                    println!(
                        "{time:.3} velocity {} {} {}",
                        velocity.x, velocity.y, velocity.z
                    );
                }
                _ => {}
            }
        }
        ControlFlow::Continue(())
    })?;
    if let Some(outcome) = outcome {
        let breaks = outcome.breaks;
        eprintln!(
            "{} gaps, {} resets, {} steps back in time",
            breaks.gaps, breaks.resets, breaks.clock_steps
        );
    }
    Ok(())
}
