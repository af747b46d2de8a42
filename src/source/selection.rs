//! Finding the telemetry of a log: which profile, which vehicle, and which of the log's channels.

use std::{cmp::Reverse, collections::BTreeSet};

use super::{
    RunnerUp, Source,
    finder::{Finder, Fit, Specificity, specificity},
    profile::{Profile, ProfileChoice},
    request::Request,
    topic::describe_topics,
};
use crate::{decode::FirstMessages, error::Error, log::Log, sample::Kind};

/// How well a profile fits, the best last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Rank {
    /// What is told by its topics is the vehicle's own estimate; what has the right fields may be anything's.
    specificity: Specificity,
    has_velocity: bool,
}

impl Fit {
    fn rank(&self, profile: &Profile) -> Rank {
        Rank {
            has_velocity: self.others[&Kind::Velocity].is_ok(),
            specificity: specificity(profile),
        }
    }
}

/// Which profiles are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Thoroughness {
    /// Until none that is left could fit better.
    UntilFound,
    All,
}

impl Source {
    /// Finds the telemetry of a log.
    ///
    /// # Errors
    /// The profile does not fit the log, or none does, or several fit equally well. The message says what was
    /// looked for and how to choose.
    pub fn select(log: &Log, request: &Request) -> Result<Self, Error> {
        Self::find(log, request, Thoroughness::UntilFound)
    }

    /// As [`select`](Self::select), trying every profile, so that all runners-up are known.
    ///
    /// # Errors
    /// Those of [`select`](Self::select).
    pub fn compare(log: &Log, request: &Request) -> Result<Self, Error> {
        Self::find(log, request, Thoroughness::All)
    }

    fn find(log: &Log, request: &Request, thoroughness: Thoroughness) -> Result<Self, Error> {
        let path = || log.file.path().to_owned();
        let examples = FirstMessages::new(log);
        let finder = Finder::new(log, &examples, request);
        finder.check_told(request)?;
        let mut profiles = request.profiles();
        // What one profile does not tell by its topics another may; the sort keeps their order otherwise.
        profiles.sort_by_key(|profile| Reverse(specificity(profile)));

        let mut fits: Vec<(&Profile, Fit)> = Vec::new();
        let mut misfits: Vec<RunnerUp> = Vec::new();
        for profile in &profiles {
            let best = fits.iter().map(|(profile, fit)| fit.rank(profile)).max();
            let could_be_best = Rank {
                has_velocity: true,
                specificity: specificity(profile),
            };
            if thoroughness == Thoroughness::UntilFound && best > Some(could_be_best) {
                break;
            }
            match finder.fit(profile)? {
                Ok(found) => fits.extend(found.into_iter().map(|fit| (profile, fit))),
                Err(reason) => misfits.push(RunnerUp {
                    profile: profile.name.clone(),
                    fits: false,
                    reason,
                }),
            }
        }
        let Some(best) = fits.iter().map(|(profile, fit)| fit.rank(profile)).max() else {
            return Err(match (&request.profile, profiles.as_slice()) {
                (ProfileChoice::Automatic, [_, _, ..]) => Error::NoTelemetry {
                    path: path(),
                    looked_for: (misfits.iter())
                        .map(|misfit| format!("\n  {}: {}", misfit.profile, misfit.reason))
                        .collect(),
                    topics: describe_topics(log),
                },
                _ => {
                    let misfit = misfits.swap_remove(0);
                    Error::ProfileDoesNotFit {
                        path: path(),
                        profile: misfit.profile,
                        problem: format!("{}\n{}", misfit.reason, describe_topics(log)),
                    }
                }
            });
        };
        // Which of several vehicles is meant does not follow from how much is known of each.
        let is_vehicle = |profile: &Profile| specificity(profile) == Specificity::Topic;
        let vehicles: BTreeSet<String> = (fits.iter())
            .filter(|(profile, _)| is_vehicle(profile))
            .map(|(_, fit)| fit.namespace.clone())
            .collect();
        let (best, mut rest): (Vec<_>, Vec<_>) = fits.into_iter().partition(|(profile, fit)| {
            fit.rank(profile) == best || vehicles.len() > 1 && is_vehicle(profile)
        });
        rest.sort_by_key(|(profile, fit)| Reverse(fit.rank(profile)));
        let [(profile, fit)] = best.as_slice() else {
            return Err(ambiguity(log, &best));
        };
        let runners_up = rest.iter().map(|(profile, fit)| RunnerUp {
            profile: profile.name.clone(),
            fits: true,
            reason: fit.attitude.reason(),
        });
        Ok(Self {
            channels: finder.channels_of(profile, fit, &Kind::ALL)?,
            runners_up: runners_up.chain(misfits).collect(),
            profile: (*profile).clone(),
            namespace: fit.namespace.clone(),
            roles: (fit.others.iter())
                .map(|(&kind, role)| (kind, role.clone().map_err(|missing| missing.reason)))
                .chain([(Kind::Attitude, Ok(fit.attitude.clone()))])
                .collect(),
            fit: fit.clone(),
        })
    }

    /// Reads only these kinds of sample, so that what else stands in their messages cannot trouble them.
    ///
    /// # Errors
    /// The log cannot be read.
    pub fn keep(self, log: &Log, request: &Request, kinds: &[Kind]) -> Result<Self, Error> {
        let examples = FirstMessages::new(log);
        let finder = Finder::new(log, &examples, request);
        Ok(Self {
            channels: finder.channels_of(&self.profile, &self.fit, kinds)?,
            ..self
        })
    }
}

/// The error for a log that several fits are equally good for.
fn ambiguity(log: &Log, fits: &[(&Profile, Fit)]) -> Error {
    let path = log.file.path().to_owned();
    let profiles: BTreeSet<&str> = (fits.iter())
        .map(|(profile, _)| profile.name.as_str())
        .collect();
    let namespaces: BTreeSet<&str> = (fits.iter())
        .map(|(_, fit)| fit.namespace.as_str())
        .collect();
    if namespaces.len() > 1 {
        Error::SeveralVehicles {
            path,
            namespaces: namespaces.into_iter().map(str::to_owned).collect(),
        }
    } else if profiles.len() > 1 {
        let place =
            |(profile, fit): &(&Profile, Fit)| (profile.name.clone(), fit.attitude.topic.clone());
        Error::SeveralProfilesFit {
            path,
            fits: fits.iter().map(place).collect(),
        }
    } else {
        Error::SeveralTopicsFit {
            path,
            topics: fits
                .iter()
                .map(|(_, fit)| fit.attitude.topic.clone())
                .collect(),
        }
    }
}
