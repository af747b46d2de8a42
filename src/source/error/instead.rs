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
    /// The other topics, if they are few.
    pub others: Vec<LogTopic>,
    /// How many other topics there are.
    pub other_count: usize,
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

impl fmt::Display for Instead {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut lines = Vec::new();
        if !self.meant.is_empty() {
            lines.push(format!("did you mean {}?", text::join(&self.meant, " or ")));
        }
        for PathReading { topic, .. } in &self.readings {
            lines.push(format!(
                "there is a topic {topic}, whose name needs quotes in a path:"
            ));
        }
        lines.extend(self.readings.iter().map(|reading| format!("  {reading}")));
        if !self.candidates.is_empty() {
            let role = self.role.name();
            lines.push(format!("topics whose messages could have the {role}:"));
        }
        for Candidate { topic, fields } in &self.candidates {
            lines.push(format!("  {topic}: {}", text::join(fields, ", ")));
        }
        let other = if self.candidates.is_empty() {
            ""
        } else {
            "other "
        };
        if self.others.is_empty() {
            lines.push(match self.other_count {
                0 if self.candidates.is_empty() => "the log has no messages".to_owned(),
                0 => "the log has no other topics".to_owned(),
                1 => format!("the log has one {other}topic"),
                count => format!("the log has {count} {other}topics"),
            });
        } else {
            lines.push(format!("{other}topics of the log:"));
            lines.extend(self.others.iter().map(|topic| format!("  {topic}")));
        }
        f.write_str(&lines.join("\n"))
    }
}
