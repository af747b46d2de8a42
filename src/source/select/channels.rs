//! How to read the channels of a fit.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Channel;

use super::{Finder, Fit};
use crate::{
    log::ReadError,
    sample::Kind,
    source::{
        Origin,
        bind::{BindError, Binder, BoundRole, bind_role},
        channel::ChannelReader,
        error::{LogTopics, Misfit, TelemetryError, TopicMisfit},
        profile::Profile,
    },
};

impl Finder<'_> {
    /// How to read each channel of a fit's topics for some kinds of sample.
    pub fn channels_of(
        &self,
        profile: &Profile,
        fit: &Fit,
        wanted: &[Kind],
    ) -> Result<BTreeMap<u16, ChannelReader>, TelemetryError> {
        // In the order of kinds, in which the samples of one message belong.
        let roles: BTreeMap<Kind, &Origin> = (fit.roles().into_iter())
            .filter(|(kind, _)| wanted.contains(kind))
            .filter_map(|(kind, origin)| Some((kind, origin.ok()?)))
            .collect();
        let topics: BTreeSet<&str> = roles.values().map(|role| role.topic.as_str()).collect();
        let mut channels = BTreeMap::new();
        for channel in topics.iter().flat_map(|topic| &self.topics[topic]) {
            let kinds = (roles.iter())
                .filter(|(_, role)| role.topic == channel.topic)
                .map(|(&kind, _)| kind);
            let reader = match self.reader(profile, fit, channel, kinds) {
                Ok(reader) => reader,
                Err(error) => return Err(self.does_not_fit(profile, channel, error)?),
            };
            channels.insert(channel.id, reader);
        }
        Ok(channels)
    }

    fn reader(
        &self,
        profile: &Profile,
        fit: &Fit,
        channel: &Channel,
        kinds: impl Iterator<Item = Kind>,
    ) -> Result<ChannelReader, BindError> {
        let schema = self.schema(channel)?;
        let mut binder = Binder::new(&schema);
        let roles: Vec<BoundRole> = kinds
            .map(|kind| {
                let own = fit.attitude.topic.as_str();
                let alternatives =
                    self.at_topic(profile, kind, &fit.namespace, &channel.topic, own);
                let alternatives = self.for_channel(channel, &alternatives)?;
                bind_role(&mut binder, profile, kind, &alternatives)
            })
            .collect::<Result<_, _>>()?;
        ChannelReader::new(&schema, &binder.wanted, roles)
    }

    fn does_not_fit(
        &self,
        profile: &Profile,
        channel: &Channel,
        error: BindError,
    ) -> Result<TelemetryError, ReadError> {
        let misfit = TopicMisfit::new(&channel.topic, error.unless_of_reading()?);
        Ok(TelemetryError::ProfileDoesNotFit {
            path: self.log.file.path().into(),
            profile: profile.name.clone(),
            misfit: Misfit::Messages(misfit).into(),
            topics: LogTopics::of(self.log),
        })
    }
}
