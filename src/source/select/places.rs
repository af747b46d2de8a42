//! The places where a role may be in one namespace, and which of them is used.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Channel;

use super::{
    Fit,
    choice::{self, Chosen, PassedOver, SeenPlace},
    look::Look,
    namespace_search::NamespaceSearch,
};
use crate::{
    decode::schema::MessageSchema,
    log::ReadError,
    sample::Kind,
    source::{
        Origin,
        bind::BindError,
        error::{Misfit, TelemetryError, TopicMisfit, Unfit},
        profile::Alternative,
    },
};

/// A topic whose messages have the fields of a role.
struct Place {
    origin: Origin,
    /// The number of the first alternative that reads them.
    first: usize,
}

/// What is found on the topics of a role.
struct Found {
    /// The places, in the order of preference.
    places: Vec<Place>,
    /// Why the first topic whose messages do not fit is none.
    fault: Option<TopicMisfit>,
}

/// The alternatives by which the messages of one topic can be read.
#[derive(Default)]
struct OnTopic {
    /// Whether the next alternative belongs to the last place, because that does not read every message.
    is_open: bool,
    origins: Vec<Origin>,
}

/// The schemas of a topic's channels that have been read.
pub type Schemas<'a> = BTreeMap<u16, MessageSchema<'a>>;

impl<'a> NamespaceSearch<'a> {
    /// Finds the place that a role is read from; `own` is the attitude's topic. If there are several, the first one is
    /// used, unless it matters for this role and [its messages](Look) speak against it.
    pub fn choose(&self, kind: Kind, own: Option<&str>) -> Result<Chosen, Unfit> {
        let Found { places, fault } = self.find(kind, own)?;
        match (&places[..], fault) {
            ([], Some(fault)) => Err(Misfit::Messages(fault).into()),
            ([], None) => Err(self.why_nowhere(kind, own).into()),
            ([_, _, ..], _) if self.log_search.looks_at(kind) => {
                Ok(self.choose_among(kind, places, own)?)
            }
            _ => Ok(chosen(places, 0, Vec::new())),
        }
    }

    fn choose_among(
        &self,
        kind: Kind,
        places: Vec<Place>,
        own: Option<&str>,
    ) -> Result<Chosen, TelemetryError> {
        let look = |place: &Place| {
            let topic = place.origin.topic.as_str();
            self.look_at(kind, topic, place.first, own.unwrap_or(topic))
        };
        let others = places[1..].iter();
        let counts = others.map(|place| self.log_search.messages_on(&place.origin.topic));
        let most_elsewhere = counts.max().unwrap_or(0);
        let first = look(&places[0])?;
        if choice::is_enough(first.usable(), most_elsewhere as f64) {
            return Ok(chosen(places, 0, Vec::new()));
        }
        let mut looks = vec![first];
        for place in &places[1..] {
            looks.push(look(place)?);
        }
        let number = choice::choose(&looks);
        let seen = |number: usize| {
            let place: &Place = &places[number];
            SeenPlace::new(&self.profile.name, &place.origin, looks[number].clone())
        };
        let passed_over = (0..number).map(|earlier| PassedOver {
            role: kind,
            place: seen(earlier),
            instead: seen(number),
        });
        let passed_over = passed_over.collect();
        Ok(chosen(places, number, passed_over))
    }

    /// Looks at messages of a role on a topic, which are read by an alternative and those after it.
    pub fn look_at(
        &self,
        kind: Kind,
        topic: &str,
        first: usize,
        own: &str,
    ) -> Result<Look, TelemetryError> {
        let mut channels = BTreeMap::new();
        for channel in &self.log_search.topics[topic] {
            let roles = [(kind, first)].into_iter();
            channels.insert(channel.id, self.reader(channel, roles, own)?);
        }
        Ok(Look::at(self.log_search.log, channels)?)
    }

    /// Looks at messages of a role of a fit, if that has it.
    pub fn look(&self, fit: &Fit, kind: Kind) -> Result<Option<Look>, TelemetryError> {
        let Ok(origin) = fit.role(kind) else {
            return Ok(None);
        };
        let look = self.look_at(kind, &origin.topic, fit.first(kind), &fit.own)?;
        Ok(Some(look))
    }

    /// Finds the places where a role may be.
    fn find(&self, kind: Kind, own: Option<&str>) -> Result<Found, ReadError> {
        let alternatives = self.profile.alternatives(kind);
        let tries = self.tries(kind, own);
        // Each schema is read only once, and kept only for its topic.
        let mut bound = BTreeMap::new();
        for topic in tries
            .iter()
            .map(|(_, topic)| *topic)
            .collect::<BTreeSet<_>>()
        {
            let mut schemas = Schemas::new();
            for (place, (number, _)) in tries.iter().enumerate().filter(|(_, one)| one.1 == topic) {
                let alternative = [&alternatives[*number]];
                bound.insert(place, self.bind(&mut schemas, kind, topic, &alternative));
            }
        }
        let mut found = Found {
            places: Vec::new(),
            fault: None,
        };
        let mut on_topics: BTreeMap<&str, OnTopic> = BTreeMap::new();
        for (&(first, topic), bound) in tries.iter().zip(bound.into_values()) {
            match bound {
                Ok(origin) => {
                    let on_topic = on_topics.entry(topic).or_default();
                    if on_topic.begins_place(&alternatives[first], &origin) {
                        found.places.push(Place { origin, first });
                    }
                }
                // An alternative for another type of message says nothing about this one.
                Err(BindError::OtherType { .. }) => {}
                Err(error) => {
                    let misfit = TopicMisfit::new(topic, error.unless_of_reading()?);
                    found.fault.get_or_insert(misfit);
                }
            }
        }
        Ok(found)
    }

    /// The alternatives of a role, by their numbers, and the log's topics that each is for, in the order of preference.
    fn tries<'t>(&'t self, kind: Kind, own: Option<&'t str>) -> Vec<(usize, &'t str)> {
        let alternatives = self.profile.alternatives(kind).iter().enumerate();
        let topics = alternatives.flat_map(|(number, alternative)| {
            let topics = alternative.location.topics.iter();
            let named = topics.flat_map(|topic| {
                let pattern = self.pattern(kind, topic);
                pattern.matches(self.log_search.topics.keys().copied())
            });
            let own = own.filter(|_| alternative.location.topics.is_empty());
            named.chain(own).map(move |topic| (number, topic))
        });
        topics.collect()
    }

    /// The schema of a channel.
    pub fn schema_of<'s>(
        &self,
        channel: &Channel,
        schemas: &'s mut Schemas<'a>,
    ) -> Result<&'s MessageSchema<'a>, BindError> {
        use std::collections::btree_map::Entry;
        Ok(match schemas.entry(channel.id) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => place.insert(self.log_search.schema(channel)?),
        })
    }
}

fn chosen(mut places: Vec<Place>, number: usize, passed_over: Vec<PassedOver>) -> Chosen {
    let Place { origin, first } = places.swap_remove(number);
    Chosen {
        origin,
        first,
        passed_over,
    }
}

impl OnTopic {
    /// Whether an alternative that fits begins a place of its own: not if it completes the one before it, nor if it reads
    /// the same fields as an earlier one, which may have its reasons not to use them.
    fn begins_place(&mut self, alternative: &Alternative, origin: &Origin) -> bool {
        let is_new = !self.is_open && !self.origins.contains(origin);
        if self.is_open || is_new {
            self.is_open = !alternative.reads_any_message();
        }
        self.origins.push(origin.clone());
        is_new
    }
}
