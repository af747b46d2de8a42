//! What fields hold in messages that a role's conditions leave out.

use std::fmt;

use serde::Serialize;

use crate::{
    decode::{
        field::Wanted,
        path::FieldPath,
        value::{FieldValue, Number},
    },
    source::{
        bind::{BoundRole, Slot},
        profile::Test,
    },
    text::{self, Foreign, escaped},
};

/// The most values of a field that are remembered for a report.
const REMEMBERED: usize = 10;

/// A field that a role's conditions look at, and what it held in messages for which none of them holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnmetCondition {
    /// The field.
    pub field: FieldPath,
    /// What it must hold, any of these.
    pub wanted: Vec<Test>,
    /// What it held instead: the first few values.
    pub found: Vec<FoundValue>,
    /// In how many messages it held yet another value.
    pub others: u64,
}

/// A value, and how many messages had it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FoundValue {
    /// The value.
    pub value: Foreign,
    /// How many messages had it.
    pub messages: u64,
}

impl fmt::Display for UnmetCondition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let times = |count| match count {
            1 => "once".to_owned(),
            count => format!("{count} times"),
        };
        let found = self.found.iter();
        let found = found.map(|found| format!("{} ({})", found.value, times(found.messages)));
        let others = (self.others > 0).then(|| format!("something else ({})", times(self.others)));
        let found = text::join(found.chain(others), ", ");
        let wanted = self.wanted.iter().map(|test| match test {
            Test::Is(number) => number.to_string(),
            Test::Says(text) => quoted(text),
            Test::Contains(text) => format!("a text with {}", quoted(text)),
            Test::IsInteger(true) => "an integer".to_owned(),
            Test::IsInteger(false) => "a number with a decimal point".to_owned(),
            Test::HasBits(bits) => format!("any bit of {bits}"),
        });
        let wanted = text::join(wanted, " or ");
        write!(f, "{} was {found}, wanted {wanted}", self.field)
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

/// Counts what the fields of one role's conditions hold in messages for which none of them holds.
#[derive(Debug, Clone)]
pub struct UnmetTracker {
    fields: Vec<Tracked>,
    /// How many such messages there were.
    pub messages: u64,
}

#[derive(Debug, Clone)]
struct Tracked {
    slot: Slot,
    field: FieldPath,
    wanted: Vec<Test>,
    held: Vec<(Held, u64)>,
    others: u64,
}

/// What a field held.
#[derive(Debug, Clone, PartialEq)]
enum Held {
    Number(Number),
    Text(Vec<u8>),
    /// A list, or a text that is too long to be kept.
    Other,
}

impl Held {
    fn of(value: &FieldValue) -> Self {
        match (value.exact(), value.text()) {
            (Some(number), _) => Self::Number(number),
            (None, Some(text)) => Self::Text(text.to_vec()),
            (None, None) => Self::Other,
        }
    }

    /// Whether it is what a field holds now, without taking memory for that.
    fn is(&self, value: &FieldValue) -> bool {
        match self {
            Self::Number(number) => value.exact() == Some(*number),
            Self::Text(text) => value.text() == Some(text),
            Self::Other => value.exact().is_none() && value.text().is_none(),
        }
    }
}

impl UnmetTracker {
    /// Tracks the fields of a role's conditions. The role's slots are those of the wanted fields.
    pub fn new(role: &BoundRole, wanted: &[Wanted]) -> Self {
        let mut fields: Vec<Tracked> = Vec::new();
        for condition in role
            .readings
            .iter()
            .filter_map(|reading| reading.condition.as_ref())
        {
            let slot = condition.field;
            let test = condition.test.clone();
            match fields.iter_mut().find(|field| field.slot == slot) {
                Some(known) => known.wanted.push(test),
                None => fields.push(Tracked {
                    slot,
                    field: wanted[slot].path.clone(),
                    wanted: vec![test],
                    held: Vec::new(),
                    others: 0,
                }),
            }
        }
        Self {
            fields,
            messages: 0,
        }
    }

    /// Counts a message for which no condition holds.
    pub fn note(&mut self, values: &[FieldValue]) {
        self.messages += 1;
        for field in &mut self.fields {
            let value = &values[field.slot];
            match field.held.iter_mut().find(|(held, _)| held.is(value)) {
                Some((_, count)) => *count += 1,
                None => field.add(Held::of(value), 1),
            }
        }
    }

    /// Adds what another tracker of the same role has counted.
    pub fn merge(&mut self, other: &Self) {
        self.messages += other.messages;
        for (field, more) in self.fields.iter_mut().zip(&other.fields) {
            for (held, count) in &more.held {
                field.add(held.clone(), *count);
            }
            field.others += more.others;
        }
    }

    /// What was found.
    pub fn unmet(&self) -> impl Iterator<Item = UnmetCondition> {
        let any = self.messages > 0;
        let fields = self.fields.iter().filter(move |_| any);
        fields.map(|field| UnmetCondition {
            field: field.field.clone(),
            wanted: field.wanted.clone(),
            found: field
                .held
                .iter()
                .map(|(held, count)| held.found(*count))
                .collect(),
            others: field.others,
        })
    }
}

impl Tracked {
    fn add(&mut self, held: Held, count: u64) {
        match self.held.iter().position(|(known, _)| *known == held) {
            Some(place) => self.held[place].1 += count,
            None if self.held.len() < REMEMBERED => self.held.push((held, count)),
            None => self.others += count,
        }
    }
}

impl Held {
    fn found(&self, messages: u64) -> FoundValue {
        let value = match self {
            Self::Number(number) => number.to_f64().to_string(),
            Self::Text(text) => format!("\"{}\"", String::from_utf8_lossy(text)),
            Self::Other => "a list or a long text".to_owned(),
        };
        FoundValue {
            value: value.into(),
            messages,
        }
    }
}
