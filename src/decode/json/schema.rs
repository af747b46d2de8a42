//! What a JSON Schema and a channel's first messages say about its messages.

use std::cell::Cell;

use serde_json::{Map, Value};

use super::{
    decoder::{JsonDecoder, JsonLeaf},
    first_messages::FirstMessages,
    non_finite,
};
use crate::{
    decode::{
        error::{Listing, SchemaError},
        field::{FieldKind, Shape, Wanted},
        path::{FieldPath, Filter, PathStep},
        resolve::{Node, resolve, walk},
        tree::tree,
        value::{FieldValue, Number, Slots},
    },
    text::Foreign,
};

/// What it takes for the messages of a JSON channel to have a field. A schema may list fields that they do not have,
/// because it is that of other topics too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// The schema lists it, or one of the first messages has it.
    Listed,
    /// The schema requires it, or one of the first messages has it, and not null.
    Shown,
}

/// What is known about a channel's messages: what its JSON Schema lists, and what its first messages contain.
#[derive(Debug)]
pub struct JsonSchema<'a> {
    schema: Value,
    first_messages: &'a FirstMessages<'a>,
    channel_id: u16,
    proof: Proof,
    /// Whether messages of other types may follow the first ones, with other fields.
    has_several_types: Cell<bool>,
}

impl<'a> JsonSchema<'a> {
    /// Reads the JSON Schema of a channel, which may be empty.
    pub fn new(
        schema: &[u8],
        first_messages: &'a FirstMessages<'a>,
        channel_id: u16,
        proof: Proof,
    ) -> Result<Self, SchemaError> {
        Ok(Self {
            schema: match schema {
                b"" => Value::Null,
                schema => non_finite::parse(schema).map_err(SchemaError::JsonSchema)?,
            },
            first_messages,
            channel_id,
            proof,
            has_several_types: Cell::new(false),
        })
    }

    /// From now on, fields that the first messages do not have are looked for in more of them.
    pub fn expect_several_types(&self) {
        self.has_several_types.set(true);
    }

    /// The kind of field a path leads to: as the JSON Schema says or, if that leaves it open, as in one of the first
    /// messages.
    pub fn kind_of(&self, path: &FieldPath) -> Result<FieldKind, SchemaError> {
        let described = resolve(self.root(), path)?.node;
        let kind = described.kind();
        let is_enough = self.proof == Proof::Listed || self.requires(path);
        if kind == FieldKind::Number && is_enough {
            return Ok(kind);
        }
        let mut messages = self.first_messages.of(self.channel_id)?;
        let mut shown = Shown::by(messages, path);
        let is_open = match shown {
            Shown::Null | Shown::BelowNull => true,
            Shown::Value(_) => false,
            Shown::Nothing => self.has_several_types.get(),
        };
        if is_open {
            match self.first_messages.more_of(self.channel_id)? {
                Some(more) => {
                    messages = more;
                    shown = Shown::by(messages, path);
                }
                None => return Ok(kind),
            }
        }
        // Messages too long to be examples show nothing, and disprove nothing.
        let is_enough = is_enough || messages.is_empty();
        match shown {
            Shown::Value(value) if kind == FieldKind::Unknown => Ok(value.kind()),
            Shown::Value(_) => Ok(kind),
            Shown::Null if is_enough => Ok(kind),
            _ if described.schema.is_some() && is_enough => Ok(kind),
            _ if let Some(fault) = self.first_messages.fault_of(self.channel_id) => {
                Err(SchemaError::NotJson(fault.clone()))
            }
            _ => Err(SchemaError::NoSuchField {
                missing: vec![path.clone()],
                place: Listing::FirstMessages,
                available: (messages.iter().filter_map(Value::as_object))
                    .max_by_key(|fields| fields.len())
                    .map_or_else(Vec::new, names)
                    .into_iter()
                    .map(Foreign::from)
                    .collect(),
            }),
        }
    }

    /// Whether the JSON Schema says that every message has what a path leads to.
    fn requires(&self, path: &FieldPath) -> bool {
        let mut place = &self.schema;
        path.steps().iter().all(|step| {
            let (is_required, next) = match step {
                PathStep::Name(name) => {
                    let required = place["required"].as_array();
                    let is_required =
                        required.is_some_and(|names| names.iter().any(|one| one == name));
                    (is_required, &place["properties"][name])
                }
                &PathStep::Index(index) => {
                    let least = place["minItems"].as_u64();
                    (least > Some(index as u64), &place["items"])
                }
                PathStep::First(_) => (false, &place["items"]),
            };
            place = next;
            is_required
        })
    }

    /// Makes a decoder that puts the n-th wanted field into slot n.
    pub fn decoder(&self, wanted: &[Wanted]) -> Result<(JsonDecoder, Slots), SchemaError> {
        let leaf = |_: &_, shape, slot| Some(JsonLeaf::new(shape, slot));
        let (fields, slots) = tree(&self.root(), wanted, leaf)?;
        Ok((JsonDecoder::new(fields), slots))
    }

    fn root(&self) -> JsonSchemaNode<'_> {
        JsonSchemaNode {
            schema: Some(&self.schema),
            whole: &self.schema,
        }
    }
}

/// What messages show of a place, the least first.
#[derive(Debug, Clone, Copy)]
enum Shown<'a> {
    Nothing,
    /// There is null on the way to it, or a list that is too short. It may be there later.
    BelowNull,
    Null,
    Value(&'a Value),
}

impl<'a> Shown<'a> {
    /// The most that any of these messages shows.
    fn by(messages: &'a [Value], path: &FieldPath) -> Self {
        let rank = |shown: &Self| match shown {
            Self::Nothing => 0,
            Self::BelowNull => 1,
            Self::Null => 2,
            Self::Value(_) => 3,
        };
        let shown = messages.iter().map(|message| Self::by_one(message, path));
        shown.max_by_key(rank).unwrap_or(Self::Nothing)
    }

    fn by_one(message: &'a Value, path: &FieldPath) -> Self {
        match walk(message, path) {
            Ok(place) if place.node.is_null() => Self::Null,
            Ok(place) => Self::Value(place.node),
            // A message that is not JSON.
            Err(_) if message.is_null() => Self::Nothing,
            Err(end) => match (end.node, end.step()) {
                (Value::Null, _) | (Value::Array(_), PathStep::Index(_) | PathStep::First(_)) => {
                    Self::BelowNull
                }
                _ => Self::Nothing,
            },
        }
    }
}

/// What a JSON Schema says about a place.
#[derive(Debug, Clone, Copy)]
struct JsonSchemaNode<'a> {
    /// The schema of the place; `None` if the whole schema does not list it, so that anything may be there.
    schema: Option<&'a Value>,
    whole: &'a Value,
}

impl Node for JsonSchemaNode<'_> {
    type Name = String;

    fn kind(&self) -> FieldKind {
        let named = self.schema.and_then(|schema| schema["type"].as_str());
        match named {
            Some("number" | "integer" | "boolean") => FieldKind::Number,
            // A string may hold a number, so a message has to show it.
            _ => FieldKind::Unknown,
        }
    }

    /// The fields of the whole message, wherever in it the place is.
    fn fields(&self) -> Option<(Listing, Vec<String>)> {
        Some((Listing::JsonSchema, names(properties(self.whole)?)))
    }

    fn field(&self, name: &str) -> Option<(String, Self)> {
        let schema = match self.schema.and_then(properties) {
            None => None,
            Some(properties) => match properties.get(name) {
                Some(schema) => Some(schema),
                // A schema that refers elsewhere may name more fields than these.
                None if properties.values().any(|field| field.get("$ref").is_some()) => None,
                None => return None,
            },
        };
        Some((name.to_owned(), Self { schema, ..*self }))
    }

    fn element(&self, _: usize) -> Option<Self> {
        let schema = self.schema.and_then(|schema| schema.get("items"));
        Some(Self { schema, ..*self })
    }
}

/// A value of a message.
impl Node for &Value {
    type Name = ();

    fn kind(&self) -> FieldKind {
        match self {
            Value::Null => FieldKind::Unknown,
            Value::Bool(_) | Value::Number(_) => FieldKind::Number,
            Value::String(text) if Number::in_text(text).is_some() => FieldKind::Number,
            Value::String(_) => FieldKind::Text,
            Value::Array(_) => FieldKind::List,
            Value::Object(fields) => FieldKind::Message(names(fields)),
        }
    }

    fn fields(&self) -> Option<(Listing, Vec<String>)> {
        let fields = self.as_object()?;
        Some((Listing::FirstMessages, names(fields)))
    }

    fn field(&self, name: &str) -> Option<((), Self)> {
        Some(((), self.get(name)?))
    }

    fn element(&self, index: usize) -> Option<Self> {
        self.get(index)
    }

    /// The one that satisfies the filters or, if there is none here, one that shows what elements have.
    fn first(&self, filters: &[Filter]) -> Option<Self> {
        let list = self.as_array()?;
        let is_meant = |element: &&Value| filters.iter().all(|filter| holds(filter, element));
        list.iter().find(is_meant).or(list.first())
    }
}

/// Whether an element of a list satisfies a filter.
fn holds(filter: &Filter, element: &Value) -> bool {
    let mut value = FieldValue::default();
    match walk(element, &filter.field).map(|place| place.node) {
        Ok(Value::Number(number)) => {
            value.set(Number::in_text(&number.to_string()).unwrap_or_default())
        }
        Ok(&Value::Bool(truth)) => value.set(truth),
        Ok(Value::String(text)) => match (filter.value.shape(), Number::in_text(text)) {
            (Shape::Number, Some(number)) => value.set(number),
            _ => value.set_text(text.as_bytes()),
        },
        _ => {}
    }
    filter.with_field(0).holds(&[value])
}

/// The fields that a schema lists, if it lists any.
fn properties(schema: &Value) -> Option<&Map<String, Value>> {
    let properties = schema.get("properties")?.as_object()?;
    (!properties.is_empty()).then_some(properties)
}

fn names(fields: &Map<String, Value>) -> Vec<String> {
    fields.keys().cloned().collect()
}
