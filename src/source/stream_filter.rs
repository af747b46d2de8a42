//! Which messages of a streamed log may turn out to be its telemetry, once all of the log is known.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use mcap::records::Channel;

use super::{
    bind::{BindError, Binder, ChannelName, SaidBy, bind_role, for_type},
    pattern::{Pattern, is_within},
    profile::{Alternative, Profile},
    request::Request,
};
use crate::{
    decode::{FirstMessages, Proof, schema::MessageSchema},
    log::{LONGEST_EXAMPLE, contents::Definitions, stream::Passing},
    sample::{Kind, VelocityFrom},
};

/// Picks the messages that [`Source::select`](super::Source::select) might choose in a log, while the log streams by.
/// Includes all of these, and some others, so that the selection gives the same result as on the whole log, for the
/// same reasons.
///
/// A channel is judged once, by its topic, its type, and the fields of its messages. The fields of JSON messages are
/// known only after the example messages have passed, which are the first ten of the first segment that has any. These
/// are always included.
#[derive(Debug)]
pub struct StreamFilter {
    /// The profiles that will be tried.
    profiles: Vec<Profile>,
    namespace: Option<String>,
    /// The roles whose places the user gives.
    requested: BTreeSet<Kind>,
    velocity_from: VelocityFrom,
    /// The kinds of sample that are looked for.
    kinds: Vec<Kind>,
    /// Whether a channel's messages are included, by its id.
    verdicts: HashMap<u16, bool>,
    /// The examples of channels that are not judged yet, from the latest segment.
    examples: BTreeMap<u16, Vec<Vec<u8>>>,
    segment: usize,
}

impl StreamFilter {
    /// Makes a filter for a request.
    pub fn new(request: &Request) -> Self {
        Self::of_kinds(request, &Kind::USUAL)
    }

    /// Makes a filter for [`Source::select_for_check`](super::Source::select_for_check).
    pub fn for_check(request: &Request) -> Self {
        Self::of_kinds(request, &Kind::CHECKED)
    }

    /// The same for [`Source::select_to_show`](super::Source::select_to_show).
    #[must_use]
    pub fn showing(mut self, shown: &[Kind]) -> Self {
        self.kinds.extend(shown);
        self
    }

    fn of_kinds(request: &Request, kinds: &[Kind]) -> Self {
        Self {
            profiles: (request.profiles().into_iter())
                .flat_map(|adapted| [adapted.with_own_attitude(), Some(adapted.profile)])
                .flatten()
                .collect(),
            namespace: request.namespace.clone(),
            requested: request.roles.keys().copied().collect(),
            velocity_from: request.velocity_from,
            kinds: kinds.to_vec(),
            verdicts: HashMap::new(),
            examples: BTreeMap::new(),
            segment: 0,
        }
    }

    /// Decides whether to include a message. All messages of the log have to be passed, in the order of the log.
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
            // The schema may still come.
            return true;
        }
        if !FirstMessages::tell_the_fields_of(channel) || self.is_named(&channel.topic) {
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

    /// Decides whether a channel's messages are included from now on; JSON messages are judged by these examples.
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
        let is_named_by = |profile: &Profile| {
            (self.kinds.iter()).any(|&kind| self.is_named_for(kind, profile, topic))
        };
        self.profiles.iter().any(is_named_by)
    }

    fn is_named_for(&self, kind: Kind, profile: &Profile, topic: &str) -> bool {
        let is_requested = self.requested.contains(&kind);
        let is_match = |name: &String| match &self.namespace {
            // The user names a topic as the log does.
            _ if is_requested => Pattern::new("", name).is_match(topic),
            Some(namespace) => Pattern::new(namespace, name).is_match(topic),
            // All namespaces are known only when all topics are.
            None if profile.namespaced => Pattern::new("", name).may_be_match(topic),
            None => Pattern::new("", name).is_match(topic),
        };
        let mut alternatives = profile.alternatives(kind).iter();
        alternatives.any(|alternative| {
            let longer = alternative.longer_readings().into_iter();
            let longer = longer.map(|reading| reading.topic.as_str().to_owned());
            let primary = alternative.location.primary.iter();
            let of_primary = primary.flat_map(|primary| &primary.topics);
            let topics = alternative.location.topics.iter().chain(of_primary);
            let names: Vec<String> = (topics.cloned()).chain(longer).collect();
            names.iter().any(is_match)
        })
    }

    /// Whether the messages have the type and the fields of the attitude of a profile that names no topics, and of what
    /// the velocity comes from if they must have that too. Whatever else such a profile finds is in the same messages.
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
            let alternatives = without_topics(profile, Kind::Attitude, name);
            alternatives.is_ok_and(|alternatives| !alternatives.is_empty())
        };
        let mut profiles = self.profiles.iter().filter(of_type).peekable();
        if profiles.peek().is_none() {
            return false;
        }
        let examples = FirstMessages::given(examples);
        // Whether it takes more than that is known only when all topics are.
        let Ok(schema) = MessageSchema::of(channel, schema, &examples, Proof::Listed) else {
            return false;
        };
        profiles.any(|profile| {
            let velocity = self.velocity_from.kind();
            let channel = ChannelName {
                topic: &channel.topic,
                schema: name,
            };
            binds(&schema, profile, Kind::Attitude, channel)
                && (!profile.requires_velocity() || binds(&schema, profile, velocity, channel))
        })
    }
}

/// The alternatives of a role that name no topics and are meant for a type of message.
fn without_topics<'p>(
    profile: &'p Profile,
    kind: Kind,
    schema_name: &str,
) -> Result<Vec<&'p Alternative>, BindError> {
    let alternatives = profile.alternatives(kind).iter();
    let without = alternatives.filter(|alternative| alternative.location.topics.is_empty());
    for_type(schema_name, without)
}

/// Whether the fields of such alternatives are there, or there are no such alternatives.
fn binds(schema: &MessageSchema, profile: &Profile, kind: Kind, channel: ChannelName) -> bool {
    let mut binder = Binder::new(schema, channel);
    without_topics(profile, kind, channel.schema)
        .and_then(|alternatives| {
            bind_role(
                &mut binder,
                profile,
                SaidBy::TypeProfile,
                kind,
                &alternatives,
            )
        })
        .is_ok()
}
