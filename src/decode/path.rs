//! Paths to fields, in Foxglove's message-path syntax: `/topic.field.sub[2]`
//! (<https://docs.foxglove.dev/docs/visualization/message-path-syntax>).

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use crate::text::{Foreign, escaped};

/// A field of a message, of a nested message, or of a list: `roll`, `velocity.x`, `q[0]`, `esc[2].rpm`.
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
}

/// A topic and, if one is named, a field of its messages: `/imu.orientation`, or `/imu` alone. A topic that contains
/// characters with a meaning here is put in double quotes: `"/a.b".field`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MessagePath {
    /// The topic.
    pub topic: String,
    /// The field; `None` for the whole message.
    pub field: Option<FieldPath>,
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
    pub(super) fn of_steps(steps: Vec<PathStep>) -> Option<Self> {
        matches!(steps.first(), Some(PathStep::Name(_))).then_some(Self { steps })
    }

    /// The path of the first `count` steps.
    pub(crate) fn first(&self, count: usize) -> Self {
        Self {
            steps: self.steps[..count].to_vec(),
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
        let steps = parse_steps(text).ok_or_else(|| NotAPath {
            text: text.into(),
            wanted: "the path of a field: write names joined by dots, and the place in a list, \
                     counted from 0, in brackets, as in `velocity.x` or `q[0]` (slices and filters \
                     are not supported)",
        })?;
        Ok(Self { steps })
    }
}

fn parse_steps(text: &str) -> Option<Vec<PathStep>> {
    let mut steps = Vec::new();
    for part in text.split('.') {
        let (name, indexes) = part.split_at(part.find('[').unwrap_or(part.len()));
        if name.is_empty() || name.contains([']', '/', '"', '{', '@', ' ']) {
            return None;
        }
        steps.push(PathStep::Name(name.to_owned()));
        if !indexes.is_empty() {
            let inner = indexes.strip_prefix('[')?.strip_suffix(']')?;
            for index in inner.split("][") {
                // `parse` accepts more than digits, for example `+1`.
                let is_plain = index.bytes().all(|byte| byte.is_ascii_digit());
                steps.push(PathStep::Index(index.parse().ok().filter(|_| is_plain)?));
            }
        }
    }
    Some(steps)
}

impl FromStr for MessagePath {
    type Err = NotAPath;

    fn from_str(text: &str) -> Result<Self, NotAPath> {
        let not_a_path = || NotAPath {
            text: text.into(),
            wanted: "a message path: write a topic and a field, as in `/imu.orientation` or \
                     `/gps.velocity[0]`, and put a topic that has one of . , : [ { in double quotes",
        };
        let (topic, rest) = match text.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').ok_or_else(not_a_path)?,
            None => text.split_at(text.find(['.', '[', '{']).unwrap_or(text.len())),
        };
        if topic.is_empty() {
            return Err(not_a_path());
        }
        let field = match rest.strip_prefix('.') {
            Some("") => return Err(not_a_path()),
            Some(field) => Some(field.parse()?),
            None if rest.is_empty() => None,
            None => return Err(not_a_path()),
        };
        Ok(Self {
            topic: topic.to_owned(),
            field,
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
        path.steps
            .iter()
            .fold(Self::new(), |text, step| match step {
                PathStep::Name(name) if text.is_empty() => name.clone(),
                PathStep::Name(name) => format!("{text}.{name}"),
                PathStep::Index(index) => format!("{text}[{index}]"),
            })
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        escaped(String::from(self.clone())).fmt(f)
    }
}
