//! Looking for a profile's telemetry in a log.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Channel;

use super::fit::{Fit, Specificity, specificity};
use crate::{
    decode::{FirstMessages, path::FieldPath, schema::MessageSchema},
    log::Log,
    sample::Kind,
    source::{
        Origin,
        bind::{BindError, Binder, bind_role, for_type},
        error::{Misfit, TopicMisfit, Unfit},
        pattern::is_within,
        profile::{Alternative, Profile},
        request::{Request, RoleArgument},
    },
};

/// Looks for what profiles name in one log. Schemas are read when they are needed and not kept: those of some
/// logs each hold the definitions of all topics.
pub struct Finder<'a> {
    pub log: &'a Log,
    examples: &'a FirstMessages<'a>,
    /// The channels that have messages, by topic.
    pub topics: BTreeMap<&'a str, Vec<&'a Channel>>,
    /// The only namespace in which to look.
    pub namespace: Option<&'a str>,
    /// Where the user says that roles are.
    pub requested: &'a BTreeMap<Kind, RoleArgument>,
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
            requested: &request.roles,
        }
    }

    /// Where a profile fits the log.
    ///
    /// # Errors
    /// Why nowhere.
    pub fn fit(&self, profile: &Profile) -> Result<Vec<Fit>, Unfit> {
        match specificity(profile) {
            Specificity::Topic => self.fit_by_topics(profile),
            Specificity::Schema | Specificity::Fields => self.fit_by_fields(profile),
        }
    }

    fn fit_by_topics(&self, profile: &Profile) -> Result<Vec<Fit>, Unfit> {
        let fits = self.namespaces(profile).into_iter().map(|namespace| {
            let attitude = (self.choose(profile, Kind::Attitude, &namespace, None))
                .map_err(|unfit| self.as_requested(Kind::Attitude, unfit))?;
            self.complete(profile, &namespace, attitude)
        });
        any_or_first_misfit(fits)
    }

    /// The namespaces in which a profile may find its topics.
    fn namespaces(&self, profile: &Profile) -> BTreeSet<String> {
        if let Some(namespace) = self.namespace {
            return BTreeSet::from([namespace.to_owned()]);
        }
        let mut namespaces = BTreeSet::new();
        if profile.namespaced {
            for pattern in self.namespaced_topics(profile) {
                let within = (self.topics.keys()).filter_map(|topic| pattern.namespace_of(topic));
                namespaces.extend(within.map(str::to_owned));
            }
        }
        if let Some(attitude) = self.requested.get(&Kind::Attitude) {
            let topics = attitude.topics();
            namespaces.retain(|namespace| topics.iter().any(|topic| is_within(topic, namespace)));
        }
        if namespaces.is_empty() {
            namespaces.insert(String::new());
        }
        namespaces
    }

    /// Looks through all topics for messages that have the attitude's fields.
    fn fit_by_fields(&self, profile: &Profile) -> Result<Vec<Fit>, Unfit> {
        let namespace = self.namespace.unwrap_or_default();
        let mut attitudes = Vec::new();
        let mut misfits = Vec::new();
        for topic in (self.topics.keys()).filter(|topic| is_within(topic, namespace)) {
            match self.bind_data_point(profile, namespace, topic) {
                Ok(fields) => attitudes.push(Origin {
                    topic: (*topic).to_owned(),
                    fields,
                }),
                Err(error) => misfits.push(TopicMisfit::new(topic, error.unless_of_reading()?)),
            }
        }
        if attitudes.is_empty() {
            return Err(no_topic(profile, misfits).into());
        }
        let attitudes = attitudes.into_iter();
        any_or_first_misfit(attitudes.map(|attitude| self.complete(profile, namespace, attitude)))
    }

    /// Resolves what the messages of any one topic must have: the attitude, and the velocity if that is required
    /// and not requested from elsewhere.
    fn bind_data_point(
        &self,
        profile: &Profile,
        namespace: &str,
        topic: &str,
    ) -> Result<Vec<FieldPath>, BindError> {
        let bind = |kind: Kind| {
            let alternatives = self.at_topic(profile, kind, namespace, topic, topic);
            self.bind(profile, kind, topic, &alternatives)
        };
        let attitude = bind(Kind::Attitude);
        let is_elsewhere = self.requested.contains_key(&Kind::Velocity);
        if is_elsewhere || !self.requires(profile, Kind::Velocity) {
            return attitude;
        }
        let velocity = bind(Kind::Velocity);
        match attitude {
            Ok(fields) => velocity.map(|_| fields),
            Err(error) => Err(error.and(velocity.err())),
        }
    }

    /// Whether a log without samples of a kind is none that a profile fits.
    fn requires(&self, profile: &Profile, kind: Kind) -> bool {
        let mut alternatives = profile.alternatives(kind).iter();
        self.requested.contains_key(&kind)
            || alternatives.any(|alternative| alternative.fields.is_required())
    }

    /// Adds to an attitude what else the profile finds beside it.
    fn complete(&self, profile: &Profile, namespace: &str, attitude: Origin) -> Result<Fit, Unfit> {
        let mut others = BTreeMap::new();
        for kind in Kind::ALL.into_iter().filter(|&kind| kind != Kind::Attitude) {
            let origin = match self.choose(profile, kind, namespace, Some(&attitude.topic)) {
                Ok(origin) => Ok(origin),
                Err(Unfit::Misfit(misfit)) if !self.is_needed(profile, kind, &misfit) => {
                    Err(misfit)
                }
                Err(unfit) => return Err(self.as_requested(kind, unfit)),
            };
            others.insert(kind, origin);
        }
        Ok(Fit {
            namespace: namespace.to_owned(),
            attitude,
            others,
        })
    }

    /// Whether a profile does not fit where a role is missing for this reason.
    fn is_needed(&self, profile: &Profile, kind: Kind, misfit: &Misfit) -> bool {
        // There are messages where the profile says that the velocity is, and they are not what it says.
        let is_fault = matches!(misfit, Misfit::Messages(_));
        self.requires(profile, kind) || kind == Kind::Velocity && is_fault
    }

    /// The first of a role's topics that has messages with the fields; `own` is the attitude's.
    fn choose(
        &self,
        profile: &Profile,
        kind: Kind,
        namespace: &str,
        own: Option<&str>,
    ) -> Result<Origin, Unfit> {
        let mut fault = None;
        for alternative in profile.alternatives(kind) {
            let topics = alternative.place.topics.iter();
            let named = topics.flat_map(|topic| {
                let pattern = self.pattern(kind, namespace, topic);
                pattern.matches(self.topics.keys().copied())
            });
            let own = own.filter(|_| alternative.place.topics.is_empty());
            for topic in named.chain(own) {
                match self.bind(profile, kind, topic, &[alternative]) {
                    Ok(fields) => {
                        let topic = topic.to_owned();
                        return Ok(Origin { topic, fields });
                    }
                    // An alternative for another type of message says nothing of this one.
                    Err(BindError::OtherType { .. }) => {}
                    Err(error) => {
                        let misfit = TopicMisfit::new(topic, error.unless_of_reading()?);
                        fault.get_or_insert(misfit);
                    }
                }
            }
        }
        Err(match fault {
            Some(fault) => Misfit::Messages(fault),
            None => self.why_nowhere(profile, kind, namespace, own),
        }
        .into())
    }

    /// Why a role is on none of the log's topics.
    fn why_nowhere(
        &self,
        profile: &Profile,
        kind: Kind,
        namespace: &str,
        own: Option<&str>,
    ) -> Misfit {
        let alternatives = profile.alternatives(kind);
        let mut topics: Vec<String> = Vec::new();
        for topic in alternatives.iter().flat_map(|one| &one.place.topics) {
            let topic = self.pattern(kind, namespace, topic).to_string();
            if !topics.contains(&topic) {
                topics.push(topic);
            }
        }
        match own {
            _ if !topics.is_empty() => Misfit::NoMessages { topics },
            Some(own) if !alternatives.is_empty() => Misfit::NotWithAttitude {
                topic: own.to_owned(),
            },
            _ if self.requested.contains_key(&kind) => Misfit::OnlyATopic { role: kind },
            _ => Misfit::NotInProfile {
                profile: profile.name.clone(),
                role: kind,
            },
        }
    }

    /// Resolves the fields of some alternatives against every channel of a topic; gives their names.
    fn bind(
        &self,
        profile: &Profile,
        kind: Kind,
        topic: &str,
        alternatives: &[&Alternative],
    ) -> Result<Vec<FieldPath>, BindError> {
        let mut fields = Vec::new();
        for channel in &self.topics[topic] {
            let alternatives = self.for_channel(channel, alternatives)?;
            let schema = self.schema(channel)?;
            let mut binder = Binder::new(&schema);
            fields = bind_role(&mut binder, profile, kind, &alternatives)?.fields;
        }
        Ok(fields)
    }

    /// Those alternatives of a role that are meant for a topic; `own` is the attitude's.
    pub fn at_topic<'p>(
        &self,
        profile: &'p Profile,
        kind: Kind,
        namespace: &str,
        topic: &str,
        own: &str,
    ) -> Vec<&'p Alternative> {
        let is_match = |text: &String| self.pattern(kind, namespace, text).is_match(topic);
        let is_at_topic = |alternative: &&Alternative| match alternative.place.topics.as_slice() {
            [] => own == topic,
            topics => topics.iter().any(is_match),
        };
        let alternatives = profile.alternatives(kind).iter();
        alternatives.filter(is_at_topic).collect()
    }

    /// Those alternatives that are meant for a channel's type of message.
    pub fn for_channel<'p>(
        &self,
        channel: &Channel,
        alternatives: &[&'p Alternative],
    ) -> Result<Vec<&'p Alternative>, BindError> {
        let schema = self.log.contents.schema_of(channel);
        let name = schema.map_or("", |schema| schema.name.as_str());
        for_type(name, alternatives.iter().copied())
    }

    pub fn schema(&self, channel: &Channel) -> Result<MessageSchema<'a>, BindError> {
        let schema = self.log.contents.schema_of(channel);
        Ok(MessageSchema::of(channel, schema, self.examples)?)
    }
}

/// The fits, or why there is none at the first place that was looked at.
fn any_or_first_misfit(
    places: impl Iterator<Item = Result<Fit, Unfit>>,
) -> Result<Vec<Fit>, Unfit> {
    let mut fits = Vec::new();
    let mut first_misfit = None;
    for place in places {
        match place {
            Ok(fit) => fits.push(fit),
            Err(Unfit::Misfit(misfit)) => {
                first_misfit.get_or_insert(misfit);
            }
            Err(error) => return Err(error),
        }
    }
    match first_misfit {
        Some(misfit) if fits.is_empty() => Err(misfit.into()),
        _ => Ok(fits),
    }
}

/// Why a profile that names no topics does not fit, when all topics lack something.
fn no_topic(profile: &Profile, misfits: Vec<TopicMisfit>) -> Misfit {
    let fields = required_fields(profile);
    let (opaque, known): (Vec<_>, Vec<_>) = misfits.into_iter().partition(TopicMisfit::is_opaque);
    let nearest = known.into_iter().min_by_key(TopicMisfit::lacks);
    let nearest = nearest.filter(|misfit| misfit.lacks() < fields.len());
    let nearest = nearest.or_else(|| opaque.into_iter().next());
    let attitude = profile.alternatives(Kind::Attitude).first();
    let schemas = attitude.map_or(&[][..], |alternative| &alternative.place.schemas);
    match schemas {
        [] => Misfit::NoSuchFields { fields, nearest },
        schemas => Misfit::NoSuchType {
            schemas: schemas.to_vec(),
            nearest,
        },
    }
}

/// The fields that a message must have for a profile that names no topics.
fn required_fields(profile: &Profile) -> Vec<FieldPath> {
    let [attitude, velocity] =
        [Kind::Attitude, Kind::Velocity].map(|kind| profile.alternatives(kind).first());
    let velocity = velocity.filter(|velocity| velocity.fields.is_required());
    let alternatives = attitude.into_iter().chain(velocity);
    let fields = alternatives.flat_map(|alternative| alternative.fields.fields());
    fields.cloned().collect()
}
