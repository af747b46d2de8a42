//! What a layout has to know about a log: its topics, their fields, and how they were made.

use std::{collections::BTreeMap, ops::ControlFlow};

use mcap::records::Channel;

use super::{panel::Times, types::Drawn};
use crate::{
    decode::{
        FirstMessages, Proof,
        error::SchemaError,
        field::{Shape, Wanted},
        path::{FieldPath, quoted},
        schema::MessageSchema,
        value::FieldValue,
    },
    derived::{Quantity, visual::VisualTopic},
    log::{Log, ReadError},
    messages::Topic,
    source::own::{is_like_own, is_own},
    writer::provenance,
};

/// A flight that is less of its log than this is but a part of it.
const PART: f64 = 0.8;

/// An enriched log, as far as a layout is concerned.
#[derive(Debug)]
pub struct Survey<'a> {
    log: &'a Log,
    first_messages: FirstMessages<'a>,
    /// The Metadata record of the run that enriched it; empty if that is lost.
    facts: BTreeMap<String, String>,
}

/// A topic that has messages, and the fields that they have.
#[derive(Debug)]
pub struct Fields<'a> {
    topic: &'a str,
    schema: Option<MessageSchema<'a>>,
}

impl<'a> Survey<'a> {
    /// Looks at a log.
    ///
    /// # Errors
    /// Its Metadata record cannot be read.
    pub fn new(log: &'a Log) -> Result<Self, ReadError> {
        let record = log.metadata(provenance::NAME)?.pop();
        Ok(Self {
            log,
            first_messages: FirstMessages::new(log),
            facts: record.map(|record| record.metadata).unwrap_or_default(),
        })
    }

    /// The channels that have messages, how many they have, and what a panel can do with those.
    pub fn channels(&self) -> impl Iterator<Item = (&'a Channel, u64, Option<Drawn>)> {
        let contents = &self.log.contents;
        contents.channels_with_messages().map(|(channel, count)| {
            let schema = contents.schema_of(channel);
            (
                channel,
                count,
                schema.and_then(|schema| Drawn::of(&schema.name)),
            )
        })
    }

    /// The channel of a topic that flightcam wrote.
    fn own(&self, topic: Topic) -> Option<(&'a Channel, Option<Drawn>)> {
        let name = topic.name();
        let is_listed = match self.facts.get(provenance::TOPICS) {
            Some(topics) => topics.split(',').any(|written| written == name),
            // Then only the name is left of a topic that other programs write to as well.
            None => topic.is_shared(),
        };
        let mut channels = self.channels().filter(|(channel, ..)| {
            let is_own = || is_own(self.log, channel) || is_like_own(self.log, channel);
            channel.topic == name && (is_listed || is_own())
        });
        let (channel, _, drawn) = channels.next()?;
        Some((channel, drawn))
    }

    /// The name of a topic that flightcam wrote, if a panel can do this with its messages.
    pub fn drawn(&self, topic: impl Into<Topic>, wanted: Drawn) -> Option<String> {
        let (channel, drawn) = self.own(topic.into())?;
        (drawn == Some(wanted)).then(|| channel.topic.clone())
    }

    /// The fields of a topic that flightcam wrote.
    pub fn own_fields(&self, topic: impl Into<Topic>) -> Result<Option<Fields<'_>>, ReadError> {
        let channel = self.own(topic.into());
        channel.map(|(channel, _)| self.fields(channel)).transpose()
    }

    /// The fields of a channel's messages; none if its schema cannot be read.
    pub fn fields<'b>(&'b self, channel: &'b Channel) -> Result<Fields<'b>, ReadError> {
        let record = self.log.contents.schema_of(channel);
        let schema = MessageSchema::of(channel, record, &self.first_messages, Proof::Listed);
        Ok(Fields {
            topic: &channel.topic,
            schema: readable(schema)?,
        })
    }

    /// The name of the first frame that moves, according to the first message of a topic with transforms that flightcam
    /// wrote.
    pub fn first_moving_frame(&self, topic: VisualTopic) -> Result<Option<String>, ReadError> {
        match self.own(topic.into()) {
            Some((channel, _)) => self.first_text(channel, "transforms[0].child_frame_id"),
            None => Ok(None),
        }
    }

    /// The frame of a channel's first message.
    pub fn first_frame(&self, channel: &Channel) -> Result<Option<String>, ReadError> {
        match self.first_text(channel, "frame_id")? {
            None => self.first_text(channel, "header.frame_id"),
            frame => Ok(frame),
        }
    }

    /// What a field holds in a channel's first message.
    fn first_text(&self, channel: &Channel, field: &str) -> Result<Option<String>, ReadError> {
        let Some(schema) = self.fields(channel)?.schema else {
            return Ok(None);
        };
        let wanted = Wanted {
            path: path(field),
            shape: Shape::Text,
        };
        let Some((decoder, mut slots)) = readable(schema.decoder(&[wanted]))? else {
            return Ok(None);
        };
        let mut found = None;
        self.log.visit_payloads(channel.id, 1, |payload| {
            slots.clear();
            if decoder.decode(payload, &mut slots).is_ok() {
                let text = slots.values.first().and_then(FieldValue::text);
                found = text.map(|text| String::from_utf8_lossy(text).into_owned());
            }
            ControlFlow::Break(())
        })?;
        Ok(found)
    }

    /// When the flight is, if it is but a part of the log: autopilots log parameters at time 0, or for long before a
    /// flight.
    pub fn times_of_flight(&self) -> Result<Times, ReadError> {
        let own = Quantity::ALL.map(|quantity| self.own(quantity.into()));
        let ids = own.iter().flatten().map(|(channel, _)| channel.id);
        let ends = self.log.message_time_ends(&ids.collect(), [0, u64::MAX])?;
        let statistics = &self.log.contents.statistics;
        let [start, end] = [statistics.message_start_time, statistics.message_end_time];
        let first = ends.values().map(|[first, _]| *first).min();
        let last = ends.values().map(|[_, last]| *last).max();
        let seconds = |time: u64| time.saturating_sub(start) as f64 / 1e9;
        let flight = first.zip(last).map(|(first, last)| {
            let [first, last] = [seconds(first), seconds(last)].map(|time| time * 10.0);
            [first.floor() / 10.0, last.ceil() / 10.0]
        });
        Ok(flight.filter(|[first, last]| last - first < PART * seconds(end)))
    }

    /// The prefix of the topics of the vehicle that the camera is on; empty if they have none, or it is not known.
    pub fn namespace(&self) -> &str {
        self.facts.get("namespace").map_or("", String::as_str)
    }

    /// Finite numbers, joined by commas, that the run which enriched the log left for layouts.
    pub fn numbers<const N: usize>(&self, key: &str) -> Option<[f64; N]> {
        let numbers = self.facts.get(key)?.split(',').map(str::parse);
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
        let numbers = numbers.try_into().ok();
        numbers.filter(|numbers: &[f64; N]| numbers.iter().all(|number| number.is_finite()))
    }
}

impl Fields<'_> {
    /// The message path of a number.
    pub fn number(&self, field: &str) -> Result<Option<String>, ReadError> {
        self.message_path(field, Shape::Number)
    }

    /// The message path of a text.
    pub fn text(&self, field: &str) -> Result<Option<String>, ReadError> {
        self.message_path(field, Shape::Text)
    }

    fn message_path(&self, field: &str, shape: Shape) -> Result<Option<String>, ReadError> {
        let Some(schema) = &self.schema else {
            return Ok(None);
        };
        let kind = readable(schema.kind_of(&path(field)))?;
        let is_there = kind.is_some_and(|kind| kind.is_a(shape));
        Ok(is_there.then(|| format!("{}.{field}", in_path(self.topic))))
    }
}

/// A field's path.
fn path(field: &str) -> FieldPath {
    field.parse().expect("the names of fields are plain")
}

/// What a schema says, unless it cannot be read or does not have what is asked for.
fn readable<T>(result: Result<T, SchemaError>) -> Result<Option<T>, ReadError> {
    match result {
        Ok(found) => Ok(Some(found)),
        Err(SchemaError::Unreadable(error)) => Err(error),
        Err(_) => Ok(None),
    }
}

/// A topic as message paths have it. Viewers take fewer characters without quotes than flightcam does.
fn in_path(topic: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/_-".contains(c);
    match !topic.is_empty() && topic.chars().all(is_plain) {
        true => topic.to_owned(),
        false => quoted(topic),
    }
}
