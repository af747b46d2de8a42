//! What a log has instead of what was looked for.

use std::fmt;

use crate::{
    decode::path::{FieldPath, quoted},
    sample::Kind,
    text::{self, Foreign, escaped},
};

/// What a log has instead of what was looked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Instead {
    /// The names that were likely meant, the likeliest first: topics, or namespaces if one of these was looked for.
    pub meant: Vec<Foreign>,
    /// What a path without quotes means if more of it belongs to the topic, where the log has that topic.
    pub readings: Vec<PathReading>,
    /// What was looked for.
    pub role: Kind,
    /// Topics whose messages could be read for the role, the likelier first, but only so many.
    pub candidates: Vec<Candidate>,
    /// The other topics.
    pub others: OtherTopics,
}

/// Topics that are neither what was meant nor candidates.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum OtherTopics {
    /// All of them, because they are few.
    Listed(Vec<LogTopic>),
    /// There are so many.
    Counted(usize),
    /// What is wrong has nothing to do with which topics there are.
    Beside,
}

/// A topic that has messages.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct LogTopic {
    /// Its name.
    pub topic: Foreign,
    /// How its messages are encoded.
    pub message_encoding: Foreign,
    /// The name of their type, if they have one.
    pub schema: Option<Foreign>,
}

/// A topic whose messages could be read for a role.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Candidate {
    /// The topic.
    pub topic: LogTopic,
    /// The fields that could be it.
    pub fields: Vec<FieldPath>,
}

/// What paths without quotes can mean: so much of them is the topic, the rest the fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathReading {
    /// The topic.
    pub topic: Foreign,
    /// The fields of its messages; none if the paths are the topic alone.
    pub fields: Vec<FieldPath>,
}

impl PathReading {
    /// The paths with the topic in quotes, which mean only this.
    pub fn quoted(&self) -> String {
        let topic = escaped(quoted(&self.topic)).to_string();
        match self.fields.is_empty() {
            true => topic,
            false => text::join(
                self.fields.iter().map(|field| format!("{topic}.{field}")),
                ",",
            ),
        }
    }
}

impl fmt::Display for PathReading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { topic, fields } = self;
        write!(f, "{}: ", self.quoted())?;
        match &fields[..] {
            [] => write!(f, "the topic {topic}"),
            [field] => write!(f, "the field {field} of the topic {topic}"),
            fields => write!(
                f,
                "the fields {} of the topic {topic}",
                text::join(fields, ", ")
            ),
        }
    }
}

impl fmt::Display for LogTopic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, ", self.topic, self.message_encoding)?;
        match &self.schema {
            Some(schema) => write!(f, "{schema})"),
            None => f.write_str("no schema)"),
        }
    }
}

/// Each line begins with a line break, because they follow an error.
impl fmt::Display for Instead {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.meant.is_empty() {
            write!(f, "\ndid you mean {}?", text::join(&self.meant, " or "))?;
        }
        for PathReading { topic, .. } in &self.readings {
            write!(
                f,
                "\nthere is a topic {topic}, whose name needs quotes in a path:"
            )?;
        }
        for reading in &self.readings {
            write!(f, "\n  {reading}")?;
        }
        let other = if self.candidates.is_empty() {
            ""
        } else {
            "other "
        };
        if !self.candidates.is_empty() {
            let role = self.role.name();
            write!(f, "\ntopics whose messages could have the {role}:")?;
        }
        for Candidate { topic, fields } in &self.candidates {
            write!(f, "\n  {topic}: {}", text::join(fields, ", "))?;
        }
        match &self.others {
            OtherTopics::Listed(others) if others.is_empty() => match self.candidates.is_empty() {
                true => f.write_str("\nthe log has no messages"),
                false => Ok(()),
            },
            OtherTopics::Listed(others) => {
                write!(f, "\n{other}topics of the log:")?;
                others.iter().try_for_each(|topic| write!(f, "\n  {topic}"))
            }
            OtherTopics::Counted(1) => write!(f, "\nthe log has one {other}topic"),
            OtherTopics::Counted(count) => write!(f, "\nthe log has {count} {other}topics"),
            OtherTopics::Beside => Ok(()),
        }
    }
}
