//! Messages that cannot be decoded.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::{decode::fault::Fault, text::Foreign};

/// A message that cannot be decoded, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UndecodableMessage {
    /// Its topic.
    pub topic: Foreign,
    /// Its log time, nanoseconds.
    pub log_time: u64,
    /// What is wrong with it.
    #[serde(serialize_with = "as_text")]
    pub problem: Fault,
}

fn as_text<S: Serializer>(fault: &Fault, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(fault)
}

impl fmt::Display for UndecodableMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SECOND: u64 = 1_000_000_000;
        let Self {
            topic,
            log_time,
            problem,
        } = self;
        let (seconds, nanoseconds) = (log_time / SECOND, log_time % SECOND);
        write!(
            f,
            "the message on {topic} at {seconds}.{nanoseconds:09} s in log time: {problem}"
        )
    }
}
