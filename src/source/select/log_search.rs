//! Looking for a profile's telemetry in a log: in which namespaces, and on which topics.

use std::{
    collections::{BTreeMap, BTreeSet},
    rc::Rc,
};

use mcap::records::Channel;

use super::{
    Thoroughness, derived_from,
    fit::{Fit, Specificity, specificity},
    namespace_search::NamespaceSearch,
    prospects::{Prospect, Words},
};
use crate::{
    decode::{FirstMessages, Proof, path::FieldPath, schema::MessageSchema},
    log::{Log, ReadError},
    sample::{Kind, VelocityFrom},
    source::{
        bind::BindError,
        error::{Misfit, TelemetryError, TopicMisfit, Unfit},
        own,
        pattern::{Pattern, is_within},
        profile::{Alternative, Profile},
        request::{Adapted, Request, RoleArgument},
    },
    text::Foreign,
};

/// Looks for what profiles name in one log. Schemas are read when they are needed and not kept, because in some logs
/// each contains the definitions of all topics.
pub struct LogSearch<'a> {
    pub log: &'a Log,
    pub examples: &'a FirstMessages<'a>,
    /// What it takes for the fields of JSON messages to be there.
    pub proof: Proof,
    /// The channels that have messages, by topic.
    pub topics: BTreeMap<&'a str, Vec<&'a Channel>>,
    /// The only namespace to look in, if the user names one.
    namespace: Option<&'a str>,
    /// Where the user says that roles are, which takes precedence over the profiles.
    pub requested: &'a BTreeMap<Kind, RoleArgument>,
    /// What the velocity is taken from.
    pub velocity_from: VelocityFrom,
    pub thoroughness: Thoroughness,
    /// The kinds of sample that are looked for.
    pub kinds: &'static [Kind],
    /// Those that viewers are shown, which are looked for, too.
    pub shown: &'static [Kind],
    /// The words in schemas by which profiles that name no topics find theirs.
    pub words: Rc<Words<'a>>,
}

impl<'a> LogSearch<'a> {
    /// Prepares the search for a request in a log.
    pub fn new(
        log: &'a Log,
        examples: &'a FirstMessages<'a>,
        request: &'a Request,
        proof: Proof,
        thoroughness: Thoroughness,
        kinds: &'static [Kind],
    ) -> Self {
        let mut topics: BTreeMap<&str, Vec<&Channel>> = BTreeMap::new();
        let named = |topic: &str| {
            let mut arguments = request.roles.values();
            arguments.any(|argument| argument.topics().iter().any(|name| name == topic))
        };
        for (channel, _) in log.contents.channels_with_messages() {
            let is_named = named(&channel.topic);
            if own::is_own(log, channel) || (!is_named && own::is_like_own(log, channel)) {
                continue;
            }
            topics.entry(&channel.topic).or_default().push(channel);
        }
        let namespace = (request.namespace.as_deref())
            .map(|namespace| as_topics_begin(namespace, topics.keys().copied()));
        Self {
            log,
            examples,
            proof,
            topics,
            namespace,
            requested: &request.roles,
            velocity_from: request.velocity_from,
            thoroughness,
            kinds,
            shown: &[],
            words: Rc::new(Words::wanted_by(request)),
        }
    }

    /// The same search, which also looks for the kinds of sample that viewers are shown.
    pub fn showing(self, shown: &'static [Kind]) -> Self {
        Self { shown, ..self }
    }

    /// Whether a kind of sample is looked for.
    pub fn looks_for(&self, kind: Kind) -> bool {
        self.kinds.contains(&kind) || self.shown.contains(&kind)
    }

    /// Whether it matters which of several places a kind of sample is read from, so that their messages are looked at.
    pub fn looks_at(&self, kind: Kind) -> bool {
        self.thoroughness == Thoroughness::All
            || derived_from(self.velocity_from).contains(&kind)
            || self.shown.contains(&kind)
    }

    /// How many messages a topic has.
    pub fn messages_on(&self, topic: &str) -> u64 {
        let counts = &self.log.contents.statistics.channel_message_counts;
        let channels = self.topics[topic].iter();
        channels.filter_map(|channel| counts.get(&channel.id)).sum()
    }

    /// Checks that the log has the namespace and the topics that the user names.
    pub fn check_request(&self) -> Result<(), TelemetryError> {
        if let Some(namespace) = self.namespace
            && !(self.topics.keys()).any(|topic| is_within(topic, namespace))
            && !namespace.is_empty()
        {
            return Err(TelemetryError::NoSuchNamespace {
                path: self.log.file.path().into(),
                namespace: namespace.into(),
                instead: self.instead_of_namespace(namespace).into(),
            });
        }
        for (&kind, argument) in self.requested {
            let is_there = |topic: &String| {
                let pattern = Pattern::new("", topic);
                self.topics.keys().any(|topic| pattern.is_match(topic))
            };
            let topics = argument.topics();
            if !topics.is_empty() && !topics.iter().any(is_there) {
                let topics = topics.iter().map(Foreign::from).collect();
                return Err(self.role_does_not_fit(kind, Misfit::NoMessages { topics }));
            }
        }
        Ok(())
    }

    /// Checks that the paths of an alternative mean only one thing in this log.
    fn check_path(&self, role: Kind, alternative: &Alternative) -> Result<(), TelemetryError> {
        match self.ambiguous_readings(alternative) {
            None => Ok(()),
            Some(readings) => Err(TelemetryError::SeveralReadings {
                path: self.log.file.path().into(),
                role,
                readings,
            }),
        }
    }

    pub fn role_does_not_fit(&self, role: Kind, misfit: Misfit) -> TelemetryError {
        TelemetryError::RoleDoesNotFit {
            path: self.log.file.path().into(),
            role,
            instead: self.instead_of_request(role, &misfit).into(),
            misfit: misfit.into(),
        }
    }

    /// Finds where a profile fits the log.
    ///
    /// # Errors
    /// It fits nowhere; the error says why.
    pub fn fit(&self, adapted: &Adapted) -> Result<Vec<Fit>, Unfit> {
        let profile = &adapted.profile;
        for kind in Kind::ALL {
            for alternative in profile.alternatives(kind) {
                self.check_path(kind, alternative)?;
            }
        }
        match (adapted.with_own_attitude(), specificity(adapted.attitude())) {
            (None, Specificity::Topic) => self.fit_by_topics(profile),
            (None, by_content) => self.fit_by_content(profile, by_content),
            (Some(_), Specificity::Topic) => self.fit_by_topics(profile),
            (Some(original), by_content) => self.fit_beside(profile, &original, by_content),
        }
    }

    fn fit_by_topics(&self, profile: &Profile) -> Result<Vec<Fit>, Unfit> {
        let namespaces = self.namespaces(profile);
        any_or_first_misfit(namespaces.iter().map(|namespace| {
            let search = self.search(profile, Specificity::Topic, namespace);
            let attitude = search.attitude()?;
            let own = attitude.origin.topic.clone();
            search.complete(attitude, &own)
        }))
    }

    /// Finds what the user gives, which is all that this profile says.
    pub fn fit_given(&self, profile: &Profile) -> Result<Fit, Unfit> {
        let namespace = self.namespace.unwrap_or_default();
        let search = self.search(profile, Specificity::Fields, namespace);
        let attitude = search.attitude()?;
        let own = attitude.origin.topic.clone();
        search.complete(attitude, &own)
    }

    /// Finds what a profile that names no topics adds to an attitude that the user gives: in the same messages or, if they
    /// have nothing, in those where the profile itself, the `original`, finds the attitude.
    fn fit_beside(
        &self,
        profile: &Profile,
        original: &Profile,
        by_content: Specificity,
    ) -> Result<Vec<Fit>, Unfit> {
        let search = self.search(profile, by_content, self.namespace.unwrap_or_default());
        let attitude = search.attitude()?;
        let complete = |own: &str| search.complete(attitude.clone(), own);
        let here = complete(&attitude.origin.topic);
        match &here {
            Ok(fit) if !self.adds(fit) => {}
            Err(Unfit::Misfit(_)) => {}
            _ => return Ok(vec![here?]),
        }
        let mut requested = self.requested.clone();
        requested.remove(&Kind::Attitude);
        let by_itself = LogSearch {
            requested: &requested,
            topics: self.topics.clone(),
            words: Rc::clone(&self.words),
            ..*self
        };
        match by_itself.fit_by_content(original, by_content) {
            Ok(fits) => any_or_first_misfit(fits.iter().map(|fit| complete(&fit.own))),
            Err(Unfit::Misfit(_)) => Ok(vec![here?]),
            Err(hopeless) => Err(hopeless),
        }
    }

    /// Whether a fit has more than what the user gives in full.
    pub fn adds(&self, fit: &Fit) -> bool {
        fit.first_of(&self.left_to_profiles()).is_some()
    }

    /// The kinds of sample that the user does not give in full, those first that something is derived from.
    pub fn left_to_profiles(&self) -> Vec<Kind> {
        let is_given =
            |kind: &Kind| matches!(self.requested.get(kind), Some(RoleArgument::Fields(_)));
        let (used, unused) = match self.velocity_from {
            VelocityFrom::Messages => (Kind::Velocity, Kind::Position),
            VelocityFrom::Position => (Kind::Position, Kind::Velocity),
        };
        let kinds = [Kind::Attitude, used, Kind::Gimbal, unused];
        kinds.into_iter().filter(|kind| !is_given(kind)).collect()
    }

    /// The namespaces in which a profile may find its topics.
    fn namespaces(&self, profile: &Profile) -> BTreeSet<&str> {
        if let Some(namespace) = self.namespace {
            return [namespace].into();
        }
        let mut namespaces = BTreeSet::new();
        if profile.namespaced {
            for pattern in self.namespaced_topics(profile) {
                namespaces
                    .extend((self.topics.keys()).filter_map(|topic| pattern.namespace_of(topic)));
            }
        }
        if let Some(attitude) = self.requested.get(&Kind::Attitude) {
            let topics = attitude.topics();
            namespaces.retain(|namespace| topics.iter().any(|topic| is_within(topic, namespace)));
        }
        if namespaces.is_empty() {
            namespaces.insert("");
        }
        namespaces
    }

    /// A topic of the log for each kind of sample but the attitude for which a profile names any.
    pub fn topics_named_by(&self, profile: &Profile) -> BTreeMap<Kind, Foreign> {
        let topic_of = |kind: Kind| {
            let topics = profile.alternatives(kind).iter();
            let topics = topics.flat_map(|one| &one.location.topics);
            let namespace = self.namespace.unwrap_or_default();
            let mut patterns = topics.map(|topic| Pattern::new(namespace, topic));
            patterns.find_map(|pattern| {
                let is_anywhere = profile.namespaced && self.namespace.is_none();
                let is_it = |topic: &&&str| match is_anywhere {
                    true => pattern.namespace_of(topic).is_some(),
                    false => pattern.is_match(topic),
                };
                self.topics
                    .keys()
                    .find(is_it)
                    .map(|topic| Foreign::from(*topic))
            })
        };
        let kinds = Kind::USUAL.into_iter();
        let kinds = kinds.filter(|kind| *kind != Kind::Attitude);
        kinds
            .filter_map(|kind| Some((kind, topic_of(kind)?)))
            .collect()
    }

    /// The topics that show a vehicle's namespace: those of the attitude or, if the user has given that, the others.
    fn namespaced_topics(&self, profile: &Profile) -> Vec<Pattern> {
        let of_role = |kind: Kind| -> Vec<Pattern> {
            let alternatives = match self.requested.contains_key(&kind) {
                true => &[],
                false => profile.alternatives(kind),
            };
            let topics = alternatives.iter().flat_map(|one| &one.location.topics);
            topics.map(|topic| Pattern::new("", topic)).collect()
        };
        match of_role(Kind::Attitude) {
            topics if topics.is_empty() => Kind::ALL.into_iter().flat_map(of_role).collect(),
            topics => topics,
        }
    }

    /// Looks through all topics for messages that have the attitude's type or fields.
    fn fit_by_content(
        &self,
        profile: &Profile,
        by_content: Specificity,
    ) -> Result<Vec<Fit>, Unfit> {
        let namespace = self.namespace.unwrap_or_default();
        let search = self.search(profile, by_content, namespace);
        let mut fitting = Vec::new();
        let mut misfits = Vec::new();
        let mut partial = Vec::new();
        for topic in (self.topics.keys()).filter(|topic| is_within(topic, namespace)) {
            match self.prospect(profile, topic)? {
                Prospect::Hopeless => continue,
                Prospect::Partial => {
                    partial.push(topic);
                    continue;
                }
                Prospect::Possible => {}
            }
            match search.check_data_point(topic) {
                Ok(()) => fitting.push(topic),
                Err(error) => misfits.push(TopicMisfit::new(topic, error.unless_of_reading()?)),
            }
        }
        if fitting.is_empty() {
            for topic in partial {
                if let Err(error) = search.check_data_point(topic) {
                    misfits.push(TopicMisfit::new(topic, error.unless_of_reading()?));
                }
            }
            return Err(self.no_topic(profile, misfits).into());
        }
        any_or_first_misfit(fitting.into_iter().map(|topic| {
            let attitude = search.choose(Kind::Attitude, Some(topic))?;
            search.complete(attitude, topic)
        }))
    }

    /// Looks for what a profile names in one namespace.
    pub fn search<'s>(
        &'s self,
        profile: &'s Profile,
        specificity: Specificity,
        namespace: &'s str,
    ) -> NamespaceSearch<'s> {
        NamespaceSearch {
            log_search: self,
            profile,
            specificity,
            namespace,
        }
    }

    /// The name of a channel's type of message; empty if it has none.
    pub fn schema_name(&self, channel: &Channel) -> &str {
        let schema = self.log.contents.schema_of(channel);
        schema.map_or("", |schema| schema.name.as_str())
    }

    pub fn schema(&self, channel: &Channel) -> Result<MessageSchema<'_>, BindError> {
        let schema = self.log.contents.schema_of(channel);
        Ok(MessageSchema::of(
            channel,
            schema,
            self.examples,
            self.proof,
        )?)
    }

    /// The first topic of which the fields cannot be known.
    pub fn first_unreadable(&self) -> Result<Option<TopicMisfit>, ReadError> {
        for (topic, channels) in &self.topics {
            for channel in channels {
                if let Err(error) = self.schema(channel) {
                    return Ok(Some(TopicMisfit::new(topic, error.unless_of_reading()?)));
                }
            }
        }
        Ok(None)
    }

    /// The first messages of a channel, which a stream keeps whichever channels are wanted.
    pub fn first_messages(&self, channel: &Channel) -> Result<FirstMessages<'static>, ReadError> {
        let messages = self.examples.of(channel.id)?;
        Ok(FirstMessages::Given(messages.to_vec()))
    }

    /// Why a profile that names no topics does not fit, if something is missing on every topic.
    fn no_topic(&self, profile: &Profile, misfits: Vec<TopicMisfit>) -> Misfit {
        let fields = self.required_fields(profile);
        let (opaque, known): (Vec<_>, Vec<_>) =
            misfits.into_iter().partition(TopicMisfit::is_opaque);
        let nearest = known.into_iter().min_by_key(TopicMisfit::missing_fields);
        let nearest = nearest.filter(|misfit| misfit.missing_fields() < fields.len());
        let nearest = nearest.or_else(|| opaque.into_iter().next());
        let attitude = profile.alternatives(Kind::Attitude).first();
        let schemas = attitude.map_or(&[][..], |alternative| &alternative.location.schemas);
        match schemas {
            [] => Misfit::NoSuchFields { fields, nearest },
            schemas => Misfit::NoSuchType {
                schemas: schemas.iter().map(Foreign::from).collect(),
                nearest,
            },
        }
    }

    /// The fields that a message must have for a profile that names no topics.
    fn required_fields(&self, profile: &Profile) -> Vec<FieldPath> {
        let [attitude, velocity] = [Kind::Attitude, self.velocity_from.kind()]
            .map(|kind| profile.alternatives(kind).first());
        let velocity = velocity.filter(|_| profile.requires_velocity());
        let alternatives = attitude.into_iter().chain(velocity);
        let fields = alternatives.flat_map(|alternative| alternative.fields.fields());
        fields.cloned().collect()
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

/// A namespace without its slash, if the log's topics in it do not begin with one.
fn as_topics_begin<'a>(
    namespace: &'a str,
    topics: impl Iterator<Item = &'a str> + Clone,
) -> &'a str {
    let without = namespace.trim_start_matches('/');
    let has_topics = |namespace: &str| topics.clone().any(|topic| is_within(topic, namespace));
    let is_without = !without.is_empty() && !has_topics(namespace) && has_topics(without);
    if is_without { without } else { namespace }
}
