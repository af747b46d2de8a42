//! Which messages samples are read from, on which condition, and what their time is.

use serde::{Deserialize, Serialize};

use super::convention::TimeUnit;
use crate::decode::path::{FieldPath, Filter};

/// Which messages an alternative reads, whatever it reads from them.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[serde(default)]
pub struct Location {
    /// Topics in order of preference; `{n}` in one stands for any number, the largest first, `{vehicle}` for a
    /// vehicle's number, which with all that comes before it is the vehicle's namespace. If empty: for an attitude, any
    /// one topic whose messages have all of the fields; otherwise the attitude's own messages.
    pub topics: Vec<String>,
    /// How the topic was written.
    #[serde(skip)]
    pub written: Written,
    /// The names of message types, of which a channel must have one; any, if empty. A `/msg/` within makes no
    /// difference.
    pub schemas: Vec<String>,
    /// What a message must satisfy to be read at all, where those of several sources share a topic. Others are counted,
    /// but not dropped.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub select: Vec<Filter>,
    /// Which of several sources on the topic is the primary one, if messages elsewhere say so. If they do not, and there are
    /// several, the user has to choose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub primary: Option<Primary>,
    /// What must hold for a message to be read this way. A message for which no alternative holds is dropped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub when: Option<Condition>,
    /// Fields of which each must be true (not 0) for a sample to be valid.
    pub valid: Vec<FieldPath>,
    /// Whether the frames that messages name are wrong, and not what their axes go by.
    pub ignore_frame_ids: bool,
    /// What the time of a sample is, if it is not the profile's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<SampleTime>,
}

/// Where messages say which of several sources is the primary one.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Primary {
    /// The topics of these messages, any of which may be there.
    pub topics: Vec<String>,
    /// The field with the primary source's number. What most messages have counts.
    pub field: FieldPath,
    /// The field of the source's own messages that has its number.
    pub among: FieldPath,
}

/// How a topic was written. Locations with the same topic are equal however it was written.
#[derive(Debug, Clone, Copy, Default)]
pub enum Written {
    /// By itself, or in quotes.
    #[default]
    Exactly,
    /// As the beginning of paths without quotes. More of the paths may be the topic, if that has dots.
    InPaths,
}

impl PartialEq for Written {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Location {
    /// Reads the messages on one topic.
    pub fn on(topic: impl Into<String>) -> Self {
        Self {
            topics: vec![topic.into()],
            ..Self::default()
        }
    }

    /// Whether messages of this type are meant.
    pub(in crate::source) fn is_for(&self, schema_name: &str) -> bool {
        let plain = |name: &str| name.replace("/msg/", "/");
        let mut schemas = self.schemas.iter();
        self.schemas.is_empty() || schemas.any(|wanted| plain(wanted) == plain(schema_name))
    }
}

/// What must hold for a message to be read in a certain way. `F` stands for a field: its path in a profile, its slot in
/// a decoder.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Condition<F = FieldPath> {
    /// The field.
    pub field: F,
    /// What it must hold.
    #[serde(flatten)]
    pub test: Test,
}

/// What a field must hold.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Test {
    /// This number.
    Is(i64),
    /// This text.
    Says(String),
    /// A text with this in it.
    Contains(String),
    /// A number that is written without a decimal point, or is of an integer type; or one that is not.
    IsInteger(bool),
    /// A number with any of these bits.
    HasBits(u64),
}

/// What the time of a sample is.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleTime<F = TimeField> {
    /// When the recorder received the message.
    #[default]
    LogTime,
    /// When the message was published.
    PublishTime,
    /// What a field of the message says.
    Field(F),
}

/// A field with a time: a number, or a message of seconds and nanoseconds.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TimeField {
    /// The field.
    pub path: FieldPath,
    /// The unit of a number, which needs one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<TimeUnit>,
}
