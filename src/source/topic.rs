//! Topics as profiles name them: in any vehicle's namespace, and with numbers that may be any.

/// What stands for any number, such as a version.
const NUMBER: &str = "{n}";

/// What stands for a vehicle's number. All that comes before it, and the number, is the vehicle's namespace.
const VEHICLE: &str = "{vehicle}";

/// A topic of a profile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    /// How a namespace must end, before the vehicle's number; `None` where the vehicle has none.
    vehicle: Option<String>,
    before: String,
    /// What follows a number, where there is one.
    after: Option<String>,
}

impl Pattern {
    /// Of a topic as a profile writes it.
    pub fn new(topic: &str) -> Self {
        let (vehicle, topic) = match topic.split_once(VEHICLE) {
            Some((vehicle, topic)) => (Some(vehicle.to_owned()), topic),
            None => (None, topic),
        };
        let (before, after) = match topic.split_once(NUMBER) {
            Some((before, after)) => (before, Some(after.to_owned())),
            None => (topic, None),
        };
        Self {
            vehicle,
            before: before.to_owned(),
            after,
        }
    }

    /// Whether this is the topic, in a namespace, which may be empty.
    pub fn is_match(&self, namespace: &str, topic: &str) -> bool {
        self.rank(namespace, topic).is_some()
    }

    /// Those of the topics that match, the one with the largest number first.
    pub fn matches<'t>(
        &self,
        namespace: &str,
        topics: impl Iterator<Item = &'t str>,
    ) -> Vec<&'t str> {
        let mut matching: Vec<(u64, &str)> = topics
            .filter_map(|topic| Some((self.rank(namespace, topic)?, topic)))
            .collect();
        matching.sort_by_key(|&(number, _)| std::cmp::Reverse(number));
        matching.into_iter().map(|(_, topic)| topic).collect()
    }

    /// The namespace in which this is the topic, if there is one.
    pub fn namespace_of<'t>(&self, topic: &'t str) -> Option<&'t str> {
        let starts = [0]
            .into_iter()
            .chain(topic.match_indices('/').map(|(start, _)| start));
        let ends = starts.filter_map(|start| match &self.vehicle {
            None => Some(start),
            Some(vehicle) => {
                let number = topic[start..].strip_prefix(vehicle.as_str())?;
                let digits = number.bytes().take_while(u8::is_ascii_digit).count();
                Some(start + vehicle.len() + digits)
            }
        });
        ends.map(|end| &topic[..end])
            .find(|namespace| self.is_match(namespace, topic))
    }

    /// The topic in a namespace, as a message names it.
    pub fn describe(&self, namespace: &str) -> String {
        let namespace = match &self.vehicle {
            Some(vehicle) if !self.is_vehicle(namespace) => {
                format!("{namespace}{vehicle}{VEHICLE}")
            }
            _ => namespace.to_owned(),
        };
        match &self.after {
            None => format!("{namespace}{}", self.before),
            Some(after) => format!("{namespace}{}{NUMBER}{after}", self.before),
        }
    }

    /// Whether a namespace ends with a vehicle's number where this topic has one.
    fn is_vehicle(&self, namespace: &str) -> bool {
        let Some(vehicle) = &self.vehicle else {
            return true;
        };
        let name = namespace.trim_end_matches(|last: char| last.is_ascii_digit());
        name.len() < namespace.len() && name.ends_with(vehicle.as_str())
    }

    /// The number in a topic that matches, 0 where the pattern has none.
    fn rank(&self, namespace: &str, topic: &str) -> Option<u64> {
        let within = topic
            .strip_prefix(namespace)
            .filter(|_| self.is_vehicle(namespace));
        let rest = within?.strip_prefix(self.before.as_str())?;
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
