//! Selecting the telemetry of a log: which profile, which vehicle, and which of the log's channels.

mod between_profiles;
mod choice;
mod conditions;
mod fit;
mod instead;
mod log_search;
mod look;
mod namespace_search;
mod places;
mod primary;
mod prospects;

use std::{cmp::Reverse, collections::BTreeSet};

use super::{
    Origin, RunnerUp, Source,
    error::{Misfit, TelemetryError, Unfit},
    profile::{Profile, ProfileChoice},
    request::{Adapted, Request},
};
use crate::{
    decode::{FirstMessages, Proof},
    log::{Log, ReadError},
    sample::{Kind, VelocityFrom},
    text::Foreign,
};
use choice::Chosen;
pub use choice::{PassedOver, SeenPlace};
pub use fit::Fit;
pub use fit::Specificity;
use fit::specificity;
use log_search::LogSearch;
use look::Look;
use namespace_search::NamespaceSearch;

/// The kinds of sample that something is derived from.
fn derived_from(velocity_from: VelocityFrom) -> [Kind; 3] {
    [Kind::Gimbal, Kind::Attitude, velocity_from.kind()]
}

/// How well a profile fits, the best last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    /// What it adds to the attitude, if the user gives that.
    adds: Option<Adds>,
    /// Named topics are the vehicle's own estimate; messages that just have the right fields may be anything's.
    specificity: Specificity,
    has_velocity: bool,
    /// The user's own profiles are made for their logs.
    is_own: bool,
}

/// The most useful kind of sample that a profile adds to a given attitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Adds {
    Position,
    Gimbal,
    Velocity,
}

/// A profile, and a place in the log that it fits.
struct Candidate<'p> {
    adapted: &'p Adapted,
    fit: Fit,
    /// What it adds to the attitude, if the user gives that.
    adds: Option<Adds>,
    /// Whether it has what the velocity is taken from.
    has_velocity: bool,
    /// What the messages of its attitude show. They are only counted until there is a reason to look at them.
    attitude: Look,
}

impl<'p> Candidate<'p> {
    fn new(log_search: &LogSearch, adapted: &'p Adapted, fit: Fit) -> Self {
        let left = log_search.left_to_profiles();
        let adds = |kind: Kind| left.contains(&kind) && fit.role(kind).is_ok();
        let kinds = [
            (log_search.velocity_from.kind(), Adds::Velocity),
            (Kind::Gimbal, Adds::Gimbal),
            (Kind::Position, Adds::Position),
        ];
        let most = kinds.into_iter().find(|(kind, _)| adds(*kind));
        Self {
            adapted,
            adds: most
                .filter(|_| adapted.own_attitude.is_some())
                .map(|(_, adds)| adds),
            has_velocity: fit.role(log_search.velocity_from.kind()).is_ok(),
            attitude: Look {
                messages: log_search.messages_on(&fit.attitude.origin.topic),
                ..Look::default()
            },
            fit,
        }
    }

    fn into_runner_up(self) -> RunnerUp {
        let others = self.fit.others.into_iter();
        RunnerUp {
            profile: (&self.adapted.profile.name).into(),
            attitude: Ok(self.fit.attitude.origin),
            others: others
                .filter_map(|(kind, found)| Some((kind, found.ok()?.origin.topic)))
                .collect(),
        }
    }

    fn rank(&self) -> Rank {
        Rank {
            adds: self.adds,
            specificity: specificity(self.adapted.attitude()),
            has_velocity: self.has_velocity,
            is_own: self.adapted.is_own,
        }
    }

    /// Whether this is a vehicle, and not just a topic with the right fields.
    fn is_vehicle(&self) -> bool {
        specificity(self.adapted.attitude()) == Specificity::Topic
    }

    /// Where it finds what it was chosen by: the attitude or, if the user gives that, what it adds.
    fn chosen_by(&self, log_search: &LogSearch) -> &Origin {
        let kinds = log_search.left_to_profiles();
        (self.fit.first_of(&kinds)).unwrap_or(&self.fit.attitude.origin)
    }
}

/// What is tried, and looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Thoroughness {
    /// Tries profiles until none that is left could fit better, and looks at what something is derived from, or shown of.
    UntilFound,
    /// Tries all profiles, and looks at all kinds of sample.
    All,
}

impl Source {
    /// Finds the telemetry of a log.
    ///
    /// # Errors
    /// The profile does not fit the log, or none does, or several fit equally well.
    pub fn select(log: &Log, request: &Request) -> Result<Self, TelemetryError> {
        Self::select_to_show(log, request, &[])
    }

    /// Like [`select`](Self::select), but also finds the kinds of sample that viewers are shown. Which of several places
    /// each of them is read from depends on what the messages hold.
    ///
    /// # Errors
    /// Those of [`select`](Self::select).
    pub fn select_to_show(
        log: &Log,
        request: &Request,
        shown: &'static [Kind],
    ) -> Result<Self, TelemetryError> {
        Self::find(log, request, Thoroughness::UntilFound, &Kind::USUAL, shown)
    }

    /// Like [`select`](Self::select), but also finds what only a check reads.
    ///
    /// # Errors
    /// Those of [`select`](Self::select).
    pub fn select_for_check(log: &Log, request: &Request) -> Result<Self, TelemetryError> {
        Self::find(log, request, Thoroughness::UntilFound, &Kind::CHECKED, &[])
    }

    /// Like [`select`](Self::select), but tries every profile, so that all runners-up are known.
    ///
    /// # Errors
    /// Those of [`select`](Self::select).
    pub fn compare(log: &Log, request: &Request) -> Result<Self, TelemetryError> {
        Self::find(log, request, Thoroughness::All, &Kind::USUAL, &[])
    }

    /// Where schemas leave open which fields JSON messages have, what the messages show goes before what the schemas
    /// list, unless less would be found: a field that is 0 at first may be left out.
    fn find(
        log: &Log,
        request: &Request,
        thoroughness: Thoroughness,
        kinds: &'static [Kind],
        shown: &'static [Kind],
    ) -> Result<Self, TelemetryError> {
        let examples = FirstMessages::new(log);
        let log_search = |proof| {
            LogSearch::new(log, &examples, request, proof, thoroughness, kinds).showing(shown)
        };
        let listed = Self::find_by(&log_search(Proof::Listed), request);
        let is_settled = match &listed {
            Ok(source) => source.is_confirmed_by(&log_search(Proof::Shown)),
            Err(error) => !error.is_ambiguity(),
        };
        if is_settled {
            return listed;
        }
        let shown = Self::find_by(&log_search(Proof::Shown), request);
        let is_better = match (&listed, &shown) {
            (Ok(listed), Ok(shown)) => shown.has_all_of(listed, request.velocity_from),
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
        let search = log_search.search(&self.profile, self.specificity, &self.fit.namespace);
        !channels.any(|channel| FirstMessages::tell_the_fields_of(&channel.record))
            || search.confirms(&self.fit, &derived_from(log_search.velocity_from))
    }

    /// Whether it has every kind of sample that another one has and that something is derived from.
    fn has_all_of(&self, other: &Self, velocity_from: VelocityFrom) -> bool {
        let has_as_much = |&kind: &Kind| self.role(kind).is_some() || other.role(kind).is_none();
        derived_from(velocity_from).iter().all(has_as_much)
    }

    fn find_by(log_search: &LogSearch, request: &Request) -> Result<Self, TelemetryError> {
        log_search.check_request()?;
        let mut profiles = request.profiles();
        for adapted in &mut profiles {
            log_search.settle_primaries(&mut adapted.profile)?;
        }
        // The most specific come first. The sort is stable, so equals keep their order.
        profiles.sort_by_key(|adapted| Reverse(specificity(adapted.attitude())));
        let is_asked_for = matches!(request.profile, ProfileChoice::Given(_));
        let is_last = |adapted: &mut Adapted| adapted.profile.fallback && !is_asked_for;
        let fallbacks: Vec<Adapted> = profiles.extract_if(.., is_last).collect();
        let (mut candidates, mut misfits) = try_profiles(log_search, &profiles)?;
        let only_given = request.without_profile();
        // Those who say where the drone's attitude or its topics are do not mean just any pose.
        let may_assume = only_given.is_none() && request.namespace.is_none();
        if candidates.is_empty() && may_assume {
            let (last, more) = try_profiles(log_search, &fallbacks)?;
            candidates = last;
            misfits.extend(more);
        }
        if only_given.is_some() {
            candidates.retain(|candidate| candidate.adds.is_some());
        }
        let strays = between_profiles::take_strays(log_search, &mut candidates)?;
        let (best, mut rest) = match (choose(candidates), &only_given) {
            // Nothing is derived from positions, so it does not matter which are shown.
            (Some((best, rest)), Some(_))
                if best.len() > 1 && best[0].adds == Some(Adds::Position) =>
            {
                (Vec::new(), best.into_iter().chain(rest).collect())
            }
            (Some(chosen), _) => chosen,
            (None, _) => (Vec::new(), Vec::new()),
        };
        let (best, passed_over) = between_profiles::settle(log_search, best, &mut rest)?;
        let best = match &only_given {
            Some(adapted) if best.is_empty() => vec![without_profile(log_search, adapted)?],
            _ => best,
        };
        let [Candidate { adapted, fit, .. }] = best.as_slice() else {
            return Err(match best.is_empty() {
                true => none_fits(log_search, &profiles, misfits)?,
                false => ambiguity(log_search, &best),
            });
        };
        let Adapted { profile, .. } = adapted;
        let specificity = specificity(adapted.attitude());
        let search = log_search.search(profile, specificity, &fit.namespace);
        if adapted.is_own {
            search.check_conditions(fit)?;
        }
        let strays_passed_over = between_profiles::strays_passed_over(&strays, &best[0]);
        let others = rest.into_iter().chain(strays);
        let runners_up = others.map(|candidate| candidate.into_runner_up());
        Ok(Self {
            channels: search.channels(fit, &Kind::ALL.into())?,
            runners_up: runners_up.chain(misfits).collect(),
            profile: profile.clone(),
            specificity,
            passed_over: (fit.passed_over().cloned())
                .chain(passed_over)
                .chain(strays_passed_over)
                .collect(),
            chosen_by: best[0].chosen_by(log_search).clone(),
            fit: fit.clone(),
            proof: log_search.proof,
        })
    }

    /// The topic of the positions that the velocity could be taken from, if there are enough that are usable.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn usable_positions(
        &self,
        log: &Log,
        request: &Request,
    ) -> Result<Option<Foreign>, TelemetryError> {
        let examples = FirstMessages::new(log);
        let log_search = LogSearch::new(
            log,
            &examples,
            request,
            self.proof,
            Thoroughness::All,
            &Kind::USUAL,
        );
        let search = log_search.search(&self.profile, self.specificity, &self.fit.namespace);
        let own = self.fit.own.as_str();
        let Chosen { origin, first, .. } = match search.choose(Kind::Position, Some(own)) {
            Ok(chosen) => chosen,
            Err(Unfit::Misfit(_)) => return Ok(None),
            Err(Unfit::Hopeless(error)) => return Err(error),
        };
        let look = search.look_at(Kind::Position, &origin.topic, first, own)?;
        let are_enough = look.tally.used >= VelocityFrom::Position.needed();
        Ok(are_enough.then_some(origin.topic))
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
        let thoroughness = Thoroughness::UntilFound;
        let log_search = LogSearch::new(
            log,
            &examples,
            request,
            self.proof,
            thoroughness,
            &Kind::ALL,
        );
        let passed_over = self.passed_over.into_iter();
        Ok(Self {
            passed_over: (passed_over.filter(|one| kinds.contains(&one.role))).collect(),
            channels: log_search
                .search(&self.profile, self.specificity, &self.fit.namespace)
                .channels(&self.fit, kinds)?,
            ..self
        })
    }
}

/// Finds where the profiles fit, and which do not.
fn try_profiles<'p>(
    log_search: &LogSearch,
    profiles: &'p [Adapted],
) -> Result<(Vec<Candidate<'p>>, Vec<RunnerUp>), TelemetryError> {
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut misfits = Vec::new();
    for adapted in profiles {
        let could_be_best = Rank {
            adds: (adapted.own_attitude.is_some()).then_some(Adds::Velocity),
            specificity: specificity(adapted.attitude()),
            has_velocity: true,
            is_own: adapted.is_own,
        };
        // One that may be a stray does not end the search.
        let series = candidates.iter().filter(|one| one.is_series());
        let best = series.map(Candidate::rank).max();
        if log_search.thoroughness == Thoroughness::UntilFound && best > Some(could_be_best) {
            break;
        }
        match log_search.fit(adapted) {
            Ok(fits) => {
                let fits = fits.into_iter();
                candidates.extend(fits.map(|fit| Candidate::new(log_search, adapted, fit)));
            }
            Err(Unfit::Misfit(misfit)) => misfits.push(RunnerUp {
                profile: (&adapted.profile.name).into(),
                attitude: Err(match profiles.len() {
                    1 => misfit,
                    _ => misfit.unless_strange(&adapted.profile),
                }),
                others: log_search.topics_named_by(&adapted.profile),
            }),
            Err(Unfit::Hopeless(error)) => return Err(error),
        }
    }
    Ok((candidates, misfits))
}

/// Where what was given fits without a profile.
fn without_profile<'p>(
    log_search: &LogSearch,
    adapted: &'p Adapted,
) -> Result<Candidate<'p>, TelemetryError> {
    match log_search.fit_given(&adapted.profile) {
        Ok(fit) => Ok(Candidate::new(log_search, adapted, fit)),
        Err(Unfit::Hopeless(error)) => Err(error),
        Err(Unfit::Misfit(misfit)) => Err(does_not_fit(log_search, &adapted.profile, misfit)),
    }
}

/// Separates the best candidates from the others, the better ones of those first.
fn choose(candidates: Vec<Candidate>) -> Option<(Vec<Candidate>, Vec<Candidate>)> {
    let best = candidates.iter().map(Candidate::rank).max()?;
    // If there are several vehicles, that more is known about one does not mean that it is the right one.
    let of_several = between_profiles::vehicles(&candidates).len() > 1;
    let is_best =
        |candidate: &Candidate| candidate.rank() == best || of_several && candidate.is_vehicle();
    let (best, mut rest): (Vec<_>, Vec<_>) = candidates.into_iter().partition(is_best);
    rest.sort_by_key(|candidate| Reverse(candidate.rank()));
    Some((best, rest))
}

fn none_fits(
    log_search: &LogSearch,
    profiles: &[Adapted],
    mut misfits: Vec<RunnerUp>,
) -> Result<TelemetryError, ReadError> {
    if !misfits.iter().any(RunnerUp::is_near)
        && let Some(unreadable) = log_search.first_unreadable()?
        && let Some(nearest) = misfits.iter_mut().rev().find_map(RunnerUp::nearest_mut)
    {
        *nearest = Some(unreadable);
    }
    if let [only] = profiles
        && let [one] = &misfits[..]
        && let Err(misfit) = &one.attitude
    {
        return Ok(does_not_fit(log_search, &only.profile, misfit.clone()));
    }
    Ok(TelemetryError::NotFound {
        path: log_search.log.file.path().into(),
        tried: misfits,
        instead: log_search.instead_of_any().into(),
    })
}

fn does_not_fit(log_search: &LogSearch, profile: &Profile, misfit: Misfit) -> TelemetryError {
    TelemetryError::ProfileDoesNotFit {
        path: log_search.log.file.path().into(),
        profile: (&profile.name).into(),
        instead: log_search.instead_of_profile(profile, &misfit).into(),
        misfit: misfit.into(),
    }
}

/// Why one of several candidates that are equally good cannot be chosen.
fn ambiguity(log_search: &LogSearch, candidates: &[Candidate]) -> TelemetryError {
    let path = log_search.log.file.path().to_owned();
    let topics: Vec<Foreign> = (candidates.iter())
        .map(|candidate| candidate.chosen_by(log_search).topic.clone())
        .collect();
    let profiles: Vec<Foreign> = (candidates.iter())
        .map(|candidate| (&candidate.adapted.profile.name).into())
        .collect();
    let namespaces: BTreeSet<Foreign> = (candidates.iter())
        .map(|candidate| (&candidate.fit.namespace).into())
        .collect();
    let role = match candidates {
        [Candidate { adapted, .. }, ..] if adapted.own_attitude.is_some() => Kind::Velocity,
        _ => Kind::Attitude,
    };
    if namespaces.len() > 1 {
        TelemetryError::SeveralVehicles { path, namespaces }
    } else if profiles.iter().any(|other| *other != profiles[0]) {
        let fits = profiles.into_iter().zip(topics).collect();
        TelemetryError::SeveralProfilesFit { path, fits }
    } else {
        TelemetryError::SeveralTopicsFit { path, role, topics }
    }
}
