//! Topics as profiles name them: in any vehicle's namespace, and with a number that may be any.

use std::fmt;

/// What stands for a number.
const NUMBER: &str = "{n}";

/// A topic of a profile, in a namespace.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    before: String,
    /// What follows a number, where there is one.
    after: Option<String>,
}

impl Pattern {
    /// Of a topic as a profile writes it, in a namespace, which may be empty.
    pub fn new(namespace: &str, topic: &str) -> Self {
        let (before, after) = match topic.split_once(NUMBER) {
            Some((before, after)) => (before, Some(after.to_owned())),
            None => (topic, None),
        };
        Self {
            before: format!("{namespace}{before}"),
            after,
        }
    }

    /// Whether this is the topic.
    pub fn is_match(&self, topic: &str) -> bool {
        self.rank(topic).is_some()
    }

    /// Those of the topics that match, the one with the largest number first.
    pub fn matches<'t>(&self, topics: impl Iterator<Item = &'t str>) -> Vec<&'t str> {
        let mut matching: Vec<(u64, &str)> = topics
            .filter_map(|topic| Some((self.rank(topic)?, topic)))
            .collect();
        matching.sort_by_key(|&(number, _)| std::cmp::Reverse(number));
        matching.into_iter().map(|(_, topic)| topic).collect()
    }

    /// The prefix with which this topic becomes that one.
    pub fn namespace_of<'t>(&self, topic: &'t str) -> Option<&'t str> {
        let starts = topic.match_indices('/').map(|(start, _)| start);
        let mut starts = starts.chain([0]);
        starts
            .find(|&start| self.is_match(&topic[start..]))
            .map(|start| &topic[..start])
    }

    /// The number in a topic that matches, 0 where the pattern has none.
    fn rank(&self, topic: &str) -> Option<u64> {
        let rest = topic.strip_prefix(self.before.as_str())?;
        match &self.after {
            None => rest.is_empty().then_some(0),
            Some(after) => {
                let digits = rest.strip_suffix(after.as_str())?;
                let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
                digits.parse().ok().filter(|_| is_number)
            }
        }
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.before)?;
        match &self.after {
            Some(after) => write!(f, "{NUMBER}{after}"),
            None => Ok(()),
        }
    }
}
