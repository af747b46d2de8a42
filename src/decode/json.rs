//! Numbers out of JSON messages.

use std::fmt;

use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor};
use serde_json::Value;

use super::{
    error::SchemaError,
    examples::Examples,
    field::{FieldKind, Shape, Wanted},
    path::{FieldPath, PathStep},
    tree::{Branches, FieldTree, Key, tree},
    value::{FieldValue, Number, Slots, Undecodable},
};

/// What is known of a channel's messages: what its JSON Schema lists, and what its first messages have. JSON
/// needs no schema, and its schemas need not name every field.
#[derive(Debug)]
pub struct Schema<'a> {
    schema: Value,
    examples: &'a Examples<'a>,
    channel_id: u16,
}

/// Reads the wanted fields of one channel's messages.
#[derive(Debug)]
pub struct Decoder {
    fields: Branches<String, Leaf>,
}

type Tree = FieldTree<String, Leaf>;

#[derive(Debug)]
struct Leaf {
    slot: usize,
    /// The words among which a text is looked up; `None` where numbers are wanted.
    words: Option<Vec<String>>,
}

impl<'a> Schema<'a> {
    /// Of a channel, whose JSON Schema may be empty.
    pub fn new(
        schema: &[u8],
        examples: &'a Examples<'a>,
        channel_id: u16,
    ) -> Result<Self, SchemaError> {
        let schema = match schema {
            b"" => Value::Null,
            schema => serde_json::from_slice(schema).map_err(|error| SchemaError::Schema {
                problem: format!("its JSON schema cannot be read: {error}"),
            })?,
        };
        Ok(Self {
            schema,
            examples,
            channel_id,
        })
    }

    /// What a path leads to: as the JSON Schema says, and where that leaves it open, in one of the first messages.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        let listed = match look_up(&self.schema, path) {
            Listing::Closed => {
                return Err(no_such_field(
                    path,
                    "its JSON schema",
                    &self.schema["properties"],
                ));
            }
            Listing::As(kind) => return Ok(kind),
            Listing::Untyped => true,
            Listing::Open => false,
        };
        let examples = self.examples.of(self.channel_id)?;
        let found = examples.iter().filter_map(|example| find(example, path));
        match found.max_by_key(|value| !value.is_null()) {
            Some(value) => Ok(kind_of(value)),
            None if listed => Ok(FieldKind::Unknown),
            None => {
                let fields =
                    |example: &&Value| example.as_object().map_or(0, |object| object.len());
                let fullest = examples.iter().max_by_key(fields);
                let place = "the fullest of its first messages";
                Err(no_such_field(path, place, fullest.unwrap_or(&Value::Null)))
            }
        }
    }

    /// A decoder that puts the n-th wanted field into slot n.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<Decoder, SchemaError> {
        let leaves = wanted
            .iter()
            .enumerate()
            .map(|(slot, Wanted { path, shape })| {
                let words = match shape {
                    Shape::Word(words) => Some(words.clone()),
                    Shape::Number | Shape::List => None,
                };
                let keys = path.steps().iter().map(Key::from);
                (path, keys.collect(), Leaf { slot, words })
            });
        Ok(Decoder {
            fields: tree(leaves.collect())?,
        })
    }
}

impl Decoder {
    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        let mut json = serde_json::Deserializer::from_slice(message);
        let fields = &self.fields;
        MessageSeed { fields, slots }.deserialize(&mut json)?;
        Ok(json.end()?)
    }
}

impl From<serde_json::Error> for Undecodable {
    fn from(_: serde_json::Error) -> Self {
        Self::Malformed
    }
}

fn no_such_field(path: &FieldPath, place: &str, object: &Value) -> SchemaError {
    let object = object.as_object();
    SchemaError::NoSuchField {
        lacking: vec![path.clone()],
        place: place.to_owned(),
        available: object.map_or_else(Vec::new, |object| object.keys().cloned().collect()),
    }
}

/// What a JSON Schema says of a field.
enum Listing {
    /// It lists the field, and of which kind it is.
    As(FieldKind),
    /// It lists the field.
    Untyped,
    /// Nothing: there may be fields that it does not list.
    Open,
    /// It lists the fields there, and this one is not among them.
    Closed,
}

fn look_up(schema: &Value, path: &FieldPath) -> Listing {
    let mut within = schema;
    for step in path.steps() {
        let name = match step {
            PathStep::Name(name) => name,
            PathStep::Index(_) => match within.get("items") {
                Some(items) => {
                    within = items;
                    continue;
                }
                None => return Listing::Open,
            },
        };
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
    match within["type"].as_str() {
        Some("number" | "integer" | "boolean") => Listing::As(FieldKind::Number),
        // Text may be a number too, so a message has to tell.
        _ => Listing::Untyped,
    }
}

/// What a path leads to in a message.
fn find<'a>(message: &'a Value, path: &FieldPath) -> Option<&'a Value> {
    path.steps()
        .iter()
        .try_fold(message, |within, step| match step {
            PathStep::Name(name) => within.get(name),
            PathStep::Index(index) => within.get(index),
        })
}

fn kind_of(value: &Value) -> FieldKind {
    match value {
        Value::Null => FieldKind::Unknown,
        Value::Bool(_) | Value::Number(_) => FieldKind::Number,
        Value::String(text) if number_in(text).is_some() => FieldKind::Number,
        Value::String(_) => FieldKind::Text,
        Value::Array(_) => FieldKind::List,
        Value::Object(fields) => FieldKind::Message(fields.keys().cloned().collect()),
    }
}

/// The number that a text is: how the JSON form of protobuf writes 64-bit integers, `NaN` and `Infinity`
/// (<https://protobuf.dev/programming-guides/json/>), and how some loggers write all numbers.
fn number_in(text: &str) -> Option<Number> {
    let integer =
        (text.parse().map(Number::Signed)).or_else(|_| text.parse().map(Number::Unsigned));
    integer
        .or_else(|_| text.trim().parse().map(Number::Real))
        .ok()
}

/// An object: what is wanted of it goes to the slots, the rest is skipped without being built.
struct MessageSeed<'a> {
    fields: &'a [(String, Tree)],
    slots: &'a mut Slots,
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
        let fields = self.fields;
        while let Some(wanted) = map.next_key_seed(KeySeed { fields })? {
            match wanted {
                None => {
                    map.next_value::<IgnoredAny>()?;
                }
                Some(node) => map.next_value_seed(NodeSeed {
                    node,
                    slots: &mut *self.slots,
                })?,
            }
        }
        Ok(())
    }
}

/// A key: what is wanted of it, found without making a string of it.
struct KeySeed<'a> {
    fields: &'a [(String, Tree)],
}

impl<'de, 'a> DeserializeSeed<'de> for KeySeed<'a> {
    type Value = Option<&'a Tree>;

    fn deserialize<D: serde::Deserializer<'de>>(
        self,
        deserializer: D,
    ) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl<'a> Visitor<'_> for KeySeed<'a> {
    type Value = Option<&'a Tree>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Self::Value, E> {
        let mut fields = self.fields.iter();
        let found = fields.find(|(wanted, _)| wanted == name);
        Ok(found.map(|(_, node)| node))
    }
}

/// Whatever a key leads to.
struct NodeSeed<'a> {
    node: &'a Tree,
    slots: &'a mut Slots,
}

impl<'de> DeserializeSeed<'de> for NodeSeed<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        let slots = self.slots;
        match self.node {
            FieldTree::Message(fields) => MessageSeed { fields, slots }.deserialize(deserializer),
            FieldTree::List { elements, .. } => {
                deserializer.deserialize_any(ElementsVisitor { elements, slots })
            }
            FieldTree::Leaf(leaf) => {
                let words = leaf.words.as_deref();
                let slot = &mut slots.values[leaf.slot];
                LeafVisitor {
                    words,
                    is_element: false,
                    slot,
                }
                .deserialize(deserializer)
            }
        }
    }
}

/// A list: what is wanted of its elements goes to the slots.
struct ElementsVisitor<'a> {
    elements: &'a [(usize, Tree)],
    slots: &'a mut Slots,
}

impl<'de> Visitor<'de> for ElementsVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list")
    }

    /// `null` for a list leaves all of its elements missing.
    fn visit_unit<E: serde::de::Error>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        for index in 0.. {
            let more = match self.elements.iter().find(|(wanted, _)| *wanted == index) {
                None => seq.next_element::<IgnoredAny>()?.is_some(),
                Some((_, node)) => {
                    let slots = &mut *self.slots;
                    seq.next_element_seed(NodeSeed { node, slots })?.is_some()
                }
            };
            if !more {
                break;
            }
        }
        Ok(())
    }
}

/// A number, a truth value, a list of numbers, a text, or `null` for a field that is missing.
struct LeafVisitor<'a> {
    words: Option<&'a [String]>,
    /// Whether it stands in a list, in which no further list may stand.
    is_element: bool,
    slot: &'a mut FieldValue,
}

impl LeafVisitor<'_> {
    /// Sets a number, which is none of the wanted words.
    fn set(self, number: impl Into<Number>) {
        match self.words {
            Some(words) => self.slot.set(words.len() as u64),
            None => self.slot.set(number),
        }
    }
}

impl<'de> DeserializeSeed<'de> for LeafVisitor<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for LeafVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, a truth value, a list of numbers, or text")
    }

    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<(), E> {
        self.set(number);
        Ok(())
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<(), E> {
        self.set(number);
        Ok(())
    }

    fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<(), E> {
        self.set(number);
        Ok(())
    }

    fn visit_bool<E: serde::de::Error>(self, truth: bool) -> Result<(), E> {
        self.set(truth);
        Ok(())
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<(), E> {
        match self.words {
            Some(words) => self.slot.set_word(words, text.as_bytes()),
            None => {
                let not_a_number = || E::invalid_type(Unexpected::Str(text), &"a number");
                self.slot.set(number_in(text).ok_or_else(not_a_number)?);
            }
        }
        Ok(())
    }

    fn visit_unit<E: serde::de::Error>(self) -> Result<(), E> {
        self.slot.clear();
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        if self.is_element || self.words.is_some() {
            return Err(serde::de::Error::invalid_type(Unexpected::Seq, &"a number"));
        }
        self.slot.set_empty_list();
        let mut element = FieldValue::default();
        let mut read_element = || {
            seq.next_element_seed(LeafVisitor {
                words: None,
                is_element: true,
                slot: &mut element,
            })
            .map(|read| read.map(|()| element.number().unwrap_or(f64::NAN)))
        };
        while let Some(number) = read_element()? {
            self.slot.push(number);
        }
        Ok(())
    }
}
