//! Small logs written message by message, and what is made of them: samples, derived messages, what is dropped.

use std::fs;

use flightcam::{
    Error, Options, Report,
    enrich::enrich,
    geometry::DepressionAngle,
    log::Log,
    reader::Reader,
    sample::{Kind, Sample, Tallies, Tally, Velocity},
    source::Source,
};

use super::{
    DERIVED, ReadMessage,
    logbook::{Logbook, request},
    message::DerivedMessage,
    stream,
};

/// Velocities, and how many others were dropped for which reason; or why none can be read.
pub type Found = Result<(Vec<[f64; 3]>, Vec<(&'static str, u64)>), String>;

impl Logbook {
    /// Its chunks are so small that a few messages make several.
    pub fn new() -> Self {
        Self::with_chunks_of(256)
    }

    /// Writes flat JSON telemetry: a yaw in radians, and a velocity to the north.
    pub fn put_flat(&mut self, channel_id: u16, time: u64, yaw: &str, vx: &str) {
        let json = format!(r#"{{"roll":0,"pitch":0,"yaw":{yaw},"vx":{vx},"vy":0,"vz":0}}"#);
        self.put(channel_id, time, json.as_bytes());
    }

    /// Enriches the log with the camera at the horizon, where the rotation's yaw is the drone's own.
    pub fn enrich(self, profile: Option<&str>) -> Result<(Vec<ReadMessage>, Report), Error> {
        let (folder, input) = self.finish();
        let output = folder.path().join("result.mcap");
        let mut options =
            Options::new().depression(DepressionAngle::from_degrees(0.0).expect("0°"));
        if let Some(profile) = profile {
            options = options.telemetry(request(profile));
        }
        let report = enrich(&input, &output, &options)?;
        let result = fs::read(output).expect("the result");
        let derived = stream(&result, false).into_iter();
        Ok((
            derived
                .filter(|message| DERIVED.contains(&message.topic.as_str()))
                .collect(),
            report,
        ))
    }

    /// The samples that a profile finds in the log, in time order, and what it drops.
    pub fn samples(self, profile: &str) -> Result<(Vec<Sample>, Tallies), Error> {
        let (_folder, input) = self.finish();
        let log = Log::open(&input)?;
        let source = Source::select(&log, &request(profile))?;
        let mut samples = Vec::new();
        let read = Reader::new(&log, source)?.for_each(|arrival| {
            samples.push(arrival.sample);
            Ok::<_, Error>(())
        })?;
        Ok((samples, read.dropped))
    }

    /// The velocities that a profile finds in the log, in NED.
    pub fn velocities(self, profile: &str) -> Found {
        let (samples, tallies) = self.samples(profile).map_err(|error| error.to_string())?;
        let velocities = samples.iter().filter_map(|sample| match sample {
            Sample::Velocity(sample) => match sample.velocity {
                Velocity::Ned(velocity) => Some(velocity.into()),
                Velocity::Frd(_) => panic!("the profile says NED"),
            },
            _ => None,
        });
        Ok((velocities.collect(), dropped(&tallies[Kind::Velocity])))
    }
}

/// Of the messages of a topic, the times in milliseconds, and one of the numbers.
fn numbers(derived: &[ReadMessage], topic: &str, which: usize) -> Vec<(u64, f64)> {
    let of_topic = derived.iter().filter(|message| message.topic == topic);
    of_topic
        .map(|message| {
            let number = DerivedMessage::decode(message).numbers[which];
            // Without the last digits, which are the subject of the tests of geometry.
            (message.log_time / 1_000_000, (number * 1e9).round() / 1e9)
        })
        .collect()
}

pub fn yaws(derived: &[ReadMessage]) -> Vec<(u64, f64)> {
    numbers(derived, "/camera/relative_rpy", 2)
}

pub fn forwards(derived: &[ReadMessage]) -> Vec<(u64, f64)> {
    numbers(derived, "/camera/velocity", 0)
}

pub fn dropped(tally: &Tally) -> Vec<(&'static str, u64)> {
    tally
        .dropped
        .iter()
        .map(|(reason, count)| (reason.name(), *count))
        .collect()
}
