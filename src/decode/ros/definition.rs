//! The text of ROS message definitions → the fields that they list, as they are written there.
//!
//! Constants and default values are skipped unread: they are never sent.

use super::layout::Length;
use crate::decode::error::RosDefinitionError;

/// A message type, as a text defines it.
#[derive(Debug, Default)]
pub struct MessageDefinition<'a> {
    /// The name in its `MSG:` line. The text's own type need not have one.
    pub name: Option<&'a str>,
    pub fields: Vec<FieldDefinition<'a>>,
}

/// A field, written like `float32[4] q`.
#[derive(Debug)]
pub struct FieldDefinition<'a> {
    pub name: &'a str,
    /// The type of a single value, without a bound: `float32`, `string`, `Header`, `geometry_msgs/Pose`.
    pub base: &'a str,
    pub list: Option<Length>,
}

/// Parses the definitions in a text, in order: first that of the text's own type, then, each after a separator, those
/// of the types that it refers to. A part without a name after a separator defines nothing.
pub fn parse(text: &str) -> Result<Vec<MessageDefinition<'_>>, RosDefinitionError> {
    let mut definitions = Vec::new();
    let mut current = MessageDefinition::default();
    for (line, number) in text.trim_start_matches('\u{feff}').lines().zip(1..) {
        let code = line.split_once('#').map_or(line, |(code, _)| code).trim();
        if is_separator(code) {
            definitions.push(std::mem::take(&mut current));
        } else if let Some(name) = code.strip_prefix("MSG:")
            && current.name.is_none()
            && current.fields.is_empty()
        {
            current.name = Some(name.trim());
        } else if !code.is_empty() && (current.name.is_some() || definitions.is_empty()) {
            current.fields.extend(parse_field(code, number)?);
        }
    }
    definitions.push(current);
    Ok(definitions)
}

fn is_separator(code: &str) -> bool {
    code.len() >= 3 && code.bytes().all(|byte| byte == b'=')
}

/// Parses a field; `None` if it is a constant.
fn parse_field(code: &str, line: usize) -> Result<Option<FieldDefinition<'_>>, RosDefinitionError> {
    let no_field = || RosDefinitionError::NoField {
        line,
        text: code.into(),
    };
    let (type_name, rest) = code.split_once(char::is_whitespace).ok_or_else(no_field)?;
    let rest = rest.trim_start();
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let (name, rest) = rest.split_at(rest.find(|c| !is_part(c)).unwrap_or(rest.len()));
    if name.is_empty() || !(rest.is_empty() || rest.starts_with([' ', '\t', '='])) {
        return Err(no_field());
    }
    if rest.trim_start().starts_with('=') {
        return Ok(None);
    }
    let (base, list) = match type_name.split_once('[') {
        Some((base, size)) => {
            let invalid = || RosDefinitionError::ArraySize {
                line,
                type_name: type_name.into(),
            };
            (base, Some(parse_array_size(size).ok_or_else(invalid)?))
        }
        None => (type_name, None),
    };
    let not_a_type = || RosDefinitionError::NotAType {
        line,
        type_name: type_name.into(),
    };
    let base = parse_base(base).ok_or_else(not_a_type)?;
    Ok(Some(FieldDefinition { name, base, list }))
}

/// Parses what comes after an opening bracket. A bounded list is sent like an unbounded one.
fn parse_array_size(text: &str) -> Option<Length> {
    let size = text.strip_suffix(']')?;
    match size.strip_prefix("<=") {
        Some(bound) => bound.parse::<usize>().ok().map(|_| Length::Sent),
        None if size.is_empty() => Some(Length::Sent),
        None => size.parse().ok().map(Length::Fixed),
    }
}

/// Parses the type of a single value. A bounded string is sent like an unbounded one.
fn parse_base(text: &str) -> Option<&str> {
    if let Some((string @ ("string" | "wstring"), bound)) = text.split_once("<=") {
        return bound.parse::<usize>().ok().map(|_| string);
    }
    let has_name = match text.rsplit_once('/') {
        Some((package, name)) => !package.is_empty() && !name.is_empty(),
        None => !text.is_empty(),
    };
    (has_name && !text.contains('=')).then_some(text)
}
