//! Enriches a log for a camera that looks 30° below the horizon, and prints what was written:
//!
//! ```sh
//! cargo run --example enrich_file -- flight.mcap result.mcap
//! ```

use std::{env, error::Error, ops::ControlFlow};

use flightcam::{DepressionAngle, Options, enrich};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let (Some(input), Some(output)) = (arguments.next(), arguments.next()) else {
        return Err("the arguments are a log and the path of the result".into());
    };
    let options = Options::new()
        .depression(DepressionAngle::from_degrees(30.0)?)
        .watch(|progress| {
            eprintln!("{} of {} bytes", progress.done, progress.total);
            // To cancel the run, return `ControlFlow::Break(())`.
            ControlFlow::Continue(())
        });
    let report = enrich(input, output, &options)?;
    for topic in &report.written {
        println!("{}: {} messages", topic.topic, topic.messages);
    }
    Ok(())
}
