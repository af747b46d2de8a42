//! Which messages of a passing log may turn out to be its telemetry, when all of it is known.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use mcap::records::Channel;

use super::{
    alternative::{Alternative, bind_role, meant_for},
    binder::Binder,
    finder::is_within,
    profile::{AttitudeSource, GimbalSource, PositionSource, Profile, VelocitySource},
    request::Request,
    topic::Pattern,
};
use crate::{
    decode::{FirstMessages, error::SchemaError, schema::MessageSchema},
    log::{LONGEST_EXAMPLE, contents::Definitions, stream::Passing},
    sample::Kind,
};

/// Tells the messages that [`Source::select`](super::Source::select) might choose in a log, while the log passes
/// by. All of these are included; of the others some, so that it finds the same as in the whole log, and for the
/// same reasons.
///
/// A channel is judged once, by its topic, its type, and the fields of its messages. What fields JSON messages
/// have is known only when those have passed that are examples of the whole log's: the first ten of the first
/// segment that has any. They are included whatever they are.
#[derive(Debug)]
pub struct Candidates {
    /// Those that will be tried.
    profiles: Vec<Profile>,
    namespace: Option<String>,
    /// What the user has told where to find.
    told: BTreeSet<Kind>,
    /// Whether a channel's messages are included, by its id.
    verdicts: HashMap<u16, bool>,
    /// The examples of channels that are not judged yet, from the latest segment.
    examples: BTreeMap<u16, Vec<Vec<u8>>>,
    segment: usize,
}

impl Candidates {
    /// For what is wanted of the log.
    pub fn new(request: &Request) -> Self {
        Self {
            profiles: request.profiles(),
            namespace: request.namespace.clone(),
            told: request.told().into_keys().collect(),
            verdicts: HashMap::new(),
            examples: BTreeMap::new(),
            segment: 0,
        }
    }

    /// Whether a message is included. All of the log's have to be shown, in the order of the log.
    pub fn include(&mut self, passing: Passing) -> bool {
        let Passing {
            channel,
            definitions,
            ..
        } = passing;
        if passing.segment != self.segment {
            self.segment = passing.segment;
            for (id, examples) in std::mem::take(&mut self.examples) {
                if let Some(channel) = definitions.channels.get(&id) {
                    self.judge(&channel.record, definitions, &examples);
                }
            }
        }
        if let Some(&verdict) = self.verdicts.get(&channel.id) {
            return verdict;
        }
        let is_schema_missing = !definitions.schemas.contains_key(&channel.schema_id);
        if channel.schema_id != 0 && is_schema_missing {
            // It may still come.
            return true;
        }
        if channel.message_encoding != "json" || self.is_named(&channel.topic) {
            return self.judge(channel, definitions, &[]);
        }
        let payload = passing.message.payload;
        let examples = self.examples.entry(channel.id).or_default();
        if payload.len() <= LONGEST_EXAMPLE {
            examples.push(payload.to_vec());
        }
        if examples.len() == FirstMessages::COUNT
            && let Some(examples) = self.examples.remove(&channel.id)
        {
            self.judge(channel, definitions, &examples);
        }
        true
    }

    /// Whether a channel's messages are included from now on; of JSON messages by these examples.
    fn judge(
        &mut self,
        channel: &Channel,
        definitions: &Definitions,
        examples: &[Vec<u8>],
    ) -> bool {
        let verdict =
            self.is_named(&channel.topic) || self.has_attitude(channel, definitions, examples);
        self.verdicts.insert(channel.id, verdict);
        verdict
    }

    /// Whether a profile names the topic, for any role.
    fn is_named(&self, topic: &str) -> bool {
        self.profiles.iter().any(|profile| {
            self.is_named_for::<AttitudeSource>(profile, topic)
                || self.is_named_for::<VelocitySource>(profile, topic)
                || self.is_named_for::<GimbalSource>(profile, topic)
                || self.is_named_for::<PositionSource>(profile, topic)
        })
    }

    fn is_named_for<A: Alternative>(&self, profile: &Profile, topic: &str) -> bool {
        let is_told = self.told.contains(&A::KIND);
        let is_match = |name: &String| match &self.namespace {
            // Whoever tells a topic names it as the log does.
            _ if is_told => Pattern::new("", name).is_match(topic),
            Some(namespace) => Pattern::new(namespace, name).is_match(topic),
            // Which namespaces there are is known only when all topics are.
            None if profile.namespaced => Pattern::new("", name).may_be_match(topic),
            None => Pattern::new("", name).is_match(topic),
        };
        let places = A::of(profile).iter().map(Alternative::place);
        places.flat_map(|place| &place.topics).any(is_match)
    }

    /// Whether the messages are of the type, and have the fields, of the attitude of a profile that names no topics,
    /// and of the velocity where they must have that too. What else such a profile finds is in the same messages.
    fn has_attitude(
        &self,
        channel: &Channel,
        definitions: &Definitions,
        examples: &[Vec<u8>],
    ) -> bool {
        if !is_within(
            &channel.topic,
            self.namespace.as_deref().unwrap_or_default(),
        ) {
            return false;
        }
        let schema = definitions.schemas.get(&channel.schema_id);
        let name = schema.map_or("", |schema| schema.name.as_str());
        let of_type = |profile: &&Profile| {
            let alternatives = unnamed::<AttitudeSource>(profile, name);
            alternatives.is_ok_and(|alternatives| !alternatives.is_empty())
        };
        let mut profiles = self.profiles.iter().filter(of_type).peekable();
        if profiles.peek().is_none() {
            return false;
        }
        let examples = FirstMessages::given(examples);
        let Ok(schema) = MessageSchema::of(channel, schema, &examples) else {
            return false;
        };
        profiles.any(|profile| {
            binds::<AttitudeSource>(&schema, profile, name)
                && (!profile.velocity.iter().any(|source| source.required)
                    || binds::<VelocitySource>(&schema, profile, name))
        })
    }
}

/// Those of a role's alternatives that name no topics and are meant for a type of message.
fn unnamed<'p, A: Alternative>(
    profile: &'p Profile,
    schema_name: &str,
) -> Result<Vec<&'p A>, SchemaError> {
    let unnamed = (A::of(profile).iter()).filter(|source| source.place().topics.is_empty());
    meant_for(schema_name, unnamed)
}

/// Whether the fields of such alternatives are there, or none is such.
fn binds<A: Alternative>(schema: &MessageSchema, profile: &Profile, schema_name: &str) -> bool {
    unnamed::<A>(profile, schema_name)
        .and_then(|alternatives| bind_role(&mut Binder::new(schema), profile, &alternatives))
        .is_ok()
}
