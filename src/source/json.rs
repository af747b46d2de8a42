//! Numbers out of JSON messages.

use std::fmt;

use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use super::{
    Unresolved,
    field::{FieldPath, FieldTree, FieldValue, Node, Undecodable, Wanted},
};
use crate::error::Error;

/// Reads the wanted fields of one topic's messages.
#[derive(Debug)]
pub struct Decoder {
    fields: FieldTree<String, usize>,
}

impl Decoder {
    /// Resolves fields. The value of the n-th field goes to slot n.
    ///
    /// JSON needs no schema, and its schemas need not name every field: a field counts as there if the JSON
    /// Schema lists it, or if one of the topic's first messages has it. `examples` gives these when asked.
    pub fn new(
        schema: Option<&[u8]>,
        wanted: &[Wanted],
        examples: impl FnOnce() -> Result<Vec<Vec<u8>>, Error>,
    ) -> Result<Self, Unresolved> {
        let schema: Value = match schema {
            None => Value::Null,
            Some(schema) => serde_json::from_slice(schema).map_err(|error| Unresolved::Schema {
                problem: format!("its JSON schema cannot be read: {error}"),
            })?,
        };
        let mut open = Vec::new();
        let mut lacking = Vec::new();
        for Wanted { path, .. } in wanted {
            match look_up(&schema, path) {
                Listing::Listed => {}
                Listing::Open => open.push(path),
                Listing::Closed => lacking.push(path.clone()),
            }
        }
        if !lacking.is_empty() {
            return Err(no_such_field(
                lacking,
                "its JSON schema",
                &schema["properties"],
            ));
        }
        if !open.is_empty() {
            let lacks = |example: &Value| -> Vec<FieldPath> {
                let lacking = open.iter().filter(|path| !has_field(example, path));
                lacking.map(|path| (*path).clone()).collect()
            };
            let examples = examples()?;
            let fullest = examples
                .iter()
                .filter_map(|json| serde_json::from_slice(json).ok())
                .min_by_key(|example| lacks(example).len())
                .unwrap_or_default();
            let lacking = lacks(&fullest);
            if !lacking.is_empty() {
                let place = "the fullest of its first messages";
                return Err(no_such_field(lacking, place, &fullest));
            }
        }
        let mut fields = FieldTree::new();
        for (slot, wanted) in wanted.iter().enumerate() {
            fields.insert(wanted.path.names(), slot);
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

fn no_such_field(lacking: Vec<FieldPath>, place: &str, object: &Value) -> Unresolved {
    let object = object.as_object();
    Unresolved::NoSuchField {
        lacking,
        place: place.to_owned(),
        available: object.map_or_else(Vec::new, |object| object.keys().cloned().collect()),
    }
}

/// What a JSON Schema says of a field.
enum Listing {
    Listed,
    /// Nothing: there may be fields that it does not list.
    Open,
    /// It lists the fields there, and this one is not among them.
    Closed,
}

fn look_up(schema: &Value, path: &FieldPath) -> Listing {
    let mut within = schema;
    for name in path.names() {
        let properties = within.get("properties").and_then(Value::as_object);
        let Some(properties) = properties.filter(|properties| !properties.is_empty()) else {
            return Listing::Open;
        };
        match properties.get(name) {
            Some(field) => within = field,
            // A schema that refers elsewhere may name more than is seen at a glance.
            None if properties.values().any(|field| field.get("$ref").is_some()) => {
                return Listing::Open;
            }
            None => return Listing::Closed,
        }
    }
    Listing::Listed
}

fn has_field(example: &Value, path: &FieldPath) -> bool {
    let mut names = path.names().iter();
    names
        .try_fold(example, |within, name| within.get(name))
        .is_some()
}

/// An object: what is wanted of it goes to the slots, the rest is skipped without being built.
struct MessageSeed<'a> {
    fields: &'a FieldTree<String, usize>,
    slots: &'a mut [FieldValue],
}

impl<'de> DeserializeSeed<'de> for MessageSeed<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for MessageSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    /// `null` for an object leaves all of its fields missing.
    fn visit_unit<E: serde::de::Error>(self) -> Result<(), E> {
        Ok(())
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
