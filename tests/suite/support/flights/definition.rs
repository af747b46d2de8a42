//! Message definitions in their publishers' own words, and messages of them.

use std::{collections::BTreeMap, fs, path::PathBuf};

use nalgebra::{UnitQuaternion, Vector3};
use prost_reflect::{Kind as ProtobufKind, MessageDescriptor};

/// A field of a message.
#[derive(Debug, Clone)]
pub struct Field {
    pub name: String,
    /// In protobuf.
    pub number: u32,
    pub kind: Kind,
    pub count: Count,
}

#[derive(Debug, Clone)]
pub enum Kind {
    Number(Number),
    Text,
    Message(Vec<Field>),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Count {
    One,
    Exactly(usize),
    Any,
}

/// A file of `tests/suite/support/flights/definitions`.
pub fn path(name: &str) -> PathBuf {
    [
        env!("CARGO_MANIFEST_DIR"),
        "tests/suite/support/flights/definitions",
        name,
    ]
    .iter()
    .collect()
}

pub fn read(name: &str) -> String {
    fs::read_to_string(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The fields of a ROS message, from `FOLDER/package/Name.msg`, and the text that recorders put into a log:
/// its definition and those of all that it refers to.
pub fn ros(folder: &str, message: &str) -> (Vec<Field>, String) {
    let mut written = Vec::new();
    let mut text = String::new();
    let fields = ros_message(folder, message, &mut written, &mut text);
    (fields, text)
}

fn ros_message(
    folder: &str,
    message: &str,
    written: &mut Vec<String>,
    text: &mut String,
) -> Vec<Field> {
    let definition = read(&format!("{folder}/{message}.msg"));
    if !written.iter().any(|earlier| earlier == message) {
        if !written.is_empty() {
            text.push_str(&format!("\n{}\nMSG: {message}\n", "=".repeat(80)));
        }
        text.push_str(&definition);
        written.push(message.to_owned());
    }
    let (package, _) = message.split_once('/').expect("a package");
    let lines = definition
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default());
    let fields = lines.filter(|line| !line.trim().is_empty() && !line.contains('='));
    fields
        .enumerate()
        .map(|(place, line)| {
            let mut words = line.split_whitespace();
            let (kind, count) = split_count(words.next().expect("a type"));
            Field {
                name: words.next().expect("a name").to_owned(),
                number: place as u32 + 1,
                kind: ros_kind(kind).unwrap_or_else(|| {
                    let message = match kind.contains('/') {
                        true => kind.to_owned(),
                        false if kind == "Header" => "std_msgs/Header".to_owned(),
                        false => format!("{package}/{kind}"),
                    };
                    Kind::Message(ros_message(folder, &message, written, text))
                }),
                count,
            }
        })
        .collect()
}

fn split_count(kind: &str) -> (&str, Count) {
    match kind.strip_suffix(']').and_then(|list| list.split_once('[')) {
        None => (kind, Count::One),
        Some((kind, "")) => (kind, Count::Any),
        Some((kind, count)) => (kind, Count::Exactly(count.parse().expect("a count"))),
    }
}

/// `None` for another message.
fn ros_kind(name: &str) -> Option<Kind> {
    let number = match name {
        "bool" => Number::Bool,
        "int8" => Number::I8,
        "uint8" | "char" => Number::U8,
        "int16" => Number::I16,
        "uint16" => Number::U16,
        "int32" => Number::I32,
        "uint32" => Number::U32,
        "int64" => Number::I64,
        "uint64" => Number::U64,
        "float32" => Number::F32,
        "float64" => Number::F64,
        "string" => return Some(Kind::Text),
        // ROS 1: two numbers without a definition of their own.
        "time" => {
            let part = |(place, name): (usize, &str)| Field {
                name: name.to_owned(),
                number: place as u32 + 1,
                kind: Kind::Number(Number::U32),
                count: Count::One,
            };
            let parts = ["secs", "nsecs"].into_iter().enumerate();
            return Some(Kind::Message(parts.map(part).collect()));
        }
        _ => return None,
    };
    Some(Kind::Number(number))
}

/// The fields of a protobuf message.
pub fn protobuf(message: &MessageDescriptor) -> Vec<Field> {
    message
        .fields()
        .map(|field| Field {
            name: field.name().to_owned(),
            number: field.number(),
            kind: match field.kind() {
                ProtobufKind::Message(message) => Kind::Message(protobuf(&message)),
                ProtobufKind::String => Kind::Text,
                ProtobufKind::Bool => Kind::Number(Number::Bool),
                ProtobufKind::Int32 => Kind::Number(Number::I32),
                ProtobufKind::Uint32 => Kind::Number(Number::U32),
                ProtobufKind::Int64 => Kind::Number(Number::I64),
                ProtobufKind::Uint64 => Kind::Number(Number::U64),
                ProtobufKind::Float => Kind::Number(Number::F32),
                ProtobufKind::Double => Kind::Number(Number::F64),
                other => panic!("no definition here has {other:?}"),
            },
            count: if field.is_list() {
                Count::Any
            } else {
                Count::One
            },
        })
        .collect()
}

/// The fields of an object in a JSON schema.
pub fn json(schema: &serde_json::Value) -> Vec<Field> {
    let properties = schema["properties"].as_object().expect("an object");
    properties
        .iter()
        .map(|(name, schema)| {
            let (schema, count) = match schema["type"] == "array" {
                true => (&schema["items"], Count::Any),
                false => (schema, Count::One),
            };
            Field {
                name: name.clone(),
                number: 0,
                kind: match schema["type"].as_str() {
                    Some("object") => Kind::Message(json(schema)),
                    Some("string") => Kind::Text,
                    Some("integer") => Kind::Number(Number::U32),
                    Some("number") => Kind::Number(Number::F64),
                    other => panic!("no schema here has {other:?}"),
                },
                count,
            }
        })
        .collect()
}

/// The fields of a message that mean something, by their paths.
#[derive(Debug, Clone, Default)]
pub struct Wanted(BTreeMap<String, Value>);

#[derive(Debug, Clone)]
pub enum Value {
    Number(f64),
    Text(String),
}

impl Wanted {
    pub fn new() -> Self {
        Self::default()
    }

    pub fn number(mut self, path: &str, number: f64) -> Self {
        self.0.insert(path.to_owned(), Value::Number(number));
        self
    }

    pub fn text(mut self, path: &str, text: &str) -> Self {
        self.0.insert(path.to_owned(), Value::Text(text.to_owned()));
        self
    }

    pub fn numbers<const N: usize>(self, paths: [&str; N], numbers: [f64; N]) -> Self {
        let pairs = paths.into_iter().zip(numbers);
        pairs.fold(self, |wanted, (path, number)| wanted.number(path, number))
    }

    /// A list of numbers.
    pub fn list(self, path: &str, numbers: &[f64]) -> Self {
        let elements = numbers.iter().enumerate();
        elements.fold(self, |wanted, (i, &number)| {
            wanted.number(&format!("{path}[{i}]"), number)
        })
    }

    /// A message of x, y, z.
    pub fn xyz(self, path: &str, vector: Vector3<f64>) -> Self {
        let paths = ["x", "y", "z"].map(|name| format!("{path}.{name}"));
        self.numbers([&paths[0], &paths[1], &paths[2]], vector.into())
    }

    /// A message of x, y, z, w.
    pub fn xyzw(self, path: &str, q: UnitQuaternion<f64>) -> Self {
        self.xyz(path, q.imag()).number(&format!("{path}.w"), q.w)
    }

    /// A list of w, x, y, z.
    pub fn wxyz(self, path: &str, q: UnitQuaternion<f64>) -> Self {
        self.list(path, &[q.w, q.i, q.j, q.k])
    }

    pub fn take(&mut self, path: &str) -> Option<Value> {
        self.0.remove(path)
    }

    /// How many elements of a list are wanted.
    pub fn length(&self, path: &str) -> usize {
        let wanted = |i: &usize| {
            let element = format!("{path}[{i}]");
            self.0.keys().any(|key| key.starts_with(&element))
        };
        (0..).take_while(wanted).count()
    }

    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }
}
