//! What flightcam wrote is never telemetry, whatever other programs did to the log since.

use std::{borrow::Cow, collections::BTreeMap, io::Cursor, sync::Arc};

use flightcam::{
    Encoding, EncodingChoice, Input, Options, camera::FieldOfView, inspect, visuals::VisualOptions,
};
use mcap::{Channel, Message, MessageStream, WriteOptions, records::MessageHeader};

use crate::support::{enrich_bytes_with, options, repository, selecting::request};

fn enriched(encoding: Encoding) -> Vec<u8> {
    let log = std::fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture");
    let seen = FieldOfView::from_degrees(70.0, 50.0).expect("it is in range");
    let options = options()
        .encoding(EncodingChoice::Given(encoding))
        .visuals(VisualOptions::new().field_of_view(seen));
    enrich_bytes_with(&log, &options).expect("a result").0
}

/// The channels of a log that are wanted, written anew by another program, without Metadata records and attachments. Their
/// own metadata may be lost, too.
fn filtered(log: &[u8], is_wanted: impl Fn(&str) -> bool, keeps_metadata: bool) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression_threads(0);
    let mut writer = options.create(&mut file).expect("a writer");
    let mut channels: BTreeMap<u16, Arc<Channel>> = BTreeMap::new();
    for message in MessageStream::new(log).expect("a readable log") {
        let message = message.expect("a message");
        if !is_wanted(&message.channel.topic) {
            continue;
        }
        let channel = channels.entry(message.channel.id).or_insert_with(|| {
            let channel = &message.channel;
            Arc::new(Channel {
                metadata: match keeps_metadata {
                    true => channel.metadata.clone(),
                    false => BTreeMap::new(),
                },
                id: channel.id,
                topic: channel.topic.clone(),
                schema: channel.schema.clone(),
                message_encoding: channel.message_encoding.clone(),
            })
        });
        let message = Message {
            channel: Arc::clone(channel),
            data: Cow::Borrowed(&message.data),
            ..message
        };
        writer.write(&message).expect("it is written");
    }
    writer.finish().expect("the log is finished");
    drop(writer);
    file.into_inner()
}

/// Two logs written into one by another program, as `mcap merge` does: channels keep their metadata and get new ids.
fn merged(logs: [&[u8]; 2]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression_threads(0);
    let mut writer = options.create(&mut file).expect("a writer");
    let mut ids: BTreeMap<(usize, u16), u16> = BTreeMap::new();
    for (number, log) in logs.into_iter().enumerate() {
        for message in MessageStream::new(log).expect("a readable log") {
            let message = message.expect("a message");
            let channel = &message.channel;
            let id = *ids.entry((number, channel.id)).or_insert_with(|| {
                let schema = channel.schema.as_ref().map_or(0, |schema| {
                    let id = writer.add_schema(&schema.name, &schema.encoding, &schema.data);
                    id.expect("a schema")
                });
                let topic = format!("/log{number}{}", channel.topic);
                let topic = match is_new(&channel.topic) {
                    true => &channel.topic,
                    false => &topic,
                };
                let encoding = &channel.message_encoding;
                let added = writer.add_channel(schema, topic, encoding, &channel.metadata);
                added.expect("a channel")
            });
            let header = MessageHeader {
                channel_id: id,
                sequence: message.sequence,
                log_time: message.log_time,
                publish_time: message.publish_time,
            };
            let written = writer.write_to_known_channel(&header, &message.data);
            written.expect("it is written");
        }
    }
    writer.finish().expect("the log is finished");
    drop(writer);
    file.into_inner()
}

/// Where the attitude of a log is found, if it is.
fn attitude(log: &[u8], options: &Options) -> Option<String> {
    let inspection = inspect(Input::bytes("log.mcap", log.to_vec()), options).expect("a log");
    let found = inspection.telemetry?;
    Some(found.profile.attitude.topic.as_str().to_owned())
}

fn is_new(topic: &str) -> bool {
    topic.starts_with("/camera/") || topic.starts_with("/tf")
}

#[test]
fn nothing_that_flightcam_wrote_is_taken_for_the_drone() {
    for encoding in Encoding::ALL {
        let result = enriched(encoding);
        for keeps_metadata in [true, false] {
            let new = filtered(&result, is_new, keeps_metadata);
            assert_eq!(
                attitude(&new, &options()),
                None,
                "{encoding:?}, with its metadata: {keeps_metadata}"
            );
            // Beside the log's own, that is found.
            let all = filtered(&result, |_| true, keeps_metadata);
            assert_eq!(attitude(&all, &options()).as_deref(), Some("/drone/state"));
        }
    }
}

#[test]
fn in_a_log_that_was_merged_of_two_it_is_not_taken_for_the_drone_either() {
    let with_telemetry = enriched(Encoding::Protobuf);
    let without = filtered(&enriched(Encoding::Ros2), is_new, true);
    let both = merged([&with_telemetry, &without]);
    let drone = attitude(&both, &options());
    assert_eq!(drone.as_deref(), Some("/log0/drone/state"));
    let neither = merged([&filtered(&with_telemetry, is_new, true), &without]);
    assert_eq!(attitude(&neither, &options()), None);
}

#[test]
fn a_channel_of_another_program_with_the_same_name_and_type_can_be_named() {
    let result = enriched(Encoding::Protobuf);
    let named = request(&[("--attitude", "/camera/odometry.pose.orientation:flu-enu")]);
    let named = options().telemetry(named);
    let of_another = filtered(&result, is_new, false);
    assert_eq!(
        attitude(&of_another, &named).as_deref(),
        Some("/camera/odometry")
    );
    // But not what is known to be flightcam's.
    let new = filtered(&result, is_new, true);
    let found = inspect(Input::bytes("log.mcap", new), &named);
    let is_found = found.is_ok_and(|inspection| inspection.telemetry.is_some());
    assert!(!is_found);
}
