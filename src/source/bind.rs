//! A profile's alternatives → how the messages of one channel are read, with each field resolved to the slot that the
//! decoder fills.

mod binder;
mod error;
mod frames;
mod ids;
mod resets;

use super::profile::{
    Alternative, Condition, Profile, RoleFields, SampleTime, convention::TimeUnit,
};
use crate::{
    decode::{
        path::{FieldPath, Filter},
        trial::Trial,
    },
    sample::Kind,
    text::Foreign,
};
pub use binder::Binder;
pub use error::BindError;
use frames::bind_frames;
pub use frames::{BoundFrames, BoundNames, ChannelName, Contradiction, SaidBy};
pub use ids::BoundId;
use ids::bind_ids;
use resets::ResetCounts;

/// Where the decoder puts a field's value.
pub type Slot = usize;

/// How the messages of a channel are read as samples of one kind.
#[derive(Debug)]
pub struct BoundRole {
    pub kind: Kind,
    /// The fields of the first reading, as the profile names them.
    pub fields: Vec<FieldPath>,
    /// What it requires of the messages, as the profile says it.
    pub select: Vec<Filter>,
    /// The ways to read a message, of which the first whose condition holds is used.
    pub readings: Vec<Reading>,
    /// Fields that tell sources apart.
    pub ids: Vec<BoundId>,
}

/// One way to read a message as a sample.
#[derive(Debug)]
pub struct Reading {
    /// What a message must satisfy to be of this source.
    pub select: Vec<Filter<Slot>>,
    /// What is noted of these filters at first: nothing.
    pub trials: Vec<Trial>,
    pub condition: Option<Condition<Slot>>,
    pub time: SampleTime<TimeSlots>,
    pub valid: Vec<Slot>,
    pub fields: RoleFields<Slot>,
    pub frames: BoundFrames,
    /// Counts of the estimator's jumps, beside a position.
    pub resets: ResetCounts,
}

/// The slots that hold the time of a sample.
#[derive(Debug, Clone, Copy)]
pub enum TimeSlots {
    Number { slot: Slot, unit: TimeUnit },
    SecondsAndNanoseconds([Slot; 2]),
}

/// Binds those alternatives of a role for which the schema has the fields, up to the first that reads any message.
///
/// # Errors
/// None fits; the error lists what is missing for the closest one.
pub fn bind_role(
    binder: &mut Binder,
    profile: &Profile,
    said_by: SaidBy,
    kind: Kind,
    alternatives: &[&Alternative],
) -> Result<BoundRole, BindError> {
    let mut role = BoundRole {
        kind,
        fields: Vec::new(),
        select: Vec::new(),
        readings: Vec::new(),
        ids: Vec::new(),
    };
    let mut nearest: Option<(f64, BindError)> = None;
    for alternative in alternatives {
        let fields = alternative.fields.fields();
        match binder.attempt(|binder| bind_reading(binder, profile, said_by, alternative)) {
            Ok(reading) => {
                if role.readings.is_empty() {
                    let primary = alternative.location.primary.as_ref();
                    let among = primary.map(|primary| &primary.among);
                    role.ids = bind_ids(binder, fields[0], among);
                    role.fields = fields.into_iter().cloned().collect();
                    role.select = alternative.location.select.clone();
                }
                role.readings.push(reading);
                if alternative.reads_any_message() {
                    break;
                }
            }
            Err(error) if error.is_of_reading() => return Err(error),
            Err(error) => {
                let share = error.missing_fields() as f64 / fields.len() as f64;
                if nearest.as_ref().is_none_or(|(least, _)| share < *least) {
                    nearest = Some((share, error));
                }
            }
        }
    }
    match nearest {
        Some((_, error)) if role.readings.is_empty() => Err(error),
        _ => Ok(role),
    }
}

fn bind_reading(
    binder: &mut Binder,
    profile: &Profile,
    said_by: SaidBy,
    alternative: &Alternative,
) -> Result<Reading, BindError> {
    let Alternative { location, fields } = alternative;
    let condition = location.when.as_ref();
    Ok(Reading {
        select: (location.select.iter())
            .map(|filter| binder.filter(filter))
            .collect::<Result<_, _>>()?,
        trials: location.select.iter().map(Trial::of).collect(),
        condition: condition.map(|when| binder.condition(when)).transpose()?,
        fields: binder.role(fields)?,
        valid: (location.valid.iter())
            .map(|path| binder.number(path))
            .collect::<Result<_, _>>()?,
        time: binder.time(location.time.as_ref().unwrap_or(&profile.time))?,
        frames: bind_frames(binder, alternative, said_by)?,
        resets: ResetCounts::bind(binder, fields),
    })
}

/// Selects those alternatives that are for a type of message.
///
/// # Errors
/// All are for other types.
pub fn for_type<'p>(
    schema_name: &str,
    alternatives: impl Iterator<Item = &'p Alternative>,
) -> Result<Vec<&'p Alternative>, BindError> {
    let (fitting, others): (Vec<_>, Vec<_>) =
        alternatives.partition(|alternative| alternative.location.is_for(schema_name));
    match others.first() {
        Some(other) if fitting.is_empty() => Err(BindError::OtherType {
            name: schema_name.into(),
            wanted: other.location.schemas.iter().map(Foreign::from).collect(),
        }),
        _ => Ok(fitting),
    }
}
