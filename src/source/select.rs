//! Selecting the telemetry of a log: which profile, which vehicle, and which of the log's channels.

mod conditions;
mod fit;
mod instead;
mod log_search;
mod namespace_search;

use std::{cmp::Reverse, collections::BTreeSet};

use super::{
    RunnerUp, Source,
    error::{TelemetryError, Unfit},
    profile::Profile,
    request::Request,
};
use crate::{
    decode::{FirstMessages, Proof},
    log::Log,
    sample::Kind,
    text::Foreign,
};
pub use fit::Fit;
use fit::{Specificity, specificity};
use log_search::LogSearch;
use namespace_search::NamespaceSearch;

/// The kinds of sample that something is derived from. A position is only shown.
const DERIVED_FROM: [Kind; 3] = [Kind::Gimbal, Kind::Attitude, Kind::Velocity];

/// How well a profile fits, the best last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    /// Named topics are the vehicle's own estimate; messages that just have the right fields may be anything's.
    specificity: Specificity,
    has_velocity: bool,
}

/// A profile, and a place in the log that it fits.
struct Candidate<'p> {
    profile: &'p Profile,
    fit: Fit,
}

impl Candidate<'_> {
    fn rank(&self) -> Rank {
        Rank {
            specificity: specificity(self.profile),
            has_velocity: self.fit.role(Kind::Velocity).is_ok(),
        }
    }

    /// Whether this is a vehicle, and not just a topic with the right fields.
    fn is_vehicle(&self) -> bool {
        specificity(self.profile) == Specificity::Topic
    }
}

/// Which profiles are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Thoroughness {
    /// Tries profiles until none that is left could fit better.
    UntilFound,
    All,
}

impl Source {
    /// Finds the telemetry of a log.
    ///
    /// # Errors
    /// The profile does not fit the log, or none does, or several fit equally well.
    pub fn select(log: &Log, request: &Request) -> Result<Self, TelemetryError> {
        Self::find(log, request, Thoroughness::UntilFound)
    }

    /// Like [`select`](Self::select), but tries every profile, so that all runners-up are known.
    ///
    /// # Errors
    /// Those of [`select`](Self::select).
    pub fn compare(log: &Log, request: &Request) -> Result<Self, TelemetryError> {
        Self::find(log, request, Thoroughness::All)
    }

    /// Where schemas leave open which fields JSON messages have, what the messages show goes before what the schemas
    /// list, unless less would be found: a field that is 0 at first may be left out.
    fn find(
        log: &Log,
        request: &Request,
        thoroughness: Thoroughness,
    ) -> Result<Self, TelemetryError> {
        let examples = FirstMessages::new(log);
        let log_search = |proof| LogSearch::new(log, &examples, request, proof);
        let listed = Self::find_by(&log_search(Proof::Listed), request, thoroughness);
        let is_settled = match &listed {
            Ok(source) => source.is_confirmed_by(&log_search(Proof::Shown)),
            Err(error) => !error.is_ambiguity(),
        };
        if is_settled {
            return listed;
        }
        let shown = Self::find_by(&log_search(Proof::Shown), request, thoroughness);
        let is_better = match (&listed, &shown) {
            (Ok(listed), Ok(shown)) => shown.has_all_of(listed),
            (Err(_), Ok(_)) => true,
            (Err(_), Err(error)) => error.is_ambiguity(),
            (Ok(_), Err(_)) => false,
        };
        if is_better { shown } else { listed }
    }

    /// Whether a search that asks for more proof finds the same fields.
    fn is_confirmed_by(&self, log_search: &LogSearch) -> bool {
        let definitions = &log_search.log.contents.definitions;
        let mut channels = self.channels.keys().map(|id| &definitions.channels[id]);
        let search = log_search.search(&self.profile, &self.fit.namespace);
        !channels.any(|channel| FirstMessages::tell_the_fields_of(&channel.record))
            || search.confirms(&self.fit, &DERIVED_FROM)
    }

    /// Whether it has every kind of sample that another one has and that something is derived from.
    fn has_all_of(&self, other: &Self) -> bool {
        let has_as_much = |&kind: &Kind| self.role(kind).is_some() || other.role(kind).is_none();
        DERIVED_FROM.iter().all(has_as_much)
    }

    fn find_by(
        log_search: &LogSearch,
        request: &Request,
        thoroughness: Thoroughness,
    ) -> Result<Self, TelemetryError> {
        let log = log_search.log;
        log_search.check_request()?;
        let mut profiles = request.profiles();
        // The most specific come first. The sort is stable, so equals keep their order.
        profiles.sort_by_key(|profile| Reverse(specificity(profile)));
        let (candidates, misfits) = try_profiles(log_search, &profiles, thoroughness)?;
        let Some((best, rest)) = choose(candidates) else {
            return Err(none_fits(log_search, &profiles, misfits));
        };
        let [Candidate { profile, fit }] = best.as_slice() else {
            return Err(ambiguity(log, &best));
        };
        if request.own_profile().is_some() {
            let search = log_search.search(profile, &fit.namespace);
            search.check_conditions(fit)?;
        }
        let runners_up = rest.into_iter().map(|candidate| RunnerUp {
            profile: (&candidate.profile.name).into(),
            attitude: Ok(candidate.fit.attitude),
        });
        Ok(Self {
            channels: log_search
                .search(profile, &fit.namespace)
                .channels(fit, &Kind::ALL.into())?,
            runners_up: runners_up.chain(misfits).collect(),
            profile: (*profile).clone(),
            fit: fit.clone(),
            proof: log_search.proof,
        })
    }

    /// Restricts reading to these kinds of sample, so that other data in their messages cannot cause trouble.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn keep(
        self,
        log: &Log,
        request: &Request,
        kinds: &BTreeSet<Kind>,
    ) -> Result<Self, TelemetryError> {
        let examples = FirstMessages::new(log);
        let log_search = LogSearch::new(log, &examples, request, self.proof);
        Ok(Self {
            channels: (log_search.search(&self.profile, &self.fit.namespace))
                .channels(&self.fit, kinds)?,
            ..self
        })
    }
}

/// Finds where the profiles fit, and which do not.
fn try_profiles<'p>(
    log_search: &LogSearch,
    profiles: &'p [Profile],
    thoroughness: Thoroughness,
) -> Result<(Vec<Candidate<'p>>, Vec<RunnerUp>), TelemetryError> {
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut misfits = Vec::new();
    for profile in profiles {
        let could_be_best = Rank {
            has_velocity: true,
            specificity: specificity(profile),
        };
        let best = candidates.iter().map(Candidate::rank).max();
        if thoroughness == Thoroughness::UntilFound && best > Some(could_be_best) {
            break;
        }
        match log_search.fit(profile) {
            Ok(fits) => candidates.extend(fits.into_iter().map(|fit| Candidate { profile, fit })),
            Err(Unfit::Misfit(misfit)) => misfits.push(RunnerUp {
                profile: (&profile.name).into(),
                attitude: Err(misfit),
            }),
            Err(Unfit::Hopeless(error)) => return Err(error),
        }
    }
    Ok((candidates, misfits))
}

/// Separates the best candidates from the others, the better ones of those first.
fn choose(candidates: Vec<Candidate>) -> Option<(Vec<Candidate>, Vec<Candidate>)> {
    let best = candidates.iter().map(Candidate::rank).max()?;
    // If there are several vehicles, that more is known about one does not mean that it is the right one.
    let vehicles = candidates.iter().filter(|candidate| candidate.is_vehicle());
    let vehicles: BTreeSet<&str> = vehicles.map(|one| one.fit.namespace.as_str()).collect();
    let of_several = vehicles.len() > 1;
    let is_best =
        |candidate: &Candidate| candidate.rank() == best || of_several && candidate.is_vehicle();
    let (best, mut rest): (Vec<_>, Vec<_>) = candidates.into_iter().partition(is_best);
    rest.sort_by_key(|candidate| Reverse(candidate.rank()));
    Some((best, rest))
}

fn none_fits(
    log_search: &LogSearch,
    profiles: &[Profile],
    misfits: Vec<RunnerUp>,
) -> TelemetryError {
    let path = log_search.log.file.path().to_owned();
    let misfits = misfits.into_iter();
    let tried: Vec<_> = misfits
        .filter_map(|misfit| Some((misfit.profile, misfit.attitude.err()?)))
        .collect();
    match (profiles, <[_; 1]>::try_from(tried)) {
        ([only], Ok([(profile, misfit)])) => TelemetryError::ProfileDoesNotFit {
            path,
            profile,
            instead: log_search.instead_of_profile(only, &misfit).into(),
            misfit: misfit.into(),
        },
        (_, tried) => TelemetryError::NotFound {
            path,
            tried: tried.map_or_else(|tried| tried, Vec::from),
            instead: log_search.instead_of_any().into(),
        },
    }
}

/// Why one of several candidates that are equally good cannot be chosen.
fn ambiguity(log: &Log, candidates: &[Candidate]) -> TelemetryError {
    let path = log.file.path().to_owned();
    let of_each = |text: fn(&Candidate) -> Foreign| candidates.iter().map(text);
    let profile = |candidate: &Candidate| Foreign::from(&candidate.profile.name);
    let topic = |candidate: &Candidate| candidate.fit.attitude.topic.clone();
    let namespace = |candidate: &Candidate| Foreign::from(&candidate.fit.namespace);
    let namespaces: BTreeSet<Foreign> = of_each(namespace).collect();
    let profiles: BTreeSet<Foreign> = of_each(profile).collect();
    if namespaces.len() > 1 {
        TelemetryError::SeveralVehicles { path, namespaces }
    } else if profiles.len() > 1 {
        let fits = of_each(profile).zip(of_each(topic)).collect();
        TelemetryError::SeveralProfilesFit { path, fits }
    } else {
        let topics = of_each(topic).collect();
        TelemetryError::SeveralTopicsFit { path, topics }
    }
}
