//! Looking for what one profile names in one namespace of a log: on which topics its roles are, and how to read the
//! topics' channels.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Channel;

use super::{Fit, LogSearch, choice::Chosen, fit::Specificity, places::Schemas};
use crate::{
    log::ReadError,
    sample::Kind,
    source::{
        Origin,
        bind::{BindError, Binder, BoundRole, ChannelName, SaidBy, bind_role, for_type},
        channel::ChannelReader,
        error::{Misfit, TelemetryError, TopicMisfit, Unfit},
        pattern::Pattern,
        profile::{Alternative, Profile},
        request::RoleArgument,
    },
    text::Foreign,
};

/// One profile in one namespace of a log.
#[derive(Clone, Copy)]
pub struct NamespaceSearch<'a> {
    pub log_search: &'a LogSearch<'a>,
    pub profile: &'a Profile,
    /// How the profile recognises its logs.
    pub specificity: Specificity,
    pub namespace: &'a str,
}

impl<'a> NamespaceSearch<'a> {
    /// Finds the attitude on the topics that the profile names.
    pub fn attitude(&self) -> Result<Chosen, Unfit> {
        let attitude = self.choose(Kind::Attitude, None);
        attitude.map_err(|unfit| self.as_requested(Kind::Attitude, unfit))
    }

    /// Checks that any one topic has the attitude, and also what the velocity is taken from if that is required and not
    /// requested from elsewhere.
    pub fn check_data_point(&self, topic: &str) -> Result<(), BindError> {
        let mut schemas = Schemas::new();
        let mut bind = |kind| {
            let alternatives = self.at_topic(kind, topic, topic, 0);
            self.bind(&mut schemas, kind, topic, &alternatives)
        };
        let attitude = bind(Kind::Attitude);
        let velocity = self.log_search.velocity_from.kind();
        if self.is_requested(velocity) || !self.requires(velocity) {
            return attitude.map(drop);
        }
        match (attitude, bind(velocity)) {
            (Ok(_), velocity) => velocity.map(drop),
            (Err(error), velocity) => Err(error.and(velocity.err())),
        }
    }

    /// Adds to an attitude whatever else the profile finds; roles without topics of their own on the topic `own`.
    pub fn complete(&self, attitude: Chosen, own: &str) -> Result<Fit, Unfit> {
        let mut others = BTreeMap::new();
        for kind in Kind::ALL.into_iter().filter(|&kind| kind != Kind::Attitude) {
            let chosen = match self.log_search.looks_for(kind) {
                true => self.choose(kind, Some(own)),
                false => Err(self.why_nowhere(kind, None).into()),
            };
            let chosen = match chosen {
                Ok(chosen) => Ok(chosen),
                Err(Unfit::Misfit(misfit)) if !self.needs(kind, &misfit) => Err(misfit),
                Err(unfit) => return Err(self.as_requested(kind, unfit)),
            };
            others.insert(kind, chosen);
        }
        Ok(Fit {
            namespace: self.namespace.to_owned(),
            attitude,
            own: own.into(),
            others,
        })
    }

    /// Whether the profile does not fit if a role is missing for this reason.
    fn needs(&self, kind: Kind, misfit: &Misfit) -> bool {
        // There are messages where the profile expects the velocity, but they are not what it expects.
        let is_fault = matches!(misfit, Misfit::Messages(misfit) if !misfit.is_of_frames());
        let is_for_velocity = kind == self.log_search.velocity_from.kind();
        self.requires(kind) || is_for_velocity && is_fault
    }

    /// Whether the profile does not fit a log without samples of a kind.
    fn requires(&self, kind: Kind) -> bool {
        let is_for_velocity = kind == self.log_search.velocity_from.kind();
        self.is_requested(kind) || is_for_velocity && self.profile.requires_velocity()
    }

    fn is_requested(&self, kind: Kind) -> bool {
        self.log_search.requested.contains_key(&kind)
    }

    /// Ends the search if a fully specified role is missing: no other profile would find it.
    fn as_requested(&self, kind: Kind, unfit: Unfit) -> Unfit {
        match (unfit, self.log_search.requested.get(&kind)) {
            (Unfit::Misfit(misfit), Some(RoleArgument::Fields(_))) => {
                self.log_search.role_does_not_fit(kind, misfit).into()
            }
            (unfit, _) => unfit,
        }
    }

    /// The pattern of a topic: the profile's in the namespace, or the user's as it is, since that names the topic as
    /// the log does.
    pub fn pattern(&self, kind: Kind, topic: &str) -> Pattern {
        match self.is_requested(kind) {
            true => Pattern::new("", topic),
            false => Pattern::new(self.namespace, topic),
        }
    }

    /// Why a role is on none of the log's topics.
    pub fn why_nowhere(&self, kind: Kind, own: Option<&str>) -> Misfit {
        let alternatives = self.profile.alternatives(kind);
        let mut topics: Vec<Foreign> = Vec::new();
        for topic in alternatives.iter().flat_map(|one| &one.location.topics) {
            let topic = self.pattern(kind, topic).as_written();
            if !topics.contains(&topic) {
                topics.push(topic);
            }
        }
        match own {
            _ if !topics.is_empty() => Misfit::NoMessages { topics },
            Some(own) if !alternatives.is_empty() => Misfit::NotWithAttitude { topic: own.into() },
            _ if self.is_requested(kind) => Misfit::OnlyATopic { role: kind },
            _ => Misfit::NotInProfile {
                profile: (&self.profile.name).into(),
                role: kind,
            },
        }
    }

    /// The alternatives of a role that are meant for a topic, from the one with the number `first` on; `own` is the one
    /// that roles without topics are read from.
    fn at_topic(&self, kind: Kind, topic: &str, own: &str, first: usize) -> Vec<&Alternative> {
        let alternatives = self.profile.alternatives(kind).iter();
        alternatives
            .skip(first)
            .filter(|alternative| self.is_at(kind, alternative, topic, own))
            .collect()
    }

    /// Whether an alternative is meant for a topic; `own` is the one that roles without topics are read from.
    pub fn is_at(&self, kind: Kind, alternative: &Alternative, topic: &str, own: &str) -> bool {
        let is_match = |text: &String| self.pattern(kind, text).is_match(topic);
        match alternative.location.topics.as_slice() {
            [] => own == topic,
            topics => topics.iter().any(is_match),
        }
    }

    /// Resolves the fields of some alternatives against every channel of a topic.
    pub fn bind(
        &self,
        schemas: &mut Schemas<'a>,
        kind: Kind,
        topic: &str,
        alternatives: &[&Alternative],
    ) -> Result<Origin, BindError> {
        let (mut fields, mut select) = (Vec::new(), Vec::new());
        for channel in &self.log_search.topics[topic] {
            let alternatives = self.for_channel(channel, alternatives)?;
            let schema = self.schema_of(channel, schemas)?;
            let mut binder = Binder::new(schema, self.name_of(channel));
            let role = bind_role(
                &mut binder,
                self.profile,
                self.said_by(kind),
                kind,
                &alternatives,
            )?;
            (fields, select) = (role.fields, role.select);
        }
        Ok(Origin {
            topic: topic.into(),
            select,
            fields,
        })
    }

    /// Who says how a role is read.
    fn said_by(&self, kind: Kind) -> SaidBy {
        match self.log_search.requested.get(&kind) {
            Some(RoleArgument::Fields(_)) => SaidBy::User,
            _ if self.specificity == Specificity::Topic => SaidBy::RecorderProfile,
            _ => SaidBy::TypeProfile,
        }
    }

    pub fn name_of<'c>(&'c self, channel: &'c Channel) -> ChannelName<'c> {
        ChannelName {
            topic: &channel.topic,
            schema: self.log_search.schema_name(channel),
        }
    }

    /// Those alternatives that are meant for a channel's type of message.
    fn for_channel<'p>(
        &self,
        channel: &Channel,
        alternatives: &[&'p Alternative],
    ) -> Result<Vec<&'p Alternative>, BindError> {
        for_type(
            self.log_search.schema_name(channel),
            alternatives.iter().copied(),
        )
    }

    /// Whether this search, which may ask for more proof than the one that found a fit, finds the same fields for some
    /// kinds of sample.
    pub fn confirms(&self, fit: &Fit, kinds: &[Kind]) -> bool {
        let is_same = |(kind, origin): (Kind, &Origin)| {
            let alternatives = self.at_topic(kind, &origin.topic, &fit.own, fit.first(kind));
            let bound = self.bind(&mut Schemas::new(), kind, &origin.topic, &alternatives);
            bound.is_ok_and(|bound| bound == *origin)
        };
        (kinds.iter())
            .filter_map(|&kind| Some((kind, fit.role(kind).ok()?)))
            .all(is_same)
    }

    /// How to read each channel of a fit's topics for some kinds of sample.
    pub fn channels(
        &self,
        fit: &Fit,
        wanted: &BTreeSet<Kind>,
    ) -> Result<BTreeMap<u16, ChannelReader>, TelemetryError> {
        // In the order of kinds, which is that of the samples of one message.
        let roles: BTreeMap<Kind, &Origin> = (fit.roles().into_iter())
            .filter(|(kind, _)| wanted.contains(kind))
            .filter_map(|(kind, origin)| Some((kind, origin.ok()?)))
            .collect();
        let topics: BTreeSet<&str> = roles.values().map(|role| role.topic.as_str()).collect();
        let mut channels = BTreeMap::new();
        for channel in topics
            .iter()
            .flat_map(|topic| &self.log_search.topics[topic])
        {
            let roles = (roles.iter())
                .filter(|(_, role)| role.topic == channel.topic)
                .map(|(&kind, _)| (kind, fit.first(kind)));
            let reader = self.reader(channel, roles, &fit.own)?;
            channels.insert(channel.id, reader);
        }
        Ok(channels)
    }

    /// Makes a reader of a channel for some kinds of sample, each with the number of the first alternative that reads it;
    /// `own` is the topic that roles without topics are read from.
    pub fn reader(
        &self,
        channel: &Channel,
        roles: impl Iterator<Item = (Kind, usize)>,
        own: &str,
    ) -> Result<ChannelReader, TelemetryError> {
        match self.bound_reader(channel, roles, own) {
            Ok(reader) => Ok(reader),
            Err(error) => Err(self.does_not_fit(channel, error)?),
        }
    }

    fn bound_reader(
        &self,
        channel: &Channel,
        roles: impl Iterator<Item = (Kind, usize)>,
        own: &str,
    ) -> Result<ChannelReader, BindError> {
        let schema = self.log_search.schema(channel)?;
        let mut binder = Binder::new(&schema, self.name_of(channel));
        let bind = |(kind, first)| {
            let alternatives = self.at_topic(kind, &channel.topic, own, first);
            let alternatives = self.for_channel(channel, &alternatives)?;
            let said_by = self.said_by(kind);
            bind_role(&mut binder, self.profile, said_by, kind, &alternatives)
        };
        let roles: Vec<BoundRole> = roles.map(bind).collect::<Result<_, _>>()?;
        ChannelReader::new(&schema, &binder.wanted, roles)
    }

    fn does_not_fit(
        &self,
        channel: &Channel,
        error: BindError,
    ) -> Result<TelemetryError, ReadError> {
        let misfit = TopicMisfit::new(&channel.topic, error.unless_of_reading()?);
        let misfit = Misfit::Messages(misfit);
        Ok(TelemetryError::ProfileDoesNotFit {
            path: self.log_search.log.file.path().into(),
            profile: (&self.profile.name).into(),
            instead: (self.log_search)
                .instead_of_profile(self.profile, &misfit)
                .into(),
            misfit: misfit.into(),
        })
    }
}
