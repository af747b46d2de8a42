//! Messages as bytes: CDR, ROS 1, protobuf and JSON, with junk in every field that is not wanted.

use serde_json::Value as Json;

use super::definition::{Count, Field, Kind, Number, Value, Wanted};

/// What a field of one message holds.
#[derive(Debug)]
pub enum Content {
    Number(Number, f64),
    Text(String),
    List(Count, Vec<Content>),
    Message(Vec<(Field, Content)>),
}

/// How the bytes of a channel's messages are laid out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layout {
    Cdr { big_endian: bool },
    Ros1,
    Json,
    Protobuf { packed: bool },
}

impl Layout {
    pub fn message_encoding(self) -> &'static str {
        match self {
            Self::Cdr { .. } => "cdr",
            Self::Ros1 => "ros1",
            Self::Json => "json",
            Self::Protobuf { .. } => "protobuf",
        }
    }

    pub fn encode(self, message: &Content) -> Vec<u8> {
        match self {
            Self::Cdr { big_endian } => Cdr::encode(message, big_endian),
            Self::Ros1 => {
                let mut out = Vec::new();
                ros1(message, &mut out);
                out
            }
            Self::Json => serde_json::to_vec(&json(message)).expect("JSON"),
            Self::Protobuf { packed } => {
                let mut out = Vec::new();
                protobuf(message, packed, &mut out);
                out
            }
        }
    }
}

// ---- Messages ----

/// A message with the wanted fields as given, and junk in all others: numbers that are not 0, some of them NaN,
/// and texts and lists whose length changes from message to message.
pub fn fill(fields: &[Field], wanted: Wanted, message: usize) -> Content {
    let mut filler = Filler {
        wanted,
        junk: message,
    };
    let content = filler.message("", fields);
    let unknown: Vec<&str> = filler.wanted.paths().collect();
    assert!(unknown.is_empty(), "the definition has no {unknown:?}");
    content
}

struct Filler {
    wanted: Wanted,
    junk: usize,
}

impl Filler {
    fn message(&mut self, path: &str, fields: &[Field]) -> Content {
        let join = |name: &str| match path {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        let fill = |field: &Field| (field.clone(), self.field(&join(&field.name), field));
        Content::Message(fields.iter().map(fill).collect())
    }

    fn field(&mut self, path: &str, field: &Field) -> Content {
        let length = match (field.count, self.wanted.length(path)) {
            (Count::One, _) => return self.single(path, &field.kind),
            (Count::Exactly(length), _) => length,
            (Count::Any, 0) => self.next_junk() % 4,
            (Count::Any, length) => length,
        };
        let elements = (0..length).map(|i| self.single(&format!("{path}[{i}]"), &field.kind));
        Content::List(field.count, elements.collect())
    }

    fn single(&mut self, path: &str, kind: &Kind) -> Content {
        match (kind, self.wanted.take(path)) {
            (Kind::Message(fields), None) => self.message(path, fields),
            (Kind::Text, Some(Value::Text(text))) => Content::Text(text),
            (Kind::Text, None) => Content::Text("junk ".repeat(self.next_junk() % 4)),
            (Kind::Number(number), Some(Value::Number(value))) => Content::Number(*number, value),
            (Kind::Number(number), None) => Content::Number(*number, self.junk_number(*number)),
            (_, Some(value)) => panic!("{path} cannot hold {value:?}"),
        }
    }

    fn junk_number(&mut self, number: Number) -> f64 {
        let junk = self.next_junk();
        match number {
            Number::Bool => 1.0,
            Number::F32 | Number::F64 if junk.is_multiple_of(5) => f64::NAN,
            Number::F32 | Number::F64 => junk as f64 / 8.0 + 0.125,
            _ => (junk + 1) as f64,
        }
    }

    /// A whole number below 100 that looks like chance.
    fn next_junk(&mut self) -> usize {
        self.junk = self
            .junk
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.junk >> 33) % 100
    }
}

impl Number {
    fn size(self) -> usize {
        match self {
            Self::Bool | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    fn little_endian(self, value: f64) -> Vec<u8> {
        match self {
            Self::F32 => (value as f32).to_le_bytes().to_vec(),
            Self::F64 => value.to_le_bytes().to_vec(),
            _ => (value as i64).to_le_bytes()[..self.size()].to_vec(),
        }
    }
}

// ---- CDR, as ROS 2 writes it (XCDR1) ----

struct Cdr {
    big_endian: bool,
    body: Vec<u8>,
}

impl Cdr {
    fn encode(message: &Content, big_endian: bool) -> Vec<u8> {
        let mut cdr = Self {
            big_endian,
            body: Vec::new(),
        };
        cdr.put(message);
        [&[0, u8::from(!big_endian), 0, 0], &cdr.body[..]].concat()
    }

    fn put(&mut self, content: &Content) {
        match content {
            Content::Number(number, value) => self.put_number(*number, *value),
            Content::Text(text) => {
                self.put_number(Number::U32, text.len() as f64 + 1.0);
                self.body.extend(text.bytes().chain([0]));
            }
            Content::List(count, elements) => {
                if *count == Count::Any {
                    self.put_number(Number::U32, elements.len() as f64);
                }
                elements.iter().for_each(|element| self.put(element));
            }
            Content::Message(fields) => fields.iter().for_each(|(_, content)| self.put(content)),
        }
    }

    /// Aligned to its size, with padding that is not 0.
    fn put_number(&mut self, number: Number, value: f64) {
        self.body
            .resize(self.body.len().next_multiple_of(number.size()), 0xaa);
        let mut bytes = number.little_endian(value);
        if self.big_endian {
            bytes.reverse();
        }
        self.body.extend(bytes);
    }
}

// ---- ROS 1 ----

fn ros1(content: &Content, out: &mut Vec<u8>) {
    let length = |length: usize| (length as u32).to_le_bytes();
    match content {
        Content::Number(number, value) => out.extend(number.little_endian(*value)),
        Content::Text(text) => {
            out.extend(length(text.len()));
            out.extend(text.bytes());
        }
        Content::List(count, elements) => {
            if *count == Count::Any {
                out.extend(length(elements.len()));
            }
            elements.iter().for_each(|element| ros1(element, out));
        }
        Content::Message(fields) => fields.iter().for_each(|(_, content)| ros1(content, out)),
    }
}

// ---- JSON ----

fn json(content: &Content) -> Json {
    match content {
        Content::Number(Number::Bool, value) => Json::from(*value != 0.0),
        // Null for NaN.
        Content::Number(number, value) if number.is_float() => Json::from(*value),
        Content::Number(_, value) => Json::from(*value as i64),
        Content::Text(text) => Json::from(text.as_str()),
        Content::List(_, elements) => elements.iter().map(json).collect(),
        Content::Message(fields) => fields
            .iter()
            .map(|(field, content)| (field.name.clone(), json(content)))
            .collect(),
    }
}

// ---- Protobuf: without presence, a field of its default value is left out ----

const VARINT: u32 = 0;
const FIXED64: u32 = 1;
const LENGTH_DELIMITED: u32 = 2;
const FIXED32: u32 = 5;

fn protobuf(content: &Content, packed: bool, out: &mut Vec<u8>) {
    let Content::Message(fields) = content else {
        panic!("protobuf writes messages")
    };
    for (field, content) in fields {
        match content {
            Content::List(_, elements) => match field.kind {
                Kind::Number(_) if packed => {
                    let numbers = elements.iter().flat_map(protobuf_number);
                    delimited(field.number, &numbers.collect::<Vec<u8>>(), out);
                }
                _ => elements
                    .iter()
                    .for_each(|element| protobuf_field(field, element, packed, out)),
            },
            Content::Number(_, value) if *value == 0.0 && packed => {}
            content => protobuf_field(field, content, packed, out),
        }
    }
}

fn protobuf_field(field: &Field, content: &Content, packed: bool, out: &mut Vec<u8>) {
    match content {
        Content::Number(number, _) => {
            let wire_type = match number {
                Number::F32 => FIXED32,
                Number::F64 => FIXED64,
                _ => VARINT,
            };
            varint(u64::from(field.number << 3 | wire_type), out);
            out.extend(protobuf_number(content));
        }
        Content::Text(text) => delimited(field.number, text.as_bytes(), out),
        message => {
            let mut inner = Vec::new();
            protobuf(message, packed, &mut inner);
            delimited(field.number, &inner, out);
        }
    }
}

fn protobuf_number(content: &Content) -> Vec<u8> {
    let Content::Number(number, value) = content else {
        panic!("a number")
    };
    if number.is_float() {
        return number.little_endian(*value);
    }
    let mut out = Vec::new();
    varint(*value as i64 as u64, &mut out);
    out
}

fn delimited(number: u32, bytes: &[u8], out: &mut Vec<u8>) {
    varint(u64::from(number << 3 | LENGTH_DELIMITED), out);
    varint(bytes.len() as u64, out);
    out.extend(bytes);
}

fn varint(mut value: u64, out: &mut Vec<u8>) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}
