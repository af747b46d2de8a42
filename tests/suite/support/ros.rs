//! ROS messages as a plain serialiser writes them, field by field, and the text of their definitions. It shares
//! nothing with the program.

use std::{collections::BTreeMap, str::FromStr};

use serde_json::Value;

/// How messages are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wire {
    LittleEndian,
    BigEndian,
    Ros1,
}

impl Wire {
    pub const ALL: [Self; 3] = [Self::LittleEndian, Self::BigEndian, Self::Ros1];

    pub fn message_encoding(self) -> &'static str {
        match self {
            Self::LittleEndian | Self::BigEndian => "cdr",
            Self::Ros1 => "ros1",
        }
    }

    pub fn schema_encoding(self) -> &'static str {
        match self {
            Self::LittleEndian | Self::BigEndian => "ros2msg",
            Self::Ros1 => "ros1msg",
        }
    }

    /// The types that need no definition.
    fn built_in(self) -> Types {
        match self {
            Self::LittleEndian | Self::BigEndian => Types::from([
                ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec"),
                ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec"),
            ]),
            Self::Ros1 => Types::from([
                ("time", "uint32 sec\nuint32 nsec"),
                ("duration", "int32 sec\nint32 nsec"),
            ]),
        }
    }
}

/// A field of a message, written like `float32[4] q`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// The type of a single value.
    pub base: String,
    pub list: List,
    pub name: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum List {
    /// A single value.
    No,
    Fixed(usize),
    Varying,
    /// Varying, up to that many. ROS 1 does not have it.
    Bounded(usize),
}

impl Field {
    fn line(&self) -> String {
        let list = match self.list {
            List::No => String::new(),
            List::Fixed(length) => format!("[{length}]"),
            List::Varying => "[]".to_owned(),
            List::Bounded(most) => format!("[<={most}]"),
        };
        format!("{}{list} {}\n", self.base, self.name)
    }
}

impl FromStr for Field {
    type Err = String;

    fn from_str(line: &str) -> Result<Self, String> {
        let not_a_field = || format!("`{line}` is not a field");
        let (kind, name) = line.split_once(' ').ok_or_else(not_a_field)?;
        let (base, list) = match kind.strip_suffix(']') {
            None => (kind, List::No),
            Some(kind) => {
                let (base, length) = kind.split_once('[').ok_or_else(not_a_field)?;
                let number = |text: &str| text.parse().map_err(|_| not_a_field());
                let list = match (length, length.strip_prefix("<=")) {
                    ("", _) => List::Varying,
                    (_, Some(most)) => List::Bounded(number(most)?),
                    (length, None) => List::Fixed(number(length)?),
                };
                (base, list)
            }
        };
        Ok(Self {
            base: base.to_owned(),
            list,
            name: name.to_owned(),
        })
    }
}

/// The types that a message is made of, by their full names, `pkg/Type`.
#[derive(Debug, Clone, Default)]
pub struct Types(pub BTreeMap<String, Vec<Field>>);

impl<const N: usize> From<[(&str, &str); N]> for Types {
    /// Of names and lines of fields.
    fn from(definitions: [(&str, &str); N]) -> Self {
        let types = definitions.map(|(name, lines)| {
            let fields = lines.lines().map(|line| line.parse().expect("a field"));
            (name.to_owned(), fields.collect())
        });
        Self(types.into())
    }
}

impl Types {
    /// The definition of a type, followed by all others.
    pub fn text(&self, name: &str) -> String {
        let lines = |fields: &[Field]| fields.iter().map(Field::line).collect::<String>();
        let mut text = lines(&self.0[name]);
        for (other, fields) in self.0.iter().filter(|(other, _)| *other != name) {
            text += &format!("{}\nMSG: {other}\n{}", "=".repeat(80), lines(fields));
        }
        text
    }

    /// A message of that type, of an object that has its fields.
    pub fn serialize(&self, wire: Wire, name: &str, message: &Value) -> Vec<u8> {
        let mut types = self.clone();
        types.0.extend(wire.built_in().0);
        let mut serializer = Serializer {
            wire,
            types: &types,
            body: Vec::new(),
        };
        serializer.message(name, message);
        let header: &[u8] = match wire {
            Wire::LittleEndian => &[0, 1, 0, 0],
            Wire::BigEndian => &[0, 0, 0, 0],
            Wire::Ros1 => &[],
        };
        [header, &serializer.body].concat()
    }
}

struct Serializer<'a> {
    wire: Wire,
    types: &'a Types,
    /// Without the header, from where alignment counts.
    body: Vec<u8>,
}

impl Serializer<'_> {
    fn message(&mut self, name: &str, message: &Value) {
        let fields = &self.types.0[name];
        if fields.is_empty() && self.wire != Wire::Ros1 {
            self.body.push(0);
        }
        for field in fields {
            let value = &message[&field.name];
            match field.list {
                List::No => self.one(&field.base, value),
                List::Fixed(_) | List::Varying | List::Bounded(_) => self.list(field, value),
            }
        }
    }

    fn list(&mut self, field: &Field, list: &Value) {
        let elements = list.as_array().expect("a list");
        match field.list {
            List::Fixed(length) => assert_eq!(elements.len(), length, "{}", field.name),
            _ => self.number((elements.len() as u32).to_le_bytes()),
        }
        for element in elements {
            self.one(&field.base, element);
        }
    }

    fn one(&mut self, base: &str, value: &Value) {
        let signed = || value.as_i64().expect("a whole number");
        let unsigned = || value.as_u64().expect("a whole number from 0");
        let real = || value.as_f64().expect("a number");
        match base {
            "bool" => self.number([value.as_bool().expect("a truth value").into()]),
            "byte" if self.wire == Wire::Ros1 => self.number((signed() as i8).to_le_bytes()),
            "uint8" | "char" | "byte" => self.number((unsigned() as u8).to_le_bytes()),
            "uint16" => self.number((unsigned() as u16).to_le_bytes()),
            "uint32" => self.number((unsigned() as u32).to_le_bytes()),
            "uint64" => self.number(unsigned().to_le_bytes()),
            "int8" => self.number((signed() as i8).to_le_bytes()),
            "int16" => self.number((signed() as i16).to_le_bytes()),
            "int32" => self.number((signed() as i32).to_le_bytes()),
            "int64" => self.number(signed().to_le_bytes()),
            "float32" => self.number((real() as f32).to_le_bytes()),
            "float64" => self.number(real().to_le_bytes()),
            text if text.starts_with("string") => self.text(value.as_str().expect("text")),
            message => self.message(message, value),
        }
    }

    fn text(&mut self, text: &str) {
        let end: &[u8] = if self.wire == Wire::Ros1 { &[] } else { &[0] };
        self.number(((text.len() + end.len()) as u32).to_le_bytes());
        self.body.extend(text.as_bytes());
        self.body.extend(end);
    }

    /// A number, given with its lowest byte first.
    fn number<const N: usize>(&mut self, mut bytes: [u8; N]) {
        if self.wire != Wire::Ros1 {
            while !self.body.len().is_multiple_of(N) {
                self.body.push(0);
            }
        }
        if self.wire == Wire::BigEndian {
            bytes.reverse();
        }
        self.body.extend(bytes);
    }
}
