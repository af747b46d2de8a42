//! Looking for a profile's telemetry in a log.

mod told;

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Channel;

use super::{
    RoleSource,
    alternative::{Alternative, bind_role, meant_for},
    binder::Binder,
    binding::Role,
    channel::ChannelSource,
    profile::{AttitudeSource, GimbalSource, Place, PositionSource, Profile, VelocitySource},
    request::{Request, Told},
    topic::Pattern,
};
use crate::{
    decode::{
        FirstMessages,
        error::{SchemaError, quote},
        path::FieldPath,
        schema::MessageSchema,
    },
    error::Error,
    log::Log,
    sample::Kind,
};

/// A place in a log that a profile fits: one vehicle, or where a profile names no topics, one topic.
#[derive(Debug, Clone)]
pub struct Fit {
    pub namespace: String,
    pub attitude: RoleSource,
    /// The other roles, or why the log has none.
    pub others: BTreeMap<Kind, Result<RoleSource, Missing>>,
}

/// Why a role has no samples.
#[derive(Debug, Clone)]
pub struct Missing {
    /// In words.
    pub reason: String,
    /// Whether there are messages where the profile says, and they lack what it says of them.
    pub is_fault: bool,
}

/// What an attitude is told by, the surest last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Specificity {
    Fields,
    Schema,
    Topic,
}

/// What a profile tells the attitude by.
pub fn specificity(profile: &Profile) -> Specificity {
    let place = &profile.attitude[0].place;
    match (place.topics.is_empty(), place.schemas.is_empty()) {
        (false, _) => Specificity::Topic,
        (true, false) => Specificity::Schema,
        (true, true) => Specificity::Fields,
    }
}

/// Looks for what profiles name in one log. Schemas are read when they are needed and not kept: those of some
/// logs each hold the definitions of all topics.
pub struct Finder<'a> {
    log: &'a Log,
    examples: &'a FirstMessages<'a>,
    /// The channels that have messages, by topic.
    topics: BTreeMap<&'a str, Vec<&'a Channel>>,
    /// The only namespace in which to look.
    namespace: Option<&'a str>,
    /// What the user has told where to find.
    told: BTreeMap<Kind, Told<'a>>,
}

impl<'a> Finder<'a> {
    /// In a log, as a request wants it.
    pub fn new(log: &'a Log, examples: &'a FirstMessages<'a>, request: &'a Request) -> Self {
        let mut topics: BTreeMap<&str, Vec<&Channel>> = BTreeMap::new();
        for (channel, _) in log.contents.channels_with_messages() {
            topics.entry(&channel.topic).or_default().push(channel);
        }
        Self {
            log,
            examples,
            topics,
            namespace: request.namespace.as_deref(),
            told: request.told(),
        }
    }

    /// Where a profile fits the log, or why nowhere.
    pub fn fit(&self, profile: &Profile) -> Result<Result<Vec<Fit>, String>, Error> {
        match specificity(profile) {
            Specificity::Topic => self.fit_by_topics(profile),
            _ => self.fit_by_fields(profile),
        }
    }

    fn fit_by_topics(&self, profile: &Profile) -> Result<Result<Vec<Fit>, String>, Error> {
        let mut fits = Vec::new();
        let mut reason = None;
        for namespace in self.namespaces(profile) {
            let fit = match self.choose::<AttitudeSource>(profile, &namespace, None)? {
                Ok(attitude) => self.complete(profile, &namespace, attitude)?,
                Err(missing) => Err(self.misfit(Kind::Attitude, &missing)?),
            };
            match fit {
                Ok(fit) => fits.push(fit),
                Err(why) => reason = reason.or(Some(why)),
            }
        }
        Ok(match reason {
            Some(why) if fits.is_empty() => Err(why),
            _ => Ok(fits),
        })
    }

    /// The namespaces in which a profile may find its topics.
    fn namespaces(&self, profile: &Profile) -> BTreeSet<String> {
        if let Some(namespace) = self.namespace {
            return BTreeSet::from([namespace.to_owned()]);
        }
        let mut namespaces = BTreeSet::new();
        if profile.namespaced {
            for pattern in self.telling_topics(profile) {
                let within = (self.topics.keys()).filter_map(|topic| pattern.namespace_of(topic));
                namespaces.extend(within.map(str::to_owned));
            }
        }
        if let Some(told) = self.told.get(&Kind::Attitude) {
            let is_near =
                |namespace: &String| (told.topics.iter()).any(|topic| is_within(topic, namespace));
            namespaces.retain(is_near);
        }
        if namespaces.is_empty() {
            namespaces.insert(String::new());
        }
        namespaces
    }

    /// Looks through all topics for messages that have the attitude's fields.
    fn fit_by_fields(&self, profile: &Profile) -> Result<Result<Vec<Fit>, String>, Error> {
        let namespace = self.namespace.unwrap_or_default();
        let mut fits = Vec::new();
        let mut misfit = None;
        let mut nearest: Option<(&str, SchemaError)> = None;
        let mut opaque: Option<(&str, SchemaError)> = None;
        for topic in self
            .topics
            .keys()
            .filter(|topic| is_within(topic, namespace))
        {
            match self.bind_data_point(profile, namespace, topic) {
                Ok(fields) => {
                    let topic = (*topic).to_owned();
                    let attitude = RoleSource { topic, fields };
                    match self.complete(profile, namespace, attitude)? {
                        Ok(fit) => fits.push(fit),
                        Err(reason) => misfit = misfit.or(Some(reason)),
                    }
                }
                Err(SchemaError::Unreadable(error)) => return Err(error.into()),
                Err(unresolved) if unresolved.is_opaque() => {
                    opaque = opaque.or(Some((topic, unresolved)));
                }
                Err(unresolved) => {
                    let lacks = unresolved.lacks();
                    if lacks
                        < nearest
                            .as_ref()
                            .map_or(usize::MAX, |(_, other)| other.lacks())
                    {
                        nearest = Some((topic, unresolved));
                    }
                }
            }
        }
        match misfit {
            _ if !fits.is_empty() => return Ok(Ok(fits)),
            Some(reason) => return Ok(Err(reason)),
            None => {}
        }
        let wanted = required_fields(profile);
        let nearest = nearest.filter(|(_, unresolved)| unresolved.lacks() < wanted.len());
        let nearest = match (nearest, opaque) {
            (Some((topic, unresolved)), _) => format!("; {topic} comes closest: {unresolved}"),
            (None, Some((topic, unresolved))) => {
                format!("; what {topic} has is not known: {unresolved}")
            }
            (None, None) => String::new(),
        };
        let schemas = &profile.attitude[0].place.schemas;
        Ok(Err(match schemas.as_slice() {
            [] => format!(
                "no topic has messages with all of the fields {}{nearest}",
                quote(&wanted)
            ),
            schemas => format!(
                "no topic has messages of type {}{nearest}",
                schemas.join(" or ")
            ),
        }))
    }

    /// Resolves what the messages of any one topic must have: the attitude, and the velocity if that is required
    /// and not told to be elsewhere.
    fn bind_data_point(
        &self,
        profile: &Profile,
        namespace: &str,
        topic: &str,
    ) -> Result<Vec<FieldPath>, SchemaError> {
        let alternatives = self.at_topic::<AttitudeSource>(profile, namespace, topic, topic);
        let attitude = self.bind(profile, topic, &alternatives);
        if !self.requires(profile, Kind::Velocity) || self.told.contains_key(&Kind::Velocity) {
            return attitude;
        }
        let alternatives = self.at_topic::<VelocitySource>(profile, namespace, topic, topic);
        let velocity = self.bind(profile, topic, &alternatives);
        match attitude {
            Ok(fields) => velocity.map(|_| fields),
            Err(unresolved) => Err(unresolved.and(velocity.err())),
        }
    }

    /// Whether a log without samples of a kind is none that a profile fits.
    fn requires(&self, profile: &Profile, kind: Kind) -> bool {
        self.told.contains_key(&kind)
            || kind == Kind::Velocity && profile.velocity.iter().any(|source| source.required)
    }

    /// Adds to an attitude what else the profile finds beside it, or tells what is wrong.
    fn complete(
        &self,
        profile: &Profile,
        namespace: &str,
        attitude: RoleSource,
    ) -> Result<Result<Fit, String>, Error> {
        let own = Some(attitude.topic.as_str());
        let others = BTreeMap::from([
            (
                Kind::Velocity,
                self.choose::<VelocitySource>(profile, namespace, own)?,
            ),
            (
                Kind::Gimbal,
                self.choose::<GimbalSource>(profile, namespace, own)?,
            ),
            (
                Kind::Position,
                self.choose::<PositionSource>(profile, namespace, own)?,
            ),
        ]);
        for (&kind, role) in &others {
            if let Err(missing) = role
                && (self.requires(profile, kind) || kind == Kind::Velocity && missing.is_fault)
            {
                return Ok(Err(self.misfit(kind, missing)?));
            }
        }
        Ok(Ok(Fit {
            namespace: namespace.to_owned(),
            attitude,
            others,
        }))
    }

    /// The first of a role's topics that has messages with the fields; `own` is the attitude's.
    fn choose<A: Alternative>(
        &self,
        profile: &Profile,
        namespace: &str,
        own: Option<&str>,
    ) -> Result<Result<RoleSource, Missing>, Error> {
        let mut fault = None;
        let mut patterns = Vec::new();
        for alternative in A::of(profile) {
            let place = alternative.place();
            let of_alternative =
                (place.topics.iter()).map(|topic| self.pattern::<A>(namespace, topic));
            let of_alternative: Vec<Pattern> = of_alternative.collect();
            let named = of_alternative
                .iter()
                .flat_map(|pattern| pattern.matches(self.topics.keys().copied()));
            let own = own.filter(|_| place.topics.is_empty());
            for topic in named.chain(own) {
                match self.bind(profile, topic, &[alternative]) {
                    Ok(fields) => {
                        let topic = topic.to_owned();
                        return Ok(Ok(RoleSource { topic, fields }));
                    }
                    Err(SchemaError::Unreadable(error)) => return Err(error.into()),
                    // An alternative for another type of message says nothing of this one.
                    Err(SchemaError::OtherType { .. }) => {}
                    Err(unresolved) => {
                        fault = fault.or_else(|| Some(format!("{topic}: {unresolved}")));
                    }
                }
            }
            patterns.extend(of_alternative);
        }
        let mut names: Vec<String> = Vec::new();
        for name in patterns.iter().map(Pattern::to_string) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        Ok(Err(Missing {
            is_fault: fault.is_some(),
            reason: fault.unwrap_or_else(|| match (names.as_slice(), own) {
                ([], Some(own)) if !A::of(profile).is_empty() => {
                    format!("the messages on {own} have none")
                }
                ([], _) => {
                    let kind = A::KIND.name();
                    match self.told.contains_key(&A::KIND) {
                        true => format!("it has no {kind}; give --{kind} fields, not only a topic"),
                        false => format!("the profile `{}` has no {kind}", profile.name),
                    }
                }
                (names, _) => format!("there is no message on {}", list(names)),
            }),
        }))
    }

    /// Resolves the fields of some alternatives against every channel of a topic; gives their names.
    fn bind<A: Alternative>(
        &self,
        profile: &Profile,
        topic: &str,
        alternatives: &[&A],
    ) -> Result<Vec<FieldPath>, SchemaError> {
        let mut fields = Vec::new();
        for channel in &self.topics[topic] {
            let alternatives = self.of_type(channel, alternatives.iter().copied())?;
            let schema = self.schema(channel)?;
            fields = bind_role(&mut Binder::new(&schema), profile, &alternatives)?.fields;
        }
        Ok(fields)
    }

    /// Those alternatives of a role that are meant for a topic; `own` is the attitude's.
    fn at_topic<'p, A: Alternative>(
        &self,
        profile: &'p Profile,
        namespace: &str,
        topic: &str,
        own: &str,
    ) -> Vec<&'p A> {
        let is_at_topic = |place: &Place| match place.topics.as_slice() {
            [] => own == topic,
            topics => {
                (topics.iter()).any(|text| self.pattern::<A>(namespace, text).is_match(topic))
            }
        };
        let alternatives = A::of(profile).iter();
        alternatives
            .filter(|source| is_at_topic(source.place()))
            .collect()
    }

    /// Those alternatives that are meant for a channel's type of message.
    fn of_type<'p, A: Alternative>(
        &self,
        channel: &Channel,
        alternatives: impl Iterator<Item = &'p A>,
    ) -> Result<Vec<&'p A>, SchemaError> {
        let schema = self.log.contents.schema_of(channel);
        let name = schema.map_or("", |schema| schema.name.as_str());
        meant_for(name, alternatives)
    }

    fn bind_into<A: Alternative>(
        &self,
        binder: &mut Binder,
        profile: &Profile,
        fit: &Fit,
        channel: &Channel,
    ) -> Result<Role, SchemaError> {
        let own = fit.attitude.topic.as_str();
        let at_topic = self.at_topic::<A>(profile, &fit.namespace, &channel.topic, own);
        let alternatives = self.of_type(channel, at_topic.into_iter())?;
        bind_role(binder, profile, &alternatives)
    }

    /// How to read each channel of a fit's topics for some kinds of sample.
    pub fn channels_of(
        &self,
        profile: &Profile,
        fit: &Fit,
        wanted: &[Kind],
    ) -> Result<BTreeMap<u16, ChannelSource>, Error> {
        let others =
            (fit.others.iter()).filter_map(|(&kind, role)| Some((kind, role.as_ref().ok()?)));
        // In the order of kinds, in which the samples of one message belong.
        let roles: BTreeMap<Kind, &RoleSource> = (others.chain([(Kind::Attitude, &fit.attitude)]))
            .filter(|(kind, _)| wanted.contains(kind))
            .collect();
        let topics: BTreeSet<&str> = roles.values().map(|role| role.topic.as_str()).collect();
        let mut channels = BTreeMap::new();
        for channel in topics.iter().flat_map(|topic| &self.topics[topic]) {
            let kinds = (roles.iter())
                .filter(|(_, role)| role.topic == channel.topic)
                .map(|(&kind, _)| kind);
            let source = self.channel_source(profile, fit, channel, kinds);
            channels.insert(
                channel.id,
                source.map_err(|unresolved| match unresolved {
                    SchemaError::Unreadable(error) => error.into(),
                    other => Error::ProfileDoesNotFit {
                        path: self.log.file.path().into(),
                        profile: profile.name.clone(),
                        problem: format!("{}: {other}", channel.topic),
                    },
                })?,
            );
        }
        Ok(channels)
    }

    fn channel_source(
        &self,
        profile: &Profile,
        fit: &Fit,
        channel: &Channel,
        kinds: impl Iterator<Item = Kind>,
    ) -> Result<ChannelSource, SchemaError> {
        let schema = self.schema(channel)?;
        let mut binder = Binder::new(&schema);
        let mut roles = Vec::new();
        for kind in kinds {
            let binder = &mut binder;
            roles.push(match kind {
                Kind::Attitude => self.bind_into::<AttitudeSource>(binder, profile, fit, channel),
                Kind::Velocity => self.bind_into::<VelocitySource>(binder, profile, fit, channel),
                Kind::Gimbal => self.bind_into::<GimbalSource>(binder, profile, fit, channel),
                Kind::Position => self.bind_into::<PositionSource>(binder, profile, fit, channel),
            }?);
        }
        ChannelSource::new(&schema, &binder.wanted, roles)
    }

    fn schema(&self, channel: &Channel) -> Result<MessageSchema<'a>, SchemaError> {
        let schema = self.log.contents.schema_of(channel);
        MessageSchema::of(channel, schema, self.examples)
    }
}

/// Whether a topic is in a namespace.
pub fn is_within(topic: &str, namespace: &str) -> bool {
    (topic.strip_prefix(namespace))
        .is_some_and(|rest| namespace.is_empty() || rest.starts_with('/'))
}

/// The first few of the topics that would do.
fn list(names: &[String]) -> String {
    const LISTED: usize = 3;
    match names.len().saturating_sub(LISTED) {
        0 => names.join(" or "),
        1 => format!("{} or one other", names[..LISTED].join(", ")),
        more => format!("{} or {more} others", names[..LISTED].join(", ")),
    }
}

/// The fields that a message must have for a profile that names no topics.
fn required_fields(profile: &Profile) -> Vec<FieldPath> {
    let attitude = profile.attitude[0].fields();
    let velocity = profile.velocity.first().filter(|source| source.required);
    let velocity = velocity.map(|source| source.fields()).unwrap_or_default();
    attitude.into_iter().chain(velocity).cloned().collect()
}
