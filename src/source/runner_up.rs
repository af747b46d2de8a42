//! Profiles that were tried and not chosen, and how nearly they fit.

use std::{collections::BTreeMap, fmt};

use serde::{Serialize, Serializer, ser::SerializeStruct};

use super::{
    Origin,
    error::{Misfit, TopicMisfit},
};
use crate::{sample::Kind, text, text::Foreign};

/// A profile that was tried and not chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct RunnerUp {
    /// The profile's own name.
    pub profile: Foreign,
    /// Where it finds the attitude, if it fits, though not as well; or why it does not fit.
    pub attitude: Result<Origin, Misfit>,
    /// Topics of the log that it names for other kinds of sample, one for each. Whether it could read them was tried only if
    /// it fits.
    pub others: BTreeMap<Kind, Foreign>,
}

impl RunnerUp {
    /// The topic that comes nearest, where the profile looks for fields on any topic.
    pub(super) fn nearest_mut(&mut self) -> Option<&mut Option<TopicMisfit>> {
        match &mut self.attitude {
            Err(Misfit::NoSuchFields { nearest, .. }) => Some(nearest),
            _ => None,
        }
    }

    /// Whether the log has something of what the profile names.
    pub fn is_near(&self) -> bool {
        let of_attitude = match &self.attitude {
            Ok(_) => true,
            Err(misfit) => misfit.is_near(),
        };
        of_attitude || !self.others.is_empty()
    }
}

/// How nearly it fits.
impl fmt::Display for RunnerUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            profile,
            attitude,
            others,
        } = self;
        let listed = || {
            let others = others.iter();
            text::join(
                others.map(|(kind, topic)| format!("{} on {topic}", kind.name())),
                ", ",
            )
        };
        match (attitude, others.is_empty()) {
            (Ok(attitude), _) if others.contains_key(&Kind::Velocity) => {
                write!(f, "{profile} fits less well: {attitude}")
            }
            (Ok(attitude), _) => write!(f, "{profile} fits less well: {attitude}; no velocity"),
            (Err(misfit), true) => write!(f, "{profile}: {misfit}"),
            (Err(misfit), false) => write!(f, "{profile}: {}, but no attitude: {misfit}", listed()),
        }
    }
}

impl Serialize for RunnerUp {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("RunnerUp", 4)?;
        fields.serialize_field("profile", &self.profile)?;
        fields.serialize_field("fits", &self.attitude.is_ok())?;
        match &self.attitude {
            Ok(attitude) => fields.serialize_field("attitude", attitude)?,
            Err(misfit) => fields.serialize_field("misfit", misfit)?,
        }
        fields.serialize_field("others", &self.others)?;
        fields.end()
    }
}

/// Lists the profiles that come near to fitting, each in a line, and says how many others there are.
pub fn nearest_first(tried: &[RunnerUp]) -> String {
    let (near, far): (Vec<&RunnerUp>, Vec<&RunnerUp>) = tried.iter().partition(|one| one.is_near());
    let mut lines: Vec<String> = near.iter().map(|one| one.to_string()).collect();
    let what = match (near.is_empty(), far.len()) {
        (_, 0) => None,
        (true, count) => Some(format!("{count}")),
        (false, 1) => Some("one other".to_owned()),
        (false, count) => Some(format!("{count} others")),
    };
    lines.extend(what.map(|what| {
        format!(
            "{what}, of whose topics, types and fields the log has none: {}",
            text::join(far.iter().map(|one| &one.profile), ", ")
        )
    }));
    lines.iter().map(|line| format!("\n  {line}")).collect()
}
