//! Topics as profiles name them: in any vehicle's namespace, and with a wildcard for a number.

use crate::text::Foreign;

/// The wildcard for any number, such as a version.
const NUMBER: &str = "{n}";

/// The wildcard for a vehicle's number. All that comes before it, and the number, is the vehicle's namespace.
pub const VEHICLE: &str = "{vehicle}";

/// A topic of a profile, in a namespace.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    /// What comes before the vehicle's number, if the namespace does not say it. No topic matches then.
    vehicle: Option<String>,
    before: String,
    /// What follows the number, if there is one.
    after: Option<String>,
}

impl Pattern {
    /// Makes the pattern of a topic as a profile writes it, in a namespace, which may be empty.
    pub fn new(namespace: &str, topic: &str) -> Self {
        let (vehicle, namespace, topic) = match topic.split_once(VEHICLE) {
            None => (None, namespace, topic),
            Some((vehicle, topic)) if is_vehicle(namespace, vehicle) => (None, namespace, topic),
            Some((vehicle, topic)) => (Some(format!("{namespace}{vehicle}")), "", topic),
        };
        let (before, after) = match topic.split_once(NUMBER) {
            Some((before, after)) => (before, Some(after.to_owned())),
            None => (topic, None),
        };
        // The topics of some logs do not begin with a slash.
        let slash = match namespace.is_empty() || before.starts_with('/') {
            true => "",
            false => "/",
        };
        Self {
            vehicle,
            before: format!("{namespace}{slash}{before}"),
            after,
        }
    }

    /// Whether the pattern matches the topic.
    pub fn is_match(&self, topic: &str) -> bool {
        self.rank(topic).is_some()
    }

    /// The topics that match, the one with the largest number first.
    pub fn matches<'t>(&self, topics: impl Iterator<Item = &'t str>) -> Vec<&'t str> {
        let mut matching: Vec<(u64, &str)> = topics
            .filter_map(|topic| Some((self.rank(topic)?, topic)))
            .collect();
        matching.sort_by_key(|&(number, _)| std::cmp::Reverse(number));
        matching.into_iter().map(|(_, topic)| topic).collect()
    }

    /// The namespace in which this pattern becomes that topic.
    pub fn namespace_of<'t>(&self, topic: &'t str) -> Option<&'t str> {
        let starts = topic.match_indices('/').map(|(start, _)| start);
        let ends = starts.chain([0]).filter_map(|start| match &self.vehicle {
            None => Some(start),
            Some(vehicle) => {
                let number = topic[start..].strip_prefix(vehicle.as_str())?;
                let digits = number.bytes().take_while(u8::is_ascii_digit).count();
                (digits > 0).then_some(start + vehicle.len() + digits)
            }
        });
        ends.map(|end| topic.split_at(end))
            .find(|(_, within)| self.number(within).is_some())
            .map(|(namespace, _)| namespace)
    }

    /// Whether the pattern may match the topic in any namespace: not only in those that
    /// [`namespace_of`](Self::namespace_of) finds, but also in those that other topics show.
    pub fn may_be_match(&self, topic: &str) -> bool {
        let Some(after) = &self.after else {
            return topic.ends_with(&self.before);
        };
        let Some(digits) = topic.strip_suffix(after.as_str()) else {
            return false;
        };
        let name = digits.trim_end_matches(|last: char| last.is_ascii_digit());
        (name.len()..digits.len()).any(|end| digits[..end].ends_with(&self.before))
    }

    /// The pattern as a profile writes it.
    pub fn as_written(&self) -> Foreign {
        let vehicle = self.vehicle.iter().flat_map(|vehicle| [vehicle, VEHICLE]);
        let after = self.after.iter().flat_map(|after| [NUMBER, after]);
        let parts = vehicle.chain([self.before.as_str()]).chain(after);
        parts.collect::<String>().into()
    }

    /// The number in a topic that matches; 0 if the pattern has none.
    fn rank(&self, topic: &str) -> Option<u64> {
        match self.vehicle {
            None => self.number(topic),
            Some(_) => None,
        }
    }

    /// Like [`rank`](Self::rank), for the part that follows the vehicle's number.
    fn number(&self, topic: &str) -> Option<u64> {
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

/// Whether a namespace ends with this and a vehicle's number.
fn is_vehicle(namespace: &str, vehicle: &str) -> bool {
    let name = namespace.trim_end_matches(|last: char| last.is_ascii_digit());
    name.len() < namespace.len() && name.ends_with(vehicle)
}

/// Whether a topic is in a namespace.
pub fn is_within(topic: &str, namespace: &str) -> bool {
    (topic.strip_prefix(namespace))
        .is_some_and(|rest| namespace.is_empty() || rest.starts_with('/'))
}
