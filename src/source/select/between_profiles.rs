//! Between profiles that fit a log, what their messages hold counts, too: one whose attitude is a few stray messages is
//! passed over, and of several that fit equally well, those without a usable velocity.

use std::collections::BTreeSet;

use super::{
    Candidate, LogSearch,
    choice::{PassedOver, SeenPlace, is_enough},
    fit::specificity,
    look::Look,
};
use crate::{
    sample::Kind,
    source::{Origin, error::TelemetryError},
};

impl Candidate<'_> {
    /// Whether its attitude has enough messages to be no stray, whatever others have.
    pub fn is_series(&self) -> bool {
        is_enough(self.attitude.messages as f64, f64::INFINITY)
    }

    fn look(&self, log_search: &LogSearch, kind: Kind) -> Result<Option<Look>, TelemetryError> {
        let by = specificity(self.adapted.attitude());
        let search = log_search.search(&self.adapted.profile, by, &self.fit.namespace);
        search.look(&self.fit, kind)
    }

    fn seen(&self, origin: &Origin, look: Look) -> SeenPlace {
        SeenPlace::new(&self.adapted.profile.name, origin, look)
    }
}

/// Takes away the candidates whose attitude is a few messages beside the series of another, unless there are several
/// vehicles: one that was logged for a short time is a vehicle all the same. Messages are looked at only if their numbers
/// give a reason to.
pub fn take_strays<'p>(
    log_search: &LogSearch,
    candidates: &mut Vec<Candidate<'p>>,
) -> Result<Vec<Candidate<'p>>, TelemetryError> {
    let messages = candidates.iter().map(|one| one.attitude.messages as f64);
    let most = messages.clone().fold(0.0, f64::max);
    let mut few = messages.filter(|messages| !is_enough(*messages, most));
    if few.next().is_none() || vehicles(candidates).len() > 1 {
        return Ok(Vec::new());
    }
    for candidate in &mut *candidates {
        let look = candidate.look(log_search, Kind::Attitude)?;
        candidate.attitude = look.unwrap_or_default();
    }
    let usable = candidates.iter().map(|one| one.attitude.usable());
    let most = usable.fold(0.0, f64::max);
    let is_stray = |one: &mut Candidate| !is_enough(one.attitude.usable(), most);
    Ok(candidates.extract_if(.., is_stray).collect())
}

/// The strays that would have been used instead of the best candidate, or that would not have let it be chosen.
pub fn strays_passed_over(strays: &[Candidate], best: &Candidate) -> Vec<PassedOver> {
    let attitude = |one: &Candidate| one.seen(&one.fit.attitude.origin, one.attitude.clone());
    let preferred = strays.iter().filter(|stray| stray.rank() >= best.rank());
    let passed_over = preferred.map(|stray| PassedOver {
        role: Kind::Attitude,
        place: attitude(stray),
        instead: attitude(best),
    });
    passed_over.collect()
}

/// The vehicles that candidates are, by their namespaces.
pub fn vehicles<'c>(candidates: &'c [Candidate]) -> BTreeSet<&'c str> {
    let vehicles = candidates.iter().filter(|candidate| candidate.is_vehicle());
    vehicles.map(|one| one.fit.namespace.as_str()).collect()
}

/// Leaves, of candidates of several profiles for one vehicle, those whose velocity is usable, if that tells them apart;
/// the others join the `rest`. Returns what was passed over, too.
pub fn settle<'p>(
    log_search: &LogSearch,
    best: Vec<Candidate<'p>>,
    rest: &mut Vec<Candidate<'p>>,
) -> Result<(Vec<Candidate<'p>>, Vec<PassedOver>), TelemetryError> {
    let velocity = log_search.velocity_from.kind();
    let namespaces: BTreeSet<&str> = best.iter().map(|one| one.fit.namespace.as_str()).collect();
    let profiles: BTreeSet<&str> = best
        .iter()
        .map(|one| one.adapted.profile.name.as_str())
        .collect();
    if profiles.len() <= 1 || profiles.len() < best.len() || namespaces.len() > 1 {
        return Ok((best, Vec::new()));
    }
    let (mut usable, mut others) = (Vec::new(), Vec::new());
    for candidate in best {
        let seen = candidate.look(log_search, velocity)?.and_then(|look| {
            let origin = candidate.fit.role(velocity).ok()?;
            Some(candidate.seen(origin, look))
        });
        match seen {
            Some(seen) if seen.looked_at.used > 0 => usable.push((candidate, seen)),
            seen => others.push((candidate, seen)),
        }
    }
    let mut passed_over = Vec::new();
    if let [(_, instead)] = &usable[..] {
        let seen = others.iter().filter_map(|(_, seen)| seen.clone());
        passed_over.extend(seen.map(|place| PassedOver {
            role: velocity,
            place,
            instead: instead.clone(),
        }));
    }
    let mut best: Vec<Candidate> = usable.into_iter().map(|(candidate, _)| candidate).collect();
    let others = others.into_iter().map(|(candidate, _)| candidate);
    match best.is_empty() {
        true => best.extend(others),
        false => drop(rest.splice(0..0, others)),
    }
    Ok((best, passed_over))
}
