//! ROS 2 messages read by walking over their definition, field by field. It shares nothing with the program.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use super::ros::{Field, List, Types};

/// The types of a definition in which several are joined, the first of which is `root`, `pkg/msg/Type`.
pub fn types(root: &str, text: &str) -> Types {
    let mut types = BTreeMap::new();
    let separator = format!("\n{}\nMSG: ", "=".repeat(80));
    let mut parts = text.split(&separator);
    types.insert(short(root), fields(parts.next().expect("the type itself")));
    for part in parts {
        let (name, definition) = part.split_once('\n').expect("a name");
        let earlier = types.insert(name.to_owned(), fields(definition));
        assert!(earlier.is_none(), "{name} is defined twice");
    }
    Types(types)
}

/// `pkg/Type`.
pub fn short(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// Constants and default values are left out.
fn fields(definition: &str) -> Vec<Field> {
    let lines = definition.lines().filter_map(|line| {
        let line = line.split('#').next().expect("what is before a comment");
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [kind, name, ..] if !line.contains('=') => Some(format!("{kind} {name}")),
            _ => None,
        }
    });
    lines.map(|line| line.parse().expect("a field")).collect()
}

const PRIMITIVES: [&str; 8] = [
    "bool", "int8", "uint8", "uint16", "int32", "uint32", "float32", "float64",
];

/// The full name of the message that a field of the type `within` holds; `None` if it is no message.
fn message_of(field: &Field, within: &str) -> Option<String> {
    if field.base == "string" || PRIMITIVES.contains(&&*field.base) {
        return None;
    }
    let (package, _) = within.split_once('/').expect("a package");
    Some(match field.base.contains('/') {
        true => field.base.clone(),
        false => format!("{package}/{}", field.base),
    })
}

/// All types that a type is made of, itself included.
pub fn referred_to(types: &Types, root: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::from([root.to_owned()]);
    let fields = types.0.get(root).unwrap_or_else(|| panic!("no {root}"));
    for name in fields.iter().filter_map(|field| message_of(field, root)) {
        found.extend(referred_to(types, &name));
    }
    found
}

/// The type of a field, of a path like `pose.position.x`.
pub fn type_of(types: &Types, root: &str, path: &str) -> String {
    let mut found = root.to_owned();
    for name in path.split('.') {
        let field = types.0[&found].iter().find(|field| field.name == name);
        let field = field.unwrap_or_else(|| panic!("no {path} in {root}"));
        found = message_of(field, &found).unwrap_or_else(|| field.base.clone());
    }
    found
}

/// A message in CDR as JSON; NaN is null. There is nothing after it, and its padding is zeros.
pub fn deserialize(types: &Types, root: &str, payload: &[u8]) -> Value {
    let (header, body) = payload.split_first_chunk().expect("a header");
    assert_eq!(header, &[0, 1, 0, 0], "CDR, little-endian");
    let mut walk = Walk { types, body, at: 0 };
    let message = walk.message(root);
    assert_eq!(walk.at, body.len(), "the end of the message");
    message
}

struct Walk<'a> {
    types: &'a Types,
    body: &'a [u8],
    at: usize,
}

impl Walk<'_> {
    fn message(&mut self, name: &str) -> Value {
        let fields = self.types.0.get(name);
        let fields = fields.unwrap_or_else(|| panic!("no definition of {name}"));
        let mut message = Map::new();
        for field in fields {
            let value = match field.list {
                List::No => self.one(field, name),
                List::Fixed(length) => self.list(length, field, name),
                List::Varying => {
                    let length = u32::from_le_bytes(self.number());
                    self.list(length as usize, field, name)
                }
                List::Bounded(_) => panic!("{} is bounded", field.name),
            };
            message.insert(field.name.clone(), value);
        }
        message.into()
    }

    fn list(&mut self, length: usize, field: &Field, within: &str) -> Value {
        (0..length).map(|_| self.one(field, within)).collect()
    }

    fn one(&mut self, field: &Field, within: &str) -> Value {
        if let Some(name) = message_of(field, within) {
            return self.message(&name);
        }
        match &*field.base {
            "string" => self.text().into(),
            "bool" => match self.number() {
                [0] => false.into(),
                [1] => true.into(),
                other => panic!("{other:?} is no truth value"),
            },
            "int8" => i8::from_le_bytes(self.number()).into(),
            "uint8" => u8::from_le_bytes(self.number()).into(),
            "uint16" => u16::from_le_bytes(self.number()).into(),
            "int32" => i32::from_le_bytes(self.number()).into(),
            "uint32" => u32::from_le_bytes(self.number()).into(),
            "float32" => f32::from_le_bytes(self.number()).into(),
            "float64" => f64::from_le_bytes(self.number()).into(),
            other => panic!("{other}"),
        }
    }

    fn text(&mut self) -> String {
        let length = u32::from_le_bytes(self.number()) as usize;
        let bytes = &self.body[self.at..self.at + length];
        self.at += length;
        let (end, text) = bytes.split_last().expect("a 0 at least");
        assert_eq!(*end, 0);
        String::from_utf8(text.to_vec()).expect("UTF-8")
    }

    fn number<const SIZE: usize>(&mut self) -> [u8; SIZE] {
        let start = self.at.next_multiple_of(SIZE);
        let padding = &self.body[self.at..start];
        assert!(padding.iter().all(|&byte| byte == 0), "{padding:?}");
        self.at = start + SIZE;
        self.body[start..self.at].try_into().expect("its size")
    }
}
