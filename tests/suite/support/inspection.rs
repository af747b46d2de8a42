//! Inspections of logs, and checks of their numbers with the official reader.

use std::collections::BTreeMap;

use flightcam::{
    Error, Options,
    inspect::{FoundRole, Inspection, RoleReport, Telemetry, inspect},
    sample::Kind,
};
use mcap::MessageStream;

use super::folder::{Folder, LOG};

pub fn inspected_with(log: &[u8], options: &Options) -> Result<Inspection, Error> {
    let folder = Folder::with(LOG, log);
    let mut inspection = inspect(folder.path(LOG), options)?;
    inspection.input = LOG.into();
    Ok(inspection)
}

pub fn inspected(log: &[u8]) -> Inspection {
    inspected_with(log, &Options::default()).expect("a readable log")
}

#[track_caller]
pub fn telemetry(inspection: &Inspection) -> &Telemetry {
    let problem = &inspection.problem;
    (inspection.telemetry.as_ref()).unwrap_or_else(|| panic!("no telemetry: {problem:?}"))
}

#[track_caller]
pub fn found(inspection: &Inspection, kind: Kind) -> &FoundRole {
    match &telemetry(inspection).roles[&kind] {
        RoleReport::Found(found) => found,
        RoleReport::Missing { missing } => panic!("no {}: {missing}", kind.name()),
    }
}

/// What the official reader counts on a topic.
#[derive(Default)]
pub struct Counted {
    pub encoding: String,
    pub schema: String,
    pub times: Vec<u64>,
}

pub fn counted(log: &[u8]) -> BTreeMap<String, Counted> {
    let mut topics: BTreeMap<String, Counted> = BTreeMap::new();
    for message in MessageStream::new(log).expect("a log") {
        let message = message.expect("a message");
        let channel = &message.channel;
        let topic = topics.entry(channel.topic.clone()).or_default();
        let schema = channel.schema.as_ref();
        topic.schema = schema.map_or_else(String::new, |schema| schema.name.clone());
        topic.encoding = channel.message_encoding.clone();
        topic.times.push(message.log_time);
    }
    topics.values_mut().for_each(|topic| topic.times.sort());
    topics
}

/// Checks every number that does not depend on what messages mean.
#[track_caller]
pub fn check_counts(inspection: &Inspection, log: &[u8]) {
    let mut topics = counted(log);
    let times = || topics.values().flat_map(|topic| &topic.times);
    assert_eq!(inspection.bytes, log.len() as u64);
    assert_eq!(inspection.messages, times().count() as u64);
    assert_eq!(inspection.topics, topics.len());
    let span = times().min().zip(times().max());
    assert_eq!(inspection.times, span.map(|(&start, &end)| [start, end]));

    let mut used = Vec::new();
    for role in telemetry(inspection).roles.values() {
        let RoleReport::Found(role) = role else {
            continue;
        };
        let topic = &topics[role.topic.as_str()];
        let (times, seconds) = (&topic.times, |time: u64| time as f64 / 1e9);
        let [start, end] = [times[0], times[times.len() - 1]];
        assert_eq!(role.encoding, topic.encoding);
        assert_eq!(role.schema, topic.schema);
        assert_eq!(role.messages, times.len() as u64);
        assert_eq!(role.times, [start, end]);
        let rate = (times.len() - 1) as f64 / seconds(end - start);
        assert_eq!(role.rate_hz, (end > start).then_some(rate));
        let gaps = times.windows(2).map(|pair| seconds(pair[1] - pair[0]));
        assert_eq!(role.largest_gap_s, gaps.reduce(f64::max));
        assert_eq!(role.read, role.tally.total() + role.tally.unselected);
        let invalid = role.tally.dropped.values().sum::<u64>() as f64;
        assert_eq!(role.share_invalid, invalid / role.tally.total() as f64);
        used.push(role.topic.as_str());
    }
    topics.retain(|topic, _| !used.contains(&topic.as_str()));
    let grouped = || inspection.other_topics.iter();
    let names = grouped().flat_map(|group| &group.topics);
    let mut names: Vec<&str> = names.map(|name| name.as_str()).collect();
    names.sort();
    assert!(names.into_iter().eq(topics.keys()));
    for group in grouped() {
        let of_group = group.topics.iter().map(|topic| &topics[topic.as_str()]);
        assert!(of_group.clone().all(|topic| {
            group.encoding == topic.encoding && topic.schema.starts_with(group.schemas.as_str())
        }));
        let messages: usize = of_group.map(|topic| topic.times.len()).sum();
        assert_eq!(group.messages, messages as u64);
    }
}
