//! Forms in which a publisher's messages are written: what is one alternative in the text of a profile is one for each.

use serde::Deserialize;
use toml::{
    Spanned,
    de::{DeArray, DeTable, DeValue},
};

use super::WITH_PATHS;

/// Keys below those that have paths, whose texts are none.
const NO_PATHS: [&str; 8] = [
    "unit",
    "altitude_unit",
    "order",
    "positive",
    "frame",
    "says",
    "contains",
    "reference",
];

/// One of the forms.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Form {
    /// The field in which all others are; empty if they are in the message itself.
    below: String,
    /// The field that says of which type a message is.
    type_field: Option<String>,
}

impl Form {
    /// Writes an alternative for messages of this form: its fields are further below, and its messages are of the type that
    /// it has in its key `type`.
    pub fn of<'t>(&self, alternative: &Spanned<DeValue<'t>>) -> Spanned<DeValue<'t>> {
        let mut alternative = alternative.clone();
        if let DeValue::Table(table) = alternative.get_mut() {
            for (key, value) in table.iter_mut() {
                if WITH_PATHS.contains(&key.get_ref().as_ref()) {
                    self.lower(value);
                }
            }
            if let Some(field) = &self.type_field
                && let Some(DeValue::String(wanted)) = table.get("type").map(Spanned::get_ref)
            {
                let filter = format!("{field}=={}", serde_json::Value::from(wanted.as_ref()));
                let filters = table.entry(Spanned::new(0..0, "select".into()));
                let none = || Spanned::new(0..0, DeValue::Array(DeArray::new()));
                if let DeValue::Array(filters) = filters.or_insert_with(none).get_mut() {
                    filters.push(Spanned::new(0..0, DeValue::String(filter.into())));
                }
                table.remove("type");
            }
        }
        alternative
    }

    /// Puts all paths in a value below the field.
    fn lower(&self, value: &mut Spanned<DeValue>) {
        if self.below.is_empty() {
            return;
        }
        match value.get_mut() {
            DeValue::String(path) => *path = format!("{}.{path}", self.below).into(),
            DeValue::Array(values) => values.iter_mut().for_each(|value| self.lower(value)),
            DeValue::Table(table) => self.lower_in(table),
            _ => {}
        }
    }

    fn lower_in(&self, table: &mut DeTable) {
        let paths = table
            .iter_mut()
            .filter(|(key, _)| !NO_PATHS.contains(&key.get_ref().as_ref()));
        paths.for_each(|(_, value)| self.lower(value));
    }
}
