//! Numbers out of JSON messages.

use std::fmt;

use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use super::{
    Unresolved,
    field::{FieldPath, FieldTree, FieldValue, Node, Undecodable},
};
use crate::error::Error;

/// Reads the wanted fields of one topic's messages.
#[derive(Debug)]
pub struct Decoder {
    fields: FieldTree<String, usize>,
}

impl Decoder {
    /// Resolves fields. The value of the n-th path goes to slot n.
    ///
    /// JSON needs no schema, and its schemas need not name every field: a field counts as there if the JSON
    /// Schema lists it, or if the topic's first message has it. `example` gives that message when asked.
    pub fn new(
        schema: Option<&[u8]>,
        paths: &[FieldPath],
        example: impl FnOnce() -> Result<Option<Vec<u8>>, Error>,
    ) -> Result<Self, Unresolved> {
        let schema: Value = match schema {
            None => Value::Null,
            Some(schema) => serde_json::from_slice(schema).map_err(|error| Unresolved::Schema {
                problem: format!("its JSON schema cannot be read: {error}"),
            })?,
        };
        if let Some(path) = paths.iter().find(|path| !schema_lists(&schema, path)) {
            let properties = &schema["properties"];
            // A schema that refers elsewhere may name more than is seen at a glance.
            if is_self_contained(properties) {
                return Err(no_such_field(path, "its JSON schema", properties));
            }
            let example = example()?.unwrap_or_default();
            let example: Value = serde_json::from_slice(&example).unwrap_or_default();
            if let Some(path) = paths.iter().find(|path| !has_field(&example, path)) {
                return Err(no_such_field(path, "its first message", &example));
            }
        }
        let mut fields = FieldTree::new();
        for (slot, path) in paths.iter().enumerate() {
            fields.insert(path.names(), slot);
        }
        Ok(Self { fields })
    }

    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut [FieldValue]) -> Result<(), Undecodable> {
        let mut json = serde_json::Deserializer::from_slice(message);
        MessageSeed {
            fields: &self.fields,
            slots,
        }
        .deserialize(&mut json)?;
        Ok(json.end()?)
    }
}

fn schema_lists(schema: &Value, path: &FieldPath) -> bool {
    let listed = |within: &Value, name: &String| within.get("properties")?.get(name).cloned();
    path.names()
        .iter()
        .try_fold(schema.clone(), |within, name| listed(&within, name))
        .is_some()
}

fn is_self_contained(properties: &Value) -> bool {
    properties.as_object().is_some_and(|properties| {
        !properties.is_empty() && properties.values().all(|field| field.get("$ref").is_none())
    })
}

fn has_field(example: &Value, path: &FieldPath) -> bool {
    path.names()
        .iter()
        .try_fold(example, |within, name| within.get(name))
        .is_some()
}

fn no_such_field(path: &FieldPath, place: &str, object: &Value) -> Unresolved {
    let keys = object
        .as_object()
        .into_iter()
        .flat_map(|object| object.keys());
    Unresolved::NoSuchField {
        path: path.clone(),
        place: place.to_owned(),
        available: keys.cloned().collect(),
    }
}

/// An object: what is wanted of it goes to the slots, the rest is skipped without being built.
struct MessageSeed<'a> {
    fields: &'a FieldTree<String, usize>,
    slots: &'a mut [FieldValue],
}

impl<'de> DeserializeSeed<'de> for MessageSeed<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for MessageSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(name) = map.next_key::<std::borrow::Cow<str>>()? {
            match self.fields.get(name.as_ref()) {
                None => {
                    map.next_value::<IgnoredAny>()?;
                }
                Some(Node::Message(fields)) => map.next_value_seed(MessageSeed {
                    fields,
                    slots: &mut *self.slots,
                })?,
                Some(Node::Leaf(slot)) => {
                    map.next_value_seed(NumberSeed(&mut self.slots[*slot]))?
                }
            }
        }
        Ok(())
    }
}

/// A number, a truth value, a list of these, or `null` for a field that is missing.
struct NumberSeed<'a>(&'a mut FieldValue);

impl<'de> DeserializeSeed<'de> for NumberSeed<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for NumberSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, a truth value, or a list of them")
    }

    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<(), E> {
        self.0.set(number);
        Ok(())
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<(), E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<(), E> {
        self.visit_f64(number as f64)
    }

    fn visit_bool<E: serde::de::Error>(self, truth: bool) -> Result<(), E> {
        self.visit_f64(f64::from(u8::from(truth)))
    }

    fn visit_unit<E: serde::de::Error>(self) -> Result<(), E> {
        self.0.clear();
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        self.0.set_empty_list();
        while let Some(number) = seq.next_element::<Option<f64>>()? {
            self.0.push(number.unwrap_or(f64::NAN));
        }
        Ok(())
    }
}
