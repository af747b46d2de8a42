//! Paths to fields, in Foxglove's message-path syntax: `/topic.field.sub[2]`
//! (<https://docs.foxglove.dev/docs/visualization/message-path-syntax>).
//!
//! A topic or a name with characters that mean something here is put in double quotes, in which a backslash stands
//! before a double quote or another backslash: `"/a.b"."OSD.pitch"`. A topic may be followed by filters, which say of
//! which messages the path is, and a list by `[:]` and filters, which say of which element: the first that satisfies
//! them all. Of Foxglove's syntax, slices without filters, places from the end, and comparisons other than `==` and
//! `!=` are not read.

mod filter;
mod parse;

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use crate::text::{Foreign, escaped};
pub use filter::{Comparison, Filter, Literal};
use parse::Parser;
pub(crate) use parse::split;

/// A field of a message, of a nested message, or of a list: `roll`, `velocity.x`, `q[0]`, `esc[2].rpm`,
/// `transforms[:]{child_frame_id=="base_link"}.transform`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
pub struct FieldPath {
    steps: Vec<PathStep>,
}

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PathStep {
    /// Leads to a field of a message.
    Name(String),
    /// Leads to an element of a list, counted from 0.
    Index(usize),
    /// Leads to the first element of a list that satisfies these filters, of which there is at least one.
    First(Vec<Filter>),
}

/// A topic, which of its messages are meant, and, if one is named, a field of theirs: `/imu.orientation`,
/// `/gimbal{device_id==1}.q`, or `/imu` alone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MessagePath {
    /// The topic.
    pub topic: String,
    /// What the messages must satisfy.
    pub filters: Vec<Filter>,
    /// The field; `None` for the whole message.
    pub field: Option<FieldPath>,
    /// Whether the topic was in quotes or followed by filters. If not, more of the path may be the topic, if that has dots.
    pub quoted: bool,
}

/// A text that is not a path.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not {wanted}")]
pub struct NotAPath {
    text: Foreign,
    wanted: &'static str,
}

impl FieldPath {
    /// The steps from the outermost message to the field. The first is a name.
    pub fn steps(&self) -> &[PathStep] {
        &self.steps
    }

    /// The path with these steps; `None` if there are none, or the first is not a name.
    pub(crate) fn of_steps(steps: Vec<PathStep>) -> Option<Self> {
        matches!(steps.first(), Some(PathStep::Name(_))).then_some(Self { steps })
    }

    /// Whether it leads to the first element of a list that satisfies filters.
    pub fn has_filters(&self) -> bool {
        let mut steps = self.steps.iter();
        steps.any(|step| matches!(step, PathStep::First(_)))
    }

    /// The path of the first `count` steps.
    pub(crate) fn first(&self, count: usize) -> Self {
        Self {
            steps: self.steps[..count].to_vec(),
        }
    }

    /// The name of the outermost field, and the path from there on, if it goes on with a name; `None` if it goes on with
    /// the place in a list.
    pub(crate) fn split_first(&self) -> Option<(&str, Option<Self>)> {
        match &self.steps[..] {
            [PathStep::Name(first)] => Some((first, None)),
            [PathStep::Name(first), rest @ ..] if matches!(rest[0], PathStep::Name(_)) => {
                let steps = rest.to_vec();
                Some((first, Some(Self { steps })))
            }
            _ => None,
        }
    }

    /// The field with this name within this one.
    pub fn child(&self, name: &str) -> Self {
        let mut steps = self.steps.clone();
        steps.push(PathStep::Name(name.to_owned()));
        Self { steps }
    }
}

impl FromStr for FieldPath {
    type Err = NotAPath;

    fn from_str(text: &str) -> Result<Self, NotAPath> {
        Parser::read(text, Parser::field_path).ok_or_else(|| NotAPath {
            text: text.into(),
            wanted: "the path of a field: write names joined by dots, and after a list the place in it, counted from \
                     0, as in `velocity.x` or `q[0]`, or a filter for its elements, as in \
                     `transforms[:]{child_frame_id==\"base_link\"}`; put a name with other characters in double \
                     quotes, as in `\"OSD.pitch\"`",
        })
    }
}

impl FromStr for MessagePath {
    type Err = NotAPath;

    fn from_str(text: &str) -> Result<Self, NotAPath> {
        Parser::read(text, Parser::message_path).ok_or_else(|| NotAPath {
            text: text.into(),
            wanted: "a message path: write a topic and a field, as in `/imu.orientation`, `/gps.velocity[0]` or \
                     `/gimbal{device_id==1}.q`, and put a topic or a name that has one of . , : [ { in double quotes",
        })
    }
}

impl FromStr for Filter {
    type Err = NotAPath;

    fn from_str(text: &str) -> Result<Self, NotAPath> {
        Parser::read(text, Parser::filter).ok_or_else(|| NotAPath {
            text: text.into(),
            wanted: "a filter: compare a field with a number, a truth value or a text in quotes, as in \
                     `device_id==1` or `header.frame_id!=\"map\"`",
        })
    }
}

impl TryFrom<String> for FieldPath {
    type Error = NotAPath;

    fn try_from(text: String) -> Result<Self, NotAPath> {
        text.parse()
    }
}

impl From<FieldPath> for String {
    fn from(path: FieldPath) -> Self {
        let mut text = Self::new();
        for step in &path.steps {
            match step {
                PathStep::Name(name) => {
                    if !text.is_empty() {
                        text.push('.');
                    }
                    text.push_str(&written(name));
                }
                PathStep::Index(index) => text.push_str(&format!("[{index}]")),
                PathStep::First(filters) => {
                    text.push_str("[:]");
                    for filter in filters {
                        text.push_str(&format!("{{{}}}", Self::from(filter.clone())));
                    }
                }
            }
        }
        text
    }
}

impl fmt::Display for MessagePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let needs_quotes = |c| c != '/' && is_special(c);
        let mut text = match self.topic.contains(needs_quotes) {
            true => quoted(&self.topic),
            false => self.topic.clone(),
        };
        for filter in &self.filters {
            text.push_str(&format!("{{{}}}", String::from(filter.clone())));
        }
        if let Some(field) = &self.field {
            text.push_str(&format!(".{}", String::from(field.clone())));
        }
        escaped(text).fmt(f)
    }
}

/// A name as a path has it: in quotes if it has characters that mean something in paths or in arguments.
pub(crate) fn written(name: &str) -> String {
    match name.is_empty() || name.contains(is_special) {
        true => quoted(name),
        false => name.to_owned(),
    }
}

/// Whether a character means something in paths, in arguments or to a shell.
fn is_special(c: char) -> bool {
    c.is_whitespace() || ".,:;/\\[]{}()<>\"'`=!@$&|".contains(c)
}

/// A text in double quotes.
pub(crate) fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', r"\\").replace('"', r#"\""#);
    format!("\"{escaped}\"")
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        escaped(String::from(self.clone())).fmt(f)
    }
}
