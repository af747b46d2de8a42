//! Panels by their titles, and flights that are shown in them.

use std::{collections::BTreeMap, fs, io::Cursor};

use flightcam::{Encoding, EncodingChoice, Options};
use mcap::{MessageStream, records::MessageHeader};
use serde_json::json;

use super::{
    repository,
    topics::{self, Topic, topic},
    viewing::{Panel, panels_of, with_view},
};

pub const TURN: &str = "Turn since the sample before (rad)";
pub const ATTITUDE: &str = "Attitude of the camera (rad)";
pub const RATE: &str = "Turn rate of the camera (°/s)";
pub const VELOCITY: &str = "Velocity in the camera's axes (m/s)";
pub const SIGHT: &str = "Where the camera looks (°)";
pub const FLIGHT: &str = "Height (m) and speed (m/s)";
pub const ONLY_SPEED: &str = "Speed over time (m/s)";
pub const GAUGE: &str = "Speed (m/s)";
pub const SCENE: &str = "Drone and camera";

/// What every log with visuals and velocities has.
pub const USUAL: [&str; 9] = [
    SCENE, GAUGE, "Data", "States", TURN, RATE, VELOCITY, SIGHT, FLIGHT,
];

pub fn survey_flight() -> Vec<u8> {
    fs::read(repository("fixtures/survey_flight.mcap")).expect("the demonstration flight")
}

pub fn in_encoding(encoding: Encoding) -> Options {
    with_view().encoding(EncodingChoice::Given(encoding))
}

/// The panels, which must have these titles.
#[track_caller]
pub fn panels_with(log: &[u8], titles: &[&str]) -> BTreeMap<String, Panel> {
    let panels = panels_of(log);
    let mut expected: Vec<&str> = titles.to_vec();
    expected.sort_unstable();
    let found: Vec<&str> = panels.keys().map(String::as_str).collect();
    assert_eq!(found, expected);
    panels
}

pub fn and<'a>(titles: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    titles.iter().chain(more).copied().collect()
}

/// What a log without positions has.
pub fn without_height() -> Vec<&'static str> {
    let usual = USUAL.into_iter().filter(|title| *title != FLIGHT);
    usual.chain([ONLY_SPEED]).collect()
}

/// Two seconds of a drone that turns, in JSON.
pub fn states() -> Topic {
    topic("/state", topics::states(100, 1.0))
}

/// All messages of some logs, on channels with other metadata, and nothing else.
pub fn rewritten<const N: usize>(
    logs: [&[u8]; N],
    change: impl Fn(BTreeMap<String, String>) -> BTreeMap<String, String>,
) -> Vec<u8> {
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).expect("a writer");
    for message in logs
        .into_iter()
        .flat_map(|log| MessageStream::new(log).expect("a readable log"))
    {
        let message = message.expect("a message");
        let channel = &message.channel;
        let schema = channel.schema.as_ref().map_or(0, |schema| {
            (writer.add_schema(&schema.name, &schema.encoding, &schema.data)).expect("a schema")
        });
        let metadata = change(channel.metadata.clone());
        let channel_id = (writer)
            .add_channel(schema, &channel.topic, &channel.message_encoding, &metadata)
            .expect("a channel");
        let header = MessageHeader {
            channel_id,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        (writer.write_to_known_channel(&header, &message.data)).expect("it is written");
    }
    writer.finish().expect("the log is finished");
    writer.into_inner().into_inner()
}

/// The same at a place.
pub fn states_at_a_place() -> Topic {
    let states = topics::states(100, 1.0).enumerate();
    let states = states.map(|(n, mut state)| {
        let place =
            json!({ "latitude": 47.4 + 1e-6 * n as f64, "longitude": 8.5, "altitude": 500 });
        let place = place.as_object().expect("an object").clone();
        state.as_object_mut().expect("an object").extend(place);
        state
    });
    topic("/state", states)
}
