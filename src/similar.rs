//! Names that were likely meant, where a name is not there.

/// How many names are suggested at most.
const SUGGESTED: usize = 3;

/// Names that are longer, in bytes, are not compared: it would take too long.
const LONGEST: usize = 512;

/// The names, of fields, keys or types, that are most like a wanted one, the likeliest first.
pub fn names<'n>(wanted: &str, names: impl IntoIterator<Item = &'n str>) -> Vec<&'n str> {
    let wanted = plain(wanted);
    nearest(names, |name| {
        let name = plain(name);
        match edits(&wanted, &name) {
            Some(edits) if edits <= tolerated(&wanted) => Some((0, edits)),
            _ if is_beginning(&wanted, &name) => Some((1, name.len())),
            _ => None,
        }
    })
}

/// The one name that is like a wanted one in all but a few letters, if there is one.
pub fn misspelt<'n>(wanted: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let wanted = plain(wanted);
    let like =
        |name: &str| edits(&wanted, &plain(name)).filter(|edits| *edits <= tolerated(&wanted));
    nearest(names, |name| Some((0, like(name)?)))
        .into_iter()
        .next()
}

/// The topics that are most like a wanted one, the likeliest first: those that differ in case or slashes, those in
/// another namespace, those that the wanted one continues, as a path continues its topic, those that differ in a few
/// letters, and those with the same last name or nearly so.
pub fn topics<'n>(wanted: &str, topics: impl IntoIterator<Item = &'n str>) -> Vec<&'n str> {
    let wanted = wanted.trim_matches('/').to_lowercase();
    let last = last_name(&wanted);
    nearest(topics, |topic| {
        let topic = topic.trim_matches('/').to_lowercase();
        let ends = |long: &str, short: &str| {
            long.strip_suffix(short)
                .is_some_and(|rest| rest.ends_with('/'))
        };
        let continues = wanted.strip_prefix(topic.as_str());
        let last_edits = edits(last, last_name(&topic))
            .filter(|_| last.len() >= 3 && last.contains(|c: char| !c.is_ascii_digit()));
        let edits = edits(&wanted, &topic)?;
        Some(match (edits, last_edits) {
            (0, _) => (0, 0),
            _ if ends(&topic, &wanted) || ends(&wanted, &topic) => (1, edits),
            _ if continues.is_some_and(|rest| rest.starts_with(['/', '.'])) => (2, edits),
            _ if edits <= tolerated(&wanted) => (3, edits),
            (_, Some(0)) => (4, edits),
            (_, Some(of_last)) if of_last <= tolerated(last) => (5, of_last),
            (_, Some(of_last)) if is_beginning(last, last_name(&topic)) => (6, of_last),
            _ => return None,
        })
    })
}

/// The nearest names. A distance is in what way a name differs, the likeliest way first, and how much; names that differ
/// in a less likely way than the nearest, or much more than it, are left out.
fn nearest<'n>(
    names: impl IntoIterator<Item = &'n str>,
    distance: impl Fn(&str) -> Option<(usize, usize)>,
) -> Vec<&'n str> {
    let mut found: Vec<((usize, usize), &str)> = (names.into_iter())
        .filter_map(|name| Some((distance(name)?, name)))
        .collect();
    found.sort_unstable();
    found.dedup();
    let Some(&((likeliest, least), _)) = found.first() else {
        return Vec::new();
    };
    (found.into_iter())
        .take_while(|((way, much), _)| *way == likeliest && *much <= 2 * least + 1)
        .map(|(_, name)| name)
        .take(SUGGESTED)
        .collect()
}

/// How many letters are added, left out, replaced or swapped between two names.
fn edits(one: &str, other: &str) -> Option<usize> {
    let is_short = one.len() <= LONGEST && other.len() <= LONGEST;
    is_short.then(|| strsim::osa_distance(one, other))
}

/// How many such letters a slip may have.
fn tolerated(wanted: &str) -> usize {
    wanted.chars().count() / 3
}

/// Whether one of two names is how the other begins.
fn is_beginning(one: &str, other: &str) -> bool {
    let begins = |short: &str, long: &str| short.len() >= 3 && long.starts_with(short);
    begins(one, other) || begins(other, one)
}

/// A name without what people spell in different ways.
fn plain(name: &str) -> String {
    name.to_lowercase().replace(['_', '-', ' '], "")
}

fn last_name(topic: &str) -> &str {
    topic.rsplit('/').next().unwrap_or(topic)
}
