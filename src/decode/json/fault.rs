//! What is wrong with a JSON message that cannot be decoded.

use std::ops::Range;

use serde_json::{Value, error::Category};

use super::{decoder::JsonTree, non_finite};
use crate::decode::{
    fault::{Content, Fault, beginning},
    path::{FieldPath, PathStep},
    tree::FieldTree,
    value::Number,
};

/// What is wrong with a message if it is not JSON.
pub fn of_message(message: &[u8]) -> Option<Fault> {
    let error = serde_json::from_slice::<Value>(&non_finite::blank(message)).err()?;
    Fault::of_bytes(message).or_else(|| Some(at_error(message, &error)))
}

/// What is wrong where the parser stopped. Bare numbers that are not finite do not count.
pub fn at_error(message: &[u8], error: &serde_json::Error) -> Fault {
    let offset = offset_of(message, error.line(), error.column());
    let (place, value) = locate(message, offset);
    let field = FieldPath::of_steps(place);
    if error.classify() == Category::Eof {
        return Fault::JsonEnds {
            field,
            length: message.len(),
        };
    }
    let whole = error.to_string();
    let problem = whole
        .split_once(" at line ")
        .map_or(whole.as_str(), |(problem, _)| problem);
    Fault::NotJson {
        field,
        problem: beginning(problem),
        offset: value.start,
        text: beginning(&String::from_utf8_lossy(&message[value])),
    }
}

/// The offset of the byte that the parser stopped at. It counts lines and columns from 1.
fn offset_of(message: &[u8], line: usize, column: usize) -> usize {
    let lines = message.split_inclusive(|byte| *byte == b'\n');
    let before: usize = lines.take(line.saturating_sub(1)).map(<[u8]>::len).sum();
    (before + column.saturating_sub(1)).min(message.len())
}

/// The path of the value that there is at an offset, and where the word there begins and ends.
fn locate(json: &[u8], offset: usize) -> (Vec<PathStep>, Range<usize>) {
    // The steps to where the scan is; `None` in an object before its first key.
    let mut steps: Vec<Option<PathStep>> = Vec::new();
    let mut at = 0;
    let mut word = 0..0;
    while at < json.len() && at <= offset {
        let end = match json[at] {
            b'"' => non_finite::end_of_string(json, at + 1),
            byte if is_of_value(byte) => {
                let rest = json[at..].iter().take_while(|byte| is_of_value(**byte));
                at + rest.count()
            }
            _ => at + 1,
        };
        word = at..end;
        match json[at] {
            b'{' => steps.push(None),
            b'[' => steps.push(Some(PathStep::Index(0))),
            b'}' | b']' => drop(steps.pop()),
            b',' => {
                if let Some(Some(PathStep::Index(index))) = steps.last_mut() {
                    *index += 1;
                }
            }
            b'"' if is_key(&json[end..]) => {
                if let Some(step) = steps.last_mut() {
                    let name = serde_json::from_slice(&json[at..end]).unwrap_or_default();
                    *step = Some(PathStep::Name(name));
                }
            }
            _ => {}
        }
        at = end;
    }
    (steps.into_iter().map_while(|step| step).collect(), word)
}

/// Whether a string before this is a key.
fn is_key(rest: &[u8]) -> bool {
    rest.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b':')
}

fn is_of_value(byte: u8) -> bool {
    !byte.is_ascii_whitespace() && !matches!(byte, b'"' | b'{' | b'}' | b'[' | b']' | b',' | b':')
}

/// What is wrong with the first value that is not what is wanted of it.
pub fn of_values(fields: &[(String, JsonTree)], message: &[u8]) -> Option<Fault> {
    let lossy = String::from_utf8_lossy(message);
    let message = non_finite::parse(lossy.as_bytes()).ok()?;
    in_object(fields, &message, &mut Vec::new())
}

fn in_object(
    fields: &[(String, JsonTree)],
    value: &Value,
    place: &mut Vec<PathStep>,
) -> Option<Fault> {
    match value {
        Value::Null => None,
        Value::Object(object) => fields.iter().find_map(|(name, node)| {
            place.push(PathStep::Name(name.clone()));
            let fault = object
                .get(name)
                .and_then(|value| in_tree(node, value, place));
            place.pop();
            fault
        }),
        other => unlike(place, other, Content::Object),
    }
}

fn in_tree(node: &JsonTree, value: &Value, place: &mut Vec<PathStep>) -> Option<Fault> {
    match (node, value) {
        (_, Value::Null) => None,
        (FieldTree::Message(fields), value) => in_object(fields, value, place),
        (FieldTree::List { elements, .. }, Value::Array(list)) => {
            elements.iter().find_map(|(index, node)| {
                place.push(PathStep::Index(*index));
                let fault = list
                    .get(*index)
                    .and_then(|value| in_tree(node, value, place));
                place.pop();
                fault
            })
        }
        (FieldTree::First(first), Value::Array(list)) => {
            let mut elements = list.iter().enumerate();
            elements.find_map(|(index, value)| {
                place.push(PathStep::Index(index));
                let fault = in_object(&first.element, value, place);
                place.pop();
                fault
            })
        }
        (FieldTree::List { .. } | FieldTree::First(_), other) => {
            unlike(place, other, Content::List)
        }
        (FieldTree::Leaf(leaf), value) if leaf.is_text => match value {
            Value::Array(_) | Value::Object(_) => unlike(place, value, Content::Text),
            _ => None,
        },
        (FieldTree::Leaf(_), Value::Array(list)) => {
            let mut elements = list.iter().enumerate();
            elements.find_map(|(index, value)| {
                place.push(PathStep::Index(index));
                let fault = unless_number(place, value);
                place.pop();
                fault
            })
        }
        (FieldTree::Leaf(_), value) => unless_number(place, value),
    }
}

fn unless_number(place: &[PathStep], value: &Value) -> Option<Fault> {
    match value {
        Value::Null | Value::Bool(_) | Value::Number(_) => None,
        Value::String(text) if Number::in_text(text).is_some() => None,
        other => unlike(place, other, Content::Number),
    }
}

fn unlike(place: &[PathStep], value: &Value, wanted: Content) -> Option<Fault> {
    Some(match FieldPath::of_steps(place.to_vec()) {
        Some(field) => Fault::Value {
            field,
            value: beginning(&value.to_string()),
            wanted,
        },
        None => Fault::NotAnObject {
            value: beginning(&value.to_string()),
        },
    })
}
