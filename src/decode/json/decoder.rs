//! Reading numbers and strings from JSON messages.

use std::fmt;

use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor};

use super::{fault, non_finite};
use crate::decode::{
    fault::Fault,
    field::Shape,
    tree::{Branches, FieldTree, First},
    value::{FieldValue, Number, Slots, Undecodable},
};

/// Reads the wanted fields of one channel's messages.
#[derive(Debug)]
pub struct JsonDecoder {
    fields: Branches<String, JsonLeaf>,
}

pub type JsonTree = FieldTree<String, JsonLeaf>;

/// How a wanted field is read.
#[derive(Debug)]
pub struct JsonLeaf {
    slot: usize,
    /// Whether text is wanted, and not numbers.
    pub is_text: bool,
}

impl JsonLeaf {
    pub fn new(shape: Shape, slot: usize) -> Self {
        Self {
            slot,
            is_text: shape == Shape::Text,
        }
    }
}

impl JsonDecoder {
    pub fn new(fields: Branches<String, JsonLeaf>) -> Self {
        Self { fields }
    }

    /// Reads a message's wanted fields into their slots, which must be cleared.
    pub fn decode(&self, message: &[u8], slots: &mut Slots) -> Result<(), Undecodable> {
        let mut quoted = std::mem::take(&mut slots.quoted);
        let decoded = match quoted.is_empty() {
            true => self.read(message, slots).or_else(|error| {
                if !non_finite::quote(message, &mut quoted) {
                    return Err(error);
                }
                slots.clear();
                self.read(&quoted, slots)
            }),
            // The channel has shown such numbers before.
            false => match non_finite::quote(message, &mut quoted) {
                true => self.read(&quoted, slots),
                false => self.read(message, slots),
            },
        };
        slots.quoted = quoted;
        Ok(decoded?)
    }

    /// What is wrong with a message that cannot be decoded.
    pub fn explain(&self, message: &[u8], slots: &mut Slots) -> Option<Fault> {
        let error = self.read(&non_finite::blank(message), slots).err()?;
        let of_value = match error.is_data() {
            true => fault::of_values(&self.fields, message),
            false => None,
        };
        of_value.or_else(|| Some(fault::at_error(message, &error)))
    }

    fn read(&self, message: &[u8], slots: &mut Slots) -> Result<(), serde_json::Error> {
        let mut json = serde_json::Deserializer::from_slice(message);
        let fields = &self.fields;
        MessageSeed { fields, slots }.deserialize(&mut json)?;
        json.end()
    }
}

impl From<serde_json::Error> for Undecodable {
    fn from(_: serde_json::Error) -> Self {
        Self::Malformed
    }
}

/// Reads an object: what is wanted of it goes to the slots, the rest is skipped without being built.
struct MessageSeed<'a> {
    fields: &'a [(String, JsonTree)],
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

/// Reads a key and finds what is wanted of it, without making a string of it.
struct KeySeed<'a> {
    fields: &'a [(String, JsonTree)],
}

impl<'de, 'a> DeserializeSeed<'de> for KeySeed<'a> {
    type Value = Option<&'a JsonTree>;

    fn deserialize<D: serde::Deserializer<'de>>(
        self,
        deserializer: D,
    ) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl<'a> Visitor<'_> for KeySeed<'a> {
    type Value = Option<&'a JsonTree>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Self::Value, E> {
        let mut fields = self.fields.iter();
        let found = fields.find(|(wanted, _)| wanted == name);
        Ok(found.map(|(_, node)| node))
    }
}

/// Reads the value of a key, whatever it is.
struct NodeSeed<'a> {
    node: &'a JsonTree,
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
            FieldTree::First(first) => deserializer.deserialize_any(FirstVisitor { first, slots }),
            FieldTree::Leaf(leaf) => {
                let visitor = LeafVisitor {
                    is_text: leaf.is_text,
                    is_element: false,
                    slot: &mut slots.values[leaf.slot],
                };
                visitor.deserialize(deserializer)
            }
        }
    }
}

/// Reads a list: what is wanted of its elements goes to the slots.
struct ElementsVisitor<'a> {
    elements: &'a [(usize, JsonTree)],
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

/// Reads a list up to the first elements that satisfy filters.
struct FirstVisitor<'a> {
    first: &'a First<String, JsonLeaf>,
    slots: &'a mut Slots,
}

impl<'de> Visitor<'de> for FirstVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list")
    }

    /// `null` for a list leaves all of its elements missing.
    fn visit_unit<E: serde::de::Error>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let First { element, picks, .. } = self.first;
        while !picks.are_found(self.slots) {
            let slots = &mut *self.slots;
            let fields = element;
            if seq
                .next_element_seed(MessageSeed { fields, slots })?
                .is_none()
            {
                return Ok(());
            }
            picks.take(self.slots);
        }
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        Ok(())
    }
}

/// Reads a number, a boolean, a list of numbers, a string, or `null` for a missing field.
struct LeafVisitor<'a> {
    /// Whether text is wanted. A number in its place is kept as the number that it is.
    is_text: bool,
    /// Whether the value is an element of a list, so that it cannot be a list itself.
    is_element: bool,
    slot: &'a mut FieldValue,
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
        self.slot.set(number);
        Ok(())
    }

    fn visit_i64<E: serde::de::Error>(self, number: i64) -> Result<(), E> {
        self.slot.set(number);
        Ok(())
    }

    fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<(), E> {
        self.slot.set(number);
        Ok(())
    }

    fn visit_bool<E: serde::de::Error>(self, truth: bool) -> Result<(), E> {
        self.slot.set(truth);
        Ok(())
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<(), E> {
        if self.is_text {
            self.slot.set_text(text.as_bytes());
        } else {
            // As protobuf's JSON form has 64-bit integers, `NaN` and `Infinity`
            // (<https://protobuf.dev/programming-guides/json/>), and some loggers all numbers.
            let not_a_number = || E::invalid_type(Unexpected::Str(text), &"a number");
            self.slot
                .set(Number::in_text(text).ok_or_else(not_a_number)?);
        }
        Ok(())
    }

    fn visit_unit<E: serde::de::Error>(self) -> Result<(), E> {
        self.slot.clear();
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        if self.is_element || self.is_text {
            return Err(serde::de::Error::invalid_type(Unexpected::Seq, &"a number"));
        }
        self.slot.set_empty_list();
        let mut element = FieldValue::default();
        let mut read_element = || {
            seq.next_element_seed(LeafVisitor {
                is_text: false,
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
